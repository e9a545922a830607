//! A raster over a domain: a density, a weight or a size (an *amount*), or a direction (an *angle*).
//!
//! Values stand at the centres of the cells; between them a field is bilinear. Rows run upwards, as y does: cell
//! (column, row) has its centre at `min + ((column + ½) · width / columns, (row + ½) · height / rows)`.

use glam::DVec2;

use super::domain::{Boundary, Domain};
use super::error::PatternError;

/// Most cells along a side. A finer field says nothing that points could follow: 20 000 points have 141 a side.
pub const MAX_FIELD_SIDE: usize = 512;

/// What the values of a field are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// A density, a weight or a size: 0 or more, and more than 0 somewhere.
    Amount,
    /// A direction in degrees, counter-clockwise; the same every 360.
    Angle,
}

/// A value for every place of a domain. It can't hold a number that is not finite, a negative amount, or nothing but
/// zero amounts.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    domain: Domain,
    boundary: Boundary,
    kind: FieldKind,
    columns: usize,
    values: Vec<f32>,
}

/// The two cells on either side of a coordinate along one axis, and the share of the second.
struct Between {
    cells: [usize; 2],
    share: f64,
}

impl Field {
    /// A field of `columns` × `values.len() / columns` cells, row after row from the domain's lower corner.
    ///
    /// # Errors
    /// [`PatternError::Field`] when there are no cells, too many along a side, or a row is incomplete;
    /// [`PatternError::FieldValue`] when a value is not finite or a negative amount, or all amounts are 0.
    pub fn new(
        domain: Domain,
        boundary: Boundary,
        kind: FieldKind,
        columns: usize,
        values: Vec<f32>,
    ) -> Result<Self, PatternError> {
        let cells = values.len();
        let refuse = |reason| Err(PatternError::Field { columns, cells, reason });
        if columns == 0 || cells == 0 {
            return refuse("it needs at least one row and one column");
        }
        if !cells.is_multiple_of(columns) {
            return refuse("the number of cells must be a multiple of the number of columns");
        }
        if columns > MAX_FIELD_SIDE || cells / columns > MAX_FIELD_SIDE {
            return refuse("at most 512 rows and 512 columns are allowed");
        }
        let is_amount = kind == FieldKind::Amount;
        let misfit = values.iter().position(|value| !value.is_finite() || (is_amount && *value < 0.0));
        let value_error = |cell: usize, reason| {
            let (column, row) = (cell % columns, cell / columns);
            Err(PatternError::FieldValue { column, row, value: f64::from(values[cell]), reason })
        };
        if let Some(cell) = misfit {
            let reason = if is_amount { "it must be a finite number, 0 or more" } else { "it must be a finite number" };
            return value_error(cell, reason);
        }
        if is_amount && values.iter().all(|&value| value == 0.0) {
            return value_error(0, "at least one cell must be above 0");
        }
        Ok(Self { domain, boundary, kind, columns, values })
    }

    /// The rectangle it covers.
    #[must_use]
    pub fn domain(&self) -> Domain {
        self.domain
    }

    /// What its values are.
    #[must_use]
    pub fn kind(&self) -> FieldKind {
        self.kind
    }

    /// Columns and rows.
    #[must_use]
    pub fn cells(&self) -> [usize; 2] {
        [self.columns, self.values.len() / self.columns]
    }

    /// Its values, row after row from the lower corner.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The value at a place in the domain's own unit. Beyond the border an open field goes on with its last cells, a
    /// periodic one with the opposite side. Angles are averaged as directions and come out in `-180 ..= 180`.
    #[must_use]
    pub fn at(&self, place: DVec2) -> f64 {
        let (x, y) = self.between(place);
        match self.kind {
            FieldKind::Amount => self.bilinear(&x, &y, &f64::from),
            FieldKind::Angle => {
                let radians = |value: f32| f64::from(value % 360.0).to_radians();
                let cosine = self.bilinear(&x, &y, &|value| libm::cos(radians(value)));
                let sine = self.bilinear(&x, &y, &|value| libm::sin(radians(value)));
                libm::atan2(sine, cosine).to_degrees()
            }
        }
    }

