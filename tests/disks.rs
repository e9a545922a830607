//! Disks overlap as the exemplar's do, values go where they fit, and neither loses a value or moves what is frozen.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail loudly")]

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use pointweave::analysis::{AnalysisError, Cloud, OverlapStatistics, lens_area};
use pointweave::finish::Arrangement;
use pointweave::finish::disks::{Disks, Overlaps, separate};
use pointweave::finish::spacing::Room;
use pointweave::finish::values::{Exchange, Values};
use pointweave::methods::network::{NetworkError, NetworkRun, Parameters, Preset};
use pointweave::run::Event;
use pointweave::sampling::{Purpose, Rng, poisson_disk, white_noise};
use pointweave::{Attribute, Boundary, Domain, PointPattern, gallery};

const GENEROUS: u64 = 4_000_000_000;
const ENTRIES: [&str; 3] = ["graded-disks", "packed-disks", "necklaces"];

fn exemplar(name: &str) -> PointPattern {
    gallery::find(name).unwrap().exemplar()
}

fn radii(pattern: &PointPattern) -> Vec<f64> {
    pattern.radii_in(pattern.domain().exemplar_unit()).unwrap()
}

fn cloud(points: &[DVec2], size: DVec2, boundary: Boundary) -> Cloud {
    Cloud::new(points.to_vec(), size, boundary).unwrap()
}

fn overlaps(points: &[DVec2], size: DVec2, boundary: Boundary, radii: &[f64]) -> OverlapStatistics {
    OverlapStatistics::of(&cloud(points, size, boundary), radii).unwrap()
}

fn sorted(list: &[usize]) -> Vec<usize> {
    let mut list = list.to_vec();
    list.sort_unstable();
    list
}

/// Every point of an exemplar of `count` points `copies` times, in random order.
fn dealt(count: usize, copies: usize, seed: u64) -> Vec<usize> {
    let mut sources: Vec<usize> = (0..count * copies).map(|place| place % count).collect();
    Rng::new(seed, Purpose::Gallery).shuffle(&mut sources);
    sources
}

#[test]
fn lenses_have_the_area_of_the_closed_form() {
    // Equal circles: 2 r² acos(d ⁄ 2r) − d ⁄ 2 √(4 r² − d²).
    for d in [0.1, 0.8, 1.7, 2.99] {
        let expected = 4.5 * (d / 3.0_f64).acos() - 0.5 * d * (9.0 - d * d).sqrt();
        assert!((lens_area(d, 1.5, 1.5) - expected).abs() < 1e-12, "{d}");
    }
    assert_eq!(lens_area(3.0, 1.0, 2.0), 0.0);
    assert_eq!(lens_area(0.5, 1.0, 2.0), PI);
    assert_eq!(lens_area(0.0, 2.0, 2.0), 4.0 * PI);
    assert_eq!(lens_area(0.0, 0.0, 0.0), 0.0);
    // Unequal ones, the smaller on either side of the chord: strips of the shared width.
    for (d, a, b) in [(2.0, 1.0, 1.5), (1.2, 0.5, 1.5), (1.6, 1.5, 0.4)] {
        let steps = 400_000;
        let width = 2.0 * f64::max(a, b) / f64::from(steps);
        let strips: f64 = (0..steps)
            .map(|step| {
                let y: f64 = -f64::max(a, b) + (f64::from(step) + 0.5) * width;
                let half = |r: f64| (r * r - y * y).max(0.0).sqrt();
                if y.abs() >= a.min(b) {
                    0.0
                } else {
                    (half(a).min(d + half(b)) - (-half(a)).max(d - half(b))).max(0.0)
                }
            })
            .sum();
        let area = lens_area(d, a, b);
        assert!((area - strips * width).abs() < 1e-5, "{d} {a} {b}: {area} and {}", strips * width);
        // Negative control: a hundredth of the way farther apart shows.
        assert!((lens_area(1.01 * d, a, b) - strips * width).abs() > 1e-4);
        assert!((lens_area(d, b, a) - area).abs() < 1e-12);
    }
}

