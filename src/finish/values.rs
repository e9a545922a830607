//! Which value goes where: exchanges of values between points that make neighbourhoods like the exemplar's.
//!
//! The paper deals the exemplar's values out at random (Huang et al. 2022, §4.5). Here points then exchange them. Every
//! point looks for the neighbourhood of the exemplar that is most like its own, by places and by values; that one says
//! which values its points should carry. Two points change places whenever both together come nearer to what is said of
//! them, and then all look again. The exemplar's values are thereby kept as they are, only dealt out otherwise.
//!
//! With E = Σ over points of the least difference to a neighbourhood of the exemplar: what is said bounds E from above
//! and meets it where it was said (Hunter & Lange 2004, *A tutorial on MM algorithms*), so that no exchange raises E.
//! It is the optimisation of Kwatra et al. (2005, *Texture optimization for example-based synthesis*) over an assignment.

use glam::DVec2;

use crate::analysis::{Cloud, NEIGHBOURHOOD, Neighbour};
use crate::pattern::{Meaning, PointPattern};
use crate::sampling::Rng;
use crate::sorting::order;

/// How many neighbourhoods of the exemplar a point chooses from: those whose places are most like its own.
const CANDIDATES: usize = 24;
/// Most pairs of neighbourhoods whose places are compared: a tenth of a second.
const MAX_PAIRS: usize = 1_000_000;
/// Most tries to exchange in one sweep.
const MAX_TRIES: usize = 2_000_000;
/// Weight of a squared distance of a mean spacing between places against one of a standard deviation between values:
/// places only decide where they tell one neighbourhood from another, so they may have the say.
const PLACES: f64 = 8.0;
/// Weight of a point's own value against that of one of its neighbours. With more, points cling to what they have.
const OWN: f64 = 0.3;

/// The exemplar's values made comparable: of each class every attribute has mean 0 and variance 1.
#[derive(Clone, Debug)]
pub struct Values {
    /// How many numbers a point has.
    width: usize,
    /// `[points, width]`.
    of: Vec<f64>,
}

impl Values {
    /// Those of an exemplar; none without attributes that vary within `class`.
    #[must_use]
    pub fn of(exemplar: &PointPattern, class: u16) -> Option<Self> {
        let classes = exemplar.classes();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for attribute in exemplar.attributes() {
            let values = &attribute.values;
            if attribute.meaning() == Meaning::Angle {
                // Degrees go round in a circle.
                columns.push(values.iter().map(|degrees| libm::cos(degrees.to_radians())).collect());
                columns.push(values.iter().map(|degrees| libm::sin(degrees.to_radians())).collect());
            } else {
                columns.push(values.clone());
            }
        }
        columns.retain_mut(|column| {
            let mut varies = false;
            for number in 0..exemplar.class_names().len() as u16 {
                let members =
                    || classes.iter().enumerate().filter(|&(_, &other)| other == number).map(|(point, _)| point);
                let count = members().count().max(1) as f64;
                let mean = members().map(|point| column[point]).sum::<f64>() / count;
                let deviation = (members().map(|point| (column[point] - mean).powi(2)).sum::<f64>() / count).sqrt();
                let known = deviation > 1e-9 * mean.abs();
                members()
                    .for_each(|point| column[point] = if known { (column[point] - mean) / deviation } else { 0.0 });
                varies |= known && number == class;
            }
            varies
        });
        let width = columns.len();
        let of = (0..exemplar.len()).flat_map(|point| columns.iter().map(move |column| column[point])).collect();
        (width > 0).then_some(Self { width, of })
    }

    fn at(&self, source: usize) -> &[f64] {
        &self.of[source * self.width..(source + 1) * self.width]
    }

    fn difference(&self, a: usize, b: usize) -> f64 {
        self.at(a).iter().zip(self.at(b)).map(|(a, b)| (a - b).powi(2)).sum()
    }
}

/// A neighbourhood of the exemplar that a point could have.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// Its middle.
    source: usize,
    /// Which of its points stands where each neighbour of the point does.
    partners: [usize; NEIGHBOURHOOD],
    /// How much the places differ.
    places: f64,
}

/// What stays while values are exchanged: neighbours, and the neighbourhoods they could be.
#[derive(Clone, Debug)]
pub struct Exchange<'a> {
    values: &'a Values,
    first: usize,
    neighbours: Vec<Vec<usize>>,
    candidates: Vec<Vec<Candidate>>,
}