    /// How an amount changes at a place, per unit of the domain along x and y. On the lines between cells it is that of
    /// the cell above; for angles it is 0.
    #[must_use]
    pub fn gradient(&self, place: DVec2) -> DVec2 {
        if self.kind == FieldKind::Angle {
            return DVec2::ZERO;
        }
        let (x, y) = self.between(place);
        let value = |column: usize, row: usize| f64::from(self.values[row * self.columns + column]);
        let along = |axis: &Between, other: &Between, value: &dyn Fn(usize, usize) -> f64| {
            let step = |at: usize| value(axis.cells[1], at) - value(axis.cells[0], at);
            (1.0 - other.share) * step(other.cells[0]) + other.share * step(other.cells[1])
        };
        let pitch = self.pitch();
        DVec2::new(along(&x, &y, &value) / pitch.x, along(&y, &x, &|row, column| value(column, row)) / pitch.y)
    }

    /// Mean of all cells.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.values.iter().map(|&value| f64::from(value)).sum::<f64>() / self.values.len() as f64
    }

    /// The same field on other cells, sampled at their centres.
    ///
    /// # Errors
    /// [`PatternError::Field`] when there would be no cells or too many; [`PatternError::FieldValue`] when the coarser
    /// cells miss all that is above 0.
    pub fn resampled(&self, [columns, rows]: [usize; 2]) -> Result<Self, PatternError> {
        if columns == 0 || rows == 0 || columns.max(rows) > MAX_FIELD_SIDE {
            let reason = "at least one and at most 512 rows and columns are allowed";
            return Err(PatternError::Field { columns, cells: columns.saturating_mul(rows), reason });
        }
        let pitch = self.domain.size() / DVec2::new(columns as f64, rows as f64);
        let center = |row: usize, column: usize| DVec2::new(column as f64 + 0.5, row as f64 + 0.5) * pitch;
        let values = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (row, column)))
            .map(|(row, column)| self.at(self.domain.min() + center(row, column)) as f32)
            .collect();
        Self::new(self.domain, self.boundary, self.kind, columns, values)
    }

    fn pitch(&self) -> DVec2 {
        let [columns, rows] = self.cells();
        self.domain.size() / DVec2::new(columns as f64, rows as f64)
    }

    fn between(&self, place: DVec2) -> (Between, Between) {
        let at = (place - self.domain.min()) / self.pitch() - 0.5;
        let axis = |at: f64, cells: usize| {
            let last = cells as f64 - 1.0;
            let at = match self.boundary {
                Boundary::Open => at.clamp(0.0, last),
                Boundary::Periodic => at.rem_euclid(cells as f64),
            };
            let below = (at.floor() as usize).min(cells - 1);
            let above = match self.boundary {
                Boundary::Open => (below + 1).min(cells - 1),
                Boundary::Periodic => (below + 1) % cells,
            };
            Between { cells: [below, above], share: at - below as f64 }
        };
        let [columns, rows] = self.cells();
        (axis(at.x, columns), axis(at.y, rows))
    }

    fn bilinear(&self, x: &Between, y: &Between, value: &dyn Fn(f32) -> f64) -> f64 {
        let row = |row: usize| {
            let [low, high] = x.cells.map(|column| value(self.values[row * self.columns + column]));
            (1.0 - x.share) * low + x.share * high
        };
        (1.0 - y.share) * row(y.cells[0]) + y.share * row(y.cells[1])
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

    use super::*;

    fn domain() -> Domain {
        Domain::new(DVec2::new(10.0, -2.0), DVec2::new(8.0, 4.0)).unwrap()
    }

    fn amount(boundary: Boundary, columns: usize, values: &[f32]) -> Result<Field, PatternError> {
        Field::new(domain(), boundary, FieldKind::Amount, columns, values.to_vec())
    }

    #[test]
    fn between_the_centres_it_is_bilinear() {
        // 3 + x / 2 - y at the centres of 4 × 2 cells.
        let values: Vec<f32> =
            (0..8).map(|i| 3.0 + (11.0 + 2.0 * (i % 4) as f32) / 2.0 - (2 * (i / 4) - 1) as f32).collect();
        let field = amount(Boundary::Open, 4, &values).unwrap();
        assert_eq!(field.cells(), [4, 2]);
        for place in [[11.0, -1.0], [12.3, 0.2], [16.9, 0.9], [14.0, -0.4]].map(DVec2::from) {
            let expected = 3.0 + place.x / 2.0 - place.y;
            assert!((field.at(place) - expected).abs() < 1e-6, "{place}: {} {expected}", field.at(place));
            assert!((field.gradient(place) - DVec2::new(0.5, -1.0)).length() < 1e-6, "{place}");
        }
        // An open field goes on with its last cell.
        assert_eq!(field.at(DVec2::new(0.0, -9.0)), f64::from(values[0]));
        assert!((field.mean() - (3.0 + 7.0)).abs() < 1e-6);
    }

    #[test]
    fn the_gradient_is_that_of_the_values() {
        let values = [0.3, 2.0, 0.0, 1.5, 0.7, 4.0, 2.2, 0.1, 0.9, 1.1, 3.0, 0.4];
        for boundary in [Boundary::Open, Boundary::Periodic] {
            let field = amount(boundary, 4, &values).unwrap();
            for place in [[12.1, -0.9], [17.6, 1.5], [14.2, 0.3]].map(DVec2::from) {
                let step = 1e-5;
                let difference = |by: DVec2| (field.at(place + by) - field.at(place - by)) / (2.0 * step);
                let expected = DVec2::new(difference(DVec2::X * step), difference(DVec2::Y * step));
                assert!((field.gradient(place) - expected).length() < 1e-6, "{boundary:?} {place}");
            }
        }
    }

    #[test]
    fn a_periodic_field_meets_itself() {
        let field = amount(Boundary::Periodic, 4, &[1.0, 2.0, 3.0, 5.0]).unwrap();
        assert_eq!(field.at(DVec2::new(10.0, 0.0)), 3.0, "halfway between the last and the first cell");
        assert_eq!(field.at(DVec2::new(12.5, 1.0)), field.at(DVec2::new(20.5, -7.0)));
    }

    #[test]
    fn angles_are_averaged_as_directions() {
        let field = Field::new(domain(), Boundary::Open, FieldKind::Angle, 2, vec![350.0, -330.0]).unwrap();
        assert!((field.at(DVec2::new(14.0, 0.0)) - 10.0).abs() < 1e-4, "{}", field.at(DVec2::new(14.0, 0.0)));
        assert_eq!(field.gradient(DVec2::new(14.0, 0.0)), DVec2::ZERO);
    }

    #[test]
    fn resampling_a_ramp_gives_a_ramp() {
        let field = amount(Boundary::Open, 4, &[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!(field.resampled([4, 1]).unwrap(), field);
        assert_eq!(field.resampled([2, 1]).unwrap().values(), [1.5, 3.5]);
        assert!(field.resampled([0, 1]).is_err() && field.resampled([513, 1]).is_err());
    }

    #[test]
    fn what_is_no_field_is_refused() {
        for (columns, values, words) in [
            (0, vec![1.0], "at least one"),
            (1, vec![], "at least one"),
            (2, vec![1.0; 3], "multiple"),
            (513, vec![1.0; 513], "512"),
            (2, vec![1.0, f32::NAN], "column 1, row 0 is NaN"),
            (1, vec![1.0, -0.5], "column 0, row 1 is -0.5"),
            (2, vec![0.0; 4], "above 0"),
        ] {
            let message = amount(Boundary::Open, columns, &values).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
        let angle = Field::new(domain(), Boundary::Open, FieldKind::Angle, 1, vec![-90.0]);
        assert!(angle.is_ok(), "an angle may be negative");
    }
}
