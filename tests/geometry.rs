//! Where points were cut from, when no one says so: unit squares, boxes, disks; the same in any unit of length; and what
//! looks odd about them.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail loudly")]

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use glam::DVec2;
use pointweave::analysis::{Analysis, Cloud, Comparison, RipleySettings, Scales, describe, ripley, verdict};
use pointweave::formats::{self, NoteKind, ReadOptions, Reading};
use pointweave::methods::network::{NetworkError, NetworkRun, Parameters, Preset};
use pointweave::pattern::Window;
use pointweave::run::Event;
use pointweave::sampling::{Purpose, Rng, white_noise};
use pointweave::{Attribute, Boundary, Domain, PointPattern, gallery};

const GENEROUS: u64 = 4_000_000_000;

fn read(points: &[DVec2]) -> Reading {
    let mut text = "x,y\n".to_owned();
    points.iter().for_each(|point| writeln!(text, "{},{}", point.x, point.y).unwrap());
    formats::open(text.as_bytes(), None, &ReadOptions::default()).unwrap()
}

fn noise(seed: u64, count: usize) -> Vec<DVec2> {
    white_noise(&mut Rng::new(seed, Purpose::Gallery), DVec2::ONE, count)
}

/// Independent points in a disk of radius 100 about the origin.
fn disk(seed: u64, count: usize) -> Vec<DVec2> {
    let mut rng = Rng::new(seed, Purpose::Gallery);
    let mut place = || {
        let (radius, angle) = (rng.uniform().sqrt(), TAU * rng.uniform());
        100.0 * radius * DVec2::new(libm::cos(angle), libm::sin(angle))
    };
    (0..count).map(|_| place()).collect()
}

/// The disk's outline.
fn circle() -> Window {
    let corner = |i: i32| 100.0 * DVec2::from_angle(TAU * f64::from(i) / 360.0);
    Window::new(vec![(0..360).map(corner).collect()]).unwrap()
}

fn claims_clustering(analysis: &Analysis) -> bool {
    let words = describe(analysis);
    words.contains("too many") || words.contains("gather")
}

fn oddities(pattern: &PointPattern) -> String {
    formats::oddities(pattern).into_iter().map(|note| note.text).collect::<Vec<_>>().join("\n")
}

