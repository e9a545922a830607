//! What stands for a point: shapes of equal weight, and what a person draws.

use thiserror::Error;

use super::outline::{Outline, OutlineError};
use super::svg::Px;

/// What a name must begin with to be path data.
const PATH: &str = "path:";

/// The shape of a point's mark. Where a point has a radius, a disk or ring has just that; the others have about the
/// area of such a disk, so that no class looks heavier than another. Turned by 0°, the arrow points right and the
/// others stand upright.
#[derive(Clone, Debug, PartialEq)]
pub enum Glyph {
    /// A filled circle.
    Disk,
    /// A circle.
    Ring,
    /// One of [`Polygon`]s.
    Polygon(&'static Polygon),
    /// Path data of a person.
    Path(Outline),
}

/// A built-in shape with straight sides.
#[derive(Debug, PartialEq)]
pub struct Polygon {
    /// What it is called.
    pub name: &'static str,
    /// Its corners; x to the right and y downwards, in radii of the disk with the same weight.
    pub corners: &'static [[f32; 2]],
}

static POLYGONS: [Polygon; 7] = [
    Polygon { name: "square", corners: &[[-0.89, -0.89], [0.89, -0.89], [0.89, 0.89], [-0.89, 0.89]] },
    Polygon { name: "triangle", corners: &[[0.0, -1.45], [1.26, 0.73], [-1.26, 0.73]] },
    Polygon { name: "diamond", corners: &[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]] },
    Polygon {
        name: "tree",
        corners: &[
            [0.0, -1.8],
            [0.8, -0.45],
            [0.5, -0.45],
            [1.15, 0.9],
            [0.22, 0.9],
            [0.22, 1.4],
            [-0.22, 1.4],
            [-0.22, 0.9],
            [-1.15, 0.9],
            [-0.5, -0.45],
            [-0.8, -0.45],
        ],
    },
    Polygon {
        name: "house",
        corners: &[
            [0.0, -1.45],
            [1.4, -0.2],
            [1.0, -0.2],
            [1.0, 0.92],
            [0.28, 0.92],
            [0.28, 0.15],
            [-0.28, 0.15],
            [-0.28, 0.92],
            [-1.0, 0.92],
            [-1.0, -0.2],
            [-1.4, -0.2],
        ],
    },
    Polygon {
        name: "star",
        corners: &[
            [0.0, -1.6],
            [0.44, -0.61],
            [1.52, -0.49],
            [0.71, 0.23],
            [0.94, 1.29],
            [0.0, 0.75],
            [-0.94, 1.29],
            [-0.71, 0.23],
            [-1.52, -0.49],
            [-0.44, -0.61],
        ],
    },
    Polygon { name: "arrow", corners: &[[1.8, 0.0], [-1.25, 1.1], [-0.65, 0.0], [-1.25, -1.1]] },
];

/// Why a glyph can't be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum GlyphError {
    /// No such shape.
    #[error("there is no glyph {name:?}; there are {}, and path:… with SVG path data", Glyph::names().join(", "))]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// The path can't be read.
    #[error(transparent)]
    Outline(#[from] OutlineError),
}

impl Glyph {
    /// All built-in shapes.
    #[must_use]
    pub fn all() -> Vec<Self> {
        [Self::Disk, Self::Ring].into_iter().chain(POLYGONS.iter().map(Self::Polygon)).collect()
    }

    /// Their names.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        Self::all().iter().map(Self::name).collect()
    }

    /// What it is called; `path` for a person's own.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Disk => "disk",
            Self::Ring => "ring",
            Self::Polygon(polygon) => polygon.name,
            Self::Path(_) => "path",
        }
    }

    /// The glyph of a name, or of `path:` and SVG path data.
    ///
    /// # Errors
    /// When there is none of that name, or the path is not one.
    pub fn from_name(name: &str) -> Result<Self, GlyphError> {
        if let Some(data) = name.strip_prefix(PATH) {
            return Ok(Self::Path(Outline::parse(data)?));
        }
        Self::built_in(name).ok_or_else(|| GlyphError::Unknown { name: name.to_owned() })
    }

    /// The same without the reader of paths, which the engine's module has no need of.
    pub(super) fn built_in(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|glyph| glyph.name() == name)
    }

    /// Its outline as path data in radii: absolute `M`, `L`, `C` and `Z`. Empty for disks and rings, which are circles.
    #[must_use]
    pub fn path_data(&self) -> String {
        match self {
            Self::Disk | Self::Ring => String::new(),
            Self::Path(outline) => outline.path_data(),
            Self::Polygon(polygon) => {
                let mut data = String::new();
                for [x, y] in polygon.corners {
                    data.push(if data.is_empty() { 'M' } else { 'L' });
                    data.push_str(&format!("{} {}", Px((*x).into()), Px((*y).into())));
                }
                data + "Z"
            }
        }
    }

    /// How far it reaches from its middle at most, in radii, however it is turned.
    pub(crate) fn reach(&self) -> f64 {
        match self {
            Self::Disk | Self::Ring => 1.0,
            _ => 1.9,
        }
    }
}
