// Instance normalisation and ReLU, forward and backward. Twin of engine/cpu/normalization.rs.
//
// Every run of pixels is measured in its own mean and the runs are put together afterwards: single precision is
// enough where the mean is large against the deviation. Images are [row, column, channel / 4].

struct Region {
    // First column and row, columns and rows that count.
    origin: vec2u,
    size: vec2u,
    // Columns of the image, vectors of four channels a pixel.
    width: u32,
    quads: u32,
    // Runs a row is cut into.
    runs: u32,
}

@group(0) @binding(0) var<uniform> region: Region;
@group(0) @binding(1) var<storage, read> image: array<vec4f>;
// Two vectors for each run and quad: mean and sum of squares, or the two sums of the way back.
@group(0) @binding(2) var<storage, read_write> parts: array<vec4f>;
// Mean and inverse deviation, alternating.
@group(0) @binding(3) var<storage, read_write> moments: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> gradient: array<vec4f>;
// Means of g and of g · x̂, alternating.
@group(0) @binding(5) var<storage, read_write> averages: array<vec4f>;

const EPSILON = 1e-5;
const RUN = 64u;
const THREADS = 64u;

// Pixels of a run.
fn run_length(run: u32) -> u32 {
    return min(RUN, region.size.x - (run % region.runs) * RUN);
}

// Where a run's first vector lies.
fn run_start(run: u32, quad: u32) -> u32 {
    let y = region.origin.y + run / region.runs;
    let x = region.origin.x + (run % region.runs) * RUN;
    return (y * region.width + x) * region.quads + quad;
}

// Mean of a run, and the sum of squared differences from it.
@compute @workgroup_size(THREADS)
fn measure_runs(@builtin(global_invocation_id) id: vec3u) {
    let index = id.x;
    let quad = index % region.quads;
    let run = index / region.quads;
    if (run >= region.runs * region.size.y) {
        return;
    }
    let length = run_length(run);
    let start = run_start(run, quad);
    var sum = vec4f(0.0);
    for (var i = 0u; i < length; i++) {
        sum += image[start + i * region.quads];
    }
    let mean = sum / f32(length);
    var squares = vec4f(0.0);
    for (var i = 0u; i < length; i++) {
        let difference = image[start + i * region.quads] - mean;
        squares += difference * difference;
    }
    parts[2u * index] = mean;
    parts[2u * index + 1u] = squares;
}

var<workgroup> partial: array<vec4f, THREADS>;

// The sum over all lanes, in a fixed order.
fn total(value: vec4f, lane: u32) -> vec4f {
    partial[lane] = value;
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if (lane < half) {
            partial[lane] += partial[lane + half];
        }
    }
    workgroupBarrier();
    let all = partial[0];
    workgroupBarrier();
    return all;
}

// One workgroup a quad: puts the runs together.
@compute @workgroup_size(THREADS)
fn measure(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let quad = group.x;
    let runs = region.runs * region.size.y;
    let pixels = f32(region.size.x * region.size.y);
    var sum = vec4f(0.0);
    for (var run = lane; run < runs; run += THREADS) {
        sum += f32(run_length(run)) * parts[2u * (run * region.quads + quad)];
    }
    let mean = total(sum, lane) / pixels;
    var squares = vec4f(0.0);
    for (var run = lane; run < runs; run += THREADS) {
        let at = 2u * (run * region.quads + quad);
        let difference = parts[at] - mean;
        squares += parts[at + 1u] + f32(run_length(run)) * difference * difference;
    }
    let variance = total(squares, lane) / pixels;
    if (lane == 0u) {
        moments[2u * quad] = mean;
        moments[2u * quad + 1u] = 1.0 / sqrt(variance + EPSILON);
    }
}

// Σ g and Σ g · x̂ of a run, where the ReLU lets g through.
@compute @workgroup_size(THREADS)
fn sum_gradient_runs(@builtin(global_invocation_id) id: vec3u) {
    let index = id.x;
    let quad = index % region.quads;
    let run = index / region.quads;
    if (run >= region.runs * region.size.y) {
        return;
    }
    let length = run_length(run);
    let start = run_start(run, quad);
    let mean = moments[2u * quad];
    let inverse = moments[2u * quad + 1u];
    var sum = vec4f(0.0);
    var product = vec4f(0.0);
    for (var i = 0u; i < length; i++) {
        let at = start + i * region.quads;
        let normalized = (image[at] - mean) * inverse;
        let g = select(vec4f(0.0), gradient[at], normalized > vec4f(0.0));
        sum += g;
        product += g * normalized;
    }
    parts[2u * index] = sum;
    parts[2u * index + 1u] = product;
}

@compute @workgroup_size(THREADS)
fn average_gradient(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let quad = group.x;
    let runs = region.runs * region.size.y;
    let pixels = f32(region.size.x * region.size.y);
    var sum = vec4f(0.0);
    var product = vec4f(0.0);
    for (var run = lane; run < runs; run += THREADS) {
        let at = 2u * (run * region.quads + quad);
        sum += parts[at];
        product += parts[at + 1u];
    }
    let mean = total(sum, lane) / pixels;
    let mean_product = total(product, lane) / pixels;
    if (lane == 0u) {
        averages[2u * quad] = mean;
        averages[2u * quad + 1u] = mean_product;
    }
}

// dL/dy = (g − mean(g) − x̂ · mean(g · x̂)) / √(σ² + ε), in place of dL/da. All pixels count on the way back.
@compute @workgroup_size(THREADS)
fn apply_gradient(@builtin(global_invocation_id) id: vec3u) {
    let at = id.y * 65535u * THREADS + id.x;
    if (at >= region.width * region.size.y * region.quads) {
        return;
    }
    let quad = at % region.quads;
    let inverse = moments[2u * quad + 1u];
    let normalized = (image[at] - moments[2u * quad]) * inverse;
    let g = select(vec4f(0.0), gradient[at], normalized > vec4f(0.0));
    gradient[at] = (g - averages[2u * quad] - normalized * averages[2u * quad + 1u]) * inverse;
}
