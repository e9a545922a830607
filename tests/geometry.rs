//! Where points were cut from, when no one says so: unit squares, boxes, disks; and what looks odd about them.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::TAU;
use std::fmt::Write as _;

use glam::DVec2;
use pointweave::analysis::{self, Analysis};
use pointweave::formats::{self, ReadOptions, Reading};
use pointweave::sampling::{Purpose, Rng, white_noise};
use pointweave::{Boundary, Domain, gallery};

fn read(points: &[DVec2]) -> Reading {
    let mut text = "x,y\n".to_owned();
    points.iter().for_each(|point| writeln!(text, "{},{}", point.x, point.y).unwrap());
    formats::open(text.as_bytes(), None, &ReadOptions::default()).unwrap()
}

fn noise(seed: u64, count: usize) -> Vec<DVec2> {
    white_noise(&mut Rng::new(seed, Purpose::Gallery), DVec2::ONE, count)
}

fn disk(seed: u64, count: usize) -> Vec<DVec2> {
    let mut rng = Rng::new(seed, Purpose::Gallery);
    let place = |_| {
        let (radius, angle) = (rng.uniform().sqrt(), TAU * rng.uniform());
        100.0 * radius * DVec2::new(libm::cos(angle), libm::sin(angle))
    };
    (0..count).map(place).collect()
}

fn claims_clustering(analysis: &Analysis) -> bool {
    let words = analysis::describe(analysis);
    words.contains("too many") || words.contains("gather")
}

#[test]
#[ignore = "prints rates"]
fn measure() {
    for entry in gallery::entries() {
        let (mut lost, mut odd, mut part) = (0, vec![], 0);
        for seed in 0..20 {
            let exemplar = entry.generate(seed);
            let pattern = read(exemplar.positions());
            let unit = exemplar.domain() == Domain::UNIT;
            lost += i32::from((pattern.pattern.domain() == Domain::UNIT) != unit);
            odd.extend(formats::oddities(&exemplar).into_iter().map(|n| n.text));
            odd.extend(formats::oddities(&pattern.pattern).into_iter().map(|n| format!("stripped {}", n.text)));
            if seed < 4 {
                part += i32::from(analysis::Cloud::of_part(&exemplar.clone().with_boundary(Boundary::Open), None).unwrap().area() != exemplar.domain().size_in_exemplar_units().x*exemplar.domain().size_in_exemplar_units().y);
            }
        }
        println!("{} {:?} n={}: wrong {lost}/20, part {part}/4, odd {} {:?}", entry.name, exemplar_size(entry), entry.exemplar().len(), odd.len(), odd.first());
    }
    for n in [2, 3, 4, 5, 8, 12, 20, 40, 150] {
        let reps = 2000;
        let (mut lost, mut odd) = (0, 0);
        for seed in 0..reps {
            let reading = read(&noise(seed, n));
            lost += i32::from(reading.pattern.domain() != Domain::UNIT);
            let o = formats::oddities(&reading.pattern);
            let few = usize::from(n < 16);
            odd += i32::from(o.len() > few);
            if o.len() > few && seed < 300 { println!("{:?}", o.last()); }
        }
        println!("noise {n}: lost {lost}/{reps} odd {odd}");
    }
    for n in [20, 40, 60, 80, 150, 400] {
        let (mut caught, mut claims, mut square, mut sc) = (0, 0, 0, 0);
        for seed in 0..200 {
            let d = Analysis::of_pattern(&read(&disk(seed, n)).pattern, 1).unwrap();
            caught += i32::from(d.part.is_some());
            claims += i32::from(claims_clustering(&d));
            let d = Analysis::of_pattern(&read(&noise(seed, n)).pattern, 1).unwrap();
            square += i32::from(d.part.is_some());
            sc += i32::from(claims_clustering(&d));
        }
        println!("n={n} disk caught {caught}/200 clustering {claims}/200; square taken for part {square}/200, clustering {sc}/200");
    }
}

fn exemplar_size(entry: &gallery::Entry) -> [f64; 2] {
    entry.exemplar().domain().size().into()
}
