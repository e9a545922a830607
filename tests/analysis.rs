//! Statistics against known answers, closed forms and other people's code; each shown to be able to fail.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod common;

use std::f64::consts::PI;

use common::{assert_close, points};
use glam::DVec2;
use pointweave::analysis::{self, *};
use pointweave::sampling::{Purpose, Rng, poisson_disk, white_noise, wrap};
use pointweave::{Boundary, Domain, PointPattern, gallery};

fn cloud(points: Vec<DVec2>, size: DVec2, boundary: Boundary) -> Cloud {
    Cloud::new(points, size, boundary).unwrap()
}

fn random(seed: u64, size: DVec2, count: usize, boundary: Boundary) -> Cloud {
    cloud(points(seed, size, count), size, boundary)
}

/// A hexagonal lattice of spacing 0.1 on a torus: 10 points a row, `2 · pairs` rows.
fn hex(pairs: usize) -> Cloud {
    let height = 0.1 * 3.0_f64.sqrt() / 2.0;
    let places = (0..2 * pairs).flat_map(|row| {
        (0..10).map(move |column| {
            DVec2::new(0.1 * (column as f64 + 0.5 * (row % 2) as f64 + 0.2), height * (row as f64 + 0.3))
        })
    });
    cloud(places.collect(), DVec2::new(1.0, 2.0 * pairs as f64 * height), Boundary::Periodic)
}

fn square(side: usize, boundary: Boundary) -> Cloud {
    let step = 1.0 / side as f64;
    let places = (0..side * side).map(|i| (DVec2::new((i % side) as f64, (i / side) as f64) + 0.5) * step);
    cloud(places.collect(), DVec2::ONE, boundary)
}

fn jittered(cloud: &Cloud, amount: f64, seed: u64) -> Cloud {
    let mut rng = Rng::new(seed, Purpose::Gallery);
    let places = cloud.points().iter().map(|&point| {
        let moved = point + DVec2::new(rng.normal(), rng.normal()) * amount;
        match cloud.boundary() {
            Boundary::Periodic => wrap(moved, cloud.size()),
            Boundary::Open => moved.clamp(DVec2::ZERO, cloud.size()),
        }
    });
    Cloud::new(places.collect(), cloud.size(), cloud.boundary()).unwrap()
}

fn pattern(cloud: &Cloud) -> PointPattern {
    PointPattern::new(Domain::new(DVec2::ZERO, cloud.size()).unwrap(), cloud.points().to_vec())
        .unwrap()
        .with_boundary(cloud.boundary())
}

/// Mean and its standard error, column by column.
fn mean_and_error(rows: &[Vec<f64>]) -> Vec<(f64, f64)> {
    let count = rows.len() as f64;
    (0..rows[0].len())
        .map(|column| {
            let mean = rows.iter().map(|row| row[column]).sum::<f64>() / count;
            let variance = rows.iter().map(|row| (row[column] - mean).powi(2)).sum::<f64>() / (count - 1.0);
            (mean, (variance / count).sqrt())
        })
        .collect()
}

#[derive(serde::Deserialize)]
struct Golden {
    size: [f64; 2],
    a: Vec<[f64; 2]>,
    b: Vec<[f64; 2]>,
    sides: Vec<GoldenSide>,
    frequencies: Vec<[f64; 2]>,
    power: Vec<f64>,
    periodic_hole: f64,
    wasserstein: f64,
    chamfer: f64,
    relative_radius: f64,
}

#[derive(serde::Deserialize)]
struct GoldenSide {
    periodic: bool,
    nearest: Vec<f64>,
    sigma: f64,
    pair_correlation: Vec<f64>,
    density_sigma: f64,
    density_places: Vec<[f64; 2]>,
    density: Vec<f64>,
    k: Vec<f64>,
}

#[test]
fn values_agree_with_scipy_astropy_and_pointpats() {
    let golden: Golden = serde_json::from_str(include_str!("analysis/golden.json")).unwrap();
    let places = |list: &[[f64; 2]]| list.iter().map(|&point| DVec2::from(point)).collect::<Vec<_>>();
    let (a, b, size) = (places(&golden.a), places(&golden.b), DVec2::from(golden.size));
    for side in &golden.sides {
        let boundary = if side.periodic { Boundary::Periodic } else { Boundary::Open };
        let cloud = cloud(a.clone(), size, boundary);
        let name = |what: &str| format!("{what}, {}", boundary.name());
        assert_close(&name("nearest"), &nearest_distances(&cloud, 6).unwrap().distances, &side.nearest, 1e-10);
        let settings = PairCorrelationSettings { sigma: side.sigma, range: 0.2, samples: 12 };
        let correlation = pair_correlation(&cloud, &settings).unwrap();
        assert_close(&name("pair correlation"), &correlation.value, &side.pair_correlation, 1e-9);
        let settings = PairDensitySettings { reach: 0.15, sigma: side.density_sigma, pitch: 0.01 };
        let density = pair_density(&cloud, &settings).unwrap();
        let half = (density.side / 2) as f64;
        let found: Vec<f64> = side
            .density_places
            .iter()
            .map(|&[x, y]| {
                let (column, row) = ((x / 0.01 + half).round(), (y / 0.01 + half).round());
                density.values[row as usize * density.side + column as usize]
            })
            .collect();
        assert_close(&name("pair density"), &found, &side.density, 1e-9);
        let k = ripley(&cloud, &RipleySettings { range: 0.16, samples: 8 }).unwrap();
        assert_close(&name("Ripley's K"), &k.k, &side.k, 1e-9);
    }
    let torus = cloud(a.clone(), size, Boundary::Periodic);
    let spectrum = periodogram(&torus, 12.0).unwrap();
    let power: Vec<f64> = golden
        .frequencies
        .iter()
        .map(|&[x, y]| {
            let near = |found: [f64; 2]| (found[0] - x).hypot(found[1] - y) < 1e-9;
            spectrum.iter().find(|&(found, _)| near(found)).unwrap().1
        })
        .collect();
    assert_close("periodogram", &power, &golden.power, 1e-10);
    let hole = largest_empty_circle(&torus).radius;
    assert!((hole - golden.periodic_hole).abs() < 2e-4, "{hole} {}", golden.periodic_hole);
    assert!((hole * 1.02 - golden.periodic_hole).abs() > 2e-4, "the comparison can't fail");
    let pair = [wasserstein(&a, &b).unwrap(), chamfer(&a, &b).unwrap()];
    assert_close("transport", &pair, &[golden.wasserstein, golden.chamfer], 1e-10);
    assert_close("both ways", &[wasserstein(&b, &a).unwrap(), chamfer(&b, &a).unwrap()], &pair, 1e-12);
    let rho = relative_radius(&cloud(a, size, Boundary::Open)).unwrap();
    assert_close("relative radius", &[rho], &[golden.relative_radius], 1e-10);
}