/// Points that keep apart, as in most exemplars: a grid, shaken.
fn shaken_grid(seed: u64, columns: usize, rows: usize) -> Vec<DVec2> {
    let mut rng = Rng::new(seed, Purpose::Gallery);
    let place = |i: usize| DVec2::new((i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5);
    (0..columns * rows).map(|i| place(i) + DVec2::new(rng.range(-0.3, 0.3), rng.range(-0.3, 0.3))).collect()
}

#[test]
fn the_unit_square_stays_where_points_fill_it() {
    for entry in gallery::entries() {
        for seed in 0..8 {
            let exemplar = entry.generate(seed);
            if exemplar.domain() == Domain::UNIT {
                let reading = read(exemplar.positions());
                assert_eq!(reading.pattern.domain(), Domain::UNIT, "{} {seed}", entry.name);
                assert!(reading.notes.is_empty() && !reading.is_domain_declared, "{}", entry.name);
            }
        }
    }
    // Independent points, also very few: by chance hardly ever.
    for count in [2, 3, 5, 8, 12, 30, 100] {
        let lost = (0..400).filter(|&seed| read(&noise(seed, count)).pattern.domain() != Domain::UNIT).count();
        assert!(lost <= 4, "{lost} of 400 with {count} points");
    }
    // The other choice is there where it is one.
    let half: Vec<DVec2> = noise(7, 12).into_iter().map(|point| point * DVec2::new(1.0, 0.8)).collect();
    let reading = read(&half);
    assert_eq!(reading.pattern.domain(), Domain::UNIT);
    assert_eq!(reading.domains[0].0, "the points' box");
}

#[test]
fn a_strip_wider_than_every_hole_is_no_part_of_the_window() {
    let grid = shaken_grid(3, 8, 5);
    let inner =
        |scale: DVec2, offset: DVec2| grid.iter().map(|&point| offset + point / 8.0 * scale).collect::<Vec<_>>();
    for (name, scale, offset) in [
        ("a corner", DVec2::splat(0.05), DVec2::new(0.4, 0.1)),
        ("a flat window", DVec2::ONE, DVec2::ZERO),
        ("a flat window in the middle", DVec2::new(1.0, 0.6), DVec2::new(0.0, 0.31)),
        ("micrometres", DVec2::splat(1e-6), DVec2::ZERO),
        ("picometres", DVec2::splat(1e-12), DVec2::ZERO),
        ("a transect", DVec2::new(1.0, 0.05), DVec2::new(0.0, 0.5)),
    ] {
        let points = inner(scale, offset);
        let reading = read(&points);
        let domain = reading.pattern.domain();
        let (low, high) =
            (points.iter().copied().reduce(DVec2::min).unwrap(), points.iter().copied().reduce(DVec2::max).unwrap());
        // Half a mean spacing around the box.
        let spacing = reading.pattern.mean_spacing().unwrap() * domain.exemplar_unit();
        assert!((domain.min() - (low - spacing / 2.0)).abs().max_element() < 1e-6 * spacing, "{name}: {domain:?}");
        assert!((domain.max() - (high + spacing / 2.0)).abs().max_element() < 1e-6 * spacing, "{name}: {domain:?}");
        assert_eq!(reading.domains, [("unit square", Domain::UNIT)], "{name}");
        assert_eq!((reading.notes.len(), reading.notes[0].kind), (1, NoteKind::Changed), "{name}");
        // Who says so gets the unit square, and a word.
        let options = ReadOptions { domain: Some(Domain::UNIT), ..ReadOptions::default() };
        let text: String = points.iter().map(|point| format!("{},{}\n", point.x, point.y)).collect();
        let declared = formats::open(text.as_bytes(), None, &options).unwrap();
        assert_eq!((declared.pattern.domain(), declared.notes.len()), (Domain::UNIT, 0), "{name}");
        assert!(oddities(&declared.pattern).contains("strip of"), "{name}: {}", oddities(&declared.pattern));
        assert!(!oddities(&reading.pattern).contains("strip of"), "{name}");
    }
    // Rings of 1 × 0.72: the holes within them are not larger than what is left over.
    let rings = gallery::find("rings").unwrap().exemplar();
    let flat: Vec<DVec2> = rings.positions().iter().map(|&point| point * 0.72).collect();
    let flat: Vec<DVec2> =
        flat.iter().flat_map(|&point| [point, point + DVec2::X * 0.72]).filter(|p| p.x <= 1.0).collect();
    let domain = read(&flat).pattern.domain();
    assert!((domain.size() - DVec2::new(1.0, 0.72)).abs().max_element() < 0.06, "{domain:?}");
    // A long line of points is too thin to be a domain, so the unit square stays.
    let line: Vec<DVec2> = (0..90).map(|i| DVec2::new(0.01 + 0.01 * f64::from(i), 0.5)).collect();
    let reading = read(&line);
    assert_eq!((reading.pattern.domain(), reading.notes.len()), (Domain::UNIT, 0));
    assert!(oddities(&reading.pattern).contains("on a line"));
    // So do points in one place.
    assert_eq!(read(&[DVec2::splat(0.3); 5]).pattern.domain(), Domain::UNIT);
}

#[test]
fn the_rule_is_quick_for_many_points_however_they_lie() {
    // 20 000 points in a speck, and one at the other end of a strip: every hole is looked at, no pair of points.
    let mut points: Vec<DVec2> = noise(1, 19_999).into_iter().map(|point| point * 1e-3).collect();
    points.push(DVec2::new(0.8, 0.8));
    assert_eq!(read(&points).pattern.len(), 20_000);
}

fn declared(points: Vec<DVec2>, domain: Domain) -> PointPattern {
    PointPattern::new(domain, points).unwrap()
}

/// A gallery's exemplar with a radius, times a factor and moved.
fn placed(name: &str, factor: f64, offset: DVec2) -> PointPattern {
    let exemplar = gallery::find(name).unwrap().exemplar();
    let points = exemplar.positions().iter().map(|&point| point * factor + offset).collect();
    let size = exemplar.domain().size() * factor;
    let radius = exemplar.attributes().iter().find(|attribute| attribute.name == "radius");
    let values = (0..exemplar.len()).map(|i| factor * radius.map_or(0.01 + 1e-4 * i as f64, |radius| radius.values[i]));
    declared(points, Domain::new(offset, size).unwrap())
        .with_boundary(exemplar.boundary())
        .with_attribute(Attribute { name: "radius".to_owned(), values: values.collect() })
        .unwrap()
}

fn few_iterations(exemplar: PointPattern) -> PointPattern {
    let parameters = Parameters {
        channels: 8,
        scales: 1,
        grid_min: 40,
        grid_max: 48,
        iterations_coarse: 2,
        iterations_fine: 2,
        iterations_polish: 0,
        expansion_x: 1.0,
        expansion_y: 1.0,
        ..Parameters::suited_to(Preset::Fast, &exemplar)
    };
    let mut run = NetworkRun::new(exemplar, parameters, GENEROUS).unwrap();
    while !matches!(run.advance().unwrap(), Event::Finished) {}
    run.canvas().pattern().unwrap()
}

#[test]
fn a_power_of_two_changes_no_bit() {
    for name in ["packed-disks", "phyllotaxis"] {
        let wanted = few_iterations(placed(name, 1.0, DVec2::ZERO));
        let analysis = Analysis::of_pattern(&placed(name, 1.0, DVec2::ZERO), 1).unwrap();
        for power in [-40, 40] {
            let factor = 2.0_f64.powi(power);
            let found = few_iterations(placed(name, factor, DVec2::ZERO));
            let back: Vec<DVec2> = found.positions().iter().map(|&point| point / factor).collect();
            assert_eq!(back, wanted.positions(), "{name} 2^{power}");
            let radii: Vec<f64> = found.attributes()[0].values.iter().map(|radius| radius / factor).collect();
            assert_eq!(radii, wanted.attributes()[0].values, "{name} 2^{power}");
            let mut other = Analysis::of_pattern(&placed(name, factor, DVec2::ZERO), 1).unwrap();
            // The radii are in the pattern's unit, and so rounded otherwise in products of theirs.
            other.mark_correlations.clone_from(&analysis.mark_correlations);
            assert_eq!(other, analysis, "{name} 2^{power}");
        }
        // Negative control: an offset rounds the last bit of the coordinates.
        let moved = placed(name, 1.0, DVec2::splat(0.1));
        assert_ne!(Analysis::of_pattern(&moved, 1).unwrap().nearest, analysis.nearest, "{name}");
    }
}

/// The largest relative difference of what two analyses say in numbers.
fn difference(a: &Analysis, b: &Analysis) -> f64 {
    let numbers = |one: &Analysis| {
        let mut list = vec![one.density, one.spacing.unwrap(), one.aggregation_index.unwrap(), one.relative_radius];
        list.extend(one.nearest.iter().map(|summary| summary.mean));
        list.extend(&one.pair_correlation.value);
        list.extend(&one.spectrum.power);
        list
    };
    let (a, b) = (numbers(a), numbers(b));
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).map(|(a, b)| (a - b).abs() / (1e-3 + a.abs())).fold(0.0, f64::max)
}

