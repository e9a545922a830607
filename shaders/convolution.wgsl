// 7 × 7 convolutions by Fourier transforms of 16 × 16 tiles (overlap-save). Twin of engine/cpu/convolution.rs.
//
// Three kernels: `transform` cuts an image into tiles and transforms them, `multiply` is one complex product of
// matrices a frequency, `invert` transforms back. Two channels go through a transform as one complex signal, four as
// one vector. Spectra are arrays [frequency, tile, channel / 4] of two vectors: real and imaginary parts.
//
// Set by the host: BLOCK_TILES, BLOCK_CHANNELS (what one workgroup multiplies) and THREADS.

struct Shape {
    // Of the image that is read or written, in its own pixels: columns, rows.
    size: vec2u,
    // Vectors of four channels a pixel.
    quads: u32,
    // Columns of tiles in the whole grid of tiles.
    tile_columns: u32,
    // First tile of this pass, and how many.
    first_tile: u32,
    tiles: u32,
    // Pixels of the convolution's input for each pixel of the image: 2 on the far side of a strided layer.
    stride: u32,
    // First row and column of a tile that hold a valid output.
    first: u32,
    periodic: u32,
    // Whether the image is normalised and rectified on the way in.
    activated: u32,
    // Vectors of four channels of the product's other side, and the first frequency of this dispatch.
    quads_out: u32,
    first_frequency: u32,
    // Columns and rows of the convolution's input.
    extent: vec2u,
}

@group(0) @binding(0) var<uniform> shape: Shape;
@group(0) @binding(1) var<storage, read> image: array<vec4f>;
// Mean and inverse deviation, alternating, of four channels each.
@group(0) @binding(2) var<storage, read> moments: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> spectra: array<vec4f>;
@group(0) @binding(4) var<storage, read> filters: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> products: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> result: array<vec4f>;

const N = 16u;
const HALF = 9u;
const STEP = 10u;
// Vectors of four channels a workgroup transforms.
const QUADS = 2u;

// Two complex signals of one tile; columns are swizzled by the row so that neither rows nor columns share banks.
var<workgroup> tile: array<vec4f, QUADS * N * N>;

fn place(quad: u32, row: u32, column: u32) -> u32 {
    return (quad * N + row) * N + (column ^ row);
}

// Multiplies both signals by −i · s.
fn quarter(a: vec4f, s: f32) -> vec4f {
    return s * vec4f(a.y, -a.x, a.w, -a.z);
}

fn times(a: vec4f, w: vec2f, s: f32) -> vec4f {
    return a * w.x + vec4f(-a.y, a.x, -a.w, a.z) * (w.y * s);
}

