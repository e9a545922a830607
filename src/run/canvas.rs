//! The result while it is made: points with ids that stay, whose values they carry, and which of them are held.
//!
//! Positions are in exemplar units from the output's lower corner. A point has an index, its place in the lists, and an
//! id. Indices may change when points come and go; an id belongs to its point for the whole run.

use glam::DVec2;
use thiserror::Error;

use crate::pattern::{Attribute, Boundary, Domain, PatternError, PointPattern, keep_inside};
use crate::sampling::Rng;

/// Darts thrown for one point that is to lie in a region, at most: a lasso may have no width to speak of.
const DARTS: usize = 2000;

/// Why points can't be touched.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CanvasError {
    /// An id that no point has.
    #[error("there is no point {id} among {count}")]
    NoPoint {
        /// The offending id.
        id: u32,
        /// How many points there are.
        count: usize,
    },
    /// A list of places that does not fit that of points.
    #[error("there are {places} places for {points} points")]
    Places {
        /// How many places were given.
        places: usize,
        /// How many points were named.
        points: usize,
    },
    /// A place beyond the border.
    #[error("({}, {}) lies outside the output, {} × {}", at[0], at[1], size[0], size[1])]
    Outside {
        /// The offending place, in exemplar units.
        at: [f64; 2],
        /// Width and height of the output, in exemplar units.
        size: [f64; 2],
    },
    /// A polygon that is none.
    #[error("a region needs three corners or more")]
    Polygon,
    /// A region without points that may move.
    #[error("there is no point in this region that may move")]
    EmptyRegion,
}

/// The points of a run and the rectangle they stand in. See the module's words on ids.
#[derive(Clone, Debug)]
pub struct Canvas {
    exemplar: PointPattern,
    size: DVec2,
    domain: Domain,
    boundary: Boundary,
    points: Vec<DVec2>,
    ids: Vec<u32>,
    sources: Vec<usize>,
    pinned: Vec<bool>,
    next_id: u32,
}

impl Canvas {
    /// An empty canvas of `expansion` exemplars in width and height.
    ///
    /// # Errors
    /// When the rectangle can't be used.
    pub fn new(exemplar: PointPattern, expansion: DVec2, boundary: Boundary) -> Result<Self, PatternError> {
        let domain = exemplar.domain();
        Ok(Self {
            size: domain.size_in_exemplar_units() * expansion,
            domain: Domain::new(domain.min(), domain.size() * expansion)?,
            boundary,
            points: Vec::new(),
            ids: Vec::new(),
            sources: Vec::new(),
            pinned: Vec::new(),
            next_id: 0,
            exemplar,
        })
    }

    /// What the points are made after.
    #[must_use]
    pub fn exemplar(&self) -> &PointPattern {
        &self.exemplar
    }