#[test]
fn a_power_of_ten_and_an_offset_change_nothing_that_matters() {
    let points: Vec<DVec2> = shaken_grid(5, 9, 7);
    let text = |power: i32, offset: DVec2| {
        let mut text = "x,y\n".to_owned();
        let sign = if power < 0 { "" } else { "+" };
        for point in &points {
            // Four decimals and an exponent, as programs write them.
            let place = *point + offset;
            writeln!(text, "{:.4}e{sign}{power},{:.4}e{sign}{power}", place.x, place.y).unwrap();
        }
        formats::open(text.as_bytes(), None, &ReadOptions::default()).unwrap().pattern
    };
    let plain = text(0, DVec2::ZERO);
    let wanted = Analysis::of_pattern(&plain, 1).unwrap();
    let grown = few_iterations(plain.clone());
    for power in [-12, -9, -6, -3, 3, 6, 9, 12] {
        let pattern = text(power, DVec2::ZERO);
        let factor: f64 = format!("1e{power}").parse().unwrap();
        let size = pattern.domain().size() / factor - plain.domain().size();
        assert!(size.abs().max_element() < 1e-12, "{power}: {size}");
        let analysis = Analysis::of_pattern(&pattern, 1).unwrap();
        assert!(difference(&analysis, &wanted) < 1e-9, "{power}: {}", difference(&analysis, &wanted));
        assert_eq!(describe(&analysis), describe(&wanted), "{power}");
        let output = few_iterations(pattern.clone());
        let worst = |output: &PointPattern, factor: f64| {
            let pairs = output.positions().iter().zip(grown.positions());
            pairs.map(|(a, b)| (*a / factor - *b).abs().max_element()).fold(0.0, f64::max)
        };
        assert!(worst(&output, factor) < 1e-4, "{power}: {}", worst(&output, factor));
        // What is written is read again without loss, also by numbers in plain columns.
        let again = formats::read(formats::write_csv(&output).as_bytes(), None, &ReadOptions::default()).unwrap();
        assert_eq!(again, output, "{power}");
        let again = formats::read(formats::write_json(&output).as_bytes(), None, &ReadOptions::default()).unwrap();
        assert_eq!(again, output, "{power}");
    }
    // Metres on a map of a country: nine digits before the point's last.
    let far = text(0, DVec2::new(500_000.0, 5_000_000.0));
    let analysis = Analysis::of_pattern(&far, 1).unwrap();
    assert!(difference(&analysis, &wanted) < 1e-6, "{}", difference(&analysis, &wanted));
    assert_eq!(few_iterations(far).len(), points.len());
    // Negative control: a thousandth of a spacing is more than all that.
    let mut other = points.clone();
    other[0].x += 1e-3;
    let other = read(&other).pattern;
    assert!(difference(&Analysis::of_pattern(&other, 1).unwrap(), &wanted) > 1e-6);
}

