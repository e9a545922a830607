//! The point pattern: positions, classes, named attributes and the domain they live in.
//!
//! A [`PointPattern`] can't hold an invalid value: every position is finite and inside the domain, every class index
//! names a class, every attribute has one finite value a point, and every count is below its cap.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::domain::{Boundary, Domain};
use super::error::PatternError;
use super::window::Window;
use crate::sorting;

/// Most points a pattern may hold; the page still draws this many smoothly.
pub const MAX_POINTS: usize = 20_000;
/// Most classes a pattern may hold.
pub const MAX_CLASSES: usize = 16;
/// Most attributes a pattern may hold.
pub const MAX_ATTRIBUTES: usize = 8;
/// Longest name of a class or an attribute, in characters.
pub const MAX_NAME_LENGTH: usize = 64;

/// The attribute that, when a pattern has it, gives every disk its radius in the pattern's own unit.
pub const RADIUS_ATTRIBUTE: &str = "radius";
/// The attribute that, when a pattern has it, turns every glyph: degrees, counter-clockwise as one sees it, 0 to the
/// right. 90 points up, towards smaller y, for y points down.
pub const ORIENTATION_ATTRIBUTE: &str = "orientation";
/// The attribute that, without a radius, makes glyphs larger or smaller: in any unit, drawn against its mean.
pub const SCALE_ATTRIBUTE: &str = "scale";
/// The attribute that says what stands before what: the distance from the eye, in any unit. What is deeper is drawn
/// first, so the smallest depth is the front.
pub const DEPTH_ATTRIBUTE: &str = "depth";

/// What an attribute's values mean, as far as its name says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// `radius` and `scale`: a size, 0 or more.
    Size,
    /// `orientation`: an angle in degrees, the same every 360.
    Angle,
    /// Anything else.
    Other,
}

/// A named number that every point carries, in its own unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Attribute {
    /// What it is called in files and on the page.
    pub name: String,
    /// One value a point.
    pub values: Vec<f64>,
}

impl Attribute {
    /// What the values mean, by the name; upper and lower case are one.
    #[must_use]
    pub fn meaning(&self) -> Meaning {
        let is = |name: &str| self.name.trim().eq_ignore_ascii_case(name);
        if is("radius") || is("scale") {
            Meaning::Size
        } else if is("orientation") {
            Meaning::Angle
        } else {
            Meaning::Other
        }
    }

    /// The first value that the name does not allow, and whose point it is: a size below 0.
    #[must_use]
    pub fn misfit(&self) -> Option<(usize, f64)> {
        let sized = self.meaning() == Meaning::Size;
        self.values.iter().copied().enumerate().find(|&(_, value)| sized && value < 0.0)
    }

    /// The least and the largest value.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        let values = || self.values.iter().copied();
        (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
    }
}

/// Positions with classes and attributes in a rectangle. See the module's words on what it can't hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawPattern", into = "RawPattern")]
pub struct PointPattern {
    domain: Domain,
    boundary: Boundary,
    positions: Vec<DVec2>,
    classes: Vec<u16>,
    class_names: Vec<String>,
    attributes: Vec<Attribute>,
}

/// The serialised form of [`PointPattern`], checked on the way in.
#[derive(Serialize, Deserialize)]
pub(crate) struct RawPattern {
    /// Files may leave it out, to be found from the points.
    #[serde(default)]
    pub(crate) domain: Option<Domain>,
    #[serde(default)]
    boundary: Boundary,
    pub(crate) positions: Vec<[f64; 2]>,
    #[serde(default)]
    classes: Vec<u16>,
    #[serde(default)]
    class_names: Vec<String>,
    #[serde(default)]
    attributes: Vec<Attribute>,
}