    /// Width and height in exemplar units.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.size
    }

    /// What lies beyond the border.
    #[must_use]
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// Positions in exemplar units.
    #[must_use]
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// For every point its id.
    #[must_use]
    pub fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// For every point the exemplar point whose class and attributes it has.
    #[must_use]
    pub fn sources(&self) -> &[usize] {
        &self.sources
    }

    /// For every point whether it is held where it is.
    #[must_use]
    pub fn pinned(&self) -> &[bool] {
        &self.pinned
    }

    /// Positions, to be moved; they must stay inside.
    pub fn points_mut(&mut self) -> &mut [DVec2] {
        &mut self.points
    }

    /// Sources, to be exchanged; they must be points of the exemplar.
    pub fn sources_mut(&mut self) -> &mut [usize] {
        &mut self.sources
    }

    /// Adds a point that is not held, and returns its id.
    pub fn add(&mut self, place: DVec2, source: usize) -> u32 {
        let id = self.next_id;
        self.next_id += 1;
        self.points.push(place);
        self.sources.push(source);
        self.pinned.push(false);
        self.ids.push(id);
        id
    }

    /// Takes a point away; those after it move up one place in the lists and keep their ids.
    ///
    /// # Errors
    /// When there is no such point.
    pub fn remove(&mut self, id: u32) -> Result<(), CanvasError> {
        let index = self.index_of(id)?;
        self.points.remove(index);
        self.sources.remove(index);
        self.pinned.remove(index);
        self.ids.remove(index);
        Ok(())
    }

    /// The same points, ids, sources and pins as on another canvas of the same size.
    pub fn adopt(&mut self, other: &Self) {
        self.points.clone_from(&other.points);
        self.ids.clone_from(&other.ids);
        self.sources.clone_from(&other.sources);
        self.pinned.clone_from(&other.pinned);
        self.next_id = other.next_id;
    }

    /// Where a point stands in the lists.
    ///
    /// # Errors
    /// When there is no such point.
    pub fn index_of(&self, id: u32) -> Result<usize, CanvasError> {
        // Ids are given in ascending order and never moved past one another.
        self.ids.binary_search(&id).map_err(|_| CanvasError::NoPoint { id, count: self.points.len() })
    }

    /// Where points stand in the lists.
    ///
    /// # Errors
    /// When one is not there.
    pub fn indices_of(&self, ids: &[u32]) -> Result<Vec<usize>, CanvasError> {
        ids.iter().map(|&id| self.index_of(id)).collect()
    }

    /// Holds points where they are, or lets them go.
    ///
    /// # Errors
    /// When there is no such point; nothing has changed then.
    pub fn pin(&mut self, ids: &[u32], pinned: bool) -> Result<(), CanvasError> {
        for index in self.indices_of(ids)? {
            self.pinned[index] = pinned;
        }
        Ok(())
    }

    /// Puts points elsewhere and holds them there.
    ///
    /// # Errors
    /// When there is no such point or a place lies outside the output; nothing has changed then.
    pub fn place(&mut self, ids: &[u32], places: &[DVec2]) -> Result<(), CanvasError> {
        if ids.len() != places.len() {
            return Err(CanvasError::Places { places: places.len(), points: ids.len() });
        }
        if let Some(&place) = places.iter().find(|&&place| !self.contains(place)) {
            return Err(CanvasError::Outside { at: place.into(), size: self.size.into() });
        }
        for (index, &place) in self.indices_of(ids)?.into_iter().zip(places) {
            self.points[index] = place;
            self.pinned[index] = true;
        }
        Ok(())
    }

    /// Whether a place lies in the output; false for what is no number.
    #[must_use]
    pub fn contains(&self, place: DVec2) -> bool {
        place.cmpge(DVec2::ZERO).all() && place.cmple(self.size).all()
    }

    /// Which points lie in a polygon and are not pinned, ascending.
    ///
    /// # Errors
    /// When the polygon is none, or no such point lies in it.
    pub fn free_points_in(&self, polygon: &[DVec2]) -> Result<Vec<usize>, CanvasError> {
        if polygon.len() < 3 || polygon.iter().any(|corner| !corner.is_finite()) {
            return Err(CanvasError::Polygon);
        }
        let chosen: Vec<usize> = (0..self.points.len())
            .filter(|&point| !self.pinned[point] && self.lies_in(self.points[point], polygon))
            .collect();
        if chosen.is_empty() { Err(CanvasError::EmptyRegion) } else { Ok(chosen) }
    }

    /// Whether a place or, in a periodic output, one of its copies lies in the polygon.
    #[must_use]
    pub fn lies_in(&self, place: DVec2, polygon: &[DVec2]) -> bool {
        let reach = if self.boundary == Boundary::Periodic { 1 } else { 0 };
        let shifts = || (-reach..=reach).map(f64::from);
        shifts().any(|x| shifts().any(|y| polygon_contains(polygon, place + DVec2::new(x, y) * self.size)))
    }

    /// A random place in the polygon; `otherwise` where none is found.
    pub fn random_place_in(&self, polygon: &[DVec2], rng: &mut Rng, otherwise: DVec2) -> DVec2 {
        let low = polygon.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = polygon.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        (0..DARTS)
            .map(|_| DVec2::new(rng.range(low.x, high.x), rng.range(low.y, high.y)))
            .map(|place| keep_inside(place, self.size, self.boundary))
            .find(|&place| self.lies_in(place, polygon))
            .unwrap_or(otherwise)
    }

    /// The points as indices, class after class in the order in which the exemplar lists its classes: that of
    /// [`Self::pattern`].
    #[must_use]
    pub fn listed(&self) -> Vec<usize> {
        let mut of_class = vec![Vec::new(); self.exemplar.class_names().len()];
        for (point, &source) in self.sources.iter().enumerate() {
            of_class[usize::from(self.exemplar.classes()[source])].push(point);
        }
        of_class.concat()
    }

    /// The points as a pattern in the exemplar's own unit, with classes and attributes.
    ///
    /// # Errors
    /// When there are no points.
    pub fn pattern(&self) -> Result<PointPattern, PatternError> {
        let (exemplar, domain) = (&self.exemplar, self.domain);
        let unit = exemplar.domain().exemplar_unit();
        let listed = self.listed();
        let listed = || listed.iter().copied();
        let positions = listed()
            // The last digit may round over the border.
            .map(|point| (domain.min() + self.points[point] * unit).clamp(domain.min(), domain.max()))
            .collect();
        let classes = listed().map(|point| exemplar.classes()[self.sources[point]]).collect();
        let mut pattern = PointPattern::new(domain, positions)?
            .with_boundary(self.boundary)
            .with_classes(classes, exemplar.class_names().to_vec())?;
        for attribute in exemplar.attributes() {
            let values = listed().map(|point| attribute.values[self.sources[point]]).collect();
            pattern = pattern.with_attribute(Attribute { name: attribute.name.clone(), values })?;
        }
        Ok(pattern)
    }
}

