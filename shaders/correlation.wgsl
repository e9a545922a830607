// Autocorrelation of every channel of the last layer, its loss and its gradient. Twin of engine/cpu/correlation.rs.
//
// By Fourier transforms of whole planes, two channels as one complex signal. A workgroup transforms one line of any
// length in workgroup memory (Stockham's scheme in mixed radix; a prime factor costs its size). Planes are kept
// column by column where columns are transformed next, row by row where rows are.
//
// Set by the host: LENGTH, the longer side of a plane, and LINES, 2 · LENGTH.

struct Plane {
    // Columns and rows.
    size: vec2u,
    // Columns and rows of the region, and its first column and row in the image.
    region: vec2u,
    origin: vec2u,
    // Columns and rows of lags.
    lags: vec2u,
    // Columns of the image, its padded channels, and those that count.
    width: u32,
    channels: u32,
    real_channels: u32,
    periodic: u32,
    // Whether there is a target.
    judged: u32,
    // Weight over the number of channels and lags.
    mean: f32,
    // In `columns_forward`, rows below the first and from the second on hold something.
    held: vec2u,
    // Factors of the number of columns and of rows, 0 after the last.
    column_factors: array<vec4u, 3>,
    row_factors: array<vec4u, 3>,
}

@group(0) @binding(0) var<uniform> plane: Plane;
@group(0) @binding(1) var<storage, read> image: array<f32>;
// Means of four channels, inverse deviations of the same, and so on.
@group(0) @binding(2) var<storage, read> moments: array<f32>;
// Roots of unity of order columns, then of order rows.
@group(0) @binding(3) var<storage, read> roots: array<vec2f>;
@group(0) @binding(4) var<storage, read_write> lines: array<vec2f>;
// [pair, column, row]: transforms of the activations.
@group(0) @binding(5) var<storage, read_write> spectra: array<vec2f>;
// [channel, lag row, lag column].
@group(0) @binding(6) var<storage, read_write> values: array<f32>;
@group(0) @binding(7) var<storage, read> target_values: array<f32>;
// One a pair and row of lags.
@group(0) @binding(8) var<storage, read_write> losses: array<f32>;
// [pair, column, row]: slopes, then their transforms.
@group(0) @binding(9) var<storage, read_write> slopes: array<vec2f>;
@group(0) @binding(10) var<storage, read_write> gradient: array<f32>;

const THREADS = 64u;

var<workgroup> line: array<vec2f, LINES>;