impl TryFrom<RawPattern> for PointPattern {
    type Error = PatternError;
    fn try_from(raw: RawPattern) -> Result<Self, PatternError> {
        let positions = raw.positions.into_iter().map(DVec2::from).collect();
        let domain = raw.domain.ok_or(PatternError::NoDomain)?;
        let mut pattern = Self::new(domain, positions)?.with_boundary(raw.boundary);
        if !raw.class_names.is_empty() || !raw.classes.is_empty() {
            pattern = pattern.with_classes(raw.classes, raw.class_names)?;
        }
        for attribute in raw.attributes {
            pattern = pattern.with_attribute(attribute)?;
        }
        Ok(pattern)
    }
}

impl From<PointPattern> for RawPattern {
    fn from(pattern: PointPattern) -> Self {
        Self {
            domain: Some(pattern.domain),
            boundary: pattern.boundary,
            positions: pattern.positions.into_iter().map(Into::into).collect(),
            classes: pattern.classes,
            class_names: pattern.class_names,
            attributes: pattern.attributes,
        }
    }
}

pub(crate) fn check_name(name: &str) -> Result<(), PatternError> {
    let refuse = |reason| Err(PatternError::Name { name: name.to_owned(), reason });
    if name.trim().is_empty() {
        return refuse("it is empty");
    }
    if name.chars().count() > MAX_NAME_LENGTH {
        return refuse("it is longer than 64 characters");
    }
    if name.chars().any(char::is_control) {
        return refuse("it holds a control character");
    }
    Ok(())
}

impl PointPattern {
    /// A pattern of one class, named `points`, without attributes, in an open domain.
    ///
    /// # Errors
    /// When there are no points, more than [`MAX_POINTS`], or one that is not finite or lies outside `domain`.
    pub fn new(domain: Domain, positions: Vec<DVec2>) -> Result<Self, PatternError> {
        if positions.is_empty() {
            return Err(PatternError::Empty);
        }
        if positions.len() > MAX_POINTS {
            return Err(PatternError::TooMany { what: "points", count: positions.len(), max: MAX_POINTS });
        }
        for (index, point) in positions.iter().enumerate() {
            for (axis, value) in [("x", point.x), ("y", point.y)] {
                if !value.is_finite() {
                    return Err(PatternError::NotFinite { index, axis: axis.to_owned(), value });
                }
            }
            if !domain.contains(*point) {
                return Err(PatternError::Outside {
                    index,
                    at: (*point).into(),
                    min: domain.min().into(),
                    max: domain.max().into(),
                });
            }
        }
        let classes = vec![0; positions.len()];
        Ok(Self {
            domain,
            boundary: Boundary::Open,
            positions,
            classes,
            class_names: vec!["points".to_owned()],
            attributes: Vec::new(),
        })
    }

    /// The same pattern, said to be a window (`Open`) or one tile of a torus (`Periodic`).
    #[must_use]
    pub fn with_boundary(mut self, boundary: Boundary) -> Self {
        self.boundary = boundary;
        self
    }

    /// The same points with a class each; `class_names[classes[i]]` is the class of point `i`.
    ///
    /// # Errors
    /// When the lengths differ, an index has no name, a name can't be used, or there are over [`MAX_CLASSES`].
    pub fn with_classes(mut self, classes: Vec<u16>, class_names: Vec<String>) -> Result<Self, PatternError> {
        if class_names.len() > MAX_CLASSES {
            return Err(PatternError::TooMany { what: "classes", count: class_names.len(), max: MAX_CLASSES });
        }
        if classes.len() != self.len() {
            return Err(PatternError::Length { what: "classes".to_owned(), count: classes.len(), points: self.len() });
        }
        for (position, name) in class_names.iter().enumerate() {
            check_name(name)?;
            if class_names[..position].contains(name) {
                return Err(PatternError::Name { name: name.clone(), reason: "another class has it already" });
            }
        }
        if let Some((index, &class)) =
            classes.iter().enumerate().find(|&(_, &class)| usize::from(class) >= class_names.len())
        {
            return Err(PatternError::Class { index, class: class.into(), classes: class_names.len() });
        }
        self.classes = classes;
        self.class_names = class_names;
        Ok(self)
    }