#[test]
fn a_domain_far_larger_than_its_points_is_refused_with_the_cause() {
    let grid = shaken_grid(3, 8, 5);
    let speck = |side: f64| {
        let points = grid.iter().map(|&point| DVec2::splat(0.3) + point / 8.0 * side).collect();
        declared(points, Domain::UNIT)
    };
    for side in [1e-2, 1e-4, 1e-6] {
        let exemplar = speck(side);
        let parameters = Parameters::suited_to(Preset::Fast, &exemplar);
        let error = NetworkRun::new(exemplar, parameters, GENEROUS).unwrap_err();
        let NetworkError::Crowded { times, points } = &error else { panic!("{error}") };
        // The cells of the grid against those of 40 independent points in the square, half a cell from one another.
        let expected = 0.5 / 40.0_f64.sqrt() / (0.75 * side / 8.0);
        assert!((0.5..2.0).contains(&(times / expected)) && *points == 40, "{times} {expected}");
        assert!(error.to_string().contains("--domain"), "{error}");
    }
    // Points that fill a good part of it run; so does what is asked for by a parameter.
    let exemplar = speck(0.3);
    let parameters = Parameters::suited_to(Preset::Fast, &exemplar);
    assert!(NetworkRun::new(exemplar, parameters, GENEROUS).is_ok());
}

