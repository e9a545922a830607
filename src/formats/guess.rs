//! The domain of points that come without one.

use glam::DVec2;

use super::Note;
use super::error::FormatError;
use super::oddities::{about, empty_band};
use crate::pattern::{Domain, mean_nearest_distance};

/// A domain that was found from points.
#[derive(Debug)]
pub(super) struct Guess {
    pub(super) domain: Domain,
    /// Others that were possible, with a word for each.
    pub(super) choices: Vec<(&'static str, Domain)>,
    /// What a person should know of it.
    pub(super) notes: Vec<Note>,
}

/// What the choices are called.
const UNIT_SQUARE: &str = "unit square";
const BOX: &str = "the points' box";

impl Guess {
    /// Nothing was to be guessed.
    pub(super) fn told(domain: Domain) -> Self {
        Self { domain, choices: Vec::new(), notes: Vec::new() }
    }

    /// The unit square when all points lie in it and fill it; else the points' box, see [`box_of`]. They fill it when no
    /// strip along a side is empty that is wider than every hole between the points; see [`empty_band`].
    pub(super) fn of(positions: &[DVec2]) -> Result<Self, FormatError> {
        if !positions.iter().all(|&point| Domain::UNIT.contains(point)) {
            return box_of(positions).map(Self::told);
        }
        let unit = Self::told(Domain::UNIT);
        // Points on a line or in one place have no box, but may lie in the unit square.
        let Ok(domain) = box_of(positions) else { return Ok(unit) };
        let Some(band) = empty_band(positions, Domain::UNIT) else {
            let (low, high) = (domain.min(), domain.max());
            // Where only the border differs there is nothing to choose.
            let differs = low.max_element().max((1.0 - high).max_element()) > 0.1;
            return Ok(Self { choices: if differs { vec![(BOX, domain)] } else { Vec::new() }, ..unit });
        };
        let note = format!(
            "The domain is the points' box, {} × {}: all points lie in the unit square, but leave a strip of {} along its \
             {} side empty, wider than any hole between them. If the unit square was meant, choose it (as --domain \
             0,0,1,1, or in a line '# domain 0 0 1 1').",
            about(domain.size().x),
            about(domain.size().y),
            about(band.width),
            band.side
        );
        Ok(Self { domain, choices: vec![(UNIT_SQUARE, Domain::UNIT)], notes: vec![Note::changed(note)] })
    }
}

/// The bounding box grown on every side by half the mean distance between nearest neighbours: that much room the points at
/// the border share with neighbours that were cut off.
fn box_of(positions: &[DVec2]) -> Result<Domain, FormatError> {
    let low = positions.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = positions.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    let extent = high - low;
    let longest = extent.max_element();
    let refuse = |reason: &str| Err(FormatError::NoDomain { reason: reason.to_owned() });
    if longest == 0.0 {
        return refuse("all of them are at one place outside the unit square");
    }
    if !longest.is_finite() {
        return refuse("they lie farther apart than a double can tell");
    }
    // In units of the extent, so that squares of 1e200 or 1e-200 stay numbers.
    let scaled: Vec<DVec2> = positions.iter().map(|&point| (point - low) / longest).collect();
    let Some(spacing) = mean_nearest_distance(&scaled, None) else {
        return refuse("they have no mean distance");
    };
    let spacing = spacing * longest;
    let size = extent + spacing;
    Domain::holding(low - spacing / 2.0, size, [low, high]).map_err(|error| {
        let thin = size.min_element() * Domain::MAX_ASPECT < size.max_element();
        let cause = if thin { "they lie on a line, or nearly: " } else { "" };
        FormatError::NoDomain { reason: format!("{cause}{error}") }
    })
}