#[derive(serde::Deserialize)]
struct Spatstat {
    sigma: [f64; 1],
    radius: Vec<f64>,
    pair_correlation: Vec<f64>,
    cross_correlation: Vec<f64>,
    within_correlation: Vec<f64>,
    k_open: Vec<f64>,
    k_periodic: Vec<f64>,
    l_open: Vec<f64>,
}

#[test]
fn values_agree_with_spatstat() {
    let golden: Golden = serde_json::from_str(include_str!("analysis/golden.json")).unwrap();
    let theirs: Spatstat = serde_json::from_str(include_str!("analysis/spatstat.json")).unwrap();
    let places: Vec<_> = golden.a.iter().map(|&point| DVec2::from(point)).collect();
    let classes: Vec<u16> = (0..places.len()).map(|i| u16::from(i % 3 == 0)).collect();
    let open = cloud(places.clone(), golden.size.into(), Boundary::Open).with_classes(classes).unwrap();
    // It evaluates the kernel on a grid of distances, so a thousandth is agreement.
    let settings = PairCorrelationSettings { sigma: theirs.sigma[0], range: 0.16, samples: 800 };
    let at = |found: PairCorrelation| {
        let curve = found.radius.iter().zip(&found.value);
        let near = |r: f64| curve.clone().min_by(|a, b| (a.0 - r).abs().total_cmp(&(b.0 - r).abs())).unwrap();
        theirs.radius.iter().map(|&r| *near(r).1).collect::<Vec<f64>>()
    };
    let all = at(pair_correlation(&open, &settings).unwrap());
    assert_close("pair correlation", &all, &theirs.pair_correlation, 3e-3);
    for ((a, b), wanted) in [((0, 1), &theirs.cross_correlation), ((1, 1), &theirs.within_correlation)] {
        let found = at(cross_pair_correlation(&open, a, b, &settings).unwrap());
        assert_close(&format!("pair correlation of {a} and {b}"), &found, wanted, 3e-3);
        assert!(found.iter().zip(&all).any(|(own, all)| (own - all).abs() > 0.1), "another curve than that of all");
    }
    let settings = RipleySettings { range: 0.16, samples: 16 };
    for (boundary, wanted) in [(Boundary::Open, &theirs.k_open), (Boundary::Periodic, &theirs.k_periodic)] {
        let found = ripley(&cloud(places.clone(), golden.size.into(), boundary), &settings).unwrap();
        assert_close(&format!("K, {}", boundary.name()), &found.k[7..], wanted, 1e-8);
        if boundary == Boundary::Open {
            let l: Vec<f64> = found.l_minus_r.iter().zip(&found.radius).map(|(l, r)| l + r).collect();
            assert_close("L", &l[7..], &theirs.l_open, 1e-8);
        }
    }
}

#[test]
fn cells_find_what_looking_at_every_point_finds() {
    for (seed, size) in [(1, DVec2::ONE), (2, DVec2::new(3.0, 0.1)), (3, DVec2::new(0.2, 5.0))] {
        for count in [1, 2, 3, 17, 120] {
            let mut places = points(seed, size, count);
            // Duplicates and points on the borders and corners.
            places.push(places[0]);
            places.extend([DVec2::ZERO, size, DVec2::new(size.x, 0.0), DVec2::new(0.3 * size.x, size.y)]);
            for boundary in [Boundary::Open, Boundary::Periodic] {
                let cloud = cloud(places.clone(), size, boundary);
                let reach: i32 = if boundary == Boundary::Periodic { 12 } else { 0 };
                let mut all = Vec::new();
                for (i, &a) in cloud.points().iter().enumerate() {
                    let mut distances = Vec::new();
                    for (j, &b) in cloud.points().iter().enumerate() {
                        for shift in (-reach..=reach).flat_map(|x| (-reach..=reach).map(move |y| (x, y))) {
                            if i != j || shift != (0, 0) {
                                let shift = DVec2::new(shift.0.into(), shift.1.into()) * size;
                                distances.push((b + shift - a).length());
                            }
                        }
                    }
                    distances.sort_unstable_by(f64::total_cmp);
                    all.push(distances);
                }
                let k = 5.min(if boundary == Boundary::Open { cloud.len() - 1 } else { 5 });
                let found = nearest_distances(&cloud, 5).unwrap();
                assert_eq!(found.neighbours, k);
                let expected: Vec<f64> = all.iter().flat_map(|list| list[..k].to_vec()).collect();
                assert_close("nearest", &found.distances, &expected, 1e-12);
                let radius = 0.7 * size.min_element();
                let mut count = 0;
                cloud.neighbours().pairs(radius, |_, _, _| count += 2);
                assert_eq!(count, all.iter().flatten().filter(|&&distance| distance <= radius).count());
            }
        }
    }
}

#[test]
fn a_hexagonal_lattice_has_known_numbers() {
    let lattice = hex(5);
    let nearest = nearest_distances(&lattice, 7).unwrap();
    for k in 1..=6 {
        assert!(nearest.of_rank(k).all(|distance| (distance - 0.1).abs() < 1e-12), "neighbour {k}");
    }
    assert!(nearest.of_rank(7).all(|distance| (distance - 0.1 * 3.0_f64.sqrt()).abs() < 1e-12));
    assert!((relative_radius(&lattice).unwrap() - 1.0).abs() < 1e-12);
    assert!((densest_distance(lattice.density()) - 0.1).abs() < 1e-12);
    assert!((largest_empty_circle(&lattice).radius - 0.1 / 3.0_f64.sqrt()).abs() < 1e-4);
    let squares = square(8, Boundary::Periodic);
    assert!((relative_radius(&squares).unwrap() - (3.0_f64.sqrt() / 2.0).sqrt()).abs() < 1e-12);
    // A rectangle as part of a larger domain: fewer points than the area could hold.
    assert!((relative_radius_in(&lattice, 4.0 * lattice.area()).unwrap() - 0.5).abs() < 1e-12);

    // One point out of place is seen by all of them.
    let mut places = lattice.points().to_vec();
    places[37] += DVec2::new(0.03, 0.0);
    let flawed = cloud(places, lattice.size(), Boundary::Periodic);
    assert!((relative_radius(&flawed).unwrap() - 0.7).abs() < 0.02);
    assert!(largest_empty_circle(&flawed).radius > 0.06);
}

