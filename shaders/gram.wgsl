// Gram matrices of activations, their loss and its gradient. Twin of engine/cpu/gram.rs.
//
// G = F Fᵀ / (C · H · W): only blocks on and above the diagonal are made, in parts of the image that are added up
// in order. Set by the host: BLOCK, the channels of a block (a multiple of 4, at most 64).

struct Shape {
    // First column and row, columns and rows of the pixels that count.
    origin: vec2u,
    size: vec2u,
    // Columns of the image, vectors of four channels a pixel.
    width: u32,
    quads: u32,
    // Pixels a part.
    part: u32,
    parts: u32,
    // 1 / (C · H · W) and the weight of the loss.
    scale: f32,
    weight: f32,
    // Whether there is a target.
    judged: u32,
}

@group(0) @binding(0) var<uniform> shape: Shape;
@group(0) @binding(1) var<storage, read> image: array<vec4f>;
// Mean and inverse deviation, alternating.
@group(0) @binding(2) var<storage, read> moments: array<vec4f>;
// [part, channel, channel].
@group(0) @binding(3) var<storage, read_write> partial: array<f32>;
// [channel, channel].
@group(0) @binding(4) var<storage, read_write> matrix: array<f32>;
@group(0) @binding(5) var<storage, read> target_matrix: array<f32>;
// Loss of every element.
@group(0) @binding(6) var<storage, read_write> losses: array<f32>;
// 4 w (G̃ − G) / (C · H · W).
@group(0) @binding(7) var<storage, read_write> slopes: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> gradient: array<vec4f>;
// The same memory as `slopes`, written number by number.
@group(0) @binding(9) var<storage, read_write> slope_numbers: array<f32>;

const OUT = BLOCK / 4u;
const THREADS = OUT * OUT;
const DEPTH = 16u;

var<workgroup> left: array<vec4f, DEPTH * OUT>;
var<workgroup> right: array<vec4f, DEPTH * OUT>;

fn activation(pixel: u32, quad: u32) -> vec4f {
    let value = image[pixel * shape.quads + quad];
    return max((value - moments[2u * quad]) * moments[2u * quad + 1u], vec4f(0.0));
}

// Activation of the i-th pixel that counts, or nothing.
fn load(i: u32, end: u32, quad: u32) -> vec4f {
    if (i >= end || quad >= shape.quads) {
        return vec4f(0.0);
    }
    let at = shape.origin + vec2u(i % shape.size.x, i / shape.size.x);
    return activation(at.y * shape.width + at.x, quad);
}

// Workgroups: blocks of rows × blocks of columns × parts.
@compute @workgroup_size(THREADS)
fn measure(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    if (group.x > group.y) {
        return;
    }
    let first = group.z * shape.part;
    let end = min(first + shape.part, shape.size.x * shape.size.y);
    let row = lane / OUT;
    let column = lane % OUT;
    var s0 = vec4f(0.0);
    var s1 = s0;
    var s2 = s0;
    var s3 = s0;
    for (var depth = first; depth < end; depth += DEPTH) {
        for (var i = lane; i < DEPTH * OUT; i += THREADS) {
            left[i] = load(depth + i / OUT, end, group.x * OUT + i % OUT);
            right[i] = load(depth + i / OUT, end, group.y * OUT + i % OUT);
        }
        workgroupBarrier();
        for (var k = 0u; k < DEPTH; k++) {
            let a = left[k * OUT + row];
            let b = right[k * OUT + column];
            s0 += a.x * b;
            s1 += a.y * b;
            s2 += a.z * b;
            s3 += a.w * b;
        }
        workgroupBarrier();
    }
    let channels = 4u * shape.quads;
    let first_channel = group.x * BLOCK + 4u * row;
    let second_channel = group.y * BLOCK + 4u * column;
    if (first_channel >= channels || second_channel >= channels) {
        return;
    }
    let at = (group.z * channels + first_channel) * channels + second_channel;
    for (var i = 0u; i < 4u; i++) {
        partial[at + i] = s0[i];
        partial[at + channels + i] = s1[i];
        partial[at + 2u * channels + i] = s2[i];
        partial[at + 3u * channels + i] = s3[i];
    }
}

