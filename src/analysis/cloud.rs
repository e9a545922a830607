//! Points as the statistics see them: a rectangle at the origin, one unit, class indices.

use std::sync::Arc;

use glam::DVec2;

use super::error::AnalysisError;
use super::neighbours::Neighbours;
use super::region::{Region, filled_part};
use crate::pattern::{Boundary, PointPattern, Window, mean_nearest_distance};
use crate::sampling::{Rng, white_noise, wrap};

/// A pair whose overlap is less than this share of the window tells nothing: its weight would be all noise.
const LEAST_OVERLAP: f64 = 0.05;

/// Points in `[0, size.x] × [0, size.y]`, at least one, in a unit of the caller's choice. A pattern and its exemplar
/// are compared in the exemplar's unit ([`Self::in_unit`]).
///
/// A periodic cloud stands for the infinite pattern its tile makes: neighbours and pairs reach across the border and
/// include a point's own images. So a tile and several copies of it side by side have the same statistics.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud {
    points: Vec<DVec2>,
    classes: Vec<u16>,
    class_count: usize,
    size: DVec2,
    boundary: Boundary,
    /// The part of the rectangle that points are looked for in; none is all of it.
    region: Option<Arc<Region>>,
}

impl Cloud {
    /// Points of a single class.
    ///
    /// # Errors
    /// When there are none, the rectangle has no area, or a point is not finite or lies outside.
    pub fn new(points: Vec<DVec2>, size: DVec2, boundary: Boundary) -> Result<Self, AnalysisError> {
        if !(size.is_finite() && size.min_element() > 0.0) {
            return Err(AnalysisError::Size { size: size.into() });
        }
        if points.is_empty() {
            return Err(AnalysisError::TooFewPoints { what: "a pattern", count: 0, needed: 1 });
        }
        // Dividing by the unit may carry a point on the border across it by a rounding.
        let slack = size * 1e-9;
        for (index, point) in points.iter().enumerate() {
            if !(point.is_finite() && point.cmpge(-slack).all() && point.cmple(size + slack).all()) {
                return Err(AnalysisError::Outside { index, at: (*point).into(), size: size.into() });
            }
        }
        let points: Vec<_> = points.into_iter().map(|point| settle(point, size, boundary)).collect();
        Ok(Self { classes: vec![0; points.len()], class_count: 1, points, size, boundary, region: None })
    }

    /// The same points with classes 0, 1, …; a class may be empty.
    ///
    /// # Errors
    /// When there is not one class a point.
    pub fn with_classes(mut self, classes: Vec<u16>) -> Result<Self, AnalysisError> {
        if classes.len() != self.points.len() {
            return Err(AnalysisError::Classes { count: classes.len(), points: self.points.len() });
        }
        self.class_count = classes.iter().map(|&class| usize::from(class) + 1).max().unwrap_or(1);
        self.classes = classes;
        Ok(self)
    }

    /// A pattern in its own exemplar units: its longer side is 1.
    #[must_use]
    pub fn of(pattern: &PointPattern) -> Self {
        let (size, boundary) = (pattern.domain().size_in_exemplar_units(), pattern.boundary());
        let points = pattern.positions_in_exemplar_units();
        Self {
            points: points.into_iter().map(|point| settle(point, size, boundary)).collect(),
            classes: pattern.classes().to_vec(),
            class_count: pattern.class_names().len(),
            size,
            boundary,
            region: None,
        }
    }

    /// A pattern in its own exemplar units, within a window in the pattern's unit; without one, within the part of the
    /// rectangle that the points fill, where the rest is emptier than chance leaves it. A tile has no window.
    ///
    /// # Errors
    /// As [`Self::within`], or when the boundary is periodic and there is a window.
    pub fn of_part(pattern: &PointPattern, window: Option<&Window>) -> Result<Self, AnalysisError> {
        let cloud = Self::of(pattern);
        let Some(window) = window else { return Ok(cloud.within_filled_part()) };
        let refuse = |error: crate::PatternError| match error {
            crate::PatternError::Window { reason } => AnalysisError::Window { reason },
            other => AnalysisError::Window { reason: other.to_string() },
        };
        let window = window.clipped(pattern.domain()).map_err(refuse)?;
        cloud.within(window.in_exemplar_units(pattern.domain()).map_err(refuse)?)
    }