#[test]
fn independent_points_have_the_k_and_the_pair_correlation_of_chance() {
    for boundary in [Boundary::Open, Boundary::Periodic] {
        let size = DVec2::new(1.0, 0.6);
        let settings = RipleySettings { range: 0.2, samples: 10 };
        let kernel = PairCorrelationSettings { sigma: 0.01, range: 0.2, samples: 20 };
        let (mut ks, mut gs, mut plain) = (Vec::new(), Vec::new(), Vec::new());
        for seed in 0..60 {
            let chance = random(100 + seed, size, 150, boundary);
            ks.push(ripley(&chance, &settings).unwrap().k);
            gs.push(pair_correlation(&chance, &kernel).unwrap().value);
            let mut count = 0.0;
            chance.neighbours().pairs(0.2, |_, _, _| count += 2.0);
            plain.push(vec![count * chance.area() / (150.0 * 149.0)]);
        }
        for (i, (mean, error)) in mean_and_error(&ks).into_iter().enumerate() {
            let r = 0.02 * (i + 1) as f64;
            assert!((mean - PI * r * r).abs() < 4.0 * error, "{boundary:?} K({r}) = {mean} ± {error}");
        }
        // On a torus a point's own images take part and n² stands for n(n − 1): 1 / n of bias.
        let bias = if boundary == Boundary::Periodic { 1.0 / 150.0 } else { 0.0 };
        for (i, (mean, error)) in mean_and_error(&gs).into_iter().enumerate() {
            assert!((mean - 1.0).abs() < 4.0 * error + bias, "{boundary:?} g[{i}] = {mean} ± {error}");
        }
        // Without the correction a window's K is too small, and these errors would tell.
        let (mean, error) = mean_and_error(&plain)[0];
        assert_eq!((mean - PI * 0.04).abs() > 4.0 * error, boundary == Boundary::Open, "{mean} ± {error}");
    }
}

#[test]
fn classes_that_know_nothing_of_one_another_have_the_pair_correlation_of_chance() {
    let kernel = PairCorrelationSettings { sigma: 0.01, range: 0.2, samples: 20 };
    for boundary in [Boundary::Open, Boundary::Periodic] {
        // Regular points, nowhere denser than elsewhere also as a window, and independent ones laid over them.
        let rows: Vec<Vec<f64>> = (0..60)
            .map(|seed| {
                let mut rng = Rng::new(seed, Purpose::Gallery);
                let mut places = poisson_disk(&mut rng, DVec2::ONE, 60, Boundary::Periodic);
                places.extend(points(500 + seed, DVec2::ONE, 90));
                let classes = (0..150).map(|i| u16::from(i >= 60)).collect();
                let both = cloud(places, DVec2::ONE, boundary).with_classes(classes).unwrap();
                let own = cross_pair_correlation(&both, 0, 0, &kernel).unwrap();
                assert!(own.value[0] < 0.1, "points of the first keep away from one another");
                cross_pair_correlation(&both, 0, 1, &kernel).unwrap().value
            })
            .collect();
        for (i, (mean, error)) in mean_and_error(&rows).into_iter().enumerate() {
            assert!((mean - 1.0).abs() < 4.0 * error, "{boundary:?} g[{i}] = {mean} ± {error}");
        }
        let (mean, error) = mean_and_error(&rows)[19];
        assert!((2.0 * mean - 1.0).abs() > 4.0 * error, "pairs counted twice would be seen");
    }
}

#[test]
fn pair_correlations_are_taken_as_oeztireli_and_gross_say() {
    for cloud in [hex(5), random(3, DVec2::new(2.0, 0.5), 80, Boundary::Open)] {
        let settings = PairCorrelationSettings::suited_to(&cloud);
        // The largest distance that as many points can keep in such an area: 2 / (√3 density) is its square.
        let r_max = (2.0 / (3.0_f64.sqrt() * cloud.len() as f64 / (cloud.size().x * cloud.size().y))).sqrt();
        assert_close("σ and range", &[settings.sigma, settings.range], &[0.25 * r_max, 2.5 * r_max], 1e-12);
        assert_eq!(settings.samples, 100);
    }
}

#[test]
fn precision_and_coverage_are_told_apart() {
    // A lattice, and the same lattice with a random half.
    let lattice = square(10, Boundary::Periodic);
    let mut places: Vec<DVec2> = lattice.points().iter().copied().filter(|point| point.x < 0.5).collect();
    places.extend(points(8, DVec2::new(0.5, 1.0), 50).into_iter().map(|point| point + DVec2::new(0.5, 0.0)));
    let mixed = cloud(places, DVec2::ONE, Boundary::Periodic);
    let [lattice, mixed] = [lattice, mixed].map(|one| Neighbourhoods::of(&one, 0.1).unwrap());
    // All that the lattice has is in the mixture, but not the other way round.
    let part = Neighbourhoods::compare(&mixed, &lattice);
    assert!(part.precision < 1e-9 && part.coverage > 0.15, "{part:?}");
    let more = Neighbourhoods::compare(&lattice, &mixed);
    assert_eq!((more.precision, more.coverage), (part.coverage, part.precision));
}

#[test]
fn other_statistics_are_scored_on_the_scale_of_the_quality() {
    for name in ["chevrons", "blue-noise", "houses", "phyllotaxis"] {
        let exemplar = gallery::find(name).unwrap().exemplar();
        let cloud = Cloud::of(&exemplar);
        let size = 2.0 * cloud.size();
        let on_domain = |cloud: &Cloud| {
            pattern(cloud).with_classes(cloud.classes().to_vec(), exemplar.class_names().to_vec()).unwrap()
        };
        let tiled = tile(&cloud, size, cloud.boundary()).unwrap();
        let found = scores(&exemplar, &on_domain(&tiled), 1).unwrap();
        let names: Vec<&str> = found.iter().map(|score| score.statistic.as_str()).collect();
        let all =
            ["pair correlation", "nearest neighbours", "periodogram", "Ripley's L", "ρ", "Chamfer", "Wasserstein"];
        assert_eq!(names, all, "{name}");
        assert!(found.iter().all(|score| score.score == 1.0 && score.value == score.tiled), "{name}: {found:?}");
        if exemplar.boundary() == Boundary::Periodic {
            // A tile and its copies have the same statistics but for what depends on how many points there are: L by
            // n(n − 1), quantiles by where they fall between points, and periodograms by the frequencies there are.
            for score in &found {
                let limit = if score.statistic == "periodogram" { 0.15 } else { 0.03 };
                assert!(score.tiled < limit * score.chance, "{name}: {score:?}");
            }
        }
        // Other starts are about 0, the better of the two kinds a little more, and a jittered tiling is between.
        let white =
            on_domain(&random(77, size, tiled.len(), cloud.boundary()).with_classes(tiled.classes().to_vec()).unwrap());
        let white = scores(&exemplar, &white, 1).unwrap();
        let jittered = jittered(&tiled, 0.1 * cloud.mean_spacing().unwrap(), 3).with_classes(tiled.classes().to_vec());
        let jittered = scores(&exemplar, &on_domain(&jittered.unwrap()), 1).unwrap();
        for (start, between) in white.iter().zip(&jittered) {
            assert!(start.score > -0.6 && start.score < 1.0, "{name}: {start:?}");
            assert!(between.score < 1.0 - 1e-3, "{name}: {between:?}");
        }
        let mean = |list: &[Score]| list.iter().map(|score| score.score).sum::<f64>() / list.len() as f64;
        assert!(mean(&white) < mean(&jittered), "{name}: {white:?} {jittered:?}");
        assert_eq!(scores(&exemplar, &on_domain(&tiled), 1).unwrap(), found, "the same seed, the same numbers");
    }
    let two =
        PointPattern::new(Domain::new(DVec2::ZERO, DVec2::ONE).unwrap(), vec![DVec2::splat(0.2), DVec2::ONE]).unwrap();
    let few = scores(&two, &two, 1).unwrap();
    assert!(few.iter().all(|score| score.score.is_finite()), "{few:?}");
    let one = PointPattern::new(Domain::new(DVec2::ZERO, DVec2::ONE).unwrap(), vec![DVec2::ONE]).unwrap();
    assert!(scores(&one, &two, 1).is_err() && scores(&two, &one, 1).is_err());
}

