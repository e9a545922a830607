//! Numbers in plain words.

use super::{Analysis, Comparison, Defects, Quality, Summary};

/// More than this share of stacked points, beyond what the exemplar has itself, is worth a word.
const STACKED: f64 = 0.005;
/// A clump this much tighter than the exemplar's tightest is worth a word. Of independent points four times as many have,
/// by the same law as for holes, clumps up to about 1.7 times as tight.
const CLUMPS: f64 = 1.8;
/// A hole this many times as wide as the exemplar's widest is worth a word. A random pattern of four times the area
/// has, by the law of extremes, holes up to about 1.3 times as wide.
const HOLES: f64 = 1.4;
/// More than this share of points too many along the border is worth a word.
const BORDER: f64 = 0.015;

/// What a comparison says to a person, in two to four sentences: how good, where it is weakest, what is wrong, and
/// whether the two patterns fit together at all.
#[must_use]
pub fn verdict(comparison: &Comparison) -> String {
    Facts {
        quality: &comparison.quality,
        defects: &comparison.defects,
        density_ratio: comparison.density_ratio,
        exemplar_points: comparison.exemplar.points,
        nearest: [comparison.exemplar.nearest.first(), comparison.output.nearest.first()],
        border_excess: comparison.output.border.map(|border| border.excess),
        filled: comparison.filled,
    }
    .verdict()
}

/// What a verdict rests on.
pub(super) struct Facts<'a> {
    pub(super) quality: &'a Quality,
    pub(super) defects: &'a Defects,
    /// The output's density over the exemplar's.
    pub(super) density_ratio: f64,
    pub(super) exemplar_points: usize,
    /// Distances to the nearest neighbour, in the exemplar and in the output.
    pub(super) nearest: [Option<&'a Summary>; 2],
    /// Of the output, when it is a window; see [`BorderCrowd::excess`](super::BorderCrowd::excess).
    pub(super) border_excess: Option<f64>,
    /// Share of their rectangle that the exemplar's and the output's points fill, where that is only a part.
    pub(super) filled: [Option<f64>; 2],
}

impl Facts<'_> {
    pub(super) fn verdict(&self) -> String {
        let mut sentences = vec![overall(self), weakest(self), defects(self)];
        let ratio = self.density_ratio;
        if !(0.9..=1.1).contains(&ratio) {
            sentences.push(format!(
                "It is {} times as dense as the exemplar, so compare with care: are both in the same unit of length?",
                short(ratio)
            ));
        }
        let [exemplar, output] = self.filled.map(|share| share.map(percent));
        if let Some(share) = &exemplar {
            sentences.push(format!(
                "The exemplar's points fill a round or otherwise convex part of their rectangle, {share} of it{}. The \
                 empty rest counts as part of the pattern.",
                output.map_or_else(String::new, |share| format!(", the output's {share}"))
            ));
        }
        sentences.retain(|sentence| !sentence.is_empty());
        sentences.join(" ")
    }
}

/// Whether a random pattern is matched as well as one can ask for: by another sample, not by a copy. Samples of the
/// gallery's random entries score up to 0.11 below what is foretold, and up to 0.12 above.
fn is_another_sample(quality: &Quality) -> bool {
    quality.score >= quality.independent - 0.12
        && quality.precision >= quality.independent - 0.1
        && quality.pair_density >= 0.3
}

/// The output's mean distance to the nearest neighbour over the exemplar's, when chance does not explain that it is
/// not 1: three standard errors, and a percent.
fn other_spacing(facts: &Facts<'_>) -> Option<f64> {
    let [exemplar, output] = facts.nearest;
    let (exemplar, output) = (exemplar?, output?);
    // As if the output had no more points than the exemplar: spacings of neighbours are not independent.
    let error = exemplar.standard_deviation * (2.0 / facts.exemplar_points as f64).sqrt();
    let allowed = 3.0 * error + 0.01 * exemplar.mean;
    ((output.mean - exemplar.mean).abs() > allowed).then(|| output.mean / exemplar.mean)
}

fn overall(facts: &Facts<'_>) -> String {
    let quality = facts.quality;
    let words = match quality.score {
        score if score >= 0.9 => "The output is as good as a copy of the exemplar",
        score if score >= 0.7 => "The output reproduces the exemplar closely",
        _ if is_another_sample(quality) && other_spacing(facts).is_some() => {
            "The output is arranged like another sample of the same random process, but not spaced like one"
        }
        _ if is_another_sample(quality) => "The output is like another sample of the same random process",
        score if score >= 0.5 => "The output reproduces the exemplar, with flaws",
        score if score >= 0.25 => "The output has something of the exemplar, but much is missing",
        _ => "The output hardly resembles the exemplar more than chance does",
    };
    format!("{words}: quality {:.2}, where 0 is chance and 1 the exemplar tiled.", quality.score)
}

