//! Hands on the result: what is pinned stays bit for bit, a region is done again and nothing else, and a run goes on with
//! other parameters from the points as they are.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail loudly")]

use glam::DVec2;
use pointweave::engine::gpu::{Gpu, OpenOptions};
use pointweave::methods::network::parameters::ClassOrder;
use pointweave::methods::network::{NetworkError, NetworkRun, NetworkState, Parameters, Preset};
use pointweave::run::Event;
use pointweave::{Boundary, PointPattern, gallery};

const GENEROUS: u64 = 4_000_000_000;

/// Well under a second, with every repair and a try at the worst regions.
fn small(boundary: Boundary, seed: u64) -> Parameters {
    Parameters {
        boundary,
        seed,
        channels: 12,
        scales: 2,
        grid_min: 40,
        grid_max: 48,
        iterations_coarse: 8,
        iterations_fine: 6,
        iterations_polish: 3,
        restarts: 1,
        ..Parameters::preset(Preset::Fast)
    }
}

fn exemplar(name: &str) -> PointPattern {
    gallery::find(name).unwrap().exemplar()
}

fn start(name: &str, parameters: Parameters) -> NetworkRun {
    NetworkRun::new(exemplar(name), parameters, GENEROUS).unwrap()
}

fn finish(run: &mut NetworkRun) {
    run.run(u64::MAX).unwrap();
    assert_eq!(run.advance().unwrap(), Event::Finished);
}

fn saved_and_resumed(run: &NetworkRun) -> NetworkRun {
    let text = serde_json::to_string(&run.state()).unwrap();
    NetworkRun::resume(serde_json::from_str::<NetworkState>(&text).unwrap(), GENEROUS).unwrap()
}

/// The ids of points at these places in the list.
fn ids(run: &NetworkRun, points: &[usize]) -> Vec<u32> {
    points.iter().map(|&point| run.canvas().ids()[point]).collect()
}

/// Which of the points are elsewhere.
fn changed(before: &[DVec2], after: &[DVec2]) -> Vec<usize> {
    assert_eq!(before.len(), after.len());
    (0..before.len()).filter(|&point| before[point] != after[point]).collect()
}

fn rectangle(low: [f64; 2], high: [f64; 2]) -> [DVec2; 4] {
    [low, [high[0], low[1]], high, [low[0], high[1]]].map(DVec2::from)
}

#[test]
fn pinned_points_stay_bit_for_bit_while_the_others_move() {
    for boundary in [Boundary::Open, Boundary::Periodic] {
        let mut run = start("rings", small(boundary, 3));
        run.run(2).unwrap();
        let before = run.points().to_vec();
        let held = [0, 5, 6, 40];
        // Two of them in each other's way, which every repair would put right, and one on the border.
        let places = [DVec2::new(0.3, 0.3), DVec2::new(0.3001, 0.3), DVec2::new(0.0, 1.0)];
        run.move_points(&held[..3], &places).unwrap();
        run.pin(&held[3..], true).unwrap();
        finish(&mut run);
        let after = run.points();
        assert_eq!([after[0], after[5], after[6]], places, "{boundary:?}");
        assert_eq!(after[40], before[40]);
        let moved = changed(&before, after);
        assert!((0..before.len()).all(|point| moved.contains(&point) || point == 40), "all others have moved");
        // Negative control: without pins nothing is where it was.
        let mut free = start("rings", small(boundary, 3));
        finish(&mut free);
        assert_ne!(free.points()[40], before[40]);
        assert_ne!(free.points(), after, "the pins are felt by the others");
    }
}

#[test]
fn pinned_disks_keep_their_places_and_values_while_the_others_exchange_theirs() {
    for name in ["packed-disks", "graded-disks"] {
        let parameters = Parameters { expansion_x: 1.0, expansion_y: 1.0, ..small(exemplar(name).boundary(), 3) };
        assert!(parameters.value_swaps > 0 && parameters.disk_overlap > 0.0 && parameters.alignment > 0);
        let mut run = start(name, parameters.clone());
        run.run(2).unwrap();
        let held: Vec<usize> = (0..run.points().len()).step_by(4).collect();
        run.pin(&ids(&run, &held), true).unwrap();
        let of = |run: &NetworkRun| -> Vec<(DVec2, usize)> {
            held.iter().map(|&point| (run.points()[point], run.sources()[point])).collect()
        };
        let (before, sources) = (of(&run), run.sources().to_vec());
        finish(&mut run);
        assert_eq!(of(&run), before, "{name}");
        assert_ne!(run.sources(), sources, "{name}: the others exchange their values");
        // Negative control: without pins the same points move and exchange, too.
        let mut free = start(name, parameters);
        finish(&mut free);
        let (places, values): (Vec<_>, Vec<_>) =
            of(&free).into_iter().zip(&before).map(|(now, then)| (now.0 != then.0, now.1 != then.1)).unzip();
        assert!(places.iter().all(|&moved| moved) && values.contains(&true), "{name}");
    }
}