#[test]
fn envelopes_tell_order_and_clusters_from_chance() {
    let settings = RipleySettings { range: 0.15, samples: 30 };
    let p_value = |cloud: &Cloud| {
        let found = ripley(cloud, &settings).unwrap();
        let envelope = envelope(cloud, &found, &settings, 39, 7).unwrap();
        assert!(envelope.low.iter().zip(&envelope.high).all(|(low, high)| low <= high));
        assert_eq!(envelope, analysis::envelope(cloud, &found, &settings, 39, 7).unwrap());
        envelope.p_value
    };
    assert_eq!(p_value(&square(9, Boundary::Open)), 1.0 / 40.0);
    let rings = Cloud::of(&gallery::find("cluster").unwrap().exemplar());
    assert_eq!(p_value(&rings), 1.0 / 40.0);
    // Chance is rejected at 5 % in one pattern of twenty.
    let rejected = (0..40).filter(|&seed| p_value(&random(seed, DVec2::ONE, 80, Boundary::Open)) <= 0.05).count();
    assert!(rejected <= 7, "{rejected} of 40");
}

#[test]
fn a_thomas_process_has_its_closed_form() {
    // Poisson parents of density κ, Poisson children around each, normal with standard deviation s:
    // g(r) = 1 + exp(−r² / 4s²) / (4π s² κ) (Møller & Waagepetersen 2004, example 5.3).
    let (density, children, s) = (80.0, 5.0, 0.02);
    let kernel = PairCorrelationSettings { sigma: 0.004, range: 0.12, samples: 25 };
    let mut rows = Vec::new();
    for seed in 0..60 {
        let mut rng = Rng::new(seed, Purpose::Gallery);
        let mut places = Vec::new();
        for _ in 0..rng.poisson(density) {
            let parent = DVec2::new(rng.uniform(), rng.uniform());
            for _ in 0..rng.poisson(children) {
                places.push(wrap(parent + s * DVec2::new(rng.normal(), rng.normal()), DVec2::ONE));
            }
        }
        // The estimate divides by n²; the process has the square of its mean density.
        let weight = (places.len() as f64 / (density * children)).powi(2);
        let found = pair_correlation(&cloud(places, DVec2::ONE, Boundary::Periodic), &kernel).unwrap();
        rows.push(found.value.iter().map(|value| value * weight).collect::<Vec<_>>());
    }
    let step = (kernel.range - 0.01 * kernel.sigma) / 24.0;
    let form = |r: f64, s: f64| 1.0 + (-r * r / (4.0 * s * s)).exp() / (4.0 * PI * s * s * density);
    let misses = |s: f64| {
        let found = mean_and_error(&rows);
        found
            .iter()
            .enumerate()
            // The kernel's width adds to the clusters': a bias of up to 2 %.
            .filter(|&(i, &(mean, error))| {
                let expected = form(0.01 * kernel.sigma + i as f64 * step, s);
                (mean - expected).abs() > 4.0 * error + 0.02 * expected
            })
            .count()
    };
    assert_eq!(misses(s), 0);
    assert!(misses(1.3 * s) > 5, "clusters 30 % wider must not pass");
    // L tells clusters from order by its sign: here r is the radius of the clusters, below it that of empty discs.
    let l = |cloud: &Cloud| ripley(cloud, &RipleySettings { range: 0.08, samples: 4 }).unwrap();
    let lattice = l(&hex(5));
    assert_close("no neighbour", &lattice.l_minus_r, &[-0.02, -0.04, -0.06, -0.08], 1e-12);
    let found = l(&Cloud::of(&gallery::find("cluster").unwrap().exemplar()));
    for (value, (k, r)) in found.l_minus_r.iter().zip(found.k.iter().zip(&found.radius)) {
        assert!((value - ((k / PI).sqrt() - r)).abs() < 1e-12 && *value > 0.02, "L({r}) - r = {value}");
    }
}

#[test]
fn pair_densities_keep_the_direction() {
    // Pairs along x only.
    let mut rng = Rng::new(3, Purpose::Gallery);
    let mut places = poisson_disk(&mut rng, DVec2::ONE, 60, Boundary::Periodic);
    places.extend(places.clone().iter().map(|&point| wrap(point + DVec2::new(0.03, 0.0), DVec2::ONE)));
    let pairs = cloud(places, DVec2::ONE, Boundary::Periodic);
    let settings = PairDensitySettings { reach: 0.1, sigma: 0.005, pitch: 0.005 };
    let density = pair_density(&pairs, &settings).unwrap();
    let at = |x: i64, y: i64| {
        let half = density.side as i64 / 2;
        density.values[((half + y) * density.side as i64 + half + x) as usize]
    };
    assert!(at(6, 0) > 20.0 && at(-6, 0) > 20.0, "{}", at(6, 0));
    assert!(at(0, 6) < 2.0 && at(4, 4) < 2.0);
    for (x, y) in [(6, 0), (3, 2), (-5, 11)] {
        assert!((at(x, y) - at(-x, -y)).abs() < 1e-9 * at(6, 0), "differences come in both directions");
    }
    // The isotropic statistic can't tell these pairs from the same ones upright; this one can.
    let upright: Vec<_> = pairs.points().iter().map(|point| DVec2::new(point.y, point.x)).collect();
    let upright = cloud(upright, DVec2::ONE, Boundary::Periodic);
    let kernel = PairCorrelationSettings::suited_to(&pairs);
    let g = [&pairs, &upright].map(|one| pair_correlation(one, &kernel).unwrap());
    assert!(g[0].mean_squared_difference(&g[1]).unwrap() < 1e-20);
    let other = pair_density(&upright, &settings).unwrap();
    assert!(density.mean_absolute_difference(&other).unwrap() > 0.1);
    // Chance is 1 everywhere.
    let chance = pair_density(&random(4, DVec2::ONE, 3000, Boundary::Open), &settings).unwrap();
    let (sum, count) = chance.within_reach().fold((0.0, 0.0), |(sum, count), (_, value)| (sum + value, count + 1.0));
    assert!((sum / count - 1.0_f64).abs() < 0.02, "{}", sum / count);
}