    /// The same points within a window in this cloud's unit: areas, what pairs count for, holes and simulated points are
    /// those of the window.
    ///
    /// # Errors
    /// When the cloud is a tile, the window fills less than a five-hundredth of the rectangle around it, or a point lies
    /// outside of it by more than a millionth of that rectangle's longer side.
    pub fn within(mut self, window: Window) -> Result<Self, AnalysisError> {
        let refuse = |reason: String| Err(AnalysisError::Window { reason });
        if self.boundary == Boundary::Periodic {
            return refuse("a tile has no border, so it is not seen through a window".to_owned());
        }
        let (low, high) = window.bounds();
        if window.area() * 500.0 < (high - low).x * (high - low).y {
            return refuse("it fills less than a five-hundredth of the rectangle around it".to_owned());
        }
        let region = Region::new(window, false);
        let outside = self.points.iter().filter(|&&point| region.excludes(point)).count();
        if outside > 0 {
            return refuse(format!("{outside} of {} points lie outside of it", self.len()));
        }
        self.region = Some(Arc::new(region));
        Ok(self)
    }

    /// The same points within the convex part of the rectangle that they fill, where the rest is emptier than chance
    /// leaves it; else unchanged.
    #[must_use]
    pub fn within_filled_part(mut self) -> Self {
        self.region = filled_part(&self).map(|window| Arc::new(Region::new(window, true)));
        self
    }

    /// The window, prepared.
    pub(super) fn region(&self) -> Option<&Region> {
        self.region.as_deref()
    }

    /// As many independent points in the same rectangle or window, of one class.
    pub(super) fn independent(&self, rng: &mut Rng) -> Self {
        let points = match &self.region {
            Some(region) => region.white_noise(rng, self.len()),
            None => white_noise(rng, self.size, self.len()),
        };
        let points = points.into_iter().map(|point| settle(point, self.size, self.boundary)).collect();
        Self { points, classes: vec![0; self.len()], class_count: 1, region: self.region.clone(), ..*self }
    }

    /// A pattern in another unit of length, given in the pattern's own: an output in the exemplar units of its
    /// exemplar is `Cloud::in_unit(output, exemplar.domain().exemplar_unit())`.
    ///
    /// # Errors
    /// When the unit is not a positive finite number.
    pub fn in_unit(pattern: &PointPattern, unit: f64) -> Result<Self, AnalysisError> {
        check_positive("unit", unit)?;
        let domain = pattern.domain();
        let points = pattern.positions().iter().map(|&point| (point - domain.min()) / unit).collect();
        let mut cloud = Self::new(points, domain.size() / unit, pattern.boundary())?;
        cloud.classes = pattern.classes().to_vec();
        cloud.class_count = pattern.class_names().len();
        Ok(cloud)
    }

    /// How many points there are; at least 1.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a cloud is never empty")]
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// The positions.
    #[must_use]
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// Class index of every point.
    #[must_use]
    pub fn classes(&self) -> &[u16] {
        &self.classes
    }

    /// How many classes there may be; some can be empty.
    #[must_use]
    pub fn class_count(&self) -> usize {
        self.class_count
    }

