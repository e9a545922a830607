//! Classes and attributes in a run: who is placed when, who carries what, and what the maps see of it.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail loudly")]

use glam::DVec2;
use pointweave::methods::network::parameters::{ClassMaps, ClassOrder};
use pointweave::methods::network::{NetworkRun, NetworkState, Parameters, Preset};
use pointweave::run::Event;
use pointweave::sampling::{Purpose, Rng, white_noise};
use pointweave::{Attribute, Boundary, Domain, PointPattern};

const GENEROUS: u64 = 4_000_000_000;

/// Three classes that have points and one without, of 4, 12 and 8 points and mean radii 0.01, 0.02 and 0.04; two attributes.
fn thicket() -> PointPattern {
    let positions = white_noise(&mut Rng::new(4, Purpose::Gallery), DVec2::ONE, 24);
    let classes: Vec<u16> = (0..24).map(|i| if i < 4 { 0 } else { 1 + 2 * u16::from(i < 12) }).collect();
    let names = ["shrub", "tree", "none", "stone"].map(str::to_owned).to_vec();
    let radius = classes
        .iter()
        .zip(0..)
        .map(|(class, i)| 0.01 * [1.0, 2.0, 0.0, 4.0][usize::from(*class)] + 1e-4 * f64::from(i));
    PointPattern::new(Domain::UNIT, positions)
        .unwrap()
        .with_attribute(Attribute { name: "radius".into(), values: radius.collect() })
        .unwrap()
        .with_attribute(Attribute {
            name: "orientation".into(),
            values: (0..24).map(|i| 15.0 * f64::from(i)).collect(),
        })
        .unwrap()
        .with_classes(classes, names)
        .unwrap()
}

fn small(class_order: ClassOrder, class_maps: ClassMaps) -> Parameters {
    Parameters {
        boundary: Boundary::Periodic,
        channels: 8,
        scales: 2,
        grid_min: 24,
        grid_max: 24,
        iterations_coarse: 3,
        iterations_fine: 2,
        iterations_polish: 0,
        // Values stay where they are put.
        value_swaps: 0,
        disk_overlap: 0.0,
        class_order,
        class_maps,
        ..Parameters::preset(Preset::Fast)
    }
}

fn start(parameters: Parameters) -> NetworkRun {
    NetworkRun::new(thicket(), parameters, GENEROUS).unwrap()
}

/// Turn and class of those that began, and all losses.
fn finish(run: &mut NetworkRun) -> (Vec<(usize, usize)>, Vec<f64>) {
    let (mut classes, mut losses) = (Vec::new(), Vec::new());
    loop {
        match run.advance().unwrap() {
            Event::Finished => return (classes, losses),
            Event::ScaleStarted { progress, .. } if progress.scale == 0 && progress.iteration == 0 => {
                classes.push((progress.turn, progress.class));
            }
            Event::Iterated { losses: terms, .. } => losses.push(terms.total()),
            _ => {}
        }
    }
}

#[test]
fn classes_are_placed_in_the_order_asked_for_and_listed_in_the_exemplar_s() {
    for (order, expected) in [
        (ClassOrder::File, [0, 1, 3]),
        // Mean radii 1, 2, 4; counts 4, 12, 8.
        (ClassOrder::LargestFirst, [3, 1, 0]),
        (ClassOrder::MostFirst, [1, 3, 0]),
    ] {
        let mut run = start(small(order, ClassMaps::Each));
        let begun = run.output().unwrap();
        assert!(begun.classes().iter().all(|&class| usize::from(class) == expected[0]), "{order:?}");
        let turns: Vec<_> = expected.into_iter().enumerate().collect();
        assert_eq!(finish(&mut run).0, turns, "{order:?}");
        assert_eq!(run.progress().classes, 3);
        assert_eq!(run.progress().done, 1.0);
        let output = run.output().unwrap();
        let classes: Vec<u16> = [vec![0; 16], vec![1; 48], vec![3; 32]].concat();
        assert_eq!(output.classes(), classes, "{order:?}");
        assert_eq!(output.class_names(), thicket().class_names());
        // Every value four times, with its class and with the other values of its point.
        let exemplar = thicket();
        let mut uses = vec![0; 24];
        for point in 0..96 {
            let radius = output.attributes()[0].values[point];
            let source = exemplar.attributes()[0].values.iter().position(|&value| value == radius).unwrap();
            assert_eq!(exemplar.classes()[source], output.classes()[point]);
            assert_eq!(exemplar.attributes()[1].values[source], output.attributes()[1].values[point]);
            uses[source] += 1;
        }
        assert_eq!(uses, [4; 24], "{order:?}");
    }
    let plain = PointPattern::new(Domain::UNIT, thicket().positions().to_vec()).unwrap();
    let plain = plain.with_classes(thicket().classes().to_vec(), thicket().class_names().to_vec()).unwrap();
    assert_eq!(ClassOrder::LargestFirst.of(&plain), [0, 3, 1], "few things are large things");
}