#[test]
fn pins_are_let_go_of() {
    let mut run = start("rings", small(Boundary::Periodic, 3));
    let all = run.canvas().ids().to_vec();
    run.pin(&all, true).unwrap();
    run.run(2).unwrap();
    let before = start("rings", small(Boundary::Periodic, 3)).points().to_vec();
    assert_eq!(run.points(), before, "nothing can move, and a run of nothing ends");
    assert_eq!(run.progress().total_iterations, 0);

    let mut run = start("rings", small(Boundary::Periodic, 3));
    run.pin(&all, true).unwrap();
    run.pin(&all, false).unwrap();
    finish(&mut run);
    let mut untouched = start("rings", small(Boundary::Periodic, 3));
    finish(&mut untouched);
    assert_eq!(run.points(), untouched.points());
}

#[test]
fn a_touched_run_is_saved_with_its_pins_and_ends_the_same() {
    let touched = || {
        let mut run = start("rings", small(Boundary::Open, 4));
        run.run(3).unwrap();
        run.move_points(&[7], &[DVec2::new(0.5, 0.25)]).unwrap();
        run.run(1).unwrap();
        run
    };
    let mut whole = touched();
    let mut parted = saved_and_resumed(&touched());
    assert!(parted.canvas().pinned()[7] && !parted.canvas().pinned()[8]);
    finish(&mut whole);
    finish(&mut parted);
    assert_eq!(whole.points(), parted.points());
    assert_eq!(whole.points()[7], DVec2::new(0.5, 0.25));
    assert!(whole.canvas().pinned()[7]);
}

#[test]
fn a_region_is_done_again_and_nothing_else() {
    // On a tile the region comes around two borders.
    for (boundary, region) in
        [(Boundary::Open, rectangle([0.4, 0.5], [1.1, 1.2])), (Boundary::Periodic, rectangle([1.7, -0.4], [2.4, 0.3]))]
    {
        let mut run = start("rings", small(boundary, 3));
        finish(&mut run);
        let before = run.points().to_vec();
        let inside = |point: DVec2| {
            let reach = if boundary == Boundary::Periodic { 1 } else { 0 };
            (-reach..=reach).any(|x| {
                (-reach..=reach).any(|y| {
                    let copy = point + 2.0 * DVec2::new(f64::from(x), f64::from(y));
                    copy.cmpgt(region[0]).all() && copy.cmplt(region[2]).all()
                })
            })
        };
        let chosen: Vec<usize> = (0..before.len()).filter(|&point| inside(before[point])).collect();
        assert!(chosen.len() > 10 && chosen.len() < before.len() / 2, "{}", chosen.len());
        run.redo_region(&region).unwrap();
        assert!(run.is_redoing() && run.progress().redoing);
        assert!(chosen.iter().all(|&point| inside(run.points()[point])), "the fresh start lies in the region");
        assert_eq!(run.progress().scale, 0);
        let mut twin = saved_and_resumed(&run);
        run.run(9).unwrap();
        let mut parted = saved_and_resumed(&run);
        for run in [&mut run, &mut twin, &mut parted] {
            finish(run);
        }
        assert!(!run.is_redoing());
        assert_eq!(changed(&before, run.points()), chosen, "{boundary:?}");
        assert_eq!(run.points(), twin.points());
        assert_eq!(run.points(), parted.points(), "stopped in the region");
        // The next time it comes out otherwise.
        let first = run.points().to_vec();
        run.redo_region(&region).unwrap();
        finish(&mut run);
        assert_ne!(run.points(), first);
    }
}

