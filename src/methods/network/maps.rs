//! What every point weighs in the maps of the first layer: by its class and by its attributes.
//!
//! Every attribute has a band of the nine frequencies (Huang et al. 2022, §4.5; every pair of map and attribute), and
//! classes that are to be told apart have a band of all ten maps each, in which the others weigh 0. The paper's maps of a
//! pattern with attributes are the bands of the attributes and the plain Gaussian; where classes have bands of their own
//! a single one has its ten maps, too: weighted by their size small points are hardly seen.

use super::parameters::ClassMaps;
use crate::engine::{Bands, Weights};
use crate::pattern::{Attribute, Meaning, PointPattern};

/// The weights of points that carry what the exemplar's points `sources` do. `columns` are those of
/// [`columns`], `classes` the class of every exemplar point; `placed` are the classes seen, the moving one last.
#[must_use]
pub(super) fn weights(
    columns: &[Vec<f64>],
    classes: &[u16],
    placed: &[usize],
    maps: ClassMaps,
    sources: &[usize],
) -> Weights {
    // The moving class first, so that its band is always the same one.
    let band_of = |class: u16| match maps {
        ClassMaps::Pooled => 0,
        ClassMaps::Separate => usize::from(placed.last() != Some(&usize::from(class))),
        ClassMaps::Each => placed.iter().rev().position(|&other| other == usize::from(class)).unwrap_or(0),
    };
    let full = match maps {
        ClassMaps::Pooled => 1,
        ClassMaps::Separate => placed.len().min(2),
        ClassMaps::Each => placed.len(),
    };
    let waves = columns.len();
    // In the paper's maps the Gaussian alone sees points that have attributes without them.
    let lone = maps == ClassMaps::Pooled && waves > 0;
    let bands = Bands { lone, full: if lone { 0 } else { full.max(1) }, waves };
    if bands == Bands::default() {
        return Weights::default();
    }
    let mut values = Vec::with_capacity(sources.len() * bands.count());
    for &source in sources {
        let own = band_of(classes[source]);
        values.extend((0..bands.count() - waves).map(|band| if band == own { 1.0 } else { 0.0 }));
        values.extend(columns.iter().map(|column| column[source]));
    }
    Weights::new(bands, values)
}