#[test]
fn the_gallery_looks_as_it_is_meant() {
    for entry in gallery::entries() {
        for seed in [entry.seed, 1001, 1002, 1003] {
            let exemplar = entry.generate(seed);
            assert_eq!(oddities(&exemplar), "", "{} {seed}", entry.name);
            assert_eq!(oddities(&read(exemplar.positions()).pattern), "", "{} {seed}", entry.name);
        }
    }
}

#[test]
fn what_looks_odd_is_said_with_what_can_be_done() {
    let grid: Vec<DVec2> = shaken_grid(11, 8, 6).into_iter().map(|point| 10.0 * point).collect();
    let with = |more: &[DVec2]| oddities(&read(&[&grid, more].concat()).pattern);
    assert_eq!(with(&[]), "");

    let doubles = with(&grid[..14]);
    assert!(doubles.contains("14 of the 62 points lie exactly on others: remove them"), "{doubles}");
    let almost: Vec<DVec2> = grid[..6].iter().map(|&point| point + 0.01).collect();
    assert!(with(&almost).starts_with("12 of the points lie within"), "{}", with(&almost));
    // All of them twice.
    let almost: Vec<DVec2> = grid.iter().map(|&point| point + 0.01).collect();
    assert!(with(&almost).starts_with("96 of the points lie within"), "{}", with(&almost));

    let far = with(&[DVec2::new(9000.0, 40.0)]);
    assert!(far.starts_with("One point, at (9000, 40), lies far from all others"), "{far}");
    assert!(!far.contains("strip"), "{far}");
    let zeros = with(&[DVec2::ZERO; 3]);
    assert!(zeros.contains("3 of the 51 points lie at exactly (0, 0)"), "{zeros}");
    let moved: Vec<DVec2> = grid.iter().map(|&point| point + 500.0).chain([DVec2::ZERO]).collect();
    assert!(
        oddities(&read(&moved).pattern).contains("a place that is not known"),
        "{}",
        oddities(&read(&moved).pattern)
    );
    let unknown = with(&[DVec2::splat(-9999.0); 5]);
    assert!(unknown.contains("5 of the 53 points lie at exactly (-9999, -9999)"), "{unknown}");

    let slope: Vec<DVec2> = (0..30).map(|i| DVec2::new(f64::from(i), 2.0 * f64::from(i) + 3.0)).collect();
    assert!(oddities(&read(&slope).pattern).contains("lie on a line"));
    assert!(oddities(&read(&grid[..9]).pattern).contains("only 9 points"));
}

#[test]
fn radii_in_another_unit_are_told() {
    let grid: Vec<DVec2> = shaken_grid(11, 8, 6);
    let disks = |factor: f64| {
        let values = (0..grid.len()).map(|i| factor * (0.3 + 0.01 * i as f64)).collect();
        let pattern = read(&grid).pattern.with_attribute(Attribute { name: "radius".to_owned(), values }).unwrap();
        oddities(&pattern)
    };
    assert_eq!(disks(1.0), "");
    let centimetres = disks(100.0);
    assert!(centimetres.contains("48 of the 48 disks cover") && centimetres.contains("another unit"), "{centimetres}");
}

#[test]
fn independent_points_in_a_disk_are_not_called_clustered() {
    for count in [40, 150] {
        let (mut claims, mut found, mut before) = (0, 0, 0);
        for seed in 0..100 {
            let pattern = read(&disk(seed, count)).pattern;
            let analysis = Analysis::of_pattern(&pattern, 1).unwrap();
            claims += usize::from(claims_clustering(&analysis));
            found += usize::from(analysis.part.is_some());
            if seed < 20 {
                // As it would be in the whole rectangle.
                let cloud = Cloud::of(&pattern);
                let scales = Scales::of(&cloud).unwrap();
                let whole = Analysis::of(&cloud, &scales).unwrap().with_envelope(&cloud, &scales, 1).unwrap();
                before += usize::from(claims_clustering(&whole));
            }
        }
        assert!(claims <= 5, "{claims} of 100 with {count} points");
        // With few points a disk is often not told from a square, nor its points from independent ones there.
        assert!(found >= if count < 100 { 60 } else { 99 }, "{found} of 100 with {count} points");
        // Negative control.
        assert!(count < 100 || before >= 15, "{before} of 20 with {count} points");
    }
    let analysis = Analysis::of_pattern(&read(&disk(3, 150)).pattern, 1).unwrap();
    let share = analysis.part.as_ref().unwrap().share;
    assert!((0.68..0.82).contains(&share), "{share}");
    assert!(
        describe(&analysis).starts_with("The points fill a round or otherwise convex part"),
        "{}",
        describe(&analysis)
    );
}

