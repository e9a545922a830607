//! The part of a domain that was looked at: an outline of straight lines, perhaps with holes.

use glam::DVec2;

use super::PatternError;

/// Most corners of an outline.
pub const MAX_CORNERS: usize = 10_000;

/// Where points could have been: what lies within an odd number of closed lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    rings: Vec<Vec<DVec2>>,
}

impl Window {
    /// A window from closed lines; a last corner that repeats the first is dropped.
    ///
    /// # Errors
    /// When there is no line, one has fewer than three corners, all together more than [`MAX_CORNERS`], a corner is not
    /// finite, or there is no area.
    pub fn new(rings: Vec<Vec<DVec2>>) -> Result<Self, PatternError> {
        let refuse = |reason: String| Err(PatternError::Window { reason });
        let mut rings = rings;
        let corners: usize = rings.iter().map(Vec::len).sum();
        if corners > MAX_CORNERS {
            return refuse(format!("it has {corners} corners; at most {MAX_CORNERS} are allowed"));
        }
        for ring in &mut rings {
            if ring.len() > 1 && ring.first() == ring.last() {
                ring.pop();
            }
            if ring.len() < 3 {
                return refuse(format!("an outline has {} corners; at least 3 are needed", ring.len()));
            }
            if let Some(corner) = ring.iter().find(|corner| !corner.is_finite()) {
                return refuse(format!("the corner ({}, {}) is not finite", corner.x, corner.y));
            }
        }
        if rings.is_empty() {
            return refuse("it has no outline".to_owned());
        }
        Ok(Self { rings })
    }

    /// The closed lines.
    #[must_use]
    pub fn rings(&self) -> &[Vec<DVec2>] {
        &self.rings
    }
}