#[test]
fn the_gallery_s_disks_overlap_as_they_say() {
    for name in ENTRIES {
        let entry = gallery::find(name).unwrap();
        for seed in (0..8).chain([u64::MAX]) {
            let pattern = entry.generate(seed);
            let statistics = OverlapStatistics::of(&Cloud::of(&pattern), &radii(&pattern)).unwrap();
            let filled = statistics.disk_area / pattern.domain().area();
            if name == "necklaces" {
                // A disk has two halves of lenses.
                let fraction = (2.0 * 0.8_f64.acos() - 0.96) / PI;
                assert!((statistics.fraction - fraction).abs() < 1e-9, "seed {seed}: {}", statistics.fraction);
                assert!((statistics.deepest - 0.2).abs() < 1e-9, "seed {seed}: {}", statistics.deepest);
                assert_eq!((statistics.pairs, pattern.len()), (67, 67), "seed {seed}");
            } else {
                assert_eq!((statistics.fraction, statistics.pairs, statistics.deepest), (0.0, 0, 0.0), "{name} {seed}");
                assert!((0.3..0.6).contains(&filled), "{name} at seed {seed} fills {filled}");
                // Negative control: a little larger they would.
                let larger: Vec<f64> = radii(&pattern).iter().map(|radius| 1.1 * radius).collect();
                assert!(OverlapStatistics::of(&Cloud::of(&pattern), &larger).unwrap().fraction > 0.0, "{name} {seed}");
            }
        }
    }
}

#[test]
fn overlaps_reach_over_the_border_of_a_tile_only() {
    let points = [DVec2::new(0.02, 0.5), DVec2::new(0.97, 0.5), DVec2::new(0.5, 0.5)];
    let of = |boundary| overlaps(&points, DVec2::ONE, boundary, &[0.05; 3]);
    assert_eq!(of(Boundary::Open).pairs, 0);
    let tile = of(Boundary::Periodic);
    assert_eq!(tile.pairs, 1);
    assert!((tile.overlap_area - lens_area(0.05, 0.05, 0.05)).abs() < 1e-12);
    assert!((tile.deepest - 0.5).abs() < 1e-12);
    // Four tiles side by side have the same fraction.
    let four: Vec<DVec2> = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE]
        .iter()
        .flat_map(|&shift| points.iter().map(move |&point| point + shift))
        .collect();
    let four = overlaps(&four, DVec2::splat(2.0), Boundary::Periodic, &[0.05; 12]);
    assert!((four.fraction - tile.fraction).abs() < 1e-12 && four.pairs == 4);
    // A disk wider than its tile overlaps its own images.
    let own = overlaps(&points[..1], DVec2::new(0.2, 1.0), Boundary::Periodic, &[0.11]);
    assert_eq!(own.pairs, 1);
    // By classes.
    let classes =
        cloud(&[points[0], points[0] + 0.01, points[2]], DVec2::ONE, Boundary::Open).with_classes(vec![1, 0, 1]);
    let statistics = OverlapStatistics::of(&classes.unwrap(), &[0.05; 3]).unwrap();
    assert_eq!(statistics.classes.len(), 1);
    assert_eq!((statistics.classes[0].a, statistics.classes[0].b, statistics.classes[0].pairs), (0, 1, 1));
}

