//! Every stage's gradient against central differences in double precision, alone and through the whole loss; and the
//! convolution against the plain sum it stands for. Each comparison is shown to be able to fail (`assert_close`).

mod common;

use std::sync::Arc;

use common::{assert_close, central_differences, noise, points};
use glam::DVec2;
use pointweave::Boundary;
use pointweave::engine::cpu::convolution::{Convolution, Direction, Filters, Geometry, Source, Tile, Workspace};
use pointweave::engine::cpu::correlation::Correlation;
use pointweave::engine::cpu::gabor::Gabor;
use pointweave::engine::cpu::gram::Gram;
use pointweave::engine::cpu::lanes::padded;
use pointweave::engine::cpu::network::{Evaluation, Network, best_tiles};
use pointweave::engine::cpu::normalization::Statistics;
use pointweave::engine::view::{Grid, Lags, Region, View, Wave};
use pointweave::engine::{Bands, FilterBank, Weights};

const BOUNDARIES: [Boundary; 2] = [Boundary::Open, Boundary::Periodic];

fn to_points(flat: &[f64]) -> Vec<DVec2> {
    flat.chunks_exact(2).map(|p| DVec2::new(p[0], p[1])).collect()
}

fn flatten(points: &[DVec2]) -> Vec<f64> {
    points.iter().flat_map(|p| [p.x, p.y]).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// One band of points that weigh the same, and bands of all kinds with weights of both signs, some of them 0.
fn weightings(points: usize) -> [Weights; 3] {
    let weighted = |bands: Bands| {
        let values = noise(15, points * bands.count()).into_iter();
        Weights::new(bands, values.map(|weight| if weight.abs() < 0.2 { 0.0 } else { weight }).collect())
    };
    [
        Weights::default(),
        weighted(Bands { lone: true, full: 0, waves: 2 }),
        weighted(Bands { lone: false, full: 2, waves: 1 }),
    ]
}

#[test]
fn gabor_maps_and_their_gradient() {
    for (boundary, weights) in BOUNDARIES.into_iter().flat_map(|b| weightings(7).map(|weights| (b, weights))) {
        let bands = weights.bands();
        let stored = padded(bands.maps());
        let of_points: Vec<f64> = weights.values(7).collect();
        let (height, width) = (12, 16);
        let grid = Grid { height, width, pitch: DVec2::new(2.0 / 16.0, 1.5 / 12.0), boundary };
        let wave = Wave { sigma: 0.21, frequency: 1.5, scale: 0.37, cutoff_sigmas: 8.0 };
        let start = points(1, DVec2::new(2.0, 1.5), 7);
        let mut gabor = Gabor::<f64>::new(grid, wave, start.len(), &weights);
        let jitter = noise(2, height + width);
        gabor.shifts_mut()[0].copy_from_slice(&jitter[..height]);
        gabor.shifts_mut()[1].copy_from_slice(&jitter[height..]);
        let mut maps = vec![f64::NAN; height * width * stored];
        gabor.maps(&start, &mut maps);

        // The definition, term by term.
        let frequencies = [(0.0, 0.0), (0.0, 1.5), (1.5, 0.0), (1.5, 1.5), (1.5, -1.5)];
        let mut expected = vec![0.0; maps.len()];
        let images: &[f64] = if boundary == Boundary::Periodic { &[-2.0, -1.0, 0.0, 1.0, 2.0] } else { &[0.0] };
        for y in 0..height {
            for x in 0..width {
                let at = DVec2::new(
                    (x as f64 + 0.5 + jitter[height + x]) * grid.pitch.x,
                    (y as f64 + 0.5 + jitter[y]) * grid.pitch.y,
                );
                let mut map = 0;
                for band in 0..bands.count() {
                    for (fx, fy) in &frequencies[..if bands.is_lone(band) { 1 } else { 5 }] {
                        let mut sum = 0.0;
                        for (point, weights) in start.iter().zip(of_points.chunks_exact(bands.count())) {
                            for i in images {
                                for j in images {
                                    let d = *point + DVec2::new(i * 2.0, j * 1.5) - at;
                                    let phase = std::f64::consts::TAU * (fx * d.x + fy * d.y);
                                    let gauss = (-d.length_squared() / (2.0 * 0.21 * 0.21)).exp();
                                    sum += weights[band] * gauss * phase.cos();
                                }
                            }
                        }
                        expected[(y * width + x) * stored + map] = 0.37 * sum;
                        map += 1;
                    }
                }
                assert_eq!(map, bands.maps());
            }
        }
        assert_close("maps", &maps, &expected, 1e-10);

        let mut slopes = noise(3, maps.len());
        for pixel in slopes.chunks_exact_mut(stored) {
            pixel[bands.maps()..].fill(0.0);
        }
        let gradient: Vec<f64> = gabor.gradients(&slopes, 0).iter().flatten().copied().collect();
        let differences = central_differences(&flatten(&start), 1e-5, |x| {
            gabor.maps(&to_points(x), &mut maps);
            dot(&maps, &slopes)
        });
        assert_close("gabor gradient", &gradient, &differences, 1e-7);
    }
}

/// `y[o] = Σ w[k] x[s·o + k − 3]`, the plain sum.
fn direct(
    x: &[f64],
    weights: &[f64],
    geometry: &Geometry,
    channels_in: usize,
    channels_out: usize,
    stored_in: usize,
    stored_out: usize,
) -> Vec<f64> {
    let Geometry { height, width, stride, boundary } = *geometry;
    let (rows, columns) = geometry.output();
    let place = |i: isize, len: usize| match boundary {
        Boundary::Open => (i >= 0 && i < len as isize).then_some(i as usize),
        Boundary::Periodic => Some(i.rem_euclid(len as isize) as usize),
    };
    let mut y = vec![0.0; rows * columns * stored_out];
    for row in 0..rows {
        for column in 0..columns {
            for ky in 0..7 {
                let Some(from_row) = place((stride * row + ky) as isize - 3, height) else { continue };
                for kx in 0..7 {
                    let Some(from_column) = place((stride * column + kx) as isize - 3, width) else { continue };
                    for to in 0..channels_out {
                        for from in 0..channels_in {
                            y[(row * columns + column) * stored_out + to] += weights
                                [((to * channels_in + from) * 7 + ky) * 7 + kx]
                                * x[(from_row * width + from_column) * stored_in + from];
                        }
                    }
                }
            }
        }
    }
    y
}

#[test]
fn convolution_is_the_plain_sum_and_its_gradient_the_adjoint() {
    let (c_in, c_out) = (3, 10);
    for boundary in BOUNDARIES {
        for tile in [Tile::Small, Tile::Large] {
            for stride in [1, 2] {
                for (height, width) in [(8, 12), (28, 36), (60, 20)] {
                    // Odd sizes are for open domains: two strided layers must halve a periodic one evenly.
                    let odd = usize::from(boundary == Boundary::Open);
                    let geometry = Geometry { height: height - odd, width: width + odd, stride, boundary };
                    let weights = noise(4, c_out * c_in * 49);
                    let filters = Filters::<f64>::new(&weights, c_in, c_out, tile);
                    let convolution = Convolution::new(&filters, geometry);
                    let mut workspace = Workspace::new(&[(geometry, tile, c_in, c_out)]);
                    let (rows, columns) = geometry.output();
                    let mut x = noise(5, geometry.height * geometry.width * 8);
                    for (i, value) in x.iter_mut().enumerate() {
                        if i % 8 >= c_in {
                            *value = 0.0;
                        }
                    }
                    let mut y = vec![f64::NAN; rows * columns * 16];
                    convolution.transform(Source::Plain(&x), Direction::Forward, &mut workspace);
                    convolution.multiply(&filters, Direction::Forward, 0..tile.side(), &mut workspace);
                    convolution.inverse(Direction::Forward, &workspace, &mut y);
                    let expected = direct(&x, &weights, &geometry, c_in, c_out, 8, 16);
                    let what = format!("{boundary:?} {tile:?} stride {stride} {height} × {width}");
                    assert_close(&what, &y, &expected, 1e-12);

                    let g = noise(6, y.len());
                    let mut back = vec![f64::NAN; x.len()];
                    convolution.transform(Source::Plain(&g), Direction::Gradient, &mut workspace);
                    // In two parts, as a run would.
                    convolution.multiply(&filters, Direction::Gradient, 0..5, &mut workspace);
                    convolution.multiply(&filters, Direction::Gradient, 5..tile.side(), &mut workspace);
                    convolution.inverse(Direction::Gradient, &workspace, &mut back);
                    let differences: Vec<f64> = (0..40)
                        .map(|i| {
                            let at = (i * 7919) % (x.len() / 8) * 8 + i % c_in;
                            let mut x = x.clone();
                            x[at] += 0.5;
                            let above = direct(&x, &weights, &geometry, c_in, c_out, 8, 16);
                            x[at] -= 1.0;
                            let below = direct(&x, &weights, &geometry, c_in, c_out, 8, 16);
                            dot(&above, &g) - dot(&below, &g)
                        })
                        .collect();
                    let ours: Vec<f64> = (0..40).map(|i| back[(i * 7919) % (x.len() / 8) * 8 + i % c_in]).collect();
                    assert_close(&format!("gradient {what}"), &ours, &differences, 1e-9);
                }
            }
        }
    }
}

#[test]
fn normalization_and_relu() {
    let (height, width, channels) = (5, 6, 8);
    let image = noise(7, height * width * channels);
    let weights = noise(8, image.len());
    let activated = |image: &[f64]| {
        let mut statistics = Statistics::<f64>::new(height, channels);
        statistics.measure(image, width, Region::whole(height, width));
        image
            .iter()
            .enumerate()
            .map(|(i, v)| ((v - statistics.mean[i % channels]) * statistics.inverse_deviation[i % channels]).max(0.0))
            .collect::<Vec<f64>>()
    };
    // Against the definition.
    let a = activated(&image);
    for channel in 0..channels {
        let values: Vec<f64> = image.iter().skip(channel).step_by(channels).copied().collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
        let expected: Vec<f64> = values.iter().map(|v| ((v - mean) / (variance + 1e-5).sqrt()).max(0.0)).collect();
        let ours: Vec<f64> = a.iter().skip(channel).step_by(channels).copied().collect();
        assert_close("activation", &ours, &expected, 1e-12);
    }
    let mut statistics = Statistics::<f64>::new(height, channels);
    statistics.measure(&image, width, Region::whole(height, width));
    let mut gradient = weights.clone();
    statistics.backward(&image, &mut gradient, width, None);
    let differences = central_differences(&image, 1e-6, |x| dot(&activated(x), &weights));
    assert_close("normalization gradient", &gradient, &differences, 1e-7);
}

/// Statistics that leave positive values alone: mean 0, deviation 1.
fn identity(height: usize, channels: usize) -> Statistics<f64> {
    let mut statistics = Statistics::new(height, channels);
    statistics.inverse_deviation.fill(1.0);
    statistics
}

#[test]
fn gram_matrix_and_its_gradient() {
    // More pixels than a block, more rows than a part holds.
    let (height, width, channels, real) = (37, 9, 16, 11);
    let mut image: Vec<f64> = noise(9, height * width * channels).into_iter().map(|v| v + 1.5).collect();
    for (i, value) in image.iter_mut().enumerate() {
        if i % channels >= real {
            *value = 0.0;
        }
    }
    let statistics = identity(height, channels);
    let region = Region::whole(height, width);
    let mut gram = Gram::<f64>::new(channels, real);
    gram.measure(&image, width, region, &statistics);
    let mut expected = vec![0.0; channels * channels];
    for pixel in image.chunks_exact(channels) {
        for i in 0..channels {
            for j in 0..channels {
                expected[i * channels + j] += pixel[i] * pixel[j] / (real * height * width) as f64;
            }
        }
    }
    assert_close("gram", gram.matrix(), &expected, 1e-12);

    let target: Vec<f64> = noise(10, channels * channels);
    let symmetric: Vec<f64> =
        (0..channels * channels).map(|i| target[i] + target[i % channels * channels + i / channels]).collect();
    gram.loss(&symmetric, 0.08, region.pixels());
    let mut gradient = vec![0.0; image.len()];
    gram.add_gradient(&image, &statistics.mean, &statistics.inverse_deviation, &mut gradient);
    let probes: Vec<usize> = (0..60).map(|i| (i * 7919) % image.len()).filter(|i| i % channels < real).collect();
    let differences: Vec<f64> = probes
        .iter()
        .map(|&at| {
            let mut loss = |delta: f64| {
                let mut image = image.clone();
                image[at] += delta;
                gram.measure(&image, width, region, &statistics);
                gram.loss(&symmetric, 0.08, region.pixels())
            };
            (loss(1e-5) - loss(-1e-5)) / 2e-5
        })
        .collect();
    let ours: Vec<f64> = probes.iter().map(|&at| gradient[at]).collect();
    assert_close("gram gradient", &ours, &differences, 1e-6);
}

#[test]
fn correlation_and_its_gradient() {
    for boundary in BOUNDARIES {
        for (height, width, lags) in [
            (6, 8, Lags { rows: 6, columns: 8 }),
            (7, 5, Lags { rows: 3, columns: 4 }),
            (9, 9, Lags { rows: 9, columns: 5 }),
        ] {
            let (channels, real) = (8, 2);
            let image: Vec<f64> = noise(11, height * width * channels).into_iter().map(|v| v + 1.1).collect();
            let statistics = identity(height, channels);
            let region = Region::whole(height, width);
            let mut correlation = Correlation::<f64>::new(region, lags, boundary, real);
            correlation.measure(&image, width, &statistics);
            let mut expected = Vec::new();
            for channel in 0..real {
                let value = |y: isize, x: isize| {
                    let inside = y >= 0 && x >= 0 && y < height as isize && x < width as isize;
                    let (y, x) = match boundary {
                        Boundary::Open if !inside => return None,
                        _ => (y.rem_euclid(height as isize) as usize, x.rem_euclid(width as isize) as usize),
                    };
                    Some(image[(y * width + x) * channels + channel].max(0.0))
                };
                for i in 0..lags.rows {
                    for j in 0..lags.columns {
                        let (dy, dx) = (i as isize - lags.rows as isize / 2, j as isize - lags.columns as isize / 2);
                        let (mut sum, mut pairs) = (0.0, 0.0);
                        for y in 0..height as isize {
                            for x in 0..width as isize {
                                if let (Some(a), Some(b)) = (value(y, x), value(y + dy, x + dx)) {
                                    sum += a * b;
                                    pairs += 1.0;
                                }
                            }
                        }
                        expected.push(sum / pairs);
                    }
                }
            }
            assert_close("correlation", correlation.values(), &expected, 1e-12);

            let target = noise(12, real * lags.count());
            let loss = correlation.loss(&target, 0.7);
            let by_hand =
                0.7 * expected.iter().zip(&target).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / target.len() as f64;
            assert_close("correlation loss", &[loss], &[by_hand], 1e-12);
            let mut gradient = vec![0.0; image.len()];
            correlation.add_gradient(&mut gradient, channels);
            let differences = central_differences(&image, 1e-6, |x| {
                correlation.measure(x, width, &statistics);
                correlation.loss(&target, 0.7)
            });
            assert_close("correlation gradient", &gradient, &differences, 1e-7);
        }
    }
}

#[test]
fn the_whole_loss() {
    // The exemplar's weights are the first of the output's.
    for (boundary, weights) in BOUNDARIES.into_iter().flat_map(|b| weightings(9).map(|weights| (b, weights))) {
        let channels = 6;
        let bands = weights.bands();
        let (exemplar_size, output_size) = (DVec2::ONE, DVec2::new(2.0, 1.5));
        let view = |size: DVec2| View {
            grid: Grid {
                height: (16.0 * size.y) as usize,
                width: (16.0 * size.x) as usize,
                pitch: DVec2::splat(1.0 / 16.0),
                boundary,
            },
            wave: Wave { sigma: 0.15, frequency: 1.5, scale: 1.0 / 6.0, cutoff_sigmas: 8.0 },
            interior_only: false,
        };
        let bank = FilterBank::for_bands(5, channels, bands);
        let network = Arc::new(Network::<f64>::new(&bank, best_tiles(channels, 24, 32, boundary, bands)));
        let lags = Lags { rows: 4, columns: 4 };
        let exemplar = points(13, exemplar_size, 6);
        let (side, seen) = (Arc::clone(&network), view(exemplar_size));
        let mut reference = Evaluation::new(side, &seen, exemplar.len(), lags, false, [0.0; 2], &weights);
        while !reference.advance(&exemplar, None) {}
        let targets = reference.targets(lags);

        let start = points(14, output_size, 9);
        let mut output = Evaluation::new(network, &view(output_size), start.len(), lags, true, [0.08, 1.0], &weights);
        let mut loss = |points: &[DVec2]| {
            while !output.advance(points, Some(&targets)) {}
            output.loss().total()
        };
        // Points at the border of a window may not leave it for a difference.
        let differences = central_differences(&flatten(&start), 1e-6, |x| loss(&to_points(x)));
        loss(&start);
        let gradient: Vec<f64> = output.point_gradients(0).iter().flatten().copied().collect();
        assert_close(&format!("whole loss, {boundary:?}, {bands:?}"), &gradient, &differences, 2e-6);
        assert!(output.loss().total() > 1e-6, "a loss of 0 would prove nothing");
    }
}
