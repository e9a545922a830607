// Gabor maps of the points, and the gradient with respect to their positions. Twin of engine/cpu/gabor.rs.
//
// A map at a pixel is a sum over the points near it of products of a row table and a column table. The points are
// sorted into cells as large as a point's reach, so that a pixel asks the points of 3 × 3 cells only. Sorting is by
// counting, in order: the sums are the same bits every time.
//
// The maps come in bands, in each of which every point has a weight.

struct Frame {
    // Columns and rows of the sampling grid.
    grid: vec2u,
    // Columns and rows of a point's window.
    span: vec2u,
    // Size of a pixel in exemplar units.
    pitch: vec2f,
    // Size of a cell in pixels.
    cell: vec2f,
    // Columns and rows of cells.
    cells: vec2u,
    // Points, and the first of them that moves.
    points: u32,
    first: u32,
    // How far the grid reaches beyond the domain.
    margin: f32,
    inverse_sigma: f32,
    // Cycles per exemplar unit.
    frequency: f32,
    scale: f32,
    periodic: u32,
    // Numbers of jitter an iteration.
    jitter: u32,
    bands: u32,
    // Numbers of a pixel of the maps, padding included.
    stored: u32,
    // Whether the first band is the Gaussian alone.
    lone: u32,
}

struct Progress {
    // Which iteration of the batch this is.
    slot: u32,
    // Not 0 when a number stopped being finite.
    failed: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> points: array<vec2f>;
@group(0) @binding(2) var<storage, read> progress: Progress;
// Shifts of rows, then of columns, in pixels; as many again for every iteration of the batch.
@group(0) @binding(3) var<storage, read> shifts: array<f32>;
// First column and row of every point's window, before wrapping.
@group(0) @binding(4) var<storage, read_write> starts: array<vec2i>;
// For every point the rows of its window, then the columns: Gaussian, with cosine, with sine, slope of the first.
@group(0) @binding(5) var<storage, read_write> tables: array<vec4f>;
// Slopes of the other two.
@group(0) @binding(6) var<storage, read_write> slopes: array<vec2f>;
@group(0) @binding(7) var<storage, read_write> cell_of: array<u32>;
// Where each cell begins in `order`, and the end of the last.
@group(0) @binding(8) var<storage, read_write> cell_starts: array<u32>;
// The points, cell by cell.
@group(0) @binding(9) var<storage, read_write> order: array<u32>;
// `stored` numbers a pixel, band by band; the padding is 0.
@group(0) @binding(10) var<storage, read_write> maps: array<f32>;
// Gradient of every moving point.
@group(0) @binding(11) var<storage, read_write> gradients: array<vec2f>;
// Of every point in every band.
@group(0) @binding(12) var<storage, read> weights: array<f32>;

const TAU = 6.283185307179586;

fn modulo(value: i32, by: u32) -> u32 {
    let rest = value % i32(by);
    return u32(select(rest, rest + i32(by), rest < 0));
}

// Cosine and sine of an angle given in turns. The built-in ones may be off by 5e-4, which the sums would show.
fn turn(turns: f32) -> vec2f {
    // Reduced exactly to an eighth of a turn on either side of a quarter.
    let quarter = round(turns * 4.0);
    let x = (turns - quarter * 0.25) * TAU;
    let x2 = x * x;
    let sine = x * (1.0 + x2 * (-0.16666667 + x2 * (8.3333333e-3 + x2 * (-1.9841270e-4 + x2 * 2.7557319e-6))));
    let cosine = 1.0 + x2 * (-0.5 + x2 * (4.1666668e-2 + x2 * (-1.3888889e-3 + x2 * (2.4801587e-5 - x2 * 2.7557319e-7))));
    switch (modulo(i32(quarter), 4u)) {
        case 0u: { return vec2f(cosine, sine); }
        case 1u: { return vec2f(-sine, cosine); }
        case 2u: { return vec2f(-cosine, -sine); }
        default: { return vec2f(sine, -cosine); }
    }
}

// One place of one point's window.
@compute @workgroup_size(64)
fn tabulate(@builtin(global_invocation_id) id: vec3u) {
    let point = id.y;
    let all = frame.span.x + frame.span.y;
    if (id.x >= all) {
        return;
    }
    let position = points[point] + frame.margin;
    let centre = vec2i(floor(position / frame.pitch));
    let start = centre - vec2i(frame.span / 2u);
    if (id.x == 0u) {
        starts[point] = start;
        let cell = vec2u(clamp(vec2f(centre) / frame.cell, vec2f(0.0), vec2f(frame.cells - 1u)));
        cell_of[point] = cell.y * frame.cells.x + cell.x;
    }
    let is_row = id.x < frame.span.y;
    let axis = select(0u, 1u, is_row);
    let place = select(id.x - frame.span.y, id.x, is_row);
    let pixel = start[axis] + i32(place);
    let wrapped = modulo(pixel, frame.grid[axis]);
    let shift = shifts[progress.slot * frame.jitter + wrapped + select(frame.grid.y, 0u, is_row)];
    let offset = position[axis] - (f32(pixel) + 0.5 + shift) * frame.pitch[axis];
    let scaled = offset * frame.inverse_sigma;
    let gauss = exp(-0.5 * scaled * scaled);
    let wave = turn(frame.frequency * offset) * gauss;
    let omega = TAU * frame.frequency;
    let slope = -scaled * frame.inverse_sigma;
    tables[point * all + id.x] = vec4f(gauss, wave, slope * gauss);
    slopes[point * all + id.x] = vec2f(slope * wave.x - omega * wave.y, slope * wave.y + omega * wave.x);
}

// One cell: counts the points of the cells before, then lists its own.
@compute @workgroup_size(64)
fn sort(@builtin(global_invocation_id) id: vec3u) {
    let cell = id.x;
    let cells = frame.cells.x * frame.cells.y;
    if (cell >= cells) {
        return;
    }
    var start = 0u;
    for (var i = 0u; i < frame.points; i++) {
        start += select(0u, 1u, cell_of[i] < cell);
    }
    cell_starts[cell] = start;
    for (var i = 0u; i < frame.points; i++) {
        if (cell_of[i] == cell) {
            order[start] = i;
            start++;
        }
    }
    if (cell == cells - 1u) {
        cell_starts[cells] = start;
    }
}

// The first map of a band: a band of the Gaussian alone has one map, all others have five.
fn first_map(band: u32) -> u32 {
    return 5u * band - select(0u, 4u, frame.lone == 1u && band > 0u);
}

// One pixel of the maps of one band.
@compute @workgroup_size(8, 8)
fn sum_maps(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= frame.grid.x || id.y >= frame.grid.y) {
        return;
    }
    let periodic = frame.periodic == 1u;
    let all = frame.span.x + frame.span.y;
    let home = vec2i(min(vec2u(vec2f(id.xy) / frame.cell), frame.cells - 1u));
    // Few cells in a periodic domain: each once, for its window may come around from both sides.
    let first = select(home - 1, vec2i(0), vec2i(frame.cells) <= vec2i(3));
    let count = select(vec2i(3), vec2i(frame.cells), vec2i(frame.cells) <= vec2i(3));
    var plain = 0.0;
    var along_y = 0.0;
    var along_x = 0.0;
    var even = 0.0;
    var odd = 0.0;
    for (var cy = 0; cy < count.y; cy++) {
        let y = first.y + cy;
        if (!periodic && (y < 0 || y >= i32(frame.cells.y))) {
            continue;
        }
        for (var cx = 0; cx < count.x; cx++) {
            let x = first.x + cx;
            if (!periodic && (x < 0 || x >= i32(frame.cells.x))) {
                continue;
            }
            let cell = modulo(y, frame.cells.y) * frame.cells.x + modulo(x, frame.cells.x);
            let end = cell_starts[cell + 1u];
            for (var i = cell_starts[cell]; i < end; i++) {
                let point = order[i];
                let offset = vec2i(id.xy) - starts[point];
                let weight = weights[point * frame.bands + id.z];
                if (weight == 0.0 || (!periodic && (offset.x < 0 || offset.y < 0))) {
                    continue;
                }
                // A window wider than a periodic domain meets a pixel more than once.
                var row = select(u32(offset.y), modulo(offset.y, frame.grid.y), periodic);
                while (row < frame.span.y) {
                    let vertical = weight * tables[point * all + row];
                    var column = select(u32(offset.x), modulo(offset.x, frame.grid.x), periodic);
                    while (column < frame.span.x) {
                        let horizontal = tables[point * all + frame.span.y + column];
                        plain += vertical.x * horizontal.x;
                        along_y += vertical.y * horizontal.x;
                        along_x += vertical.x * horizontal.y;
                        even += vertical.y * horizontal.y;
                        odd += vertical.z * horizontal.z;
                        column += frame.grid.x;
                        if (!periodic) {
                            break;
                        }
                    }
                    row += frame.grid.y;
                    if (!periodic) {
                        break;
                    }
                }
            }
        }
    }
    let pixel = (id.y * frame.grid.x + id.x) * frame.stored;
    let at = pixel + first_map(id.z);
    maps[at] = frame.scale * plain;
    if (id.z > 0u || frame.lone == 0u) {
        maps[at + 1u] = frame.scale * along_y;
        maps[at + 2u] = frame.scale * along_x;
        maps[at + 3u] = frame.scale * (even - odd);
        maps[at + 4u] = frame.scale * (even + odd);
    }
    if (id.z + 1u == frame.bands) {
        for (var i = first_map(frame.bands); i < frame.stored; i++) {
            maps[pixel + i] = 0.0;
        }
    }
}