#[test]
fn a_radius_that_is_none_is_refused_with_its_point() {
    let points = cloud(&[DVec2::splat(0.2), DVec2::splat(0.4)], DVec2::ONE, Boundary::Open);
    for bad in [-0.01, f64::NAN, f64::INFINITY, 0.51] {
        match OverlapStatistics::of(&points, &[0.1, bad]) {
            Err(AnalysisError::Radius { index: 1, value, max }) => {
                assert!(value.to_bits() == bad.to_bits() && max == 0.5);
            }
            other => panic!("{bad}: {other:?}"),
        }
    }
    assert_eq!(OverlapStatistics::of(&points, &[0.1]), Err(AnalysisError::Radii { count: 1, points: 2 }));
    assert!(OverlapStatistics::of(&points, &[0.0, 0.5]).is_ok());
    // A run says it before it starts, unless it leaves disks alone; in the pattern's own unit the side is 10.
    let domain = Domain::new(DVec2::ZERO, DVec2::splat(10.0)).unwrap();
    let pattern = |values: [f64; 3]| {
        let positions = vec![DVec2::splat(2.0), DVec2::splat(4.0), DVec2::new(8.0, 3.0)];
        let radius = Attribute { name: "Radius".to_owned(), values: values.to_vec() };
        PointPattern::new(domain, positions).unwrap().with_attribute(radius).unwrap()
    };
    let start = |pattern, disk_overlap| {
        NetworkRun::new(pattern, Parameters { disk_overlap, ..small(Boundary::Open) }, GENEROUS)
    };
    let error = start(pattern([1.0, 0.5, 5.5]), 1.0).unwrap_err();
    assert!(matches!(error, NetworkError::Disks(_)), "{error:?}");
    assert!(error.to_string().contains("the disk of point 2 has a radius of 0.55"), "{error}");
    assert!(start(pattern([1.0, 0.5, 5.5]), 0.0).is_ok());
    assert!(start(pattern([1.0, 0.5, 4.5]), 1.0).is_ok());
    // Disks so large that moving them would take for ever.
    let many = white_noise(&mut Rng::new(1, Purpose::Gallery), DVec2::ONE, 2000);
    let radius = Attribute { name: "radius".to_owned(), values: vec![0.3; many.len()] };
    let huge = PointPattern::new(Domain::UNIT, many).unwrap().with_attribute(radius).unwrap();
    let error = start(huge, 1.0).unwrap_err().to_string();
    assert!(error.contains("overlaps hundreds of others"), "{error}");
}

#[test]
fn no_overlap_stays_none_and_some_stays_some() {
    for name in ENTRIES {
        let pattern = exemplar(name);
        let (own, radii) = (Cloud::of(&pattern), radii(&pattern));
        let wanted = OverlapStatistics::of(&own, &radii).unwrap();
        let limits = Overlaps::of(&own, &radii, 0, 1.0);
        let disks = Disks { radii: &radii, classes: pattern.classes() };
        for boundary in [Boundary::Open, Boundary::Periodic] {
            let size = DVec2::splat(2.0);
            let start = poisson_disk(&mut Rng::new(4, Purpose::Gallery), size, 4 * pattern.len(), boundary);
            let dealt = dealt(pattern.len(), 4, 5);
            let measure = |points: &[DVec2], sources: &[usize]| {
                let of: Vec<f64> = sources.iter().map(|&source| radii[source]).collect();
                overlaps(points, size, boundary, &of)
            };
            // Negative control: as dealt they overlap, and otherwise than the exemplar's.
            let before = measure(&start, &dealt);
            assert!((before.fraction - wanted.fraction).abs() > 0.02, "{name} {boundary:?}: {}", before.fraction);
            let classes = vec![0; start.len()];
            let all = Arrangement { classes: &classes, first: 0, size, boundary };
            let move_all = || {
                let (mut points, mut sources) = (start.clone(), dealt.clone());
                let parted = separate(&mut points, &mut sources, all, disks, &limits, Room::default());
                (points, sources, parted)
            };
            let (points, sources, parted) = move_all();
            let after = measure(&points, &sources);
            if wanted.pairs == 0 {
                assert!(parted, "{name} {boundary:?}");
                assert_eq!((after.pairs, after.fraction), (0, 0.0), "{name} {boundary:?}: {}", after.deepest);
            } else {
                assert!((after.fraction - wanted.fraction).abs() < 0.02, "{name} {boundary:?}: {}", after.fraction);
                assert!(after.deepest < before.deepest, "{name} {boundary:?}: {}", after.deepest);
            }
            assert_eq!(sorted(&sources), sorted(&dealt), "{name}: a value is lost");
            assert!(points.iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(size).all()));
            assert_eq!(move_all(), (points, sources, parted), "{name}: another time something else");
        }
    }
}

