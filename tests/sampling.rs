//! Random numbers and ways to scatter points: what a start in a share link relies on.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail loudly")]

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use pointweave::Boundary;
use pointweave::sampling::{Purpose, Rng, lloyd_step, poisson_disk, white_noise, wrap};

const BOUNDARIES: [Boundary; 2] = [Boundary::Open, Boundary::Periodic];
const SIZES: [DVec2; 3] = [DVec2::ONE, DVec2::new(2.0, 1.5), DVec2::new(1.0, 64.0)];

fn rng(seed: u64) -> Rng {
    Rng::new(seed, Purpose::Start(0))
}

/// Smallest distance between two points over that of the densest packing of as many.
fn relative_distance(points: &[DVec2], size: DVec2, boundary: Boundary) -> f64 {
    let mut smallest = f64::INFINITY;
    for (i, &a) in points.iter().enumerate() {
        for &b in &points[..i] {
            let mut offset = (a - b).abs();
            if boundary == Boundary::Periodic {
                offset = offset.min(size - offset);
            }
            smallest = smallest.min(offset.length());
        }
    }
    smallest / (2.0 * size.x * size.y / (3.0_f64.sqrt() * points.len() as f64)).sqrt()
}

fn inside(points: &[DVec2], size: DVec2) -> bool {
    points.iter().all(|point| point.cmpge(DVec2::ZERO).all() && point.cmplt(size).all())
}

#[test]
fn poisson_disk_gives_the_exact_count_inside_and_apart() {
    for size in SIZES {
        for boundary in BOUNDARIES {
            for count in [0, 1, 2, 3, 7, 100, 1000] {
                for seed in 0..if count > 100 { 2 } else { 8 } {
                    let case = format!("{count} points in {size}, {boundary:?}, seed {seed}");
                    let points = poisson_disk(&mut rng(seed), size, count, boundary);
                    assert_eq!(points.len(), count, "{case}");
                    assert!(inside(&points, size), "{case}");
                    if count < 2 {
                        continue;
                    }
                    let ratio = relative_distance(&points, size, boundary);
                    assert!(ratio >= 0.62, "{case}: {ratio} of the densest packing's distance");
                    // Negative control: the bound tells chance from darts as soon as there are a few points.
                    if count >= 100 {
                        let chance = white_noise(&mut rng(seed), size, count);
                        assert_eq!(chance.len(), count);
                        assert!(inside(&chance, size), "{case}");
                        let ratio = relative_distance(&chance, size, boundary);
                        assert!(ratio < 0.3, "{case}: white noise has {ratio}");
                    }
                }
            }
        }
    }
}

#[test]
fn only_a_periodic_pattern_keeps_its_distance_over_the_border() {
    let ratio = |seed, boundary| {
        let points = poisson_disk(&mut rng(seed), DVec2::ONE, 60, boundary);
        relative_distance(&points, DVec2::ONE, Boundary::Periodic)
    };
    for seed in 0..30 {
        assert!(ratio(seed, Boundary::Periodic) >= 0.62, "seed {seed}");
    }
    let crowded = (0..30).filter(|&seed| ratio(seed, Boundary::Open) < 0.5).count();
    assert!(crowded > 10, "only {crowded} of 30 open patterns have close points across the border");
}

#[test]
fn poisson_disk_copes_with_the_largest_outputs() {
    for boundary in BOUNDARIES {
        let size = DVec2::new(3.0, 2.0);
        let points = poisson_disk(&mut rng(1), size, 20_000, boundary);
        assert_eq!(points.len(), 20_000);
        assert!(inside(&points, size));
        let distinct: BTreeSet<_> = points.iter().map(|p| (p.x.to_bits(), p.y.to_bits())).collect();
        assert_eq!(distinct.len(), 20_000);
    }
}

