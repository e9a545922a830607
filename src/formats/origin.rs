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

    /// About the middle of places in degrees. Places on both sides of the 180th meridian are taken across it.
    pub(super) fn of(positions: &[DVec2]) -> Self {
        let (low, high) = bounds(positions);
        let middle = (low + high) / 2.0;
        Self { longitude: wrapped(middle.x), latitude: middle.y.clamp(-90.0, 90.0) }
    }

    /// Of degrees about their middle; none where a plane can't hold them, or where they are no degrees. What was done is noted.
    pub(super) fn decide(positions: &[DVec2], keeps_degrees: bool) -> (Option<Self>, Option<Note>) {
        /// Beyond so many degrees a plane is wrong by tens of percent.
        const WIDEST: f64 = 20.0;
        /// From where on a note says how wrong a plane is.
        const WRONG: f64 = 0.01;
        if !are_on_earth(positions) {
            return (None, None);
        }
        let (low, high) = bounds(positions);
        let span = (high - low).max_element();
        let projection = Self::of(positions);
        let Self { longitude, latitude } = projection;
        let metres = projection.metres_a_degree();
        if span > WIDEST || metres.x < 1000.0 {
            let text = format!(
                "The coordinates span {span:.0} degrees, more than a plane can hold, and were taken as they are. If they are \
                 degrees, distances are wrong; project them first."
            );
            return (None, Some(Note::changed(text)));
        }
        let north = format!("{:.4}° {}", latitude.abs(), if latitude < 0.0 { "S" } else { "N" });
        let east = format!("{:.4}° {}", longitude.abs(), if longitude < 0.0 { "W" } else { "E" });
        if keeps_degrees {
            let text = format!(
                "Degrees were taken as they are, as if a degree of longitude were as long as one of latitude; at {north} it is \
                 {:.2} times as long.",
                metres.x / metres.y
            );
            return (None, Some(Note::changed(text)));
        }
        let mut text = format!(
            "Degrees of longitude and latitude became metres about {north}, {east}, so that distances are right in every \
             direction. --no-projection, or the choice in the import dialog, keeps degrees."
        );
        // A parallel's length goes with the cosine.
        let cosine = |latitude: f64| libm::cos(latitude.to_radians());
        let wrong =
            [low.y, high.y].map(|edge| (cosine(edge) / cosine(latitude) - 1.0).abs()).into_iter().fold(0.0, f64::max);
        if wrong > WRONG {
            text.push_str(&format!(
                " They span {span:.1} degrees, so distances from west to east are wrong by up to {:.0} % at the edges.",
                100.0 * wrong
            ));
        }
        (Some(projection), Some(Note::changed(text)))
    }

    /// The rectangle in metres of one in degrees: what lies in that lies in this.
    pub(super) fn project_domain(self, domain: Domain) -> Result<Domain, PatternError> {
        Domain::spanning(self.project(domain.min()), self.project(domain.max()))
    }

    /// Metres east and north of the place, of degrees.
    #[must_use]
    pub fn project(self, degrees: DVec2) -> DVec2 {
        let east = wrapped(degrees.x - self.longitude);
        DVec2::new(east, degrees.y - self.latitude) * self.metres_a_degree()
    }

    /// Degrees, of metres east and north of the place.
    #[must_use]
    pub fn unproject(self, metres: DVec2) -> DVec2 {
        let degrees = metres / self.metres_a_degree() + DVec2::new(self.longitude, self.latitude);
        DVec2::new(wrapped(degrees.x), degrees.y)
    }

    /// Whether it is one that [`Self::decide`] may have made.
    pub(super) fn is_usable(self) -> bool {
        self.longitude.abs() <= 180.0 && self.latitude.abs() <= 90.0 && self.metres_a_degree().x >= 1000.0
    }
}

/// Whether places may be degrees of longitude and latitude.
fn are_on_earth(positions: &[DVec2]) -> bool {
    positions.iter().all(|point| point.x.abs() <= 180.0 && point.y.abs() <= 90.0)
}