#[test]
fn a_saved_run_goes_on_in_the_middle_of_any_class() {
    for maps in [ClassMaps::Pooled, ClassMaps::Separate, ClassMaps::Each] {
        let parameters = small(ClassOrder::LargestFirst, maps);
        let mut whole = start(parameters.clone());
        let (_, losses) = finish(&mut whole);
        for stop in [2, 7, 13] {
            let mut run = start(parameters.clone());
            run.run(stop).unwrap();
            let text = serde_json::to_string(&run.state()).unwrap();
            let state: NetworkState = serde_json::from_str(&text).unwrap();
            let mut resumed = NetworkRun::resume(state, GENEROUS).unwrap();
            assert_eq!(finish(&mut resumed).1, losses[stop as usize..], "{maps:?} stopped after {stop}");
            assert_eq!(resumed.points(), whole.points());
            assert_eq!(resumed.sources(), whole.sources());
        }
    }
}

#[test]
fn weighted_maps_are_the_same_bits_at_any_number_of_threads() {
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut run = start(small(ClassOrder::File, ClassMaps::Separate));
            (finish(&mut run), run.points().to_vec())
        })
    };
    assert_eq!(with_threads(1), with_threads(3));
}

#[test]
fn the_maps_see_whose_values_a_point_carries() {
    // The loss before the first move, with and without an exchange of two points' values.
    let first_loss = |exemplar: &PointPattern, exchange: bool| {
        let parameters = small(ClassOrder::MostFirst, ClassMaps::Pooled);
        let mut run = NetworkRun::new(exemplar.clone(), parameters, GENEROUS).unwrap();
        if exchange {
            let mut sources = run.sources().to_vec();
            let other = (0..sources.len()).find(|&other| sources[other] != sources[0]).unwrap();
            sources.swap(0, other);
            run.set_sources(&sources).unwrap();
        }
        finish(&mut run).1[0]
    };
    let exemplar = thicket();
    let before = first_loss(&exemplar, false);
    assert_ne!(before, first_loss(&exemplar, true));
    // Negative control: what is the same everywhere has no bands.
    let flat = PointPattern::new(Domain::UNIT, exemplar.positions().to_vec()).unwrap();
    let flat = flat.with_attribute(Attribute { name: "depth".into(), values: vec![3.0; 24] }).unwrap();
    assert_eq!(first_loss(&flat, false), first_loss(&flat, true));
}

#[test]
fn values_may_change_hands_in_the_middle_of_a_scale() {
    let mut run = start(small(ClassOrder::File, ClassMaps::Pooled));
    run.run(7).unwrap();
    let before = run.state();
    let mut sources = run.sources().to_vec();
    let class_of = |source: usize| thicket().classes()[source];
    let last = sources.len() - 1;
    let other =
        (0..last).rev().find(|&i| class_of(sources[i]) == class_of(sources[last]) && sources[i] != sources[last]);
    sources.swap(last, other.unwrap());
    run.set_sources(&sources).unwrap();
    let after = run.state();
    assert_eq!((&after.points, &after.losses, &after.adam), (&before.points, &before.losses, &before.adam));
    let mut resumed = NetworkRun::resume(after, GENEROUS).unwrap();
    assert_eq!(finish(&mut run).1, finish(&mut resumed).1, "as if it had been saved");
    assert_eq!(&run.sources()[..sources.len()], sources);

    let refused = |damage: &dyn Fn(&mut Vec<usize>)| {
        let mut wrong = run.sources().to_vec();
        damage(&mut wrong);
        let mut copy = NetworkRun::resume(run.state(), GENEROUS).unwrap();
        copy.set_sources(&wrong).unwrap_err().to_string()
    };
    assert!(refused(&|s| s.truncate(5)).contains("there are 5 for 96 points"));
    assert!(refused(&|s| s.swap(0, 95)).contains("point 0 has those of point"));
    assert!(refused(&|s| s[3] = 900).contains("point 3 has those of point 900"));
    assert!(refused(&|s| s.copy_within(20..22, 22)).contains("times"));
}

#[test]
fn states_whose_values_do_not_fit_and_old_ones_are_refused() {
    let mut run = start(small(ClassOrder::File, ClassMaps::Pooled));
    run.run(2).unwrap();
    let mut state = run.state();
    state.sources[0] = 23;
    let message = NetworkRun::resume(state, GENEROUS).unwrap_err().to_string();
    assert!(message.contains("not of its class"), "{message}");
    // As version 1 wrote it.
    let mut old = serde_json::to_value(run.state()).unwrap();
    let fields = old.as_object_mut().unwrap();
    fields.insert("version".into(), 1.into());
    fields.remove("sources").unwrap();
    for name in ["class-order", "class-maps"] {
        fields["parameters"].as_object_mut().unwrap().remove(name).unwrap();
    }
    let old: NetworkState = serde_json::from_value(old).unwrap();
    let message = NetworkRun::resume(old, GENEROUS).unwrap_err().to_string();
    assert!(message.contains("its version is 1, this program reads 2"), "{message}");
}

#[test]
fn the_memory_of_all_maps_is_counted() {
    let parameters = |maps| Parameters { channels: 32, ..small(ClassOrder::File, maps) };
    let needed = |maps| {
        let error = NetworkRun::new(thicket(), parameters(maps), 1).unwrap_err().to_string();
        let (_, rest) = error.split_once("needs about ").unwrap_or_else(|| panic!("{error}"));
        rest.split(' ').next().unwrap().parse::<u32>().unwrap()
    };
    assert!(needed(ClassMaps::Each) > needed(ClassMaps::Pooled));
}