#[test]
fn a_filled_rectangle_stays_whole() {
    for count in [15, 40, 120] {
        let parts = (0..200).filter(|&seed| {
            let pattern = declared(noise(seed, count), Domain::UNIT);
            Analysis::of(&Cloud::of_part(&pattern, None).unwrap(), &Scales::of(&Cloud::of(&pattern)).unwrap())
                .unwrap()
                .part
                .is_some()
        });
        let parts = parts.count();
        assert!(parts <= 5, "{parts} of 200 with {count} points");
    }
    // Tiles never are a part. Of the gallery's windows one is: a disk.
    for entry in gallery::entries() {
        let exemplar = entry.exemplar();
        let part = Analysis::of_pattern(&exemplar, 1).unwrap().part;
        assert_eq!(part.is_some(), entry.name == "phyllotaxis", "{}", entry.name);
        let open = Cloud::of_part(&exemplar.with_boundary(Boundary::Open), None).unwrap();
        let whole = open.size().x * open.size().y;
        assert_eq!(open.area() < whole, entry.name == "phyllotaxis", "{}", entry.name);
    }
}

#[test]
fn clusters_in_a_disk_are_still_clusters() {
    let mut rng = Rng::new(4, Purpose::Gallery);
    let points: Vec<DVec2> = disk(4, 60)
        .into_iter()
        .flat_map(|center| (0..4).map(|_| center + DVec2::new(rng.normal(), rng.normal())).collect::<Vec<_>>())
        .collect();
    let analysis = Analysis::of_pattern(&read(&points).pattern, 1).unwrap();
    assert!(claims_clustering(&analysis), "{}", describe(&analysis));
}

#[test]
fn ripley_s_k_in_a_disk_is_that_of_independent_points() {
    let window = circle();
    let settings = RipleySettings { range: 0.25, samples: 10 };
    let (mut within, mut without) = (vec![0.0; 10], vec![0.0; 10]);
    let runs = 100;
    for seed in 0..runs {
        let (pattern, outside) =
            declared(disk(seed, 80), Domain::new(DVec2::splat(-100.0), DVec2::splat(200.0)).unwrap())
                .cut(&window)
                .unwrap();
        // The outline has corners, the disk has none.
        assert!(outside <= 1, "{outside}");
        let cloud = Cloud::of_part(&pattern, Some(&window)).unwrap();
        assert!(
            (cloud.area() - PI / 4.0).abs() < 1e-3
                && (cloud.density() - pattern.len() as f64 / cloud.area()).abs() < 1e-9
        );
        let add = |sums: &mut Vec<f64>, cloud: &Cloud| {
            let k = ripley(cloud, &settings).unwrap().k;
            sums.iter_mut().zip(k).for_each(|(sum, k)| *sum += k / runs as f64);
        };
        add(&mut within, &cloud);
        add(&mut without, &Cloud::of(&pattern));
    }
    for i in 2..10 {
        let radius = 0.025 * (i + 1) as f64;
        let wanted = PI * radius * radius;
        // The standard error of the mean is a percent and a half.
        assert!((within[i] / wanted - 1.0).abs() < 0.04, "{radius}: {} {wanted}", within[i]);
        assert!((without[i] / wanted - 1.0).abs() > 0.1, "{radius}: {} {wanted}", without[i]);
    }
}