/// Whether places in degrees are nearer to each other across the 180th meridian than across the others.
fn cross_the_antimeridian(positions: &[DVec2]) -> bool {
    let span = |shift: fn(f64) -> f64| {
        let (low, high) = positions
            .iter()
            .map(|point| shift(point.x))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    let plain = span(|x| x);
    plain > 180.0 && span(eastwards) < plain
}

/// Longitudes from 0 to 360, for places on both sides of the 180th meridian.
fn eastwards(longitude: f64) -> f64 {
    if longitude < 0.0 { longitude + 360.0 } else { longitude }
}

/// The smallest and largest coordinates, across the 180th meridian where that is shorter.
fn bounds(positions: &[DVec2]) -> (DVec2, DVec2) {
    let crosses = cross_the_antimeridian(positions);
    let place = |point: &DVec2| if crosses { DVec2::new(eastwards(point.x), point.y) } else { *point };
    let low = positions.iter().map(place).fold(DVec2::INFINITY, DVec2::min);
    let high = positions.iter().map(place).fold(DVec2::NEG_INFINITY, DVec2::max);
    (low, high)
}

/// The same longitude, or difference of two, from -180 to 180; within that unchanged.
fn wrapped(degrees: f64) -> f64 {
    if degrees.abs() <= 180.0 { degrees } else { degrees - 360.0 * (degrees / 360.0).round() }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]
    use super::*;

    /// Lengths of a degree on WGS 84 as they are published, in kilometres: Wikipedia, "Latitude" and "Longitude".
    #[test]
    fn a_degree_is_as_long_as_on_the_ellipsoid() {
        for (latitude, east, north) in [
            (0.0, 111.320, 110.574),
            (15.0, 107.550, 110.649),
            (30.0, 96.486, 110.852),
            (45.0, 78.847, 111.132),
            (60.0, 55.800, 111.412),
            (75.0, 28.902, 111.618),
        ] {
            for sign in [1.0, -1.0] {
                let about = Projection { longitude: 12.0, latitude: sign * latitude };
                let degree = about.project(DVec2::new(13.0, sign * (latitude + 1.0))) / 1000.0;
                assert!((degree.x - east).abs() < 6e-4, "{latitude}: {degree} east");
                assert!((degree.y - sign * north).abs() < 6e-4, "{latitude}: {degree} north");
            }
        }
    }

    /// From Flinders Peak to Buninyong, the example of the Geocentric Datum of Australia's manual: 54972.271 m.
    #[test]
    fn a_geodesic_is_as_long_as_on_the_ellipsoid() {
        let degrees = |d: f64, m: f64, s: f64| d + m / 60.0 + s / 3600.0;
        let flinders = DVec2::new(degrees(144.0, 25.0, 29.5244), -degrees(37.0, 57.0, 3.7203));
        let buninyong = DVec2::new(degrees(143.0, 55.0, 35.3839), -degrees(37.0, 39.0, 10.1561));
        let about = Projection::of(&[flinders, buninyong]);
        let length = (about.project(flinders) - about.project(buninyong)).length();
        assert!((length / 54_972.271 - 1.0).abs() < 1e-4, "{length}");
    }

    #[test]
    fn degrees_come_back() {
        for (longitude, latitude) in [(10.7005, 60.0003), (-179.9999, -17.0), (180.0, 85.0), (0.0, 0.0)] {
            let about = Projection { longitude, latitude };
            for offset in [DVec2::ZERO, DVec2::new(0.01, -0.02), DVec2::new(-0.5, 0.3)] {
                let degrees = DVec2::new(wrapped(longitude + offset.x), latitude + offset.y);
                let back = about.unproject(about.project(degrees));
                assert!((back - degrees).abs().max_element() < 1e-12, "{degrees} {back}");
            }
        }
    }

    #[test]
    fn places_on_both_sides_of_the_antimeridian_are_neighbours() {
        let fiji = [DVec2::new(179.99, -17.0), DVec2::new(-179.99, -17.0), DVec2::new(179.995, -16.99)];
        let (projection, note) = Projection::decide(&fiji, false);
        let projection = projection.unwrap();
        assert!((projection.longitude.abs() - 180.0).abs() < 1e-9, "{projection:?}");
        let distance = (projection.project(fiji[0]) - projection.project(fiji[1])).length();
        assert!((distance - 2129.0).abs() < 2.0, "{distance}");
        assert!(note.unwrap().text.contains("became metres about 16.9950° S, 180.0000°"));
        let degrees = projection.unproject(projection.project(fiji[1]));
        assert!((degrees - fiji[1]).abs().max_element() < 1e-12);
    }

    #[test]
    fn a_plane_has_its_limits() {
        let norway = [DVec2::new(5.0, 58.0), DVec2::new(20.0, 70.0)];
        let (projection, note) = Projection::decide(&norway, false);
        assert!(projection.is_some() && note.unwrap().text.contains("wrong by up to 22 %"));
        let kept = Projection::decide(&norway, true);
        assert!(kept.0.is_none() && kept.1.unwrap().text.contains("0.44 times as long"));
        for places in [[DVec2::new(-90.0, 0.0), DVec2::new(90.0, 1.0)], [DVec2::new(1.0, 89.9), DVec2::new(2.0, 89.9)]]
        {
            let (projection, note) = Projection::decide(&places, false);
            assert!(projection.is_none() && note.unwrap().text.contains("more than a plane can hold"), "{places:?}");
        }
        assert_eq!(Projection::decide(&[DVec2::new(500_000.0, 60.0)], false), (None, None));
    }
}
