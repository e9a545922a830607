//! Mark correlations against known answers, and classes and attributes of an output against chance.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod common;

use common::{assert_close, points};
use glam::DVec2;
use pointweave::analysis::*;
use pointweave::pattern::Attribute;
use pointweave::sampling::{Purpose, Rng};
use pointweave::{Boundary, Domain, PointPattern, gallery};

const PRODUCT: MarkFunction = MarkFunction::Product;
const DIRECTION: MarkFunction = MarkFunction::Direction;

/// A square lattice of spacing 1⁄side, and for each point whether it is black on a chequerboard.
fn chequers(side: usize, boundary: Boundary) -> (Cloud, Vec<bool>) {
    let places = (0..side * side).map(|i| (DVec2::new((i % side) as f64, (i / side) as f64) + 0.5) / side as f64);
    let black = (0..side * side).map(|i| (i % side + i / side).is_multiple_of(2)).collect();
    (Cloud::new(places.collect(), DVec2::ONE, boundary).unwrap(), black)
}

/// The value at the sample nearest to a distance.
fn at(correlation: &MarkCorrelation, distance: f64) -> Option<f64> {
    let gap = |i: &usize| (correlation.radius[*i] - distance).abs();
    let nearest = (0..correlation.radius.len()).min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap();
    correlation.value[nearest]
}

#[test]
fn a_chequerboard_has_known_mark_correlations() {
    for boundary in [Boundary::Periodic, Boundary::Open] {
        let (cloud, black) = chequers(10, boundary);
        // Narrow enough that no sample near a shell sees another shell.
        let settings = PairCorrelationSettings { sigma: 0.004, range: 0.25, samples: 251 };
        let two = |a: f64, b: f64| -> Vec<f64> { black.iter().map(|&black| if black { a } else { b }).collect() };
        // Side by side stand the other kind, across the corner one's own: ab and (a² + b²)/2 over ((a + b)/2)².
        let products = mark_correlation(&cloud, &two(1.0, 3.0), PRODUCT, &settings).unwrap();
        let found = [0.1, 0.1 * 2.0_f64.sqrt(), 0.2].map(|shell| at(&products, shell).unwrap());
        assert_close("products", &found, &[3.0 / 4.0, 5.0 / 4.0, 5.0 / 4.0], 1e-9);
        assert_eq!(products.independent, 1.0);
        assert_eq!((at(&products, 0.05), at(&products, 0.12)), (None, None), "no two points are so far apart");
        // The unit of the marks does not matter.
        let scaled = mark_correlation(&cloud, &two(70.0, 210.0), PRODUCT, &settings).unwrap();
        assert!(scaled.mean_squared_difference(&products).unwrap() < 1e-24);

        let turned = |a, b| mark_correlation(&cloud, &two(a, b), DIRECTION, &settings).unwrap();
        for (a, b, side_by_side, independent) in
            [(0.0, 180.0, -1.0, 0.0), (10.0, 100.0, 0.0, 0.5), (350.0, 50.0, 0.5, 0.75), (-90.0, 270.0, 1.0, 1.0)]
        {
            let directions = turned(a, b);
            let found = [at(&directions, 0.1).unwrap() + 2.0, at(&directions, 0.2).unwrap(), directions.independent];
            let expected = [side_by_side + 2.0, 1.0, independent];
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-9, "{a}° and {b}°: {found} instead of {expected}");
            }
        }
        // Negative control: one mark of another kind is seen.
        let mut marks = two(1.0, 3.0);
        marks[0] = 3.0;
        let flawed = mark_correlation(&cloud, &marks, PRODUCT, &settings).unwrap();
        assert!(flawed.mean_squared_difference(&products).unwrap() > 1e-5);
    }
}

