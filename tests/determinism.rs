//! Same exemplar, parameters and seed: the same points, bit for bit, at any number of threads, in one go or saved and
//! continued; and what the limits refuse.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail loudly")]

use glam::DVec2;
use pointweave::analysis::Cloud;
use pointweave::finish::Limits;
use pointweave::methods::network::parameters::PointStart;
use pointweave::methods::network::{Best, NetworkError, NetworkRun, NetworkState, Parameters, Preset};
use pointweave::run::Event;
use pointweave::{Attribute, Boundary, Domain, PointPattern, gallery};

const GENEROUS: u64 = 4_000_000_000;

/// A run that takes well under a second: two scales, tiny grids, few channels; both tile sizes of the convolution
/// and several chunks of every stage occur.
fn small(boundary: Boundary, seed: u64) -> Parameters {
    Parameters {
        boundary,
        seed,
        channels: 12,
        scales: 2,
        grid_min: 40,
        grid_max: 48,
        iterations_coarse: 12,
        iterations_fine: 8,
        iterations_polish: 3,
        ..Parameters::preset(Preset::Fast)
    }
}

fn rings() -> PointPattern {
    gallery::find("rings").unwrap().exemplar()
}

fn run_all(exemplar: PointPattern, parameters: Parameters) -> (Vec<DVec2>, Vec<f64>) {
    let mut run = NetworkRun::new(exemplar, parameters, GENEROUS).unwrap();
    let mut losses = Vec::new();
    loop {
        match run.advance().unwrap() {
            Event::Finished => return (run.points().to_vec(), losses),
            Event::Iterated { losses: terms, .. } => losses.push(terms.total()),
            _ => {}
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for boundary in [Boundary::Open, Boundary::Periodic] {
        let with_threads = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| run_all(rings(), small(boundary, 5)))
        };
        let one = with_threads(1);
        assert_eq!(one.1.len(), 23);
        for threads in [2, 3, 7] {
            assert_eq!(one, with_threads(threads), "{threads} threads, {boundary:?}");
        }
        // Negative control: another seed does differ.
        assert_ne!(one.0, run_all(rings(), small(boundary, 6)).0);
    }
}

#[test]
fn repairs_follow_the_last_scales_only_where_asked_for() {
    // Points as the second scale finds them, and in the end.
    let run_with = |repair_scales: u32, spacing_floor: f64| {
        let parameters = Parameters {
            repair_scales,
            spacing_floor,
            start: PointStart::WhiteNoise,
            iterations_polish: 0,
            alignment: 0,
            transplants: 0,
            ..small(Boundary::Periodic, 5)
        };
        let mut run = NetworkRun::new(rings(), parameters, GENEROUS).unwrap();
        let mut between = None;
        loop {
            match run.advance().unwrap() {
                Event::Finished => return (between.unwrap(), run.points().to_vec()),
                Event::ScaleFinished { .. } if between.is_none() => between = Some(run.points().to_vec()),
                _ => {}
            }
        }
    };
    let closest = |points: &[DVec2]| {
        let cloud = Cloud::new(points.to_vec(), DVec2::splat(2.0), Boundary::Periodic).unwrap();
        Limits::of(&cloud).unwrap().distance
    };
    let (last, all, half, none) = (run_with(1, 1.0), run_with(0, 1.0), run_with(1, 0.5), run_with(0, 0.0));
    let wanted = Limits::of(&Cloud::of(&rings())).unwrap().distance;
    assert!(closest(&last.0) < 0.5 * wanted && closest(&last.1) > 0.99 * wanted);
    assert!(closest(&all.0) > 0.99 * wanted && closest(&all.1) > 0.99 * wanted);
    assert!(closest(&half.1) > 0.49 * wanted);
    // Without repairs between them the scales do not know of any.
    assert_eq!(last.0, half.0);
    assert_ne!(last.0, all.0);
    // Negative control: no floor at all.
    assert!(closest(&none.1) < 0.5 * wanted, "{} of {wanted}", closest(&none.1));
}

#[test]
fn a_saved_run_continues_as_if_never_stopped() {
    let (first, _) = run_all(rings(), small(Boundary::Periodic, 5));
    for restarts in [0, 2] {
        let parameters = Parameters { restarts, ..small(Boundary::Periodic, 5) };
        let (points, losses) = run_all(rings(), parameters.clone());
        // Negative control: other tries do lead elsewhere.
        assert_eq!(points == first, restarts == 0);
        // In the middle of each scale, at its end, before anything has happened, and in the last try.
        for stop in [0, 5, 12, 15, losses.len() as u64 - 2] {
            let mut run = NetworkRun::new(rings(), parameters.clone(), GENEROUS).unwrap();
            run.run(stop).unwrap();
            // Some of the next iteration is already done, and will be done again.
            if stop > 0 {
                for _ in 0..3 {
                    run.advance().unwrap();
                }
            }
            let text = serde_json::to_string(&run.state()).unwrap();
            let state: NetworkState = serde_json::from_str(&text).unwrap();
            let mut resumed = NetworkRun::resume(state, GENEROUS).unwrap();
            let mut rest = Vec::new();
            loop {
                match resumed.advance().unwrap() {
                    Event::Finished => break,
                    Event::Iterated { losses: terms, .. } => rest.push(terms.total()),
                    _ => {}
                }
            }
            assert_eq!(rest, losses[stop as usize..], "stopped after {stop}");
            assert_eq!(resumed.points(), points, "stopped after {stop}");
            // A finished run stays finished.
            let mut done = NetworkRun::resume(resumed.state(), GENEROUS).unwrap();
            assert_eq!(done.advance().unwrap(), Event::Finished);
            assert_eq!(done.points(), points);
        }
    }
}