const LANES_A_POINT = 64u;
var<workgroup> partial: array<vec2f, LANES_A_POINT>;

// One workgroup a moving point: `maps` holds the gradient with respect to the maps.
@compute @workgroup_size(LANES_A_POINT)
fn gather_gradients(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let point = frame.first + group.x;
    let start = starts[point];
    let base = point * (frame.span.x + frame.span.y);
    var sum = vec2f(0.0);
    let periodic = frame.periodic == 1u;
    for (var i = lane; i < frame.span.x * frame.span.y; i += LANES_A_POINT) {
        let place = vec2u(i % frame.span.x, i / frame.span.x);
        let pixel = start + vec2i(place);
        let inside = all(pixel >= vec2i(0)) && all(pixel < vec2i(frame.grid));
        if (periodic || inside) {
            let at = (modulo(pixel.y, frame.grid.y) * frame.grid.x + modulo(pixel.x, frame.grid.x)) * frame.stored;
            // The tables are those of all bands, so that the gradients of the bands add up first.
            var g = vec4f(0.0);
            var fifth = 0.0;
            for (var band = 0u; band < frame.bands; band++) {
                let weight = weights[point * frame.bands + band];
                if (weight == 0.0) {
                    continue;
                }
                let first = at + first_map(band);
                if (band == 0u && frame.lone == 1u) {
                    g.x += weight * maps[first];
                } else {
                    g += weight * vec4f(maps[first], maps[first + 1u], maps[first + 2u], maps[first + 3u]);
                    fifth += weight * maps[first + 4u];
                }
            }
            // Maps 3 and 4 are even ∓ odd: their gradients meet the cosines as a sum, the sines as a difference.
            let even = g.w + fifth;
            let odd = fifth - g.w;
            let y = tables[base + place.y];
            let x = tables[base + frame.span.y + place.x];
            let y_slope = slopes[base + place.y];
            let x_slope = slopes[base + frame.span.y + place.x];
            sum.x += y.x * (g.x * x.w + g.z * x_slope.x) + y.y * (g.y * x.w + even * x_slope.x) + y.z * odd * x_slope.y;
            sum.y += y.w * (g.x * x.x + g.z * x.y) + y_slope.x * (g.y * x.x + even * x.y) + y_slope.y * odd * x.z;
        }
    }
    partial[lane] = sum;
    for (var half = LANES_A_POINT / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if (lane < half) {
            partial[lane] += partial[lane + half];
        }
    }
    if (lane == 0u) {
        gradients[group.x] = frame.scale * partial[0];
    }
}