#[test]
fn independent_marks_correlate_like_chance() {
    let settings = PairCorrelationSettings { sigma: 0.02, range: 0.2, samples: 12 };
    for boundary in [Boundary::Periodic, Boundary::Open] {
        let (mut products, mut cosines) = (Vec::new(), Vec::new());
        let mut clustered = Vec::new();
        for seed in 0..60 {
            let places = points(seed, DVec2::ONE, 150);
            let cloud = Cloud::new(places.clone(), DVec2::ONE, boundary).unwrap();
            let mut rng = Rng::new(seed, Purpose::Analysis(7));
            let marks: Vec<f64> = places.iter().map(|_| rng.range(1.0, 9.0)).collect();
            let turns: Vec<f64> = places.iter().map(|_| rng.range(0.0, 360.0)).collect();
            // A mark that is where the point is: large on the left.
            let placed: Vec<f64> = places.iter().map(|point| 1.0 + 8.0 * f64::from(u8::from(point.x < 0.5))).collect();
            let values = |marks: &[f64], function| -> Vec<f64> {
                mark_correlation(&cloud, marks, function, &settings).unwrap().value.iter().map(|v| v.unwrap()).collect()
            };
            products.push(values(&marks, PRODUCT));
            cosines.push(values(&turns, DIRECTION));
            clustered.push(values(&placed, PRODUCT));
        }
        // By more than four standard errors of the mean.
        let off = |rows: &[Vec<f64>], wanted: f64| -> usize {
            let count = rows.len() as f64;
            (0..settings.samples)
                .filter(|&column| {
                    let mean = rows.iter().map(|row| row[column]).sum::<f64>() / count;
                    let variance = rows.iter().map(|row| (row[column] - mean).powi(2)).sum::<f64>() / (count - 1.0);
                    // The mark's own mean is estimated too: a bias of the order of one over the number of points.
                    (mean - wanted).abs() > 4.0 * (variance / count).sqrt() + 0.01
                })
                .count()
        };
        assert_eq!(off(&products, 1.0), 0, "{}", boundary.name());
        assert_eq!(off(&cosines, 0.0), 0, "{}", boundary.name());
        // Negative control.
        assert!(off(&clustered, 1.0) > 6, "{}", boundary.name());
    }
}

/// Sums over all pairs and images, without cells and without the recurrence of the kernel.
fn brute_force(cloud: &Cloud, marks: &[f64], function: MarkFunction, settings: &PairCorrelationSettings) -> Vec<f64> {
    let (places, size) = (cloud.points(), cloud.size());
    let periodic = cloud.boundary() == Boundary::Periodic;
    let images: i32 = if periodic { 2 } else { 0 };
    let first = 0.01 * settings.sigma;
    let mean = marks.iter().sum::<f64>() / marks.len() as f64;
    (0..settings.samples)
        .map(|sample| {
            let r = first + sample as f64 * (settings.range - first) / (settings.samples - 1) as f64;
            let (mut products, mut pairs) = (0.0, 0.0);
            for (i, &a) in places.iter().enumerate() {
                for (j, &b) in places.iter().enumerate() {
                    for shift in (-images..=images).flat_map(|x| (-images..=images).map(move |y| (x, y))) {
                        if i == j && shift == (0, 0) {
                            continue;
                        }
                        let offset = b - a + DVec2::new(shift.0.into(), shift.1.into()) * size;
                        let x = (r - offset.length()) / settings.sigma;
                        if x.abs() > 4.0 {
                            continue;
                        }
                        let overlap = if periodic { size } else { size - offset.abs() };
                        let weight = (-0.5 * x * x).exp() / (overlap.x * overlap.y);
                        pairs += weight;
                        products += weight
                            * match function {
                                MarkFunction::Product => marks[i] * marks[j] / (mean * mean),
                                MarkFunction::Direction => (marks[i] - marks[j]).to_radians().cos(),
                            };
                    }
                }
            }
            products / pairs
        })
        .collect()
}

#[test]
fn mark_correlations_are_those_of_brute_force() {
    let size = DVec2::new(1.2, 0.8);
    let settings = PairCorrelationSettings { sigma: 0.05, range: 0.3, samples: 9 };
    for (seed, boundary) in [(3, Boundary::Periodic), (4, Boundary::Open)] {
        let places = points(seed, size, 40);
        let marks: Vec<f64> = places.iter().map(|point| 10.0 + 200.0 * point.x * point.y).collect();
        let cloud = Cloud::new(places, size, boundary).unwrap();
        for function in [PRODUCT, DIRECTION] {
            let found = mark_correlation(&cloud, &marks, function, &settings).unwrap();
            let found: Vec<f64> = found.value.iter().map(|value| value.unwrap()).collect();
            assert_close(boundary.name(), &found, &brute_force(&cloud, &marks, function, &settings), 1e-9);
        }
    }
}

#[test]
fn marks_that_can_not_be_correlated_are_refused() {
    let (cloud, _) = chequers(4, Boundary::Periodic);
    let settings = PairCorrelationSettings::suited_to(&cloud);
    let refused = |marks: &[f64], part: &str| {
        let message = mark_correlation(&cloud, marks, PRODUCT, &settings).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    };
    refused(&[1.0; 15], "15 marks for 16 points");
    refused(&[&[1.0; 7][..], &[f64::NAN], &[1.0; 8]].concat(), "the mark of point 7 is NaN");
    refused(&[[1.0; 8], [-1.0; 8]].concat(), "the mean of the marks is 0");
    assert!(mark_correlation(&cloud, &[0.0; 16], DIRECTION, &settings).is_ok(), "a direction has no need of a mean");
}