    /// How many points each class has.
    #[must_use]
    pub fn class_sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.class_count];
        for &class in &self.classes {
            if let Some(size) = sizes.get_mut(usize::from(class)) {
                *size += 1;
            }
        }
        sizes
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.size
    }

    /// Whether the rectangle is a window or a tile.
    #[must_use]
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// Width times height, or the area of the window.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.region.as_ref().map_or(self.size.x * self.size.y, |region| region.area())
    }

    /// The shorter side of the rectangle, or of the one around the window.
    pub(super) fn shorter_side(&self) -> f64 {
        self.region.as_ref().map_or(self.size, |region| region.size()).min_element()
    }

    /// Points per unit of area.
    #[must_use]
    pub fn density(&self) -> f64 {
        self.len() as f64 / self.area()
    }

    /// Mean distance to the nearest neighbour, as [`PointPattern::mean_spacing`] but in this cloud's unit.
    #[must_use]
    pub fn mean_spacing(&self) -> Option<f64> {
        let period = (self.boundary == Boundary::Periodic).then_some(self.size);
        mean_nearest_distance(&self.points, period)
    }

    /// As [`Self::mean_spacing`], or why there is none.
    pub(super) fn spacing_for(&self, what: &'static str) -> Result<f64, AnalysisError> {
        self.at_least(what, 2)?;
        self.mean_spacing().ok_or(AnalysisError::NoSpacing { count: self.len() })
    }

    /// Refuses too few points.
    pub(super) fn at_least(&self, what: &'static str, needed: usize) -> Result<(), AnalysisError> {
        if self.len() < needed {
            return Err(AnalysisError::TooFewPoints { what, count: self.len(), needed });
        }
        Ok(())
    }

    /// Same points, other class numbers, `class_count` of them.
    pub(super) fn renumbered(mut self, class_count: usize, number: impl Fn(u16) -> u16) -> Self {
        for class in &mut self.classes {
            *class = number(*class);
        }
        self.class_count = class_count;
        self
    }

    /// Same points, other classes for them, one a point.
    pub(super) fn relabelled(mut self, classes: Vec<u16>) -> Self {
        self.classes = classes;
        self
    }

    /// The cells that find neighbours and pairs.
    #[must_use]
    pub fn neighbours(&self) -> Neighbours<'_> {
        Neighbours::new(self)
    }

    /// How far statistics of pairs may reach: three quarters of a window's shorter side. Beyond it hardly a pair fits
    /// into the window. A tile goes on for ever.
    pub(super) fn longest_reach(&self) -> f64 {
        match self.boundary {
            Boundary::Open => 0.75 * self.shorter_side(),
            Boundary::Periodic => f64::INFINITY,
        }
    }

    /// What a pair with this offset counts for: one over the area in which its first point can lie so that the second
    /// is in the window too (the translation correction of Ohser & Stoyan 1981). On a torus that is the whole area.
    pub(super) fn pair_weight(&self, offset: DVec2) -> f64 {
        match self.boundary {
            Boundary::Periodic => 1.0 / self.area(),
            Boundary::Open => {
                let overlap = match &self.region {
                    Some(region) => region.overlap(offset),
                    None => {
                        let sides = (self.size - offset.abs()).max(DVec2::ZERO);
                        sides.x * sides.y
                    }
                };
                1.0 / overlap.max(LEAST_OVERLAP * self.area())
            }
        }
    }

    /// The square of the density, as it enters the density of pairs.
    ///
    /// In a window a point has n − 1 others; a tile is one of many, and a point also meets its own images.
    pub(super) fn squared_density(&self) -> f64 {
        let n = self.len() as f64;
        let others = if self.boundary == Boundary::Open { n - 1.0 } else { n };
        n * others / (self.area() * self.area())
    }
}

/// Undoes what rounding may have done to a point on the border.
fn settle(point: DVec2, size: DVec2, boundary: Boundary) -> DVec2 {
    match boundary {
        Boundary::Open => point.clamp(DVec2::ZERO, size),
        Boundary::Periodic => wrap(point, size),
    }
}

/// Refuses lengths that are none.
pub(super) fn check_positive(name: &'static str, value: f64) -> Result<(), AnalysisError> {
    super::error::check(name, value, f64::MIN_POSITIVE, f64::MAX)
}
