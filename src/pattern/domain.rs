//! The rectangle a pattern lives in, and what happens at its border.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::error::PatternError;

/// What lies beyond the border of a domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Boundary {
    /// Nothing: the pattern is seen through a window.
    #[default]
    Open,
    /// The opposite side: the domain is a torus, and the pattern tiles.
    Periodic,
}

impl Boundary {
    /// The name used in files, links and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Periodic => "periodic",
        }
    }
}

/// An axis-aligned rectangle with finite corners and a positive, finite area.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawDomain", into = "RawDomain")]
pub struct Domain {
    min: DVec2,
    size: DVec2,
}

/// The serialised form of [`Domain`], checked on the way in.
#[derive(Serialize, Deserialize)]
struct RawDomain {
    min: [f64; 2],
    size: [f64; 2],
}

impl TryFrom<RawDomain> for Domain {
    type Error = PatternError;
    fn try_from(raw: RawDomain) -> Result<Self, PatternError> {
        Self::new(raw.min.into(), raw.size.into())
    }
}

impl From<Domain> for RawDomain {
    fn from(domain: Domain) -> Self {
        Self { min: domain.min.into(), size: domain.size.into() }
    }
}

impl Domain {
    /// The square `[0, 1] × [0, 1]`.
    pub const UNIT: Self = Self { min: DVec2::ZERO, size: DVec2::ONE };

    /// The longest side may be at most this many times the shortest: beyond it no sampling grid fits both sides.
    pub const MAX_ASPECT: f64 = 64.0;

    /// A rectangle from its lower corner and its size.
    ///
    /// # Errors
    /// [`PatternError::Domain`] when a number is not finite, a side is not positive, the sides differ by more than
    /// [`Self::MAX_ASPECT`], or the sides are too small to be told apart from the corner in double precision.
    pub fn new(min: DVec2, size: DVec2) -> Result<Self, PatternError> {
        let max = min + size;
        let refuse = |reason| Err(PatternError::Domain { min: min.into(), size: size.into(), reason });
        if !(min.is_finite() && size.is_finite() && max.is_finite()) {
            return refuse("every corner must be a finite number");
        }
        if size.min_element() <= 0.0 {
            return refuse("both sides must be greater than 0");
        }
        if size.max_element() / size.min_element() > Self::MAX_ASPECT {
            return refuse("the longer side must be at most 64 times the shorter one");
        }
        // A square-metre pattern stored at planetary offsets loses its digits: say so instead of collapsing points.
        let magnitude = min.abs().max(max.abs()).max_element();
        if size.min_element() < magnitude * 1e-12 {
            return refuse("the sides are too small against the coordinates to hold distinct positions");
        }
        Ok(Self { min, size })
    }

    /// The rectangle between two corners that holds both: where rounding would leave the upper one outside, its sides are a digit
    /// or two longer.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn spanning(low: DVec2, high: DVec2) -> Result<Self, PatternError> {
        Self::holding(low, high - low, [low, high])
    }

    /// The rectangle from its lower corner and its size, a digit or two of the coordinates longer where rounding would leave the
    /// upper one of two places outside.
    pub(crate) fn holding(min: DVec2, mut size: DVec2, [low, high]: [DVec2; 2]) -> Result<Self, PatternError> {
        let digit = low.abs().max(high.abs()) * f64::EPSILON;
        for _ in 0..4 {
            size += DVec2::select(high.cmpgt(min + size), digit, DVec2::ZERO);
        }
        Self::new(min, size)
    }

    /// The lower corner.
    #[must_use]
    pub fn min(&self) -> DVec2 {
        self.min
    }

    /// The upper corner.
    #[must_use]
    pub fn max(&self) -> DVec2 {
        self.min + self.size
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.size
    }

    /// Width times height.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.size.x * self.size.y
    }

    /// Whether `point` lies inside or on the border.
    #[must_use]
    pub fn contains(&self, point: DVec2) -> bool {
        let max = self.max();
        point.x >= self.min.x && point.y >= self.min.y && point.x <= max.x && point.y <= max.y
    }

    /// Length of one *exemplar unit* in this domain's own unit: the longer side, so that an exemplar's square has
    /// side 1 (the unit every σ, frequency and pixel pitch of the method is given in).
    #[must_use]
    pub fn exemplar_unit(&self) -> f64 {
        self.size.max_element()
    }

    /// Width and height in exemplar units; the longer one is 1.
    #[must_use]
    pub fn size_in_exemplar_units(&self) -> DVec2 {
        self.size / self.exemplar_unit()
    }
}

/// A point that stepped over the border comes back: on the other side of a periodic domain, mirrored in an open one.
/// (Clamping would line points up along the border.)
pub(crate) fn keep_inside(point: DVec2, size: DVec2, boundary: Boundary) -> DVec2 {
    let axis = |value: f64, side: f64| match boundary {
        Boundary::Periodic => {
            let wrapped = value.rem_euclid(side);
            // Rounding can give the side itself for a tiny negative value.
            if wrapped < side { wrapped } else { 0.0 }
        }
        Boundary::Open => {
            let folded = value.rem_euclid(2.0 * side);
            if folded > side { 2.0 * side - folded } else { folded }
        }
    };
    DVec2::new(axis(point.x, size.x), axis(point.y, size.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_that_leave_come_back_inside() {
        let size = DVec2::new(2.0, 1.0);
        let back = |x, y, boundary| keep_inside(DVec2::new(x, y), size, boundary);
        assert_eq!(back(2.25, -0.25, Boundary::Open), DVec2::new(1.75, 0.25));
        assert_eq!(back(2.25, -0.25, Boundary::Periodic), DVec2::new(0.25, 0.75));
        assert_eq!(back(1.5, 0.5, Boundary::Open), DVec2::new(1.5, 0.5));
        let tiny = back(-1e-300, 1.0, Boundary::Periodic);
        assert!(tiny.x < 2.0 && tiny.y < 1.0, "{tiny}");
    }
}