/// The same points, classes and values by `order` instead of the own: `order[i]` says whose point `i` gets.
fn reassigned(pattern: &PointPattern, order: &[usize]) -> PointPattern {
    let classes = order.iter().map(|&from| pattern.classes()[from]).collect();
    let mut other = PointPattern::new(pattern.domain(), pattern.positions().to_vec())
        .unwrap()
        .with_boundary(pattern.boundary())
        .with_classes(classes, pattern.class_names().to_vec())
        .unwrap();
    for Attribute { name, values } in pattern.attributes() {
        let values = order.iter().map(|&from| values[from]).collect();
        other = other.with_attribute(Attribute { name: name.clone(), values }).unwrap();
    }
    other
}

/// Two by two copies side by side.
fn tiled(pattern: &PointPattern) -> PointPattern {
    let size = pattern.domain().size();
    let shifts = [DVec2::ZERO, DVec2::new(size.x, 0.0), DVec2::new(0.0, size.y), size];
    let places = shifts.iter().flat_map(|&shift| pattern.positions().iter().map(move |&point| point + shift));
    let mut whole = PointPattern::new(Domain::new(DVec2::ZERO, 2.0 * size).unwrap(), places.collect())
        .unwrap()
        .with_boundary(pattern.boundary())
        .with_classes(pattern.classes().repeat(4), pattern.class_names().to_vec())
        .unwrap();
    for Attribute { name, values } in pattern.attributes() {
        whole = whole.with_attribute(Attribute { name: name.clone(), values: values.repeat(4) }).unwrap();
    }
    whole
}

#[test]
fn a_copy_is_far_better_than_chance_and_chance_is_not() {
    for name in ["attracting", "repelling", "houses", "grove", "boats", "meadow"] {
        let exemplar = gallery::find(name).unwrap().exemplar();
        let copy = tiled(&exemplar);
        let marks = Comparison::of(&exemplar, &copy, 1).unwrap().marks.unwrap();
        for pair in &marks.class_pairs {
            assert!(pair.error.error < 1e-20 && pair.error.random > 0.003, "{name}: {pair:?}");
        }
        for one in &marks.attributes {
            assert!(one.error.error < 1e-20 && one.error.random > 1e-5, "{name}: {one:?}");
        }
        let several = exemplar.class_names().len();
        assert_eq!(marks.class_pairs.len(), if several == 1 { 0 } else { several * (several + 1) / 2 }, "{name}");
        let named: Vec<&str> = marks.attributes.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(named, exemplar.attributes().iter().map(|one| one.name.as_str()).collect::<Vec<_>>(), "{name}");

        // Marks given out at random are as good as marks given out at random.
        let mut order: Vec<usize> = (0..copy.len()).collect();
        Rng::new(9, Purpose::Analysis(5)).shuffle(&mut order);
        let marks = Comparison::of(&exemplar, &reassigned(&copy, &order), 1).unwrap().marks.unwrap();
        for error in [marks.classes, marks.marks].into_iter().flatten() {
            assert!((0.5..2.0).contains(&error.factor()), "{name}: {error:?}");
        }
    }
    // One class and no attribute leave nothing to say.
    let plain = gallery::find("hex").unwrap().exemplar();
    assert_eq!(Comparison::of(&plain, &tiled(&plain), 1).unwrap().marks, None);
}

#[test]
fn a_missing_class_counts_as_far_away() {
    let exemplar = gallery::find("houses").unwrap().exemplar();
    let houses: Vec<DVec2> = exemplar.positions()[..36].to_vec();
    let alone = PointPattern::new(exemplar.domain(), houses)
        .unwrap()
        .with_boundary(exemplar.boundary())
        .with_classes(vec![0; 36], exemplar.class_names().to_vec())
        .unwrap();
    let marks = Comparison::of(&exemplar, &alone, 1).unwrap().marks.unwrap();
    let error = |a, b| marks.class_pairs.iter().find(|one| (one.a, one.b) == (a, b)).unwrap().error.error;
    assert!(error(0, 0) < 1e-20, "the houses are the exemplar's");
    assert!(error(0, 1) > 0.5 && error(1, 1) > 0.5, "{marks:?}");
}