struct Four {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

// Transforms of length 4, forward for s = 1 and back for s = −1.
fn four(a: vec4f, b: vec4f, c: vec4f, d: vec4f, s: f32) -> Four {
    let even = a + c;
    let odd = b + d;
    let difference = a - c;
    let turned = quarter(b - d, s);
    return Four(even + odd, difference + turned, even - odd, difference - turned);
}

// e^(−2πi k / 16).
const W1 = vec2f(0.9238795325112867, -0.3826834323650898);
const W2 = vec2f(0.7071067811865476, -0.7071067811865476);
const W3 = vec2f(0.3826834323650898, -0.9238795325112867);
const W4 = vec2f(0.0, -1.0);
const W6 = vec2f(-0.7071067811865476, -0.7071067811865476);
const W9 = vec2f(-0.9238795325112867, 0.3826834323650898);

// Transforms one row (stride_row = 0) or one column of the tile in place. Written out in full: indices that a
// compiler can't resolve would put the sixteen vectors into slow memory.
fn transform_line(quad: u32, line: u32, along_columns: bool, s: f32) {
    var x: array<vec4f, 16>;
    var at: array<u32, 16>;
    at[0] = select(place(quad, line, 0u), place(quad, 0u, line), along_columns);
    at[1] = select(place(quad, line, 1u), place(quad, 1u, line), along_columns);
    at[2] = select(place(quad, line, 2u), place(quad, 2u, line), along_columns);
    at[3] = select(place(quad, line, 3u), place(quad, 3u, line), along_columns);
    at[4] = select(place(quad, line, 4u), place(quad, 4u, line), along_columns);
    at[5] = select(place(quad, line, 5u), place(quad, 5u, line), along_columns);
    at[6] = select(place(quad, line, 6u), place(quad, 6u, line), along_columns);
    at[7] = select(place(quad, line, 7u), place(quad, 7u, line), along_columns);
    at[8] = select(place(quad, line, 8u), place(quad, 8u, line), along_columns);
    at[9] = select(place(quad, line, 9u), place(quad, 9u, line), along_columns);
    at[10] = select(place(quad, line, 10u), place(quad, 10u, line), along_columns);
    at[11] = select(place(quad, line, 11u), place(quad, 11u, line), along_columns);
    at[12] = select(place(quad, line, 12u), place(quad, 12u, line), along_columns);
    at[13] = select(place(quad, line, 13u), place(quad, 13u, line), along_columns);
    at[14] = select(place(quad, line, 14u), place(quad, 14u, line), along_columns);
    at[15] = select(place(quad, line, 15u), place(quad, 15u, line), along_columns);
    let p = four(tile[at[0]], tile[at[4]], tile[at[8]], tile[at[12]], s);
    let q = four(tile[at[1]], tile[at[5]], tile[at[9]], tile[at[13]], s);
    let r = four(tile[at[2]], tile[at[6]], tile[at[10]], tile[at[14]], s);
    let t = four(tile[at[3]], tile[at[7]], tile[at[11]], tile[at[15]], s);
    let k0 = four(p.a, q.a, r.a, t.a, s);
    let k1 = four(p.b, times(q.b, W1, s), times(r.b, W2, s), times(t.b, W3, s), s);
    let k2 = four(p.c, times(q.c, W2, s), times(r.c, W4, s), times(t.c, W6, s), s);
    let k3 = four(p.d, times(q.d, W3, s), times(r.d, W6, s), times(t.d, W9, s), s);
    tile[at[0]] = k0.a;
    tile[at[4]] = k0.b;
    tile[at[8]] = k0.c;
    tile[at[12]] = k0.d;
    tile[at[1]] = k1.a;
    tile[at[5]] = k1.b;
    tile[at[9]] = k1.c;
    tile[at[13]] = k1.d;
    tile[at[2]] = k2.a;
    tile[at[6]] = k2.b;
    tile[at[10]] = k2.c;
    tile[at[14]] = k2.d;
    tile[at[3]] = k3.a;
    tile[at[7]] = k3.b;
    tile[at[11]] = k3.c;
    tile[at[15]] = k3.d;
}

// Column and row of the first output of a tile, in pixels of the convolution's input.
fn corner(index: u32) -> vec2u {
    return STEP * vec2u(index % shape.tile_columns, index / shape.tile_columns);
}

// The image at a position in pixels of the convolution's input; zero beyond an open border and between samples.
fn sample(position: vec2i, quad: u32) -> vec4f {
    var at = position;
    let extent = vec2i(shape.extent);
    if (any(at < vec2i(0)) || any(at >= extent)) {
        if (shape.periodic == 0u) {
            return vec4f(0.0);
        }
        at = ((at % extent) + extent) % extent;
    }
    let pixel = vec2u(at) / shape.stride;
    if (any(pixel * shape.stride != vec2u(at))) {
        return vec4f(0.0);
    }
    let value = image[(pixel.y * shape.size.x + pixel.x) * shape.quads + quad];
    if (shape.activated == 1u) {
        return max((value - moments[2u * quad]) * moments[2u * quad + 1u], vec4f(0.0));
    }
    return value;
}

// Workgroups: tiles × groups of QUADS vectors.
@compute @workgroup_size(N, QUADS)
fn transform(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let first_quad = group.y * QUADS;
    let origin = vec2i(corner(shape.first_tile + group.x)) - 3;
    for (var i = lane; i < N * N * QUADS; i += N * QUADS) {
        let quad = i % QUADS;
        let pixel = i / QUADS;
        let at = vec2u(pixel % N, pixel / N);
        tile[place(quad, at.y, at.x)] = sample(origin + vec2i(at), first_quad + quad);
    }
    workgroupBarrier();
    transform_line(local.y, local.x, false, 1.0);
    workgroupBarrier();
    transform_line(local.y, local.x, true, 1.0);
    workgroupBarrier();
    // Separates the two channels of each signal: a = (z(k) + z̄(−k)) / 2, b = (z(k) − z̄(−k)) / 2i.
    for (var i = lane; i < N * HALF * QUADS; i += N * QUADS) {
        let quad = i % QUADS;
        let frequency = i / QUADS;
        let k = vec2u(frequency % HALF, frequency / HALF);
        let z = tile[place(quad, k.y, k.x)];
        let m = tile[place(quad, (N - k.y) % N, (N - k.x) % N)];
        let at = 2u * ((frequency * shape.tiles + group.x) * shape.quads + first_quad + quad);
        spectra[at] = 0.5 * vec4f(z.x + m.x, z.y + m.y, z.z + m.z, z.w + m.w);
        spectra[at + 1u] = 0.5 * vec4f(z.y - m.y, m.x - z.x, z.w - m.w, m.z - z.z);
    }
}

// Workgroups: tiles × groups of QUADS vectors.
@compute @workgroup_size(N, QUADS)
fn invert(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let first_quad = group.y * QUADS;
    for (var i = lane; i < N * HALF * QUADS; i += N * QUADS) {
        let quad = i % QUADS;
        let frequency = i / QUADS;
        let k = vec2u(frequency % HALF, frequency / HALF);
        let at = 2u * ((frequency * shape.tiles + group.x) * shape.quads + first_quad + quad);
        let re = products[at];
        let im = products[at + 1u];
        // z = a + i b, and z(−k) = ā + i b̄.
        tile[place(quad, k.y, k.x)] = vec4f(re.x - im.y, im.x + re.y, re.z - im.w, im.z + re.w);
        if (k.x > 0u && k.x < HALF - 1u) {
            tile[place(quad, (N - k.y) % N, N - k.x)] = vec4f(re.x + im.y, re.y - im.x, re.z + im.w, re.w - im.z);
        }
    }
    workgroupBarrier();
    transform_line(local.y, local.x, true, -1.0);
    workgroupBarrier();
    transform_line(local.y, local.x, false, -1.0);
    workgroupBarrier();
    let origin = corner(shape.first_tile + group.x);
    for (var i = lane; i < STEP * STEP * QUADS; i += N * QUADS) {
        let quad = i % QUADS;
        let pixel = i / QUADS;
        let inner = vec2u(pixel % STEP, pixel / STEP);
        let position = origin + inner;
        let at = position / shape.stride;
        if (all(position < shape.extent) && all(at * shape.stride == position)) {
            let value = tile[place(quad, shape.first + inner.y, shape.first + inner.x)];
            result[(at.y * shape.size.x + at.x) * shape.quads + first_quad + quad] = value;
        }
    }
}

// Inner channels worked on at a time, in vectors.
const DEPTH = 4u;
const ROWS = 4u;
const OUT = BLOCK_CHANNELS / 4u;
// [tile, depth] and [channel in, channel out / 4], real and imaginary parts alternating.
var<workgroup> left: array<vec4f, BLOCK_TILES * DEPTH * 2u>;
var<workgroup> right: array<vec4f, DEPTH * 4u * OUT * 2u>;

struct Sum {
    re: vec4f,
    im: vec4f,
}

// Adds the products of four inner channels of one tile with four outer channels.
fn accumulate(sum: Sum, a_re: vec4f, a_im: vec4f, b: u32) -> Sum {
    var out = sum;
    let stride = 2u * OUT;
    let r0 = right[b];
    let i0 = right[b + 1u];
    out.re += a_re.x * r0 - a_im.x * i0;
    out.im += a_re.x * i0 + a_im.x * r0;
    let r1 = right[b + stride];
    let i1 = right[b + stride + 1u];
    out.re += a_re.y * r1 - a_im.y * i1;
    out.im += a_re.y * i1 + a_im.y * r1;
    let r2 = right[b + 2u * stride];
    let i2 = right[b + 2u * stride + 1u];
    out.re += a_re.z * r2 - a_im.z * i2;
    out.im += a_re.z * i2 + a_im.z * r2;
    let r3 = right[b + 3u * stride];
    let i3 = right[b + 3u * stride + 1u];
    out.re += a_re.w * r3 - a_im.w * i3;
    out.im += a_re.w * i3 + a_im.w * r3;
    return out;
}

// Workgroups: blocks of outer channels × blocks of tiles × frequencies. An invocation makes four tiles by four
// channels.
@compute @workgroup_size(THREADS)
fn multiply(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let frequency = shape.first_frequency + group.z;
    let first_tile = group.y * BLOCK_TILES;
    let first_out = group.x * OUT;
    let column = lane % OUT;
    let row = lane / OUT;
    var s0 = Sum(vec4f(0.0), vec4f(0.0));
    var s1 = s0;
    var s2 = s0;
    var s3 = s0;
    for (var depth = 0u; depth < shape.quads; depth += DEPTH) {
        for (var i = lane; i < BLOCK_TILES * DEPTH; i += THREADS) {
            let tile_index = first_tile + i / DEPTH;
            let quad = depth + i % DEPTH;
            var re = vec4f(0.0);
            var im = vec4f(0.0);
            if (tile_index < shape.tiles && quad < shape.quads) {
                let at = 2u * ((frequency * shape.tiles + tile_index) * shape.quads + quad);
                re = spectra[at];
                im = spectra[at + 1u];
            }
            left[2u * i] = re;
            left[2u * i + 1u] = im;
        }
        for (var i = lane; i < DEPTH * 4u * OUT; i += THREADS) {
            let inner = depth * 4u + i / OUT;
            let outer = first_out + i % OUT;
            var re = vec4f(0.0);
            var im = vec4f(0.0);
            if (inner < 4u * shape.quads && outer < shape.quads_out) {
                let at = 2u * ((frequency * 4u * shape.quads + inner) * shape.quads_out + outer);
                re = filters[at];
                im = filters[at + 1u];
            }
            right[2u * i] = re;
            right[2u * i + 1u] = im;
        }
        workgroupBarrier();
        for (var quad = 0u; quad < DEPTH; quad++) {
            let a = 2u * (row * ROWS * DEPTH + quad);
            let b = 2u * (quad * 4u * OUT + column);
            s0 = accumulate(s0, left[a], left[a + 1u], b);
            s1 = accumulate(s1, left[a + 2u * DEPTH], left[a + 2u * DEPTH + 1u], b);
            s2 = accumulate(s2, left[a + 4u * DEPTH], left[a + 4u * DEPTH + 1u], b);
            s3 = accumulate(s3, left[a + 6u * DEPTH], left[a + 6u * DEPTH + 1u], b);
        }
        workgroupBarrier();
    }
    let outer = first_out + column;
    if (outer >= shape.quads_out) {
        return;
    }
    let t = first_tile + row * ROWS;
    let at = 2u * ((frequency * shape.tiles + t) * shape.quads_out + outer);
    let next = 2u * shape.quads_out;
    if (t < shape.tiles) {
        products[at] = s0.re;
        products[at + 1u] = s0.im;
    }
    if (t + 1u < shape.tiles) {
        products[at + next] = s1.re;
        products[at + next + 1u] = s1.im;
    }
    if (t + 2u < shape.tiles) {
        products[at + 2u * next] = s2.re;
        products[at + 2u * next + 1u] = s2.im;
    }
    if (t + 3u < shape.tiles) {
        products[at + 3u * next] = s3.re;
        products[at + 3u * next + 1u] = s3.im;
    }
}