#[test]
fn a_window_of_any_outline_counts() {
    // Independent points in an L: what lies outside is left out, and the notch makes no clusters.
    let ell = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.4], [0.4, 0.4], [0.4, 1.0], [0.0, 1.0]].map(DVec2::from);
    let window = Window::new(vec![ell.to_vec()]).unwrap();
    let (mut claims, mut whole) = (0, 0);
    for seed in 0..40 {
        let (pattern, outside) = declared(noise(seed, 200), Domain::UNIT).cut(&window).unwrap();
        assert!(outside > 40 && pattern.len() + outside == 200);
        let analysis = Analysis::of_pattern_within(&pattern, Some(&window), 1).unwrap();
        let part = analysis.part.as_ref().unwrap();
        assert!((part.share - 0.64).abs() < 1e-6 && !part.found, "{}", part.share);
        assert!(describe(&analysis).contains("those of the window, 64 % of the rectangle"));
        claims += i32::from(claims_clustering(&analysis));
        if seed < 10 {
            let cloud = Cloud::of(&pattern);
            let scales = Scales::of(&cloud).unwrap();
            let plain = Analysis::of(&cloud, &scales).unwrap().with_envelope(&cloud, &scales, 1).unwrap();
            whole += i32::from(claims_clustering(&plain));
        }
        // No hole reaches into the notch.
        let [x, y] = analysis.largest_empty_circle.center;
        assert!(x <= 0.4 || y <= 0.4, "{x} {y}");
    }
    assert!(claims <= 4 && whole >= 9, "{claims} of 40, {whole} of 10");
    // A tile has no window, and points outside are not counted in silence.
    let tile = gallery::find("blue-noise").unwrap().exemplar();
    assert!(Analysis::of_pattern_within(&tile, Some(&window), 1).unwrap_err().to_string().contains("tile"));
    let open = tile.with_boundary(Boundary::Open);
    assert!(Analysis::of_pattern_within(&open, Some(&window), 1).unwrap_err().to_string().contains("outside"));
}

#[test]
fn a_large_window_is_cut_to() {
    // 10 000 corners around 20 000 points: a star with long teeth.
    let corner = |i: u32| DVec2::from_angle(TAU * f64::from(i) / 1e4) * if i.is_multiple_of(2) { 1.0 } else { 0.6 };
    let window = Window::new(vec![(0..10_000).map(corner).collect()]).unwrap();
    let points = noise(3, 20_000).into_iter().map(|point| 2.0 * point - 1.0).collect();
    let domain = Domain::new(DVec2::splat(-1.0), DVec2::splat(2.0)).unwrap();
    let (pattern, outside) = declared(points, domain).cut(&window).unwrap();
    // Twice the area of one tooth, ½ · 1 · 0.6 · sin, for all of them.
    let area = 0.5 * 0.6 * libm::sin(TAU / 1e4) * 1e4;
    assert!((window.area() - area).abs() < 1e-4 * area, "{} {area}", window.area());
    assert!((pattern.len() as f64 / 20_000.0 - area / 4.0).abs() < 0.012, "{outside}");
    assert!(Cloud::of_part(&pattern, Some(&window)).unwrap().density() > 0.0);
}

#[test]
fn a_comparison_says_that_the_exemplar_fills_a_part() {
    let round = read(&disk(3, 150)).pattern;
    let output = few_iterations(round.clone());
    let comparison = Comparison::of(&round, &output, 1).unwrap();
    assert!(comparison.filled[0].is_some_and(|share| (0.68..0.82).contains(&share)), "{:?}", comparison.filled);
    assert!(verdict(&comparison).contains("convex part of their rectangle"), "{}", verdict(&comparison));
    let square = declared(noise(3, 150), Domain::UNIT);
    let comparison = Comparison::of(&square, &square, 1).unwrap();
    assert!(comparison.filled == [None; 2] && !verdict(&comparison).contains("rectangle"));
}