fn weakest(facts: &Facts<'_>) -> String {
    let quality = facts.quality;
    let own = quality.distances.neighbourhoods;
    let least = quality.pair_density.min(quality.precision).min(quality.coverage);
    if least >= 0.9 {
        return String::new();
    }
    if quality.score < 0.7 && is_another_sample(quality) {
        if let Some(ratio) = other_spacing(facts) {
            return format!(
                "Nearest neighbours lie at {} times the exemplar's distance on average, more off than chance explains.",
                short(ratio)
            );
        }
        return format!(
            "More would be a copy: the exemplar's own neighbourhoods resemble one another no better (score {:.2}).",
            quality.independent
        );
    }
    if least == quality.precision {
        format!(
            "Its weakest side is detail: a neighbourhood lies {:.2} mean spacings off the best match in the exemplar \
             (score {:.2}).",
            own.precision, quality.precision
        )
    } else if least == quality.coverage {
        format!(
            "Its weakest side is variety: a neighbourhood of the exemplar lies {:.2} mean spacings off the best match \
             in the output (score {:.2}).",
            own.coverage, quality.coverage
        )
    } else {
        format!(
            "Its weakest side is arrangement: offsets between points are not as frequent as in the exemplar (score \
             {:.2}).",
            quality.pair_density
        )
    }
}

fn defects(facts: &Facts<'_>) -> String {
    let defects = facts.defects;
    let crowded = facts.border_excess.is_some_and(|excess| excess > 0.0);
    let mut wrong = Vec::new();
    let stacked = defects.stacked - defects.exemplar_stacked;
    if stacked > STACKED {
        wrong.push(format!("{} of its points are stacked in pairs or clumps", percent(defects.stacked)));
    }
    if defects.clumps > CLUMPS {
        wrong.push(format!("its tightest clump is {} times as tight as the exemplar's", short(defects.clumps)));
    }
    if defects.holes > HOLES {
        wrong.push(format!("its largest hole is {} times as wide as the exemplar's", short(defects.holes)));
    }
    if let Some(border) = defects.border.filter(|&border| border > BORDER && crowded) {
        wrong.push(format!("{} too many points crowd along its border", percent(border)));
    }
    match wrong.split_last() {
        None => match defects.border {
            Some(_) => "No points are stacked, no hole is too wide, and the border is not crowded.".to_owned(),
            None => "No points are stacked, and no hole is too wide.".to_owned(),
        },
        Some((only, [])) => capitalised(&format!("{only}.")),
        Some((last, others)) => capitalised(&format!("{} and {last}.", others.join(", "))),
    }
}

/// What one pattern is like, in two or three sentences.
#[must_use]
pub fn describe(analysis: &Analysis) -> String {
    let mut sentences = Vec::new();
    if let Some(part) = &analysis.part {
        let share = percent(part.share);
        sentences.push(if part.found {
            format!(
                "The points fill a round or otherwise convex part of their rectangle, {share} of it: the statistics are \
                 those of that part."
            )
        } else {
            format!("The statistics are those of the window, {share} of the rectangle.")
        });
    }
    let index = analysis.aggregation_index.unwrap_or(0.0);
    let manner = match index {
        index if index >= 1.95 => "stand like a lattice",
        index if index >= 1.25 => "keep apart from one another",
        index if index > 0.85 => "are about as close to their neighbours as independent points",
        _ => "gather in groups",
    };
    sentences.push(format!(
        "The {} points {manner}: their mean spacing is {} times that of independent points.",
        analysis.points,
        short(index)
    ));
    if let Some(envelope) = &analysis.envelope {
        let (radius, value) = analysis
            .ripley
            .radius
            .iter()
            .zip(&analysis.ripley.l_minus_r)
            .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
            .map_or((0.0, 0.0), |(&radius, &value)| (radius, value));
        let spacing = analysis.spacing.unwrap_or(1.0);
        sentences.push(if envelope.p_value > 0.05 {
            format!("Ripley's L does not tell them from chance (p = {:.2}).", envelope.p_value)
        } else {
            format!(
                "Ripley's L tells them from chance (p = {:.2}), most at {} mean spacings, where points have too {} \
                 neighbours.",
                envelope.p_value,
                short(radius / spacing),
                if value < 0.0 { "few" } else { "many" }
            )
        });
    }
    sentences.push(format!("Their relative radius ρ is {:.3}.", analysis.relative_radius));
    sentences.join(" ")
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent < 9.95 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// Two or three digits that matter.
fn short(value: f64) -> String {
    if value.abs() < 9.995 { format!("{value:.2}") } else { format!("{value:.0}") }
}