#[test]
fn a_lattice_peaks_at_its_reciprocal_frequencies() {
    for boundary in [Boundary::Open, Boundary::Periodic] {
        let spectrum = periodogram(&square(10, boundary), 25.0).unwrap();
        for (frequency, power) in spectrum.iter() {
            let peak = frequency.iter().all(|cycles| (cycles / 10.0 - (cycles / 10.0).round()).abs() < 1e-9);
            assert!((power - if peak { 100.0 } else { 0.0 }).abs() < 1e-8, "{frequency:?}: {power}");
        }
    }
    let radial = periodogram(&square(10, Boundary::Periodic), 13.0).unwrap().radial_mean(1.0).unwrap();
    let strongest = radial.power.iter().zip(&radial.frequency).max_by(|a, b| a.0.total_cmp(b.0)).unwrap();
    assert!((10.0..11.0).contains(strongest.1), "{strongest:?}");
    // Independent points have 1 everywhere.
    let rows: Vec<Vec<f64>> = (0..20)
        .map(|seed| {
            periodogram(&random(seed, DVec2::ONE, 100, Boundary::Open), 20.0).unwrap().radial_mean(2.0).unwrap().power
        })
        .collect();
    assert!(mean_and_error(&rows).iter().all(|(mean, error)| (mean - 1.0).abs() < 4.0 * error));
    // The largest patterns are thinned out, not waited for.
    let large = random(1, DVec2::ONE, 20_000, Boundary::Periodic);
    let thinned = periodogram(&large, 3.0 * 20_000_f64.sqrt()).unwrap();
    assert!(thinned.step[0] > 1.0 && thinned.size[0] * thinned.size[1] < 40_000, "{:?}", thinned.size);
}

#[test]
fn transport_finds_known_matches() {
    let a = points(1, DVec2::ONE, 80);
    let shift = DVec2::new(0.003, -0.004);
    let mut b: Vec<_> = a.iter().map(|&point| point + shift).collect();
    Rng::new(2, Purpose::Gallery).shuffle(&mut b);
    // 80 points, each 0.005 from its partner.
    assert_close("permutation", &[wasserstein(&a, &b).unwrap()], &[80_f64.sqrt() * 0.005], 1e-12);
    assert!(wasserstein(&a, &points(9, DVec2::ONE, 80)).unwrap() > 0.3, "other points are farther");
    // More points on one side stay over.
    b.extend([DVec2::splat(5.0), DVec2::splat(-3.0)]);
    assert_close("unequal", &[wasserstein(&a, &b).unwrap()], &[80_f64.sqrt() * 0.005], 1e-12);
    // The best of all assignments, found by trying them all.
    for seed in 0..30 {
        let (few, many) = (points(seed, DVec2::ONE, 4), points(seed + 1000, DVec2::ONE, 6));
        let mut best = f64::INFINITY;
        for code in 0..6_usize.pow(4) {
            let choice: Vec<usize> = (0..4).map(|i| code / 6_usize.pow(i) % 6).collect();
            if (0..4).all(|i| !choice[..i].contains(&choice[i])) {
                let cost: f64 = few.iter().zip(&choice).map(|(p, &j)| p.distance_squared(many[j])).sum();
                best = best.min(cost);
            }
        }
        assert_close("exhaustive", &[wasserstein(&few, &many).unwrap()], &[best.sqrt()], 1e-12);
    }
    assert_eq!(chamfer(&a, &a).unwrap(), 0.0);
    assert_close("chamfer", &[chamfer(&[DVec2::ZERO], &[DVec2::X, DVec2::X * 3.0]).unwrap()], &[1.0 + 2.0], 1e-12);
    // Equal costs everywhere, duplicates on both sides.
    assert_eq!(wasserstein(&[DVec2::ONE; 40], &[DVec2::ONE; 50]).unwrap(), 0.0);
}

#[test]
fn patches_of_a_tiling_are_the_exemplar() {
    let exemplar = Cloud::of(&gallery::find("blue-noise").unwrap().exemplar());
    let tiled = tile(&exemplar, 2.0 * exemplar.size(), Boundary::Periodic).unwrap();
    let found = compare_patches(&exemplar, &tiled).unwrap();
    assert_eq!(found.patches, [2, 2]);
    assert!(found.chamfer < 1e-12 && found.wasserstein.unwrap() < 1e-12);
    assert!(found.pair_correlation_error < 1e-20 && found.narrow_pair_correlation_error < 1e-20);
    // The magnitudes of the paper's table for independent blue noise of about its size.
    let other = Cloud::of(&gallery::find("blue-noise").unwrap().generate(5));
    let other = compare_patches(&exemplar, &tile(&other, 2.0 * exemplar.size(), Boundary::Periodic).unwrap()).unwrap();
    assert!((0.06..0.11).contains(&other.chamfer), "{other:?}");
    assert!((0.4..0.7).contains(&other.wasserstein.unwrap()), "{other:?}");
    assert!((0.001..0.02).contains(&other.pair_correlation_error), "{other:?}");
    assert!(other.narrow_pair_correlation_error > 10.0 * other.pair_correlation_error, "{other:?}");
}