impl<'a> Exchange<'a> {
    /// Looks up the neighbourhoods of the points of `first …` of `output` in `exemplar`, whose point `i` has the number
    /// `numbers[i]` in `values`; classes count. All points of `first …` are of one class.
    #[must_use]
    pub fn new(values: &'a Values, (exemplar, numbers): (&Cloud, &[usize]), output: &Cloud, first: usize) -> Self {
        let unit = exemplar.mean_spacing().unwrap_or(1.0);
        let class = output.classes().last().copied().unwrap_or(0);
        let grid = exemplar.neighbours();
        let mut found = Vec::new();
        let known: Vec<(usize, Vec<Neighbour>)> = (0..exemplar.len())
            .filter(|&point| exemplar.classes()[point] == class)
            .map(|point| {
                grid.nearest(exemplar.points()[point], NEIGHBOURHOOD + NEIGHBOURHOOD / 2, Some(point), &mut found);
                (point, found.clone())
            })
            .collect();
        let grid = output.neighbours();
        let stride = ((output.len() - first) * known.len()).div_ceil(MAX_PAIRS).max(1);
        let (mut neighbours, mut candidates) = (Vec::new(), Vec::new());
        for point in first..output.len() {
            grid.nearest(output.points()[point], NEIGHBOURHOOD, Some(point), &mut found);
            let options: Vec<Candidate> = known
                .iter()
                // Another part of them for each point.
                .skip(point % stride)
                .step_by(stride)
                .filter(|(_, theirs)| !theirs.is_empty())
                .map(|(source, theirs)| {
                    let mut option = Candidate { source: numbers[*source], partners: [0; NEIGHBOURHOOD], places: 0.0 };
                    for (partner, own) in option.partners.iter_mut().zip(&found) {
                        let gap = |other: &Neighbour| {
                            let same = output.classes()[own.index] == exemplar.classes()[other.index];
                            let gap: DVec2 = (own.offset - other.offset) / unit;
                            gap.length_squared() + if same { 0.0 } else { 1.0 }
                        };
                        let mut nearest = (f64::INFINITY, 0);
                        for other in theirs {
                            let gap = gap(other);
                            if gap < nearest.0 {
                                nearest = (gap, other.index);
                            }
                        }
                        option.places += PLACES * nearest.0.min(1.0);
                        *partner = numbers[nearest.1];
                    }
                    option
                })
                .collect();
            let best = order(options.iter().map(|option| option.places));
            candidates.push(best.into_iter().take(CANDIDATES).map(|place| options[place]).collect());
            neighbours.push(found.iter().map(|neighbour| neighbour.index).collect());
        }
        Self { values, first, neighbours, candidates }
    }

    /// The least difference of a point's neighbourhood to one of the exemplar's, and which.
    fn best(&self, place: usize, sources: &[usize]) -> (f64, Option<&Candidate>) {
        let mut best = (f64::INFINITY, None);
        for candidate in &self.candidates[place] {
            let mut sum =
                candidate.places + OWN * self.values.difference(candidate.source, sources[self.first + place]);
            for (&neighbour, &partner) in self.neighbours[place].iter().zip(&candidate.partners) {
                sum += self.values.difference(partner, sources[neighbour]);
            }
            if sum < best.0 {
                best = (sum, Some(candidate));
            }
        }
        best
    }

    /// E, the loss: the mean over the points of the least difference to a neighbourhood of the exemplar.
    #[must_use]
    pub fn loss(&self, sources: &[usize]) -> f64 {
        let sum: f64 =
            (0..self.candidates.len()).map(|place| self.best(place, sources).0).filter(|e| e.is_finite()).sum();
        sum / self.candidates.len().max(1) as f64
    }

    /// Lets the points of `first …` exchange their sources up to `sweeps` times over; `sources[i]` is the number in
    /// `values` of what point `i` carries.
    pub fn run(&self, sources: &mut [usize], sweeps: u32, rng: &mut Rng) {
        let (width, count) = (self.values.width, self.candidates.len());
        for _ in 0..sweeps {
            // What is said of each point: the weighted sum of values, and the weight.
            let mut said = vec![0.0; count * width];
            let mut weights = vec![0.0; count];
            let mut say = |point: usize, source: usize, weight: f64| {
                if let Some(place) = point.checked_sub(self.first) {
                    weights[place] += weight;
                    for (sum, value) in said[place * width..].iter_mut().zip(self.values.at(source)) {
                        *sum += weight * value;
                    }
                }
            };
            for place in 0..count {
                if let (_, Some(best)) = self.best(place, sources) {
                    say(self.first + place, best.source, OWN);
                    for (&neighbour, &partner) in self.neighbours[place].iter().zip(&best.partners) {
                        say(neighbour, partner, 1.0);
                    }
                }
            }
            // Σ weight · |value − said / weight|², as far as it depends on which value it is.
            let cost = |place: usize, source: usize| -> f64 {
                let said = &said[place * width..(place + 1) * width];
                let values = self.values.at(source).iter().zip(said);
                values.map(|(value, said)| value * (weights[place] * value - 2.0 * said)).sum()
            };
            let mut any = false;
            let tries = (MAX_TRIES / count.max(1)).clamp(1, count);
            for place in 0..count {
                for _ in 0..tries {
                    let other = rng.index(count);
                    let (own, theirs) = (sources[self.first + place], sources[self.first + other]);
                    let before = cost(place, own) + cost(other, theirs);
                    if cost(place, theirs) + cost(other, own) < before - 1e-9 {
                        sources.swap(self.first + place, self.first + other);
                        any = true;
                    }
                }
            }
            if !any {
                break;
            }
        }
    }
}