#[test]
fn states_that_do_not_fit_together_are_refused() {
    let mut run = NetworkRun::new(rings(), small(Boundary::Open, 1), GENEROUS).unwrap();
    run.run(3).unwrap();
    let good = run.state();
    assert!(NetworkRun::resume(good.clone(), GENEROUS).is_ok());
    type Break = fn(&mut NetworkState);
    let breaks: [(&str, Break); 12] = [
        ("version", |s| s.version = 99),
        ("points", |s| s.points.truncate(5)),
        ("outside", |s| s.points[3] = DVec2::new(7.0, 0.5)),
        ("outside", |s| s.points[3].x = f64::NAN),
        ("scale", |s| s.scale = 40),
        ("try 1", |s| s.restart = 1),
        ("best points", |s| s.best = Some(Best { mismatch: 0.1, points: Vec::new(), sources: Vec::new() })),
        ("class", |s| s.class = 2),
        ("iterations", |s| s.iterations = 4000),
        ("losses", |s| s.losses.push(f64::NAN)),
        ("optimiser", |s| s.adam.first.truncate(1)),
        ("optimiser", |s| s.adam.second[0] = DVec2::splat(-1.0)),
    ];
    for (word, damage) in breaks {
        let mut state = good.clone();
        damage(&mut state);
        let error = NetworkRun::resume(state, GENEROUS).err().map(|e| e.to_string()).unwrap_or_default();
        assert!(error.contains(word), "{word}: {error:?}");
    }
}

#[test]
fn points_move_and_the_loss_falls() {
    for (boundary, start) in [(Boundary::Open, PointStart::PoissonDisk), (Boundary::Periodic, PointStart::WhiteNoise)] {
        let parameters = Parameters { start, iterations_coarse: 30, ..small(boundary, 3) };
        let before = NetworkRun::new(rings(), parameters.clone(), GENEROUS).unwrap().points().to_vec();
        let (after, losses) = run_all(rings(), parameters);
        assert_eq!(before.len(), 240, "60 points on four times the area");
        assert!(before.iter().zip(&after).all(|(a, b)| a != b), "every point has moved");
        assert!(after.iter().all(|p| p.x >= 0.0 && p.y >= 0.0 && p.x <= 2.0 && p.y <= 2.0));
        assert!(losses[29] < 0.6 * losses[0], "{} → {}", losses[0], losses[29]);
    }
}

#[test]
fn results_come_in_the_exemplar_s_own_unit_with_classes_and_attributes() {
    let domain = Domain::new(DVec2::new(-500.0, 1e6), DVec2::new(200.0, 100.0)).unwrap();
    let positions: Vec<DVec2> = (0..32)
        .map(|i| DVec2::new(-500.0 + 25.0 * f64::from(i % 8) + 3.0, 1e6 + 25.0 * f64::from(i / 8) + 7.0))
        .collect();
    let exemplar = PointPattern::new(domain, positions)
        .unwrap()
        .with_classes((0..32).map(|i| (i % 3) as u16).collect(), vec!["a".into(), "b".into(), "c".into()])
        .unwrap()
        .with_attribute(Attribute { name: "radius".into(), values: (0..32).map(f64::from).collect() })
        .unwrap();
    let parameters = Parameters {
        expansion_x: 1.5,
        expansion_y: 2.0,
        iterations_coarse: 2,
        iterations_fine: 1,
        ..small(Boundary::Open, 3)
    };
    let mut run = NetworkRun::new(exemplar.clone(), parameters, GENEROUS).unwrap();
    let mut classes_seen = Vec::new();
    loop {
        match run.advance().unwrap() {
            Event::Finished => break,
            Event::ScaleStarted { progress, .. } => classes_seen.push(progress.class),
            _ => {}
        }
    }
    assert_eq!(classes_seen, [0, 0, 0, 1, 1, 1, 2, 2, 2]);
    assert_eq!(run.progress().done, 1.0);
    let output = run.output().unwrap();
    assert_eq!(output.domain().min(), domain.min());
    assert_eq!(output.domain().size(), DVec2::new(300.0, 200.0));
    for class in 0..3_u16 {
        let count = |p: &PointPattern| p.classes().iter().filter(|&&c| c == class).count();
        assert_eq!(count(&output), 3 * count(&exemplar), "class {class} on three times the area");
    }
    // Every value of a class three times, and only within its class.
    let mut values: Vec<f64> = output.attributes()[0].values.clone();
    for (value, class) in values.iter().zip(output.classes()) {
        assert_eq!(*value as u16 % 3, *class);
    }
    values.sort_by(f64::total_cmp);
    assert_eq!(values, (0..96).map(|i| f64::from(i / 3)).collect::<Vec<_>>());
}

