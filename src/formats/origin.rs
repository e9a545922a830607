//! How a file named and placed what its pattern holds: what it takes to write a result in the words and coordinates of the
//! file it came from.

use glam::DVec2;
use serde::{Deserialize, Serialize};

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