/// What every exemplar point weighs in the bands of its attributes, one list a band.
///
/// Sizes and whatever else is positive weigh their value over the largest (Huang et al. 2022, §4.5). Of other values
/// the origin means nothing: a point at depth 0 must not vanish, so they weigh ½ (least) to 1 (largest). An angle has
/// two bands, its cosine and its sine: 359° and 1° are neighbours, and no direction weighs more than another. An
/// attribute that is the same everywhere says nothing, and has none.
#[must_use]
pub(super) fn columns(exemplar: &PointPattern) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for attribute in exemplar.attributes() {
        let Attribute { values, .. } = attribute;
        let (least, most) = attribute.range();
        let mut push = |weight: &dyn Fn(f64) -> f64| {
            let column: Vec<f64> = values.iter().map(|&value| weight(value)).collect();
            if column.iter().any(|weight| (weight - column[0]).abs() > 1e-9) {
                columns.push(column);
            }
        };
        match attribute.meaning() {
            Meaning::Angle => {
                // Reduced first: a large angle in radians has lost digits.
                let radians = |degrees: f64| (degrees % 360.0).to_radians();
                push(&|value| libm::cos(radians(value)));
                push(&|value| libm::sin(radians(value)));
            }
            Meaning::Size => push(&|value| value / most),
            Meaning::Other if least > 0.0 => push(&|value| value / most),
            // Halved before they are subtracted: the span of the largest numbers is not one.
            Meaning::Other => push(&|value| 0.5 + 0.5 * (value / 2.0 - least / 2.0) / (most / 2.0 - least / 2.0)),
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Domain;
    use glam::DVec2;

    fn pattern(attributes: &[(&str, [f64; 4])]) -> PointPattern {
        let positions = (0..4).map(|i| DVec2::splat(0.2 * f64::from(i))).collect();
        let mut pattern = PointPattern::new(Domain::UNIT, positions).unwrap_or_else(|e| unreachable!("{e}"));
        for (name, values) in attributes {
            let attribute = Attribute { name: (*name).to_owned(), values: values.to_vec() };
            pattern = pattern.with_attribute(attribute).unwrap_or_else(|e| unreachable!("{e}"));
        }
        pattern
    }

    #[test]
    fn weights_of_values_by_their_meaning() {
        let exemplar = pattern(&[
            ("radius", [0.0, 1.0, 2.0, 4.0]),
            ("height", [3.0, 6.0, 12.0, 3.0]),
            ("depth", [0.0, 1.0, 0.5, 0.25]),
            ("charge", [-1.0, 1.0, 1.0, -1.0]),
            ("huge", [-1.7e308, 1.7e308, 0.0, 0.0]),
            ("Orientation", [0.0, 90.0, -180.0, 36_000_000_360.0]),
            ("same", [5.0; 4]),
            ("scale", [0.0; 4]),
        ]);
        let expected = [
            [0.0, 0.25, 0.5, 1.0],
            [0.25, 0.5, 1.0, 0.25],
            [0.5, 1.0, 0.75, 0.625],
            [0.5, 1.0, 1.0, 0.5],
            [0.5, 1.0, 0.75, 0.75],
            [1.0, 0.0, -1.0, 1.0],
            [0.0, 1.0, 0.0, 0.0],
        ];
        let columns = columns(&exemplar);
        assert_eq!(columns.len(), expected.len(), "what says nothing has no band");
        for (column, expected) in columns.iter().zip(expected) {
            for (weight, expected) in column.iter().zip(expected) {
                assert!((weight - expected).abs() < 1e-12, "{column:?} is not {expected:?}");
            }
        }
        assert!(super::columns(&pattern(&[])).is_empty());
    }

    #[test]
    fn classes_have_bands_of_their_own_where_asked() {
        let classes = [0, 1, 2, 1];
        let column = vec![vec![0.1, 0.2, 0.3, 0.4]];
        let placed = [2, 0, 1];
        let sources = [0, 1, 2, 3, 3];
        let values = |columns: &[Vec<f64>], placed: &[usize], maps| {
            let weights = super::weights(columns, &classes, placed, maps, &sources);
            (weights.bands(), weights.values(sources.len()).collect::<Vec<f64>>())
        };
        let plain = (Bands::default(), vec![1.0; 5]);
        assert_eq!(values(&[], &placed, ClassMaps::Pooled), plain);
        assert_eq!(values(&[], &placed[..1], ClassMaps::Separate), plain, "one class is not told from others");
        let (bands, weights) = values(&[], &placed, ClassMaps::Separate);
        assert_eq!((bands.full, weights), (2, vec![0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0]));
        let (bands, weights) = values(&[], &placed, ClassMaps::Each);
        assert_eq!((bands.full, &weights[..9]), (3, &[0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0][..]));
        let (bands, weights) = values(&column, &placed, ClassMaps::Pooled);
        assert_eq!(bands, Bands { lone: true, full: 0, waves: 1 });
        assert_eq!(weights, [1.0, 0.1, 1.0, 0.2, 1.0, 0.3, 1.0, 0.4, 1.0, 0.4]);
        let (bands, weights) = values(&column, &placed, ClassMaps::Separate);
        assert_eq!(bands, Bands { lone: false, full: 2, waves: 1 });
        assert_eq!(weights[..6], [0.0, 1.0, 0.1, 1.0, 0.0, 0.2]);
        let weights = super::weights(&column, &[0; 4], &[0], ClassMaps::Separate, &sources);
        assert_eq!(weights.bands(), Bands { lone: false, full: 1, waves: 1 }, "all ten maps without the attribute");
        assert_eq!(weights.values(2).collect::<Vec<_>>(), [1.0, 0.1, 1.0, 0.2]);
    }
}