// One element: adds up the parts and compares.
@compute @workgroup_size(64)
fn compare(@builtin(global_invocation_id) id: vec3u) {
    let channels = 4u * shape.quads;
    if (id.x >= channels * channels) {
        return;
    }
    var first_channel = id.x / channels;
    var second_channel = id.x % channels;
    if (first_channel / BLOCK > second_channel / BLOCK) {
        let swap = first_channel;
        first_channel = second_channel;
        second_channel = swap;
    }
    var sum = 0.0;
    for (var part = 0u; part < shape.parts; part++) {
        sum += partial[(part * channels + first_channel) * channels + second_channel];
    }
    let value = sum * shape.scale;
    matrix[id.x] = value;
    if (shape.judged == 1u) {
        let difference = value - target_matrix[id.x];
        losses[id.x] = shape.weight * difference * difference;
        slope_numbers[id.x] = 4.0 * shape.weight * shape.scale * difference;
    }
}

const PIXELS = 64u;
const PIXEL_ROWS = PIXELS / 4u;
// [pixel, depth / 4] and [depth, channel / 4].
var<workgroup> activations: array<vec4f, PIXELS * DEPTH / 4u>;
var<workgroup> factors: array<vec4f, DEPTH * OUT>;

fn accumulate(sum: vec4f, a: vec4f, b: u32) -> vec4f {
    return sum + a.x * factors[b] + a.y * factors[b + OUT] + a.z * factors[b + 2u * OUT] + a.w * factors[b + 3u * OUT];
}

// Adds dL/dF = slope · F. Workgroups: blocks of channels × blocks of 64 pixels. The region is the whole image.
@compute @workgroup_size(OUT * PIXEL_ROWS)
fn add_gradient(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let pixels = shape.size.x * shape.size.y;
    let first = (group.z * 65535u + group.y) * PIXELS;
    let column = lane % OUT;
    let row = lane / OUT;
    var s0 = vec4f(0.0);
    var s1 = s0;
    var s2 = s0;
    var s3 = s0;
    for (var depth = 0u; depth < shape.quads; depth += DEPTH / 4u) {
        for (var i = lane; i < PIXELS * DEPTH / 4u; i += OUT * PIXEL_ROWS) {
            let pixel = first + i / (DEPTH / 4u);
            let quad = depth + i % (DEPTH / 4u);
            var value = vec4f(0.0);
            if (pixel < pixels && quad < shape.quads) {
                value = activation(pixel, quad);
            }
            activations[i] = value;
        }
        for (var i = lane; i < DEPTH * OUT; i += OUT * PIXEL_ROWS) {
            let inner = 4u * depth + i / OUT;
            let outer = group.x * OUT + i % OUT;
            var value = vec4f(0.0);
            if (inner < 4u * shape.quads && outer < shape.quads) {
                value = slopes[inner * shape.quads + outer];
            }
            factors[i] = value;
        }
        workgroupBarrier();
        for (var k = 0u; k < DEPTH / 4u; k++) {
            let a = row * 4u * (DEPTH / 4u) + k;
            let b = 4u * k * OUT + column;
            s0 = accumulate(s0, activations[a], b);
            s1 = accumulate(s1, activations[a + DEPTH / 4u], b);
            s2 = accumulate(s2, activations[a + 2u * (DEPTH / 4u)], b);
            s3 = accumulate(s3, activations[a + 3u * (DEPTH / 4u)], b);
        }
        workgroupBarrier();
    }
    let outer = group.x * OUT + column;
    if (outer >= shape.quads) {
        return;
    }
    let pixel = first + 4u * row;
    let at = pixel * shape.quads + outer;
    if (pixel < pixels) {
        gradient[at] += s0;
    }
    if (pixel + 1u < pixels) {
        gradient[at + shape.quads] += s1;
    }
    if (pixel + 2u < pixels) {
        gradient[at + 2u * shape.quads] += s2;
    }
    if (pixel + 3u < pixels) {
        gradient[at + 3u * shape.quads] += s3;
    }
}
