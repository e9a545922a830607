// A 7 × 7 convolution of stride 1 done directly, as a product of matrices that are never written out: what the
// transforms of `convolution.wgsl` are measured against. Forward only, without activation.

struct Shape {
    // Columns and rows.
    size: vec2u,
    // Vectors of four channels in and out.
    quads: u32,
    quads_out: u32,
    periodic: u32,
}

@group(0) @binding(0) var<uniform> shape: Shape;
@group(0) @binding(1) var<storage, read> image: array<vec4f>;
// [row, column, channel in, channel out / 4].
@group(0) @binding(2) var<storage, read> weights: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> result: array<vec4f>;

const KERNEL = 7u;
// Pixels along a side of a workgroup's block, and with what the kernel reaches beyond.
const BLOCK = 8u;
const SIDE = BLOCK + KERNEL - 1u;
// Vectors of outer channels of a workgroup.
const OUT = 16u;
const THREADS = OUT * 16u;

var<workgroup> patch_of: array<vec4f, SIDE * SIDE>;
// Of one row of the kernel: [column, channel in, channel out / 4].
var<workgroup> factors: array<vec4f, KERNEL * 4u * OUT>;

fn sample_at(position: vec2i, quad: u32) -> vec4f {
    var at = position;
    let size = vec2i(shape.size);
    if (any(at < vec2i(0)) || any(at >= size)) {
        if (shape.periodic == 0u) {
            return vec4f(0.0);
        }
        at = ((at % size) + size) % size;
    }
    return image[u32(at.y * size.x + at.x) * shape.quads + quad];
}

fn accumulate(sum: vec4f, a: vec4f, b: u32) -> vec4f {
    return sum + a.x * factors[b] + a.y * factors[b + OUT] + a.z * factors[b + 2u * OUT] + a.w * factors[b + 3u * OUT];
}

// Workgroups: columns and rows of blocks × groups of 64 outer channels. An invocation makes four pixels in a row by
// four channels.
@compute @workgroup_size(THREADS)
fn convolve(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let origin = vec2i(group.xy * BLOCK) - 3;
    let column = lane % OUT;
    let x = (lane / OUT) % 2u * 4u;
    let y = lane / OUT / 2u;
    var s0 = vec4f(0.0);
    var s1 = s0;
    var s2 = s0;
    var s3 = s0;
    for (var quad = 0u; quad < shape.quads; quad++) {
        for (var i = lane; i < SIDE * SIDE; i += THREADS) {
            patch_of[i] = sample_at(origin + vec2i(vec2u(i % SIDE, i / SIDE)), quad);
        }
        for (var ky = 0u; ky < KERNEL; ky++) {
            for (var i = lane; i < KERNEL * 4u * OUT; i += THREADS) {
                let outer = group.z * OUT + i % OUT;
                let inner = 4u * quad + i / OUT % 4u;
                let kx = i / OUT / 4u;
                var value = vec4f(0.0);
                if (outer < shape.quads_out) {
                    value = weights[((ky * KERNEL + kx) * 4u * shape.quads + inner) * shape.quads_out + outer];
                }
                factors[i] = value;
            }
            workgroupBarrier();
            for (var kx = 0u; kx < KERNEL; kx++) {
                let a = (y + ky) * SIDE + x + kx;
                let b = kx * 4u * OUT + column;
                s0 = accumulate(s0, patch_of[a], b);
                s1 = accumulate(s1, patch_of[a + 1u], b);
                s2 = accumulate(s2, patch_of[a + 2u], b);
                s3 = accumulate(s3, patch_of[a + 3u], b);
            }
            workgroupBarrier();
        }
    }
    let outer = group.z * OUT + column;
    let pixel = group.xy * BLOCK + vec2u(x, y);
    if (outer >= shape.quads_out || pixel.y >= shape.size.y) {
        return;
    }
    let at = (pixel.y * shape.size.x + pixel.x) * shape.quads_out + outer;
    if (pixel.x < shape.size.x) {
        result[at] = s0;
    }
    if (pixel.x + 1u < shape.size.x) {
        result[at + shape.quads_out] = s1;
    }
    if (pixel.x + 2u < shape.size.x) {
        result[at + 2u * shape.quads_out] = s2;
    }
    if (pixel.x + 3u < shape.size.x) {
        result[at + 3u * shape.quads_out] = s3;
    }
}