#[test]
fn quality_is_one_for_a_tiling_and_zero_for_chance() {
    let mut sums = [0.0; 3];
    let names = ["chevrons", "maze", "crosses", "blue-noise", "jittered-grid", "honeycomb"];
    for name in names {
        let exemplar = Cloud::of(&gallery::find(name).unwrap().exemplar());
        let (size, spacing) = (2.0 * exemplar.size(), exemplar.mean_spacing().unwrap());
        let scale = QualityScale::new(&exemplar, size, Boundary::Periodic, &[4 * exemplar.len()], 1).unwrap();
        let tiled = tile(&exemplar, size, Boundary::Periodic).unwrap();
        let judge = |cloud: &Cloud| scale.judge(cloud).unwrap().score;
        assert!((judge(&tiled) - 1.0).abs() < 1e-9, "{name}");
        // A tile has no corner: shifted it is as good.
        let shifted = tiled.points().iter().map(|&point| wrap(point + DVec2::new(0.37, 0.81), size)).collect();
        assert!((judge(&cloud(shifted, size, Boundary::Periodic)) - 1.0).abs() < 1e-3, "{name}");
        let white = judge(&random(5, size, tiled.len(), Boundary::Periodic));
        assert!(white.abs() < 0.2, "{name}: white noise {white}");
        sums[0] += white;
        sums[1] += judge(&jittered(&tiled, 0.1 * spacing, 3));
        sums[2] += judge(&jittered(&tiled, 0.2 * spacing, 3));
        // A pattern against itself, open or not.
        for boundary in [Boundary::Open, Boundary::Periodic] {
            let same = pattern(&exemplar).with_boundary(boundary);
            assert!((normalised_quality(&same, &same, 3).unwrap().score - 1.0).abs() < 1e-9, "{name}");
        }
    }
    let [white, slight, strong] = sums.map(|sum| sum / names.len() as f64);
    assert!(white.abs() < 0.1, "white noise {white}");
    assert!((0.7..0.85).contains(&slight), "jitter of 0.1 d: {slight}");
    assert!((0.4..0.65).contains(&strong), "jitter of 0.2 d: {strong}");
}

#[test]
fn an_independent_sample_scores_about_what_is_foretold() {
    for (name, tolerance) in
        [("blue-noise", 0.15), ("cluster", 0.15), ("triangles", 0.15), ("chevrons", 0.1), ("hex", 0.01)]
    {
        let entry = gallery::find(name).unwrap();
        let exemplar = Cloud::of(&entry.exemplar());
        let other = tile(&Cloud::of(&entry.generate(2)), 2.0 * exemplar.size(), Boundary::Periodic).unwrap();
        let scale = QualityScale::new(&exemplar, other.size(), other.boundary(), &[other.len()], 1).unwrap();
        let found = scale.judge(&other).unwrap();
        assert!((found.score - found.independent).abs() < tolerance, "{name}: {found:?}");
    }
}

#[test]
fn classes_count() {
    // A checkerboard of two classes.
    let board = |side: usize, class: &dyn Fn(usize, usize) -> u16| {
        let classes = (0..side * side).map(|i| class(i % side, i / side)).collect();
        pattern(&square(side, Boundary::Periodic)).with_classes(classes, vec!["a".into(), "b".into()]).unwrap()
    };
    let exemplar = board(8, &|x, y| ((x + y) % 2) as u16);
    assert!((normalised_quality(&exemplar, &exemplar, 1).unwrap().score - 1.0).abs() < 1e-9);
    // The classes by name, not by number.
    let renamed = pattern(&square(8, Boundary::Periodic))
        .with_classes((0..64).map(|i| ((i % 8 + i / 8 + 1) % 2) as u16).collect(), vec!["b".into(), "a".into()])
        .unwrap();
    assert!((normalised_quality(&exemplar, &renamed, 1).unwrap().score - 1.0).abs() < 1e-9);
    let stripes = board(8, &|x, _| (x % 2) as u16);
    let wrong = normalised_quality(&exemplar, &stripes, 1).unwrap();
    assert!(wrong.score < 0.6, "{wrong:?}");
    // Without their classes both are the same lattice.
    let plain = |pattern: &PointPattern| {
        PointPattern::new(pattern.domain(), pattern.positions().to_vec()).unwrap().with_boundary(Boundary::Periodic)
    };
    assert!((normalised_quality(&plain(&exemplar), &plain(&stripes), 1).unwrap().score - 1.0).abs() < 1e-9);

    let cloud = Cloud::of(&exemplar);
    let sharp = PairCorrelationSettings { sigma: 0.01, range: 0.3, samples: 50 };
    let cross = cross_pair_correlation(&cloud, 0, 1, &sharp).unwrap();
    let same = cross_pair_correlation(&cloud, 0, 0, &sharp).unwrap();
    let at = |one: &PairCorrelation, r: f64| {
        let nearest =
            one.radius.iter().enumerate().min_by(|a, b| (a.1 - r).abs().total_cmp(&(b.1 - r).abs())).unwrap().0;
        one.value[nearest]
    };
    assert!(at(&cross, 0.125) > 3.0 && at(&same, 0.125) < 0.1, "neighbours are of the other class");
    assert!(at(&cross, 0.177) < 0.1 && at(&same, 0.177) > 3.0, "diagonal ones of the same");
    assert_eq!(cross, cross_pair_correlation(&cloud, 1, 0, &sharp).unwrap());
    let comparison = Comparison::of(&exemplar, &stripes, 1).unwrap();
    assert_eq!(comparison.output.cross_correlations.len(), 3);
}

#[test]
fn defects_are_seen_one_by_one() {
    let exemplar = square(10, Boundary::Open);
    let clean = Defects::of(&exemplar, &exemplar).unwrap();
    assert_eq!((clean.stacked, clean.clumps, clean.holes), (0.0, 1.0, 1.0));
    assert!(clean.border.unwrap().abs() < 1e-12);
    let change = |edit: &dyn Fn(&mut Vec<DVec2>)| {
        let mut places = exemplar.points().to_vec();
        edit(&mut places);
        let output = cloud(places, DVec2::ONE, Boundary::Open);
        (Defects::of(&exemplar, &output).unwrap(), pattern(&output))
    };
    let words = |output: &PointPattern| verdict(&Comparison::of(&pattern(&exemplar), output, 1).unwrap());
    assert!(words(&pattern(&exemplar)).contains("No points are stacked"));

    let (stacked, output) = change(&|places| places[44] = places[45] + DVec2::splat(0.01));
    assert_eq!(stacked.stacked, 0.02);
    assert!(words(&output).contains("2.0 % of its points are stacked"), "{}", words(&output));
    // A row with a point too many: as seen from its middle, four others are as near as only two should be.
    let (clump, output) = change(&|places| {
        for point in places.iter_mut().filter(|point| (point.y - 0.45).abs() < 1e-9 && point.x < 0.5) {
            point.x = 0.5 - 0.52 * (0.5 - point.x);
        }
    });
    assert!(clump.stacked == 0.0 && clump.clumps > 1.9 && clump.clumps < 1.95, "{clump:?}");
    assert!(words(&output).contains("clump"), "{}", words(&output));
    let (hole, output) = change(&|places| places.retain(|point| point.distance(DVec2::splat(0.5)) > 0.2));
    assert!(hole.holes > 2.0 && hole.stacked == 0.0, "{hole:?}");
    assert!(words(&output).contains("hole"), "{}", words(&output));
    let (border, output) = change(&|places| {
        for point in places.iter_mut().take(10) {
            point.y = 0.0;
        }
    });
    assert!(border.border.unwrap() > 0.09 && border.stacked == 0.0, "{border:?}");
    assert!(words(&output).contains("border"), "{}", words(&output));
    // A tile has no border to be crowded.
    let tile = pattern(&exemplar).with_boundary(Boundary::Periodic);
    assert_eq!(Comparison::of(&tile, &tile, 1).unwrap().defects.border, None);
}