#[test]
fn streams_never_change() {
    // A share link carries a seed, not the numbers drawn from it, so a changed value breaks every link. Update one
    // only on purpose, with a new version of the link format.
    // The values are those of an independent ChaCha8 (64-bit block counter, the stream's number as the nonce).
    const GOLDEN: [(Purpose, [u32; 4]); 7] = [
        (Purpose::Start(0), [0x9ef6_db63, 0x0db2_3628, 0x2e14_4830, 0xb365_488e]),
        (Purpose::Start(1), [0xa26c_ebfa, 0xf931_1c25, 0xd463_203d, 0x229d_c232]),
        (Purpose::Filters, [0x287e_548e, 0xef32_9c99, 0xac6c_c009, 0x4818_605b]),
        (Purpose::Jitter { class: 1, scale: 2, iteration: 3 }, [0x0c38_1d4f, 0x1262_6a0b, 0xb652_157f, 0x5192_631a]),
        (Purpose::Attributes(0), [0x0c7e_d5dd, 0x4e32_fd00, 0x0745_ecbe, 0x2786_442a]),
        (Purpose::Attributes(1), [0xd05b_6ecf, 0x3088_ae77, 0x791f_4539, 0x6f7e_c77a]),
        (Purpose::Gallery, [0xb9e2_935b, 0x02cb_d593, 0xdf9d_3d29, 0x31c3_ac8d]),
    ];
    let actual = GOLDEN.map(|(purpose, _)| {
        let mut rng = Rng::new(7, purpose);
        (purpose, [(); 4].map(|()| rng.bits()))
    });
    assert_eq!(actual, GOLDEN, "now {actual:#x?}");
}

#[test]
fn distributions_never_change() {
    // As above: starts, jitter and the gallery are built of these draws. Update only on purpose.
    let mut rng = Rng::new(7, Purpose::Start(0));
    let reals = [rng.uniform(), rng.range(-2.0, 3.0), rng.normal()].map(f64::to_bits);
    let whole = [rng.index(1000), rng.poisson(13.0), rng.poisson(0.5)];
    let mut order = [0, 1, 2, 3, 4, 5, 6, 7];
    rng.shuffle(&mut order);
    let hash = |points: &[DVec2]| {
        let bytes = points.iter().flat_map(|p| [p.x, p.y]).flat_map(|v| v.to_bits().to_le_bytes());
        bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    };
    let size = DVec2::new(2.0, 1.5);
    let starts = [
        hash(&white_noise(&mut rng, size, 100)),
        hash(&poisson_disk(&mut rng, size, 100, Boundary::Open)),
        hash(&poisson_disk(&mut rng, size, 100, Boundary::Periodic)),
    ];
    assert_eq!(reals, [0x3fe3_dedb_6c61_b646, 0xbff1_99a9_70c7_f05a, 0xbfca_49cc_9804_7522], "now {reals:#018x?}");
    assert_eq!(whole, [455, 10, 0]);
    assert_eq!(order, [0, 4, 7, 5, 3, 6, 1, 2]);
    assert_eq!(starts, [0x10e2_25de_c516_a824, 0x021b_b20a_eff2_126a, 0x93da_7276_c471_7502], "now {starts:#018x?}");
}

#[test]
fn every_purpose_and_seed_has_its_own_stream() {
    let mut purposes = vec![Purpose::Filters, Purpose::Gallery];
    for class in 0..4 {
        purposes.extend([Purpose::Start(class), Purpose::Attributes(class)]);
        for scale in 0..4 {
            purposes.extend((0..50).map(|iteration| Purpose::Jitter { class, scale, iteration }));
        }
    }
    let mut seen = BTreeMap::new();
    for seed in [0, 1, 7, 1 << 32, u64::MAX] {
        for &purpose in &purposes {
            let mut rng = Rng::new(seed, purpose);
            let draws = [rng.bits(), rng.bits()];
            if let Some(other) = seen.insert(draws, (seed, purpose)) {
                panic!("{other:?} and {:?} begin alike", (seed, purpose));
            }
        }
    }
}

/// Mean and variance.
fn moments(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
    (mean, variance)
}

/// Asserts mean and variance of `DRAWS` values within six standard errors, more than any honest stream strays.
fn assert_moments(what: &str, values: impl Iterator<Item = f64>, mean: f64, variance: f64, kurtosis: f64) {
    let (actual_mean, actual_variance) = moments(values.take(DRAWS));
    let allowed = 6.0 * (variance / DRAWS as f64).sqrt();
    assert!((actual_mean - mean).abs() < allowed, "{what}: mean {actual_mean}, not {mean} ± {allowed}");
    let allowed = 6.0 * variance * ((kurtosis - 1.0) / DRAWS as f64).sqrt();
    assert!(
        (actual_variance - variance).abs() < allowed,
        "{what}: variance {actual_variance}, not {variance} ± {allowed}"
    );
}