fn times(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

// Transforms the first `length` numbers of `line`; `sign` is 1 forward and −1 back. Returns where the result begins.
fn transform(lane: u32, of_rows: bool, sign: f32) -> u32 {
    let length = select(plane.size.y, plane.size.x, of_rows);
    let first_root = select(plane.size.x, 0u, of_rows);
    var source = 0u;
    var stride = 1u;
    for (var stage = 0u; stage < 12u; stage++) {
        let factor = select(plane.row_factors[stage / 4u][stage % 4u], plane.column_factors[stage / 4u][stage % 4u], of_rows);
        if (factor == 0u) {
            break;
        }
        let sink = LENGTH - source;
        let step = length / factor;
        workgroupBarrier();
        for (var i = lane; i < length; i += THREADS) {
            let q = i % stride;
            let p = i / stride / factor;
            let k = i / stride % factor;
            let turn = p * k * stride;
            var sum = vec2f(0.0);
            for (var j = 0u; j < factor; j++) {
                let root = roots[first_root + (turn + j * k * step) % length];
                sum += times(line[source + q + stride * p + j * step], vec2f(root.x, sign * root.y));
            }
            line[sink + i] = sum;
        }
        source = sink;
        stride *= factor;
    }
    workgroupBarrier();
    return source;
}

fn activation(at: vec2u, channel: u32) -> f32 {
    if (channel >= plane.real_channels) {
        return 0.0;
    }
    let pixel = plane.origin + at;
    let value = image[(pixel.y * plane.width + pixel.x) * plane.channels + channel];
    let quad = 8u * (channel / 4u) + channel % 4u;
    return max((value - moments[quad]) * moments[quad + 4u], 0.0);
}

// Where a lag lies along one axis.
fn lag_place(index: u32, count: u32, size: u32) -> u32 {
    return (index + size - count / 2u) % size;
}

// How far a lag is from zero along one axis.
fn lag_distance(index: u32, count: u32) -> u32 {
    return u32(abs(i32(index) - i32(count / 2u)));
}

// Number of pairs of pixels at a lag.
fn pairs_at(lag: vec2u) -> f32 {
    if (plane.periodic == 1u) {
        return f32(plane.region.x * plane.region.y);
    }
    let rest = plane.region - vec2u(lag_distance(lag.x, plane.lags.x), lag_distance(lag.y, plane.lags.y));
    return f32(rest.x * rest.y);
}

// Workgroups: rows of the region × pairs of channels. Activations to `lines`, [pair, column, row].
@compute @workgroup_size(THREADS)
fn rows_forward(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    for (var x = lane; x < plane.size.x; x += THREADS) {
        var value = vec2f(0.0);
        if (x < plane.region.x) {
            let at = vec2u(x, group.x);
            value = vec2f(activation(at, 2u * group.y), activation(at, 2u * group.y + 1u));
        }
        line[x] = value;
    }
    let at = transform(lane, true, 1.0);
    for (var x = lane; x < plane.size.x; x += THREADS) {
        lines[(group.y * plane.size.x + x) * plane.size.y + group.x] = line[at + x];
    }
}

// Workgroups: columns × pairs. `lines` to `spectra`, both [pair, column, row].
@compute @workgroup_size(THREADS)
fn columns_forward(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let base = (group.y * plane.size.x + group.x) * plane.size.y;
    for (var y = lane; y < plane.size.y; y += THREADS) {
        var value = vec2f(0.0);
        if (y < plane.held.x || y >= plane.held.y) {
            value = lines[base + y];
        }
        line[y] = value;
    }
    let at = transform(lane, false, 1.0);
    for (var y = lane; y < plane.size.y; y += THREADS) {
        spectra[base + y] = line[at + y];
    }
}

// Where the frequency opposite to row y of this column lies.
fn opposite(group: vec3u, y: u32) -> u32 {
    let column = (plane.size.x - group.x) % plane.size.x;
    return (group.y * plane.size.x + column) * plane.size.y + (plane.size.y - y) % plane.size.y;
}

// The transforms of the two channels whose joint transform is z; m is its value at the opposite frequency.
fn split(z: vec2f, m: vec2f) -> vec4f {
    return 0.5 * vec4f(z.x + m.x, z.y - m.y, z.y + m.y, m.x - z.x);
}

// Workgroups: columns × pairs. Power spectra, back along the columns, to `lines` [pair, row, column].
@compute @workgroup_size(THREADS)
fn power_columns(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let base = (group.y * plane.size.x + group.x) * plane.size.y;
    for (var y = lane; y < plane.size.y; y += THREADS) {
        let both = split(spectra[base + y], spectra[opposite(group, y)]);
        line[y] = vec2f(dot(both.xy, both.xy), dot(both.zw, both.zw));
    }
    let at = transform(lane, false, -1.0);
    for (var y = lane; y < plane.size.y; y += THREADS) {
        lines[(group.y * plane.size.y + y) * plane.size.x + group.x] = line[at + y];
    }
}

var<workgroup> sums: array<f32, THREADS>;

// Workgroups: rows of lags × pairs. Back along the rows; the autocorrelations, their loss, and its slopes forward
// along the rows again, to `slopes` [pair, column, row].
@compute @workgroup_size(THREADS)
fn power_rows(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let row = lag_place(group.x, plane.lags.y, plane.size.y);
    for (var x = lane; x < plane.size.x; x += THREADS) {
        line[x] = lines[(group.y * plane.size.y + row) * plane.size.x + x];
    }
    let at = transform(lane, true, -1.0);
    let scale = 1.0 / f32(plane.size.x * plane.size.y);
    var loss = 0.0;
    let count = plane.lags.x * plane.lags.y;
    let second = 2u * group.y + 1u < plane.real_channels;
    // The other half of `line` is free: the slopes go there.
    let free = LENGTH - at;
    for (var x = lane; x < plane.size.x; x += THREADS) {
        line[free + x] = vec2f(0.0);
    }
    workgroupBarrier();
    for (var j = lane; j < plane.lags.x; j += THREADS) {
        let column = lag_place(j, plane.lags.x, plane.size.x);
        let pairs = pairs_at(vec2u(j, group.x));
        let value = line[at + column] * (scale / pairs);
        let index = 2u * group.y * count + group.x * plane.lags.x + j;
        values[index] = value.x;
        if (second) {
            values[index + count] = value.y;
        }
        if (plane.judged == 1u) {
            var difference = vec2f(value.x - target_values[index], 0.0);
            if (second) {
                difference.y = value.y - target_values[index + count];
            }
            loss += plane.mean * dot(difference, difference);
            line[free + column] = (2.0 * plane.mean / pairs) * difference;
        }
    }
    if (plane.judged == 0u) {
        return;
    }
    sums[lane] = loss;
    workgroupBarrier();
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        if (lane < half) {
            sums[lane] += sums[lane + half];
        }
        workgroupBarrier();
    }
    if (lane == 0u) {
        losses[group.y * plane.lags.y + group.x] = sums[0];
    }
    // `transform` starts from the beginning.
    if (free != 0u) {
        for (var x = lane; x < plane.size.x; x += THREADS) {
            line[x] = line[free + x];
        }
    }
    let forward = transform(lane, true, 1.0);
    for (var x = lane; x < plane.size.x; x += THREADS) {
        slopes[(group.y * plane.size.x + x) * plane.size.y + row] = line[forward + x];
    }
}

// Workgroups: columns × pairs. 2 Re(D̂) F̂ of both channels, back along the columns, to `lines` [pair, row, column].
// `slopes` holds D̂ of both.
@compute @workgroup_size(THREADS)
fn gradient_columns(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let base = (group.y * plane.size.x + group.x) * plane.size.y;
    let scale = 2.0 / f32(plane.size.x * plane.size.y);
    for (var y = lane; y < plane.size.y; y += THREADS) {
        let mirrored = opposite(group, y);
        let weights = (0.5 * scale) * (slopes[base + y] + slopes[mirrored]);
        let both = split(spectra[base + y], spectra[mirrored]);
        let a = both.xy * weights.x;
        let b = both.zw * weights.y;
        line[y] = vec2f(a.x - b.y, a.y + b.x);
    }
    let at = transform(lane, false, -1.0);
    for (var y = lane; y < plane.size.y; y += THREADS) {
        lines[(group.y * plane.size.y + y) * plane.size.x + group.x] = line[at + y];
    }
}

// Workgroups: rows of the region × pairs. Back along the rows, into the gradient image.
@compute @workgroup_size(THREADS)
fn gradient_rows(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    for (var x = lane; x < plane.size.x; x += THREADS) {
        line[x] = lines[(group.y * plane.size.y + group.x) * plane.size.x + x];
    }
    let at = transform(lane, true, -1.0);
    for (var x = lane; x < plane.region.x; x += THREADS) {
        let pixel = (group.x * plane.width + x) * plane.channels + 2u * group.y;
        gradient[pixel] = line[at + x].x;
        gradient[pixel + 1u] = line[at + x].y;
    }
}