#[test]
fn disks_that_jam_exchange_their_places() {
    // A large disk in a cage of frozen ones has to go; a small one far away has the room.
    let mut points: Vec<DVec2> =
        (0..12).map(|k| DVec2::splat(0.25) + 0.1 * DVec2::from_angle(TAU * f64::from(k) / 12.0)).collect();
    points.extend([DVec2::splat(0.25), DVec2::splat(0.75)]);
    let radii: Vec<f64> = (0..14).map(|point| if point == 12 { 0.12 } else { 0.02 }).collect();
    let far = cloud(&[DVec2::splat(0.2), DVec2::splat(0.7)], DVec2::ONE, Boundary::Open);
    let none = Overlaps::of(&far, &[0.1; 2], 0, 1.0);
    let mut sources: Vec<usize> = (0..14).collect();
    let disks = Disks { radii: &radii, classes: &[0; 14] };
    let frozen = points[..12].to_vec();
    let last = Arrangement { classes: &[0; 14], first: 12, size: DVec2::ONE, boundary: Boundary::Open };
    assert!(separate(&mut points, &mut sources, last, disks, &none, Room::default()));
    assert_eq!(points[..12], frozen);
    assert_eq!(sources[..12], (0..12).collect::<Vec<_>>());
    let of: Vec<f64> = sources.iter().map(|&source| radii[source]).collect();
    assert_eq!(overlaps(&points, DVec2::ONE, Boundary::Open, &of).pairs, 0);
}

#[test]
fn frozen_disks_count_but_stay() {
    let pattern = exemplar("packed-disks");
    let radii = radii(&pattern);
    let limits = Overlaps::of(&Cloud::of(&pattern), &radii, 0, 1.0);
    let disks = Disks { radii: &radii, classes: pattern.classes() };
    let mut points = pattern.positions().to_vec();
    let mut sources: Vec<usize> = (0..points.len()).collect();
    // The small ones are thrown anew among the large ones.
    let first = 40;
    let anew = white_noise(&mut Rng::new(3, Purpose::Gallery), DVec2::ONE, points.len() - first);
    points[first..].copy_from_slice(&anew);
    let before = points.clone();
    let small = Arrangement { classes: pattern.classes(), first, size: DVec2::ONE, boundary: Boundary::Periodic };
    let measure = |points: &[DVec2], sources: &[usize]| {
        let of: Vec<f64> = sources.iter().map(|&source| radii[source]).collect();
        overlaps(points, small.size, small.boundary, &of)
    };
    assert!(measure(&points, &sources).pairs > 10);
    assert!(separate(&mut points, &mut sources, small, disks, &limits, Room::default()));
    assert_eq!(measure(&points, &sources).pairs, 0);
    assert_eq!(points[..first], before[..first]);
    assert_eq!(sources[..first], (0..first).collect::<Vec<_>>());
    assert_ne!(points[first..], before[first..]);
}

/// Mean squared difference of the values of nearest neighbours.
fn roughness(cloud: &Cloud, sources: &[usize], values: &[f64]) -> f64 {
    let mut found = Vec::new();
    let differences: Vec<f64> = (0..cloud.len())
        .map(|point| {
            cloud.neighbours().nearest(cloud.points()[point], 1, Some(point), &mut found);
            (values[sources[point]] - values[sources[found[0].index]]).powi(2)
        })
        .collect();
    differences.iter().sum::<f64>() / differences.len() as f64
}