#[test]
fn a_region_keeps_its_classes_its_values_and_what_is_pinned() {
    let parameters = Parameters { class_order: ClassOrder::MostFirst, ..small(Boundary::Open, 2) };
    let mut run = start("repelling", parameters);
    finish(&mut run);
    let (before, sources) = (run.points().to_vec(), run.sources().to_vec());
    let region = rectangle([0.2, 0.2], [1.3, 1.4]);
    let inside = |point: &DVec2| point.cmpgt(region[0]).all() && point.cmplt(region[2]).all();
    let held = before.iter().position(inside).unwrap();
    run.pin(&ids(&run, &[held]), true).unwrap();
    let classes = run.output().unwrap().classes().to_vec();
    run.redo_region(&region).unwrap();
    finish(&mut run);
    let moved = changed(&before, run.points());
    let chosen: Vec<usize> = (0..before.len()).filter(|&point| inside(&before[point]) && point != held).collect();
    assert_eq!(moved, chosen);
    assert_eq!(run.output().unwrap().classes(), classes, "as many points of every class");
    let sorted = |mut list: Vec<usize>| {
        list.sort_unstable();
        list
    };
    assert_eq!(sorted(run.sources().to_vec()), sorted(sources), "the same values");
    let listed = run.canvas().listed();
    let class = |point: &usize| classes[listed.iter().position(|other| other == point).unwrap()];
    assert!(moved.iter().any(|point| class(point) == 0) && moved.iter().any(|point| class(point) == 1));
}

#[test]
fn a_run_under_way_goes_on_after_a_region() {
    let parameters = Parameters { restarts: 0, ..small(Boundary::Open, 2) };
    let mut run = start("repelling", parameters);
    // In the second class, on the second scale.
    while (run.progress().turn, run.progress().scale) != (1, 1) {
        run.run(1).unwrap();
    }
    let before = run.points().to_vec();
    let region = rectangle([0.0, 0.0], [0.9, 2.0]);
    run.redo_region(&region).unwrap();
    while run.is_redoing() {
        run.advance().unwrap();
    }
    let kept = |point: &DVec2| point.x > 0.9;
    let moved = changed(&before, run.points());
    assert!(moved.iter().all(|&point| !kept(&before[point])), "only the region so far");
    assert_eq!((run.progress().turn, run.progress().scale, run.progress().iteration), (1, 1, 0));
    finish(&mut run);
    let moved = changed(&before, run.points());
    assert!(moved.iter().any(|&point| kept(&before[point])), "afterwards all of the class at hand move again");
}

#[test]
fn a_run_goes_on_with_other_parameters_from_its_points() {
    let mut run = start("rings", small(Boundary::Open, 3));
    finish(&mut run);
    run.move_points(&[4], &[DVec2::new(1.0, 1.0)]).unwrap();
    let parameters = || Parameters { channels: 16, iterations_fine: 4, ..small(Boundary::Periodic, 9) };
    let mut next = run.continue_with(parameters(), GENEROUS).unwrap();
    assert_eq!(next.points(), run.points());
    assert_eq!(next.progress().scale, 1, "coarse scales would undo what is there");
    assert_eq!(next.progress().total_iterations, run.progress().total_iterations);
    let mut twin = saved_and_resumed(&next);
    finish(&mut next);
    finish(&mut twin);
    assert_eq!(next.points(), twin.points());
    assert_eq!(next.points()[4], DVec2::new(1.0, 1.0), "pins hold");
    assert_eq!(changed(run.points(), next.points()).len(), run.points().len() - 1);
    // Negative control: what was there is felt. From anywhere else the same parameters lead elsewhere.
    let mut fresh = start("rings", parameters());
    finish(&mut fresh);
    assert_ne!(fresh.points(), next.points());

    // Under way it goes on at the scale it was at, and the class after comes as always.
    let mut run = start("repelling", small(Boundary::Open, 3));
    run.run(2).unwrap();
    let mut next = run.continue_with(Parameters { channels: 16, ..small(Boundary::Open, 3) }, GENEROUS).unwrap();
    assert_eq!((next.progress().turn, next.progress().scale), (0, 0));
    finish(&mut next);
    assert_eq!(next.output().unwrap().len(), 4 * exemplar("repelling").len());
}