#[test]
fn what_does_not_fit_into_memory_is_refused_with_a_way_out() {
    let paper = Parameters { expansion_x: 8.0, expansion_y: 8.0, ..Parameters::preset(Preset::Paper) };
    let error = NetworkRun::new(rings(), paper, 600_000_000).unwrap_err();
    let NetworkError::Memory { needed_mb, limit_mb, lower } = &error else { panic!("{error}") };
    assert_eq!(*limit_mb, 600);
    assert!(*needed_mb > 3000, "{needed_mb}");
    assert!(lower.contains("expansion") && lower.contains("channels"), "{lower}");
    // The paper's own size fits.
    assert!(NetworkRun::new(rings(), Parameters::preset(Preset::Paper), 600_000_000).is_ok());
}

#[test]
fn exemplars_without_a_spacing_and_parameters_out_of_range_are_refused() {
    let words = |pattern: PointPattern, parameters: Parameters| {
        NetworkRun::new(pattern, parameters, GENEROUS).err().map(|e| e.to_string()).unwrap_or_default()
    };
    let one = PointPattern::new(Domain::UNIT, vec![DVec2::splat(0.5)]).unwrap();
    assert!(words(one, small(Boundary::Open, 1)).contains("two points"));
    let twice = PointPattern::new(Domain::UNIT, vec![DVec2::splat(0.5); 7]).unwrap();
    assert!(words(twice, small(Boundary::Open, 1)).contains("two points"));
    type Break = fn(&mut Parameters);
    let breaks: [(&str, Break); 6] = [
        ("'expansion-x' is 80", |p| p.expansion_x = 80.0),
        ("'channels' is 161", |p| p.channels = 161),
        ("'frequency' is NaN", |p| p.frequency = f64::NAN),
        ("'learning-rate-fine' is inf", |p| p.learning_rate_fine = f64::INFINITY),
        ("'grid-max' is 20", |p| p.grid_max = 20),
        ("'sigma-fine-divisor' is 0.2", |p| p.sigma_fine_divisor = 0.2),
    ];
    for (word, damage) in breaks {
        let mut parameters = small(Boundary::Open, 1);
        damage(&mut parameters);
        let error = words(rings(), parameters);
        assert!(error.contains(word), "{word}: {error}");
    }
}

#[test]
fn awkward_exemplars_work() {
    let line: Vec<DVec2> = (0..9).map(|i| DVec2::new(0.1 * f64::from(i) + 0.05, 0.5)).collect();
    let doubled: Vec<DVec2> = line.iter().chain(&line).copied().collect();
    let two = vec![DVec2::new(0.2, 0.2), DVec2::new(0.8, 0.7)];
    for (name, points) in [("collinear", line), ("doubled", doubled), ("two points", two)] {
        for boundary in [Boundary::Open, Boundary::Periodic] {
            let count = points.len();
            let exemplar = PointPattern::new(Domain::UNIT, points.clone()).unwrap();
            let parameters = Parameters { iterations_coarse: 3, iterations_fine: 2, ..small(boundary, 2) };
            let (points, losses) = run_all(exemplar, parameters);
            assert_eq!(points.len(), 4 * count, "{name}");
            assert!(points.iter().all(|p| p.is_finite()) && losses.iter().all(|l| l.is_finite()), "{name}");
        }
    }
}

#[test]
fn scales_at_which_a_lattice_is_flat_are_passed_over() {
    let scales_run = |name: &str| {
        let exemplar = gallery::find(name).unwrap().exemplar();
        let parameters = Parameters { scales: 3, grid_max: 80, ..small(exemplar.boundary(), 1) };
        let mut run = NetworkRun::new(exemplar, parameters, GENEROUS).unwrap();
        let mut scales: Vec<(usize, u32)> = Vec::new();
        loop {
            match run.advance().unwrap() {
                Event::Finished => return scales,
                Event::ScaleFinished { progress, .. } => scales.push((progress.scale, progress.iteration)),
                _ => {}
            }
        }
    };
    let lattice = scales_run("square-grid");
    assert_eq!(lattice.len(), 4);
    assert_eq!(lattice[0].1, 0, "a lattice blurred over more than its pitch is flat: {lattice:?}");
    assert_eq!(lattice[2].1, 12, "its last scale has the iterations of the first: {lattice:?}");
    let rings = scales_run("rings");
    assert_eq!(rings, [(0, 12), (1, 8), (2, 8), (3, 3)]);
}