    /// The same points with one more attribute.
    ///
    /// # Errors
    /// When the length differs, a value is not finite, a radius or scale is negative, the name can't be used, or there
    /// are over [`MAX_ATTRIBUTES`].
    pub fn with_attribute(mut self, attribute: Attribute) -> Result<Self, PatternError> {
        if self.attributes.len() >= MAX_ATTRIBUTES {
            return Err(PatternError::TooMany {
                what: "attributes",
                count: self.attributes.len() + 1,
                max: MAX_ATTRIBUTES,
            });
        }
        check_name(&attribute.name)?;
        if self.attributes.iter().any(|other| other.name == attribute.name) {
            return Err(PatternError::Name { name: attribute.name, reason: "another attribute has it already" });
        }
        if attribute.values.len() != self.len() {
            return Err(PatternError::Length {
                what: attribute.name,
                count: attribute.values.len(),
                points: self.len(),
            });
        }
        if let Some((index, &value)) = attribute.values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(PatternError::NotFinite { index, axis: attribute.name, value });
        }
        if let Some((index, value)) = attribute.misfit() {
            return Err(PatternError::Negative { index, name: attribute.name, value });
        }
        self.attributes.push(attribute);
        Ok(self)
    }

    /// What lies within a window, in the smallest rectangle around it, and how many points do not. A point that lies
    /// outside by no more than a millionth of the rectangle's longer side is on the outline.
    ///
    /// # Errors
    /// When no point lies within, or the rectangle can't be a domain.
    pub fn cut(&self, window: &Window) -> Result<(Self, usize), PatternError> {
        let (low, high) = window.bounds();
        let index = window.index();
        let slack = 1e-6 * (high - low).max_element();
        let kept: Vec<usize> = (0..self.len())
            .filter(|&i| index.contains(self.positions[i]) || window.clearance(&index, self.positions[i]) >= -slack)
            .collect();
        let positions: Vec<DVec2> = kept.iter().map(|&i| self.positions[i]).collect();
        let min = positions.iter().copied().fold(low, DVec2::min);
        let max = positions.iter().copied().fold(high, DVec2::max);
        let mut size = max - min;
        // Rounding must not leave the outermost points outside.
        let digit = min.abs().max(max.abs()) * f64::EPSILON;
        for _ in 0..4 {
            size += DVec2::select(max.cmpgt(min + size), digit, DVec2::ZERO);
        }
        let mut pattern = Self::new(Domain::new(min, size)?, positions)?
            .with_classes(kept.iter().map(|&i| self.classes[i]).collect(), self.class_names.clone())?;
        for attribute in &self.attributes {
            let values = kept.iter().map(|&i| attribute.values[i]).collect();
            pattern = pattern.with_attribute(Attribute { name: attribute.name.clone(), values })?;
        }
        Ok((pattern, self.len() - kept.len()))
    }

    /// How many points there are; at least 1.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a pattern is never empty")]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// The rectangle the points live in, in their own unit.
    #[must_use]
    pub fn domain(&self) -> Domain {
        self.domain
    }

    /// Whether the pattern is a window or a tile.
    #[must_use]
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// Positions in the pattern's own unit.
    #[must_use]
    pub fn positions(&self) -> &[DVec2] {
        &self.positions
    }

    /// Class index of every point.
    #[must_use]
    pub fn classes(&self) -> &[u16] {
        &self.classes
    }

    /// Names of the classes, at least one.
    #[must_use]
    pub fn class_names(&self) -> &[String] {
        &self.class_names
    }

    /// The named attributes, perhaps none.
    #[must_use]
    pub fn attributes(&self) -> &[Attribute] {
        &self.attributes
    }

    /// Radii of the disks that the points stand for: the attribute `radius`, if there is one, divided by a unit of
    /// length. Nothing but finite numbers, but perhaps negative ones.
    #[must_use]
    pub fn radii_in(&self, unit: f64) -> Option<Vec<f64>> {
        let radius = self.attributes.iter().find(|attribute| attribute.name.trim().eq_ignore_ascii_case("radius"))?;
        Some(radius.values.iter().map(|value| value / unit).collect())
    }

    /// Positions in exemplar units, relative to the domain's lower corner: the longer side is 1.
    #[must_use]
    pub fn positions_in_exemplar_units(&self) -> Vec<DVec2> {
        let unit = self.domain.exemplar_unit();
        self.positions.iter().map(|&point| (point - self.domain.min()) / unit).collect()
    }

    /// Clark & Evans's (1954) index of aggregation: the mean spacing over that of as many independent points. Below 1
    /// points cluster, above 1 they keep apart. `None` where [`Self::mean_spacing`] is.
    #[must_use]
    pub fn aggregation_index(&self) -> Option<f64> {
        let size = self.domain.size_in_exemplar_units();
        let density = self.len() as f64 / (size.x * size.y);
        self.mean_spacing().map(|spacing| 2.0 * spacing * density.sqrt())
    }

    /// Mean distance from a point to its nearest neighbour, all classes together, in exemplar units: the method's d
    /// (Huang et al. 2022, §4). `None` when no point has a neighbour at a positive distance.
    ///
    /// Exact duplicates are left out of the mean, so that a doubled point does not shrink every scale.
    #[must_use]
    pub fn mean_spacing(&self) -> Option<f64> {
        let period = (self.boundary == Boundary::Periodic).then(|| self.domain.size_in_exemplar_units());
        mean_nearest_distance(&self.positions_in_exemplar_units(), period)
    }
}