const DRAWS: usize = 40_000;

#[test]
fn distributions_have_their_moments() {
    let mut rng = rng(3);
    let uniform: Vec<f64> = (0..DRAWS).map(|_| rng.uniform()).collect();
    assert!(uniform.iter().all(|value| (0.0..1.0).contains(value)));
    assert_moments("uniform", uniform.into_iter(), 0.5, 1.0 / 12.0, 1.8);

    let range: Vec<f64> = (0..DRAWS).map(|_| rng.range(-2.0, 3.0)).collect();
    assert!(range.iter().all(|value| (-2.0..3.0).contains(value)));
    assert_moments("range", range.into_iter(), 0.5, 25.0 / 12.0, 1.8);

    let normal: Vec<f64> = (0..DRAWS).map(|_| rng.normal()).collect();
    assert!(normal.iter().all(|value| value.is_finite()));
    let within_one = normal.iter().filter(|value| value.abs() < 1.0).count() as f64 / DRAWS as f64;
    assert!((within_one - 0.6827).abs() < 0.02, "{within_one} of normal draws lie within one deviation");
    assert_moments("normal", normal.into_iter(), 0.0, 1.0, 3.0);

    for mean in [0.3, 4.0, 13.0, 90.0] {
        let values = std::iter::repeat_with(|| rng.poisson(mean) as f64);
        assert_moments(&format!("poisson {mean}"), values, mean, mean, 3.0 + 1.0 / mean);
    }
    assert_eq!(rng.poisson(0.0), 0);
}

#[test]
fn index_stays_below_its_count_and_reaches_all() {
    let mut rng = rng(4);
    for count in [1, 2, 3, 7, 1000, 1 << 20, u32::MAX as usize] {
        assert!((0..5000).all(|_| rng.index(count) < count), "{count}");
    }
    let mut hits = [0; 7];
    (0..7000).for_each(|_| hits[rng.index(7)] += 1);
    assert!(hits.iter().all(|hit| (800..1200).contains(hit)), "{hits:?}");
}

#[test]
fn shuffle_permutes_and_reaches_every_order() {
    let mut rng = rng(5);
    let mut list: Vec<u32> = (0..100).collect();
    rng.shuffle(&mut list);
    assert!(!list.is_sorted());
    list.sort_unstable();
    assert_eq!(list, (0..100).collect::<Vec<_>>());
    rng.shuffle::<u32>(&mut []);

    let mut orders: BTreeMap<[u8; 3], u32> = BTreeMap::new();
    for _ in 0..6000 {
        let mut three = [0, 1, 2];
        rng.shuffle(&mut three);
        *orders.entry(three).or_default() += 1;
    }
    assert_eq!(orders.len(), 6);
    assert!(orders.values().all(|times| (800..1200).contains(times)), "{orders:?}");
}

#[test]
fn wrap_stays_on_the_torus() {
    let size = DVec2::new(2.0, 1.5);
    assert_eq!(wrap(DVec2::new(2.5, -0.5), size), DVec2::new(0.5, 1.0));
    for point in [size, -size, DVec2::splat(-1e-300), DVec2::splat(-1e-17), 5.0 * size] {
        assert!(inside(&[wrap(point, size)], size), "{point} goes to {}", wrap(point, size));
    }
}

#[test]
fn lloyd_steps_even_out_a_pattern() {
    let size = DVec2::new(2.0, 1.5);
    for boundary in BOUNDARIES {
        let before = white_noise(&mut rng(6), size, 80);
        let mut points = before.clone();
        for _ in 0..10 {
            points = lloyd_step(&points, size, boundary);
            assert!(points.len() == 80 && inside(&points, size));
        }
        let (from, to) = (relative_distance(&before, size, boundary), relative_distance(&points, size, boundary));
        assert!(from < 0.3 && to > 0.45, "{boundary:?}: from {from} to {to}");
    }
    // A lattice is a fixed point on the torus.
    let lattice: Vec<DVec2> =
        (0..16).map(|k| DVec2::new(f64::from(k % 4) + 0.2, f64::from(k / 4) + 0.7) * 0.25).collect();
    for (moved, place) in lloyd_step(&lattice, DVec2::ONE, Boundary::Periodic).iter().zip(&lattice) {
        assert!(moved.distance(*place) < 1e-12, "{place} moves to {moved}");
    }
}
