// Adds up the losses of one iteration. The CPU does it where each loss is made.

struct Progress {
    slot: u32,
    failed: u32,
}

// Numbers of each kind.
struct Counts {
    gram: u32,
    correlation: u32,
}

@group(0) @binding(0) var<uniform> counts: Counts;
@group(0) @binding(1) var<storage, read> progress: Progress;
@group(0) @binding(2) var<storage, read> gram_2: array<f32>;
@group(0) @binding(3) var<storage, read> gram_3: array<f32>;
@group(0) @binding(4) var<storage, read> gram_4: array<f32>;
@group(0) @binding(5) var<storage, read> correlation: array<f32>;
@group(0) @binding(6) var<storage, read_write> losses: array<vec4f>;

const THREADS = 256u;

var<workgroup> partial: array<vec4f, THREADS>;

// One workgroup.
@compute @workgroup_size(THREADS)
fn add_up(@builtin(local_invocation_index) lane: u32) {
    var sum = vec4f(0.0);
    for (var i = lane; i < counts.gram; i += THREADS) {
        sum += vec4f(gram_2[i], gram_3[i], gram_4[i], 0.0);
    }
    for (var i = lane; i < counts.correlation; i += THREADS) {
        sum.w += correlation[i];
    }
    partial[lane] = sum;
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if (lane < half) {
            partial[lane] += partial[lane + half];
        }
    }
    if (lane == 0u) {
        losses[progress.slot] = partial[0];
    }
}