#[test]
fn values_go_where_they_fit() {
    // A wave across a pattern whose places say nothing of it.
    let pattern = exemplar("poisson-disk");
    let wave: Vec<f64> = pattern.positions().iter().map(|place| 3.0 + (TAU * place.x).sin()).collect();
    let pattern = pattern.with_attribute(Attribute { name: "height".to_owned(), values: wave.clone() }).unwrap();
    let values = Values::of(&pattern, 0).unwrap();
    let own = Cloud::of(&pattern);
    let numbers: Vec<usize> = (0..pattern.len()).collect();
    let size = DVec2::splat(2.0);
    let points = poisson_disk(&mut Rng::new(9, Purpose::Gallery), size, 4 * pattern.len(), Boundary::Periodic);
    let output = cloud(&points, size, Boundary::Periodic);
    let exchange = Exchange::new(&values, (&own, &numbers), &output, 0);
    let dealt = dealt(pattern.len(), 4, 5);
    let mut sources = dealt.clone();
    let mut losses = vec![exchange.loss(&sources)];
    for sweep in 0..12 {
        exchange.run(&mut sources, 1, &mut Rng::new(1, Purpose::Exchange { class: 0, scale: sweep }));
        losses.push(exchange.loss(&sources));
    }
    // No sweep raises the loss.
    assert!(losses.windows(2).all(|two| two[1] <= two[0] + 1e-12), "{losses:?}");
    assert!(losses[12] < 0.7 * losses[0], "{losses:?}");
    assert_eq!(sorted(&sources), sorted(&dealt), "a value is lost");
    let (dealt, swapped, wanted) =
        (roughness(&output, &dealt, &wave), roughness(&output, &sources, &wave), roughness(&own, &numbers, &wave));
    assert!(dealt > 8.0 * wanted, "{dealt} {wanted}");
    assert!(swapped < 3.0 * wanted, "{swapped} {wanted}");
    // Same stream, same exchanges; another, others.
    let again = |scale| {
        let mut sources = (0..4 * pattern.len()).map(|place| place % pattern.len()).collect::<Vec<_>>();
        exchange.run(&mut sources, 3, &mut Rng::new(1, Purpose::Exchange { class: 0, scale }));
        sources
    };
    assert_eq!(again(0), again(0));
    assert_ne!(again(0), again(1));
}

#[test]
fn frozen_values_stay_and_values_that_are_all_the_same_are_left_alone() {
    let pattern = exemplar("packed-disks");
    let classes: Vec<u16> = (0..pattern.len()).map(|point| u16::from(point >= 30)).collect();
    let pattern = pattern.with_classes(classes, vec!["large".to_owned(), "small".to_owned()]).unwrap();
    let values = Values::of(&pattern, 1).unwrap();
    let own = Cloud::of(&pattern);
    let numbers: Vec<usize> = (0..pattern.len()).collect();
    let mut sources = numbers.clone();
    Rng::new(2, Purpose::Gallery).shuffle(&mut sources[30..]);
    let before = sources.clone();
    let exchange = Exchange::new(&values, (&own, &numbers), &own, 30);
    exchange.run(&mut sources, 20, &mut Rng::new(1, Purpose::Exchange { class: 1, scale: 0 }));
    assert_eq!(sources[..30], before[..30]);
    assert_ne!(sources[30..], before[30..]);
    assert!(sources[30..].iter().all(|&source| source >= 30));
    assert!(exchange.loss(&sources) < exchange.loss(&before));
    // In its own pattern every value has its place.
    assert!(exchange.loss(&numbers) < 1e-12);
    let flat = PointPattern::new(Domain::UNIT, vec![DVec2::splat(0.1), DVec2::splat(0.5)]).unwrap();
    assert!(Values::of(&flat, 0).is_none());
    let flat = flat.with_attribute(Attribute { name: "radius".to_owned(), values: vec![0.1; 2] }).unwrap();
    assert!(Values::of(&flat, 0).is_none());
}