#[test]
fn what_can_not_be_done_is_refused_in_words_and_changes_nothing() {
    let mut run = start("repelling", small(Boundary::Open, 1));
    run.run(3).unwrap();
    let before = run.state();
    let count = run.points().len();
    let said = |result: Result<(), NetworkError>, words: &str| {
        let error = result.unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    said(run.pin(&[0, count as u32], true), &format!("no point {count} among {count}"));
    said(run.move_points(&[0], &[]), "0 places for 1 points");
    said(run.move_points(&[0], &[DVec2::new(0.5, 2.5)]), "(0.5, 2.5) lies outside the output, 2 × 2");
    said(run.move_points(&[0], &[DVec2::new(f64::NAN, 0.5)]), "outside the output");
    said(run.redo_region(&[DVec2::ZERO, DVec2::ONE]), "three corners");
    said(run.redo_region(&rectangle([0.0, 0.0], [f64::INFINITY, 1.0])), "three corners");
    said(run.redo_region(&rectangle([5.0, 5.0], [6.0, 6.0])), "no point in this region");
    let wider = Parameters { expansion_x: 3.0, ..small(Boundary::Open, 1) };
    said(run.continue_with(wider, GENEROUS).map(drop), "another size needs another start");
    let order = Parameters { class_order: ClassOrder::MostFirst, ..small(Boundary::Open, 1) };
    if order.class_order.of(run.exemplar()) != ClassOrder::File.of(run.exemplar()) {
        said(run.continue_with(order, GENEROUS).map(drop), "another order");
    }
    said(run.continue_with(small(Boundary::Open, 1), 1000).map(drop), "MB of memory");
    assert_eq!(run.state(), before);
    // Negative control: what is allowed does change it.
    run.move_points(&[0], &[DVec2::new(0.5, 1.5)]).unwrap();
    assert_ne!(run.state(), before);
    run.redo_region(&rectangle([0.0, 0.0], [1.0, 1.0])).unwrap();
    said(run.continue_with(small(Boundary::Open, 1), GENEROUS).map(drop), "have to wait");
}

#[test]
fn states_whose_pins_or_regions_do_not_fit_are_refused() {
    let mut run = start("rings", small(Boundary::Open, 1));
    run.pin(&[3], true).unwrap();
    run.redo_region(&rectangle([0.0, 0.0], [1.0, 1.0])).unwrap();
    run.run(2).unwrap();
    let good = run.state();
    assert!(NetworkRun::resume(good.clone(), GENEROUS).is_ok());
    type Break = fn(&mut NetworkState);
    let breaks: [(&str, Break); 8] = [
        ("it holds point 999999", |state| state.pinned.push(999_999)),
        ("may move", |state| state.pinned = (0..50).collect()),
        ("may move", |state| state.redo = None),
        ("region", |state| state.redo.as_mut().unwrap().points.clear()),
        ("region", |state| state.redo.as_mut().unwrap().points.push(999_999)),
        ("region", |state| state.redo.as_mut().unwrap().points.reverse()),
        ("region", |state| state.redo.as_mut().unwrap().scale = 9),
        ("region", |state| state.redo.as_mut().unwrap().class = 5),
    ];
    for (words, spoil) in breaks {
        let mut state = good.clone();
        spoil(&mut state);
        let error = NetworkRun::resume(state, GENEROUS).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

/// Needs a Vulkan adapter, as the tests of the engine do.
#[test]
fn pins_and_regions_hold_on_a_device() {
    let gpu = pollster::block_on(Gpu::open(OpenOptions::default())).expect("this test needs a Vulkan adapter");
    let parameters = Parameters {
        channels: 4,
        grid_min: 16,
        grid_max: 16,
        expansion_x: 1.0,
        expansion_y: 1.0,
        iterations_coarse: 2,
        iterations_fine: 2,
        iterations_polish: 1,
        restarts: 0,
        ..small(Boundary::Open, 5)
    };
    let mut run = start("rings", parameters);
    run.use_gpu(Some(gpu), GENEROUS);
    let places = [DVec2::new(0.3, 0.3), DVec2::new(0.31, 0.3)];
    let before = run.points().to_vec();
    run.move_points(&[2, 9], &places).unwrap();
    run.run(1).unwrap();
    run.pin(&[20], true).unwrap();
    let held = run.points()[20];
    finish(&mut run);
    assert!(run.gpu().is_some(), "it stayed on the device");
    assert_eq!([run.points()[2], run.points()[9], run.points()[20]], [places[0], places[1], held]);
    assert_eq!(changed(&before, run.points()).len(), before.len());
    let before = run.points().to_vec();
    run.redo_region(&rectangle([0.0, 0.0], [0.5, 1.0])).unwrap();
    finish(&mut run);
    assert!(run.gpu().is_some());
    let moved = changed(&before, run.points());
    let chosen: Vec<usize> =
        (0..before.len()).filter(|&point| before[point].x < 0.5 && ![2, 9, 20].contains(&point)).collect();
    assert_eq!(moved, chosen);
}