#[test]
fn a_verdict_is_two_to_four_sentences_and_follows_the_score() {
    let entry = gallery::find("crosses").unwrap();
    let exemplar = entry.exemplar();
    let cloud = Cloud::of(&exemplar);
    let tiled = tile(&cloud, 2.0 * cloud.size(), Boundary::Periodic).unwrap();
    let spacing = cloud.mean_spacing().unwrap();
    let unit = exemplar.domain().exemplar_unit();
    assert_eq!(unit, 1.0);
    let say = |cloud: &Cloud| verdict(&Comparison::of(&exemplar, &pattern(cloud), 1).unwrap());
    let sparse = cloud_of_half(&tiled);
    let cases = [
        (tiled.clone(), "as good as a copy"),
        (jittered(&tiled, 0.1 * spacing, 1), "closely"),
        (jittered(&tiled, 0.25 * spacing, 1), "with flaws"),
        (jittered(&tiled, 0.5 * spacing, 1), "much is missing"),
        (random(1, tiled.size(), tiled.len(), Boundary::Periodic), "hardly"),
        (sparse, "same unit"),
    ];
    for (cloud, part) in cases {
        let words = say(&cloud);
        assert!(words.contains(part), "{words:?} without {part:?}");
        let sentences = words.matches(". ").count() + 1;
        assert!((2..=4).contains(&sentences), "{sentences} sentences: {words}");
    }
    let blue = gallery::find("blue-noise").unwrap();
    let other = tile(&Cloud::of(&blue.generate(2)), DVec2::splat(2.0), Boundary::Periodic).unwrap();
    let words = verdict(&Comparison::of(&blue.exemplar(), &pattern(&other), 1).unwrap());
    assert!(words.contains("is like another sample"), "{words}");
    // Arranged alike, but every point a little off: the neighbours come too near.
    let near = verdict(&Comparison::of(&blue.exemplar(), &pattern(&jittered(&other, 0.004, 1)), 1).unwrap());
    assert!(!near.contains("is like another sample"), "{near}");
    assert!(describe(&Analysis::of_pattern(&exemplar, 1).unwrap()).contains("Ripley"));
}

fn cloud_of_half(cloud: &Cloud) -> Cloud {
    let half = cloud.points().iter().step_by(2).copied().collect();
    Cloud::new(half, cloud.size(), cloud.boundary()).unwrap()
}

#[test]
fn units_do_not_matter() {
    let exemplar = gallery::find("triangles").unwrap().exemplar();
    let output =
        pattern(&jittered(&tile(&Cloud::of(&exemplar), DVec2::splat(2.0), Boundary::Periodic).unwrap(), 0.01, 1));
    let scaled = |pattern: &PointPattern, factor: f64| {
        let offset = DVec2::new(-30.0, 7.0);
        let domain = Domain::new(pattern.domain().min() * factor + offset, pattern.domain().size() * factor).unwrap();
        let places = pattern.positions().iter().map(|&point| point * factor + offset).collect();
        PointPattern::new(domain, places).unwrap().with_boundary(pattern.boundary())
    };
    let here = Comparison::of(&exemplar, &output, 1).unwrap();
    let there = Comparison::of(&scaled(&exemplar, 400.0), &scaled(&output, 400.0), 1).unwrap();
    assert_eq!(there.unit, 400.0);
    let (one, other) = (here.quality.score, there.quality.score);
    // Rounding decides between the exemplar's equally far neighbours, and so the last but a few digits.
    assert!((one - other).abs() < 1e-3, "{one} {other}");
    assert_close("pair correlation", &there.output.pair_correlation.value, &here.output.pair_correlation.value, 1e-6);
    assert_eq!(verdict(&here), verdict(&there));
    // In another unit than the exemplar it is another pattern.
    let wrong = Comparison::of(&exemplar, &scaled(&output, 2.0), 1).unwrap();
    assert!((wrong.density_ratio - 0.25).abs() < 1e-9 && verdict(&wrong).contains("same unit"), "{}", verdict(&wrong));
    assert!(wrong.quality.score < here.quality.score - 0.1, "{:?}", wrong.quality);

    let judge = Judge::new(&exemplar, &output, 1).unwrap();
    assert_eq!(judge.compare(&output).unwrap(), here);
    let live = judge.follow(&output).unwrap();
    assert_eq!((live.scales, live.quality, live.defects), (here.scales, here.quality, here.defects));
    assert_eq!(live.verdict, verdict(&here));
    for (curves, analysis) in [(&live.exemplar, &here.exemplar), (&live.output, &here.output)] {
        assert_eq!(curves.points, analysis.points);
        assert_eq!(curves.nearest, analysis.nearest.first().copied());
        assert_eq!(curves.nearest_histogram, analysis.nearest_histogram);
        assert_eq!(curves.pair_correlation, analysis.pair_correlation);
        assert_eq!(curves.spectrum, analysis.spectrum);
        assert_eq!(curves.relative_radius, analysis.relative_radius);
    }
    let text = serde_json::to_string(&here).unwrap();
    assert_eq!(serde_json::from_str::<Comparison>(&text).unwrap(), here);
}