#[test]
fn degrees_go_round_in_a_circle() {
    let positions: Vec<DVec2> = (0..4).map(|k| DVec2::new(0.1 + 0.2 * f64::from(k), 0.5)).collect();
    let turned = |by: f64| {
        let values = [10.0, 350.0, 90.0, 180.0].map(|degrees| degrees + by).to_vec();
        let pattern = PointPattern::new(Domain::UNIT, positions.clone()).unwrap();
        pattern.with_attribute(Attribute { name: "orientation".to_owned(), values }).unwrap()
    };
    let loss = |by: f64, sources: &[usize]| {
        let pattern = turned(by);
        let values = Values::of(&pattern, 0).unwrap();
        let own = Cloud::of(&pattern);
        Exchange::new(&values, (&own, &[0, 1, 2, 3]), &own, 0).loss(sources)
    };
    // A full turn changes nothing, and 350° is nearer to 10° than 90° is.
    assert!((loss(0.0, &[1, 0, 2, 3]) - loss(720.0, &[1, 0, 2, 3])).abs() < 1e-9);
    assert!(loss(0.0, &[1, 0, 2, 3]) < loss(0.0, &[2, 1, 0, 3]));
}

/// A run of seconds: two scales, a small grid, few channels.
fn small(boundary: Boundary) -> Parameters {
    Parameters {
        boundary,
        expansion_x: 1.5,
        expansion_y: 1.0,
        channels: 8,
        scales: 2,
        grid_min: 32,
        grid_max: 40,
        iterations_coarse: 10,
        iterations_fine: 6,
        iterations_polish: 2,
        ..Parameters::preset(Preset::Fast)
    }
}

fn finish(run: &mut NetworkRun) {
    while run.advance().unwrap() != Event::Finished {}
}

#[test]
fn a_run_keeps_every_tuple_of_values_and_no_overlap() {
    let pattern = exemplar("packed-disks");
    // A second attribute tells which exemplar point a tuple is of.
    let number = Attribute { name: "number".to_owned(), values: (0..pattern.len()).map(|n| n as f64).collect() };
    let pattern = pattern.with_attribute(number).unwrap();
    let output = |parameters: Parameters| {
        let mut run = NetworkRun::new(pattern.clone(), parameters, GENEROUS).unwrap();
        finish(&mut run);
        run.output().unwrap()
    };
    let measure = |output: &PointPattern| {
        OverlapStatistics::of(&Cloud::in_unit(output, 1.0).unwrap(), &output.radii_in(1.0).unwrap()).unwrap()
    };
    for boundary in [Boundary::Open, Boundary::Periodic] {
        let with = output(small(boundary));
        let [radius, number] = [&with.attributes()[0].values, &with.attributes()[1].values];
        let mut counts = vec![0; pattern.len()];
        for (radius, &number) in radius.iter().zip(number) {
            assert_eq!(*radius, pattern.attributes()[0].values[number as usize]);
            counts[number as usize] += 1;
        }
        // Half of the tuples once, the others twice.
        assert_eq!(counts.iter().filter(|&&count| count == 1).count(), 45);
        assert_eq!(counts.iter().filter(|&&count| count == 2).count(), 45);
        assert_eq!(measure(&with).pairs, 0, "{boundary:?}: {}", measure(&with).deepest);
        // Negative control: the paper's way.
        let paper = output(Parameters { disk_overlap: 0.0, value_swaps: 0, ..small(boundary) });
        assert!(measure(&paper).fraction > 0.02, "{boundary:?}: {}", measure(&paper).fraction);
    }
}

#[test]
fn a_run_that_was_saved_goes_on_with_the_same_values() {
    let start = || NetworkRun::new(exemplar("packed-disks"), small(Boundary::Periodic), GENEROUS).unwrap();
    let mut whole = start();
    finish(&mut whole);
    let mut half = start();
    half.run(13).unwrap();
    let state = half.state();
    let mut other = NetworkRun::resume(state.clone(), GENEROUS).unwrap();
    finish(&mut other);
    assert_eq!(other.output().unwrap(), whole.output().unwrap());
    // What does not fit is refused.
    let mut lacking = state.clone();
    lacking.sources.pop();
    assert!(NetworkRun::resume(lacking, GENEROUS).unwrap_err().to_string().contains("there are 134 for"));
    let mut beyond = state;
    beyond.sources[3] = 90;
    assert!(NetworkRun::resume(beyond, GENEROUS).unwrap_err().to_string().contains("not of its class"));
}
