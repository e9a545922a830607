// Adam on the positions. Twin of engine/cpu/adam.rs.

struct Rule {
    // Columns and rows of the domain in exemplar units.
    size: vec2f,
    learning_rate: f32,
    periodic: u32,
    // Points that move, and the first of them.
    moving: u32,
    first: u32,
}

struct Progress {
    // Which iteration of the batch this is.
    slot: u32,
    // Not 0 when a number stopped being finite: nothing moves any more.
    failed: u32,
}

@group(0) @binding(0) var<uniform> rule: Rule;
@group(0) @binding(1) var<storage, read_write> progress: Progress;
// Gram losses of three layers and the correlation loss, for every iteration of the batch.
@group(0) @binding(2) var<storage, read> losses: array<vec4f>;
@group(0) @binding(3) var<storage, read> gradients: array<vec2f>;
@group(0) @binding(4) var<storage, read_write> points: array<vec2f>;
// Mean of the gradient and of its square.
@group(0) @binding(5) var<storage, read_write> moments: array<vec4f>;
// 1 / (1 − β₁ᵗ) and 1 / (1 − β₂ᵗ), for every iteration of the batch.
@group(0) @binding(6) var<storage, read> corrections: array<vec2f>;

const BETA1 = 0.9;
const BETA2 = 0.999;
const EPSILON = 1e-8;
const THREADS = 256u;

var<workgroup> bad: array<u32, THREADS>;

// 1 for ∞ and NaN. By the bits: a compiler may take every number for finite.
fn is_bad(bits: u32) -> u32 {
    return select(0u, 1u, (bits & 0x7f800000u) == 0x7f800000u);
}

// One workgroup: are the loss, the points and their gradients finite?
@compute @workgroup_size(THREADS)
fn check(@builtin(local_invocation_index) lane: u32) {
    let loss = bitcast<vec4u>(losses[progress.slot]);
    var found = is_bad(loss.x) | is_bad(loss.y) | is_bad(loss.z) | is_bad(loss.w);
    for (var i = lane; i < rule.moving; i += THREADS) {
        let gradient = bitcast<vec2u>(gradients[i]);
        let point = bitcast<vec2u>(points[rule.first + i]);
        found |= is_bad(gradient.x) | is_bad(gradient.y) | is_bad(point.x) | is_bad(point.y);
    }
    bad[lane] = found;
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if (lane < half) {
            bad[lane] |= bad[lane + half];
        }
    }
    if (lane == 0u && bad[0] != 0u && progress.failed == 0u) {
        progress.failed = progress.slot + 1u;
    }
}

// One coordinate back into the domain: from the other side of a periodic one, mirrored in an open one.
fn keep_inside(value: f32, side: f32) -> f32 {
    if (rule.periodic == 1u) {
        let wrapped = value - side * floor(value / side);
        return select(0.0, wrapped, wrapped < side);
    }
    let folded = value - 2.0 * side * floor(value / (2.0 * side));
    return clamp(select(folded, 2.0 * side - folded, folded > side), 0.0, side);
}

@compute @workgroup_size(64)
fn move_points(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if (i >= rule.moving || progress.failed != 0u) {
        return;
    }
    let gradient = gradients[i];
    let mean = BETA1 * moments[i].xy + (1.0 - BETA1) * gradient;
    let square = BETA2 * moments[i].zw + (1.0 - BETA2) * gradient * gradient;
    moments[i] = vec4f(mean, square);
    let correction = corrections[progress.slot];
    let change = rule.learning_rate * (mean * correction.x) / (sqrt(square * correction.y) + EPSILON);
    let moved = points[rule.first + i] - change;
    points[rule.first + i] = vec2f(keep_inside(moved.x, rule.size.x), keep_inside(moved.y, rule.size.y));
}

// One invocation: the iteration is over.
@compute @workgroup_size(1)
fn next() {
    progress.slot += 1u;
}
