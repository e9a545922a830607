//! What hands do to a result.

use glam::DVec2;

/// A change of the points by hand. Points are named by their ids; places are in exemplar units from the output's lower
/// corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// Points are held where they are, or let go.
    Pin {
        /// Which points.
        ids: Vec<u32>,
        /// Whether they are held from now on.
        pinned: bool,
    },
    /// Points are put elsewhere and held there.
    Move {
        /// Which points.
        ids: Vec<u32>,
        /// Where to, one place a point.
        places: Vec<DVec2>,
    },
    /// What lies in a polygon is erased and done again while everything else stays.
    RedoRegion {
        /// The polygon's corners; in a periodic output it may reach over the border.
        polygon: Vec<DVec2>,
    },
}