/// Whether a point lies in a polygon, by the even-odd rule.
fn polygon_contains(polygon: &[DVec2], point: DVec2) -> bool {
    let before = polygon.iter().cycle().skip(polygon.len() - 1);
    let crossings = polygon.iter().zip(before).filter(|(a, b)| {
        (a.y > point.y) != (b.y > point.y) && point.x < (b.x - a.x) * (point.y - a.y) / (b.y - a.y) + a.x
    });
    crossings.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

    use super::*;

    /// Two classes in a rectangle twice as wide as high, in metres; the output is 2 × 1 exemplars.
    fn canvas(boundary: Boundary) -> Canvas {
        let domain = Domain::new(DVec2::new(100.0, 50.0), DVec2::new(20.0, 10.0)).unwrap();
        let places = [[102.0, 52.0], [110.0, 55.0], [118.0, 58.0]].map(DVec2::from).to_vec();
        let exemplar = PointPattern::new(domain, places)
            .unwrap()
            .with_classes(vec![0, 1, 0], vec!["oak".to_owned(), "elm".to_owned()])
            .unwrap()
            .with_attribute(Attribute { name: "height".to_owned(), values: vec![3.0, 4.0, 5.0] })
            .unwrap();
        let mut canvas = Canvas::new(exemplar, DVec2::new(2.0, 1.0), boundary).unwrap();
        for (place, source) in [([0.2, 0.1], 1), ([0.4, 0.2], 0), ([1.9, 0.4], 2), ([2.0, 0.5], 1)] {
            canvas.add(place.into(), source);
        }
        canvas
    }

    #[test]
    fn ids_stay_while_points_come_and_go() {
        let mut canvas = canvas(Boundary::Open);
        assert_eq!(canvas.ids(), [0, 1, 2, 3]);
        canvas.pin(&[2], true).unwrap();
        canvas.remove(1).unwrap();
        assert_eq!((canvas.ids(), canvas.index_of(2)), (&[0, 2, 3][..], Ok(1)));
        assert_eq!(canvas.pinned(), [false, true, false]);
        assert_eq!(canvas.add(DVec2::ZERO, 0), 4, "an id is never given twice");
        assert_eq!(canvas.remove(1), Err(CanvasError::NoPoint { id: 1, count: 4 }));
        let mut other = self::canvas(Boundary::Open);
        other.adopt(&canvas);
        assert_eq!((other.ids(), other.points()), (canvas.ids(), canvas.points()));
        assert_eq!(other.add(DVec2::ONE, 1), 5);
    }

    #[test]
    fn the_pattern_lists_classes_as_the_exemplar_does() {
        let pattern = canvas(Boundary::Open).pattern().unwrap();
        assert_eq!(canvas(Boundary::Open).listed(), [1, 2, 0, 3]);
        assert_eq!(pattern.classes(), [0, 0, 1, 1]);
        assert_eq!(pattern.attributes()[0].values, [3.0, 5.0, 4.0, 4.0]);
        assert_eq!(pattern.positions()[0], DVec2::new(108.0, 54.0));
        assert_eq!(pattern.domain().size(), DVec2::new(40.0, 10.0));
    }

    #[test]
    fn what_can_t_be_done_changes_nothing() {
        let mut canvas = canvas(Boundary::Open);
        let before = canvas.points().to_vec();
        for (refused, words) in [
            (canvas.place(&[0, 9], &[DVec2::ZERO; 2]), "no point 9 among 4"),
            (canvas.place(&[0], &[]), "0 places for 1 points"),
            (canvas.place(&[0, 1], &[DVec2::ZERO, DVec2::new(2.5, 0.0)]), "(2.5, 0) lies outside the output, 2 × 0.5"),
            (canvas.place(&[0], &[DVec2::NAN]), "NaN"),
            (canvas.pin(&[7], true), "no point 7"),
        ] {
            let message = refused.unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
        assert_eq!((canvas.points(), canvas.pinned()), (&before[..], &[false; 4][..]));
        canvas.place(&[3], &[DVec2::new(1.0, 0.25)]).unwrap();
        assert_eq!((canvas.points()[3], canvas.pinned()[3]), (DVec2::new(1.0, 0.25), true));
    }

    #[test]
    fn regions_reach_over_a_periodic_border() {
        let corner = [[1.8, 0.3], [2.3, 0.3], [2.3, 0.7], [1.8, 0.7]].map(DVec2::from);
        assert_eq!(canvas(Boundary::Open).free_points_in(&corner), Ok(vec![2, 3]));
        let across = [[2.1, 0.0], [2.3, 0.0], [2.3, 0.3], [2.1, 0.3]].map(DVec2::from);
        assert_eq!(canvas(Boundary::Open).free_points_in(&across), Err(CanvasError::EmptyRegion));
        assert_eq!(canvas(Boundary::Periodic).free_points_in(&across), Ok(vec![0]));
        let mut pinned = canvas(Boundary::Periodic);
        pinned.pin(&[0], true).unwrap();
        assert_eq!(pinned.free_points_in(&across), Err(CanvasError::EmptyRegion), "a pinned point may not move");
        assert_eq!(pinned.free_points_in(&across[..2]), Err(CanvasError::Polygon));
    }

    #[test]
    fn a_polygon_contains_what_is_inside() {
        let arrow = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]].map(DVec2::from);
        for (point, inside) in
            [([1.2, 1.0], true), ([0.8, 1.0], false), ([0.3, 0.2], true), ([-0.1, 1.0], false), ([1.9, 1.2], false)]
        {
            assert_eq!(polygon_contains(&arrow, point.into()), inside, "{point:?}");
        }
    }
}