/// Mean of the positive distances to the nearest other point, on a torus of size `period` when there is one.
///
/// Walks outwards from every point in the order of the axis along which the points spread most, and stops where that
/// axis alone is farther than the nearest point so far.
pub(crate) fn mean_nearest_distance(points: &[DVec2], period: Option<DVec2>) -> Option<f64> {
    let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    let axis = usize::from((high - low).y > (high - low).x);
    let across = sorting::order(points.iter().map(|point| point[1 - axis]));
    let along = sorting::order(across.iter().map(|&i| points[i][axis]));
    let order: Vec<usize> = along.into_iter().map(|rank| across[rank]).collect();

    // Points in one place have one distance. Without this a walk would pass all of them before it comes to another place.
    let same = |a: usize, b: usize| points[a] == points[b];
    let first: Vec<usize> = {
        let mut first: Vec<usize> = (0..points.len()).collect();
        order.windows(2).filter(|pair| same(pair[0], pair[1])).for_each(|pair| first[pair[1]] = first[pair[0]]);
        first
    };
    let order: Vec<usize> = order.into_iter().filter(|&i| first[i] == i).collect();
    let mut nearest = vec![f64::INFINITY; points.len()];
    for (rank, &i) in order.iter().enumerate() {
        // `gap` is how far the walk has come along the axis, around the torus where it wraps.
        let mut visit = |j: usize, wrapped: bool| -> bool {
            let mut offset = (points[i] - points[j]).abs();
            let gap = match period {
                Some(period) if wrapped => period[axis] - offset[axis],
                _ => offset[axis],
            };
            if let Some(period) = period {
                offset = offset.min(period - offset);
            }
            let distance = offset.length_squared();
            if distance > 0.0 && distance < nearest[i] {
                nearest[i] = distance;
            }
            gap * gap < nearest[i]
        };
        let up = order[rank + 1..].iter().map(|&j| (j, false));
        let around = order[..rank].iter().map(|&j| (j, true)).take_while(|_| period.is_some());
        for (j, wrapped) in up.chain(around) {
            if !visit(j, wrapped) {
                break;
            }
        }
        let down = order[..rank].iter().rev().map(|&j| (j, false));
        let around = order[rank + 1..].iter().rev().map(|&j| (j, true)).take_while(|_| period.is_some());
        for (j, wrapped) in down.chain(around) {
            if !visit(j, wrapped) {
                break;
            }
        }
    }

    // Summed in the order of the points, so that the order of the walk can't change the last digit.
    let (sum, count) = first
        .iter()
        .map(|&i| nearest[i])
        .filter(|distance| distance.is_finite())
        .fold((0.0, 0_usize), |(sum, count), distance| (sum + distance.sqrt(), count + 1));
    (count > 0).then(|| sum / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Purpose, Rng, white_noise};

    fn brute_force(points: &[DVec2], period: Option<DVec2>) -> Option<f64> {
        let (mut sum, mut count) = (0.0, 0);
        for (i, &a) in points.iter().enumerate() {
            let mut nearest = f64::INFINITY;
            for (j, &b) in points.iter().enumerate() {
                let mut offset = (a - b).abs();
                if let Some(period) = period {
                    offset = offset.min(period - offset);
                }
                let distance = offset.length_squared();
                if i != j && distance > 0.0 && distance < nearest {
                    nearest = distance;
                }
            }
            if nearest.is_finite() {
                sum += nearest.sqrt();
                count += 1;
            }
        }
        (count > 0).then(|| sum / f64::from(count))
    }

    /// Noise, a lattice with ties, a vertical line, a cluster with a far point, and duplicates.
    fn clouds() -> Vec<Vec<DVec2>> {
        let mut clouds = Vec::new();
        for seed in 0..20 {
            let mut rng = Rng::new(seed, Purpose::Gallery);
            let mut noise = white_noise(&mut rng, DVec2::new(1.0, 0.4), 3 + 11 * seed as usize);
            clouds.push(noise.clone());
            noise.extend_from_within(..noise.len() / 2);
            clouds.push(noise.clone());
            clouds.push(noise.iter().map(|point| DVec2::new(0.3, point.y)).collect());
            let mut cluster: Vec<_> = noise.iter().map(|point| *point * 1e-3).collect();
            cluster.push(DVec2::new(0.99, 0.39));
            clouds.push(cluster);
        }
        clouds.push((0..90).map(|i| DVec2::new(f64::from(i % 10) * 0.1, f64::from(i / 10) * 0.04)).collect());
        clouds.push(vec![DVec2::ZERO, DVec2::new(1.0, 0.4), DVec2::new(1.0, 0.0), DVec2::new(0.5, 0.2)]);
        clouds
    }

    #[test]
    fn mean_spacing_equals_brute_force() {
        for points in clouds() {
            for period in [None, Some(DVec2::new(1.0, 0.4))] {
                assert_eq!(
                    mean_nearest_distance(&points, period),
                    brute_force(&points, period),
                    "{points:?} {period:?}"
                );
            }
        }
    }

    #[test]
    fn mean_spacing_needs_two_places() {
        let here = DVec2::new(0.25, 0.5);
        assert_eq!(mean_nearest_distance(&[here], None), None);
        assert_eq!(mean_nearest_distance(&[here; 5], Some(DVec2::ONE)), None);
        assert_eq!(mean_nearest_distance(&[here, here, DVec2::new(0.75, 0.5)], None), Some(0.5));
    }

    #[test]
    fn mean_spacing_of_the_largest_pattern_is_quick() {
        let mut rng = Rng::new(1, Purpose::Gallery);
        let points = white_noise(&mut rng, DVec2::ONE, MAX_POINTS);
        let started = std::time::Instant::now();
        let spacing = mean_nearest_distance(&points, Some(DVec2::ONE)).unwrap_or_default();
        // Independent points: half of one over the square root of the density.
        assert!((spacing - 0.5 / (MAX_POINTS as f64).sqrt()).abs() < 2e-4, "{spacing}");
        assert!(started.elapsed().as_secs_f64() < 2.0, "{:?}", started.elapsed());
    }
}