#[test]
fn poor_patterns_give_errors_or_values_but_no_panic() {
    let none = Cloud::new(Vec::new(), DVec2::ONE, Boundary::Open).unwrap_err();
    assert_eq!(none.to_string(), "a pattern needs at least 1 points, but there are 0");
    for (places, part) in
        [(vec![DVec2::new(0.5, f64::NAN)], "(0.5, NaN)"), (vec![DVec2::new(1.5, 0.5)], "does not lie in the rectangle")]
    {
        let error = Cloud::new(places, DVec2::ONE, Boundary::Open).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
    for size in [DVec2::ZERO, DVec2::new(1.0, -1.0), DVec2::new(f64::INFINITY, 1.0)] {
        assert!(matches!(Cloud::new(vec![DVec2::ZERO], size, Boundary::Open), Err(AnalysisError::Size { .. })));
    }
    let place = DVec2::new(0.3, 0.4);
    let other = DVec2::new(0.6, 0.8);
    for boundary in [Boundary::Open, Boundary::Periodic] {
        let of = |places: &[DVec2]| pattern(&cloud(places.to_vec(), DVec2::ONE, boundary));
        let good = of(&points(1, DVec2::ONE, 40));
        for (poor, part) in [(of(&[place]), "at least 2 points, but there are 1"), (of(&[place; 9]), "in one place")] {
            for outcome in [
                Analysis::of_pattern(&poor, 1).map(drop),
                Comparison::of(&poor, &good, 1).map(drop),
                normalised_quality(&poor, &good, 1).map(drop),
            ] {
                let error = outcome.unwrap_err().to_string();
                assert!(error.contains(part), "{error}");
            }
        }
        assert!(Comparison::of(&good, &of(&[place]), 1).is_err());
        // Everything in one place is a result, and a bad one.
        let clump = Comparison::of(&good, &of(&[place; 40]), 1).unwrap();
        assert_eq!((clump.defects.stacked, clump.output.spacing), (1.0, None));
        assert!(clump.quality.score < 0.0 && clump.quality.score >= -1.0, "{:?}", clump.quality);
        assert!(verdict(&clump).contains("100 % of its points are stacked"), "{}", verdict(&clump));
        for few in [vec![place, other], vec![place, other, place], points(3, DVec2::ONE, 3), points(4, DVec2::ONE, 9)] {
            let few = of(&few);
            let own = Comparison::of(&few, &few, 1).unwrap();
            let finite = |list: &[f64]| list.iter().all(|value| value.is_finite());
            assert!(finite(&own.output.pair_correlation.value) && finite(&own.output.ripley.k));
            assert!(own.quality.score.is_finite() && own.quality.score > 0.99, "{:?}", own.quality);
            assert!(!verdict(&own).is_empty() && !describe(&own.output).is_empty());
            assert!(Comparison::of(&few, &good, 1).unwrap().quality.score.is_finite());
            assert!(Comparison::of(&good, &few, 1).unwrap().quality.score.is_finite());
        }
    }
    // A class without points.
    let places = points(1, DVec2::ONE, 20);
    let names = || vec!["a".into(), "b".into(), "c".into()];
    let classed = |class: fn(usize) -> u16| {
        let classes = (0..20).map(class).collect();
        PointPattern::new(Domain::UNIT, places.clone()).unwrap().with_classes(classes, names()).unwrap()
    };
    let (two, one) = (classed(|i| (i % 2) as u16 * 2), classed(|_| 0));
    let kernel = PairCorrelationSettings::suited_to(&Cloud::of(&two));
    let error = cross_pair_correlation(&Cloud::of(&two), 0, 1, &kernel).unwrap_err();
    assert_eq!(error, AnalysisError::EmptyClass { class: 1 });
    assert_eq!(Analysis::of_pattern(&two, 1).unwrap().class_sizes, [10, 0, 10]);
    for (a, b) in [(&two, &one), (&one, &two)] {
        let score = Comparison::of(a, b, 1).unwrap().quality.score;
        assert!(score < 0.9, "{score}");
    }
    // Settings that can't be used.
    let chance = random(1, DVec2::ONE, 20, Boundary::Open);
    for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(pair_correlation(&chance, &kernel.with_sigma(sigma)).is_err());
        assert!(periodogram(&chance, sigma).is_err());
        assert!(relative_radius_in(&chance, sigma).is_err());
        assert!(pair_density(&chance, &PairDensitySettings { reach: 0.1, sigma: 0.1, pitch: sigma }).is_err());
    }
    assert!(wasserstein(&[], &places).is_err() && chamfer(&places, &[]).is_err());
    assert!(matches!(
        wasserstein(&vec![place; MAX_ASSIGNMENT + 1], &places),
        Err(AnalysisError::TooManyPoints { count: 3001, .. })
    ));
}

#[test]
fn a_thousand_points_are_analysed_while_one_watches() {
    let exemplar = Cloud::of(&gallery::find("nested-grids").unwrap().exemplar());
    let chance = random(1, 2.5 * exemplar.size(), 1000, Boundary::Open);
    // The best of several, since other tests run beside this one.
    let best = |work: &dyn Fn()| {
        (0..7)
            .map(|_| {
                let started = std::time::Instant::now();
                work();
                started.elapsed().as_secs_f64() * 1e3
            })
            .fold(f64::INFINITY, f64::min)
    };
    let scales = Scales::of(&exemplar).unwrap();
    let own = PairCorrelationSettings::suited_to(&chance);
    let sizes = [chance.len()];
    let scale = QualityScale::new(&exemplar, chance.size(), Boundary::Open, &sizes, 1).unwrap();
    let times = [
        ("pair correlation", best(&|| drop(pair_correlation(&chance, &own)))),
        ("pair density", best(&|| drop(pair_density(&chance, &scales.pair_density)))),
        ("periodogram", best(&|| drop(periodogram(&chance, scales.max_frequency)))),
        ("largest empty circle", best(&|| assert!(largest_empty_circle(&chance).radius > 0.0))),
        ("analysis", best(&|| drop(Analysis::of(&chance, &scales)))),
        ("quality", best(&|| drop(scale.judge(&chance)))),
    ];
    println!("{times:.1?} ms");
    assert!(times[0].1 < 25.0 && times[4].1 < 250.0 && times[5].1 < 800.0, "{times:?} ms");
}

#[test]
fn white_noise_is_not_blue() {
    // The direction of the whole scale: an exemplar of blue noise rates blue noise above white, and the other way.
    let size = DVec2::splat(2.0);
    let mut rng = Rng::new(9, Purpose::Gallery);
    let white = cloud(white_noise(&mut rng, size, 480), size, Boundary::Periodic);
    let blue = cloud(poisson_disk(&mut rng, size, 480, Boundary::Periodic), size, Boundary::Periodic);
    for (name, better, worse) in [("poisson-disk", &blue, &white), ("white-noise", &white, &blue)] {
        let exemplar = Cloud::of(&gallery::find(name).unwrap().exemplar());
        let scale = QualityScale::new(&exemplar, size, Boundary::Periodic, &[480], 1).unwrap();
        let [better, worse] = [better, worse].map(|one| scale.judge(one).unwrap().score);
        assert!(better > worse + 0.1, "{name}: {better} {worse}");
    }
}
