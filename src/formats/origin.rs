//! How a file named and placed what its pattern holds: what it takes to write a result in the words and coordinates of the
//! file it came from.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::Note;
use crate::pattern::{Domain, PatternError};

/// Words and coordinates of a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct Origin {
    /// What the columns x and y were called, units included; `None` where the file did not say.
    pub axes: Option<[String; 2]>,
    /// What the column or property of classes was called.
    pub class: Option<String>,
    /// Attributes (by name) whose columns were called something else, units included.
    pub attributes: Vec<(String, String)>,
    /// The unit of length, as in `µm`.
    pub unit: Option<String>,
    /// How degrees became metres.
    pub projection: Option<Projection>,
}

impl Origin {
    /// What the column of an attribute was called.
    #[must_use]
    pub fn header<'a>(&'a self, attribute: &'a str) -> &'a str {
        self.attributes.iter().find(|(name, _)| name == attribute).map_or(attribute, |(_, header)| header)
    }
}

/// Degrees of longitude and latitude on a plane that touches the ellipsoid of WGS 84 in one place, in metres from there.
///
/// Along the meridian a degree is M π/180 long, along the parallel N cos φ π/180, with the ellipsoid's radii of curvature
/// M and N at the place (Snyder 1987, Map Projections, equations 4-18 and 4-20). Lengths a hundred kilometres off are wrong by
/// about a percent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct Projection {
    /// Degrees east of Greenwich of the place.
    pub longitude: f64,
    /// Degrees north of the equator.
    pub latitude: f64,
}

impl Projection {
    /// Metres a degree, eastwards and northwards.
    fn metres_a_degree(self) -> DVec2 {
        // Of WGS 84.
        const SEMI_MAJOR_AXIS: f64 = 6_378_137.0;
        const FLATTENING: f64 = 1.0 / 298.257_223_563;
        let eccentricity = FLATTENING * (2.0 - FLATTENING);
        let (sine, cosine) = (libm::sin(self.latitude.to_radians()), libm::cos(self.latitude.to_radians()));
        let bend = 1.0 - eccentricity * sine * sine;
        let across = SEMI_MAJOR_AXIS / bend.sqrt();
        let along = across * (1.0 - eccentricity) / bend;
        DVec2::new(across * cosine, along) * (std::f64::consts::PI / 180.0)
    }

    /// Of degrees about their middle; none where a plane can't hold them, or where they are no degrees. What was done is noted.
    pub(super) fn decide(positions: &[DVec2], keeps_degrees: bool) -> (Option<Self>, Option<Note>) {
        /// Beyond so many degrees a plane is wrong by tens of percent.
        const WIDEST: f64 = 20.0;
        let low = positions.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = positions.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let is_on_earth = low.x >= -180.0 && high.x <= 180.0 && low.y >= -90.0 && high.y <= 90.0;
        let middle = (low + high) / 2.0;
        let span = (high - low).max_element();
        let projection = Self { longitude: middle.x, latitude: middle.y };
        if !is_on_earth {
            return (None, None);
        }
        if span > WIDEST || projection.metres_a_degree().x < 1000.0 {
            let text = format!(
                "The coordinates span {span:.0} degrees, more than a plane can hold, and were taken as they are. If they are \
                 degrees, distances are wrong; project them first."
            );
            return (None, Some(Note::changed(text)));
        }
        if keeps_degrees {
            let text = "Degrees were taken as they are, as if a degree of longitude were as long as one of latitude.";
            return (None, Some(Note::changed(text)));
        }
        let text = format!(
            "Degrees of longitude and latitude became metres about {:.4}° {}, {:.4}° {}, so that distances are right in every \
             direction. --no-projection, or the choice in the import dialog, keeps degrees.",
            middle.y.abs(),
            if middle.y < 0.0 { "S" } else { "N" },
            middle.x.abs(),
            if middle.x < 0.0 { "W" } else { "E" }
        );
        (Some(projection), Some(Note::changed(text)))
    }

    /// The rectangle in metres of one in degrees: what lies in that lies in this.
    pub(super) fn project_domain(self, domain: Domain) -> Result<Domain, PatternError> {
        Domain::spanning(self.project(domain.min()), self.project(domain.max()))
    }

    /// Metres east and north of the place, of degrees.
    #[must_use]
    pub fn project(self, degrees: DVec2) -> DVec2 {
        (degrees - DVec2::new(self.longitude, self.latitude)) * self.metres_a_degree()
    }

    /// Degrees, of metres east and north of the place.
    #[must_use]
    pub fn unproject(self, metres: DVec2) -> DVec2 {
        metres / self.metres_a_degree() + DVec2::new(self.longitude, self.latitude)
    }
}
