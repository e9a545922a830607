//! A pattern as numbers, in its own unit and to the last digit: how the engine and the module for files hand patterns to
//! each other, by way of the page.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::protocol::typed_array;
use crate::pattern::{Attribute, Boundary, Domain, PatternError, PointPattern};

/// A [`PointPattern`] as typed arrays. Nothing in it is checked before [`PointPattern::try_from`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct PatternData {
    /// Lower corner, width and height.
    pub domain: [f64; 4],
    /// Whether it is a window or a tile.
    pub boundary: Boundary,
    /// `x, y, x, y, …`; a `Float64Array` on the page.
    #[serde(with = "typed_array::doubles")]
    pub positions: Vec<f64>,
    /// Class of every point; a `Uint16Array` on the page.
    #[serde(with = "typed_array::words")]
    pub classes: Vec<u16>,
    /// Names of the classes.
    pub class_names: Vec<String>,
    /// What every point carries besides.
    pub attributes: Vec<AttributeData>,
}

/// An [`Attribute`] as a typed array.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttributeData {
    /// What it is called.
    pub name: String,
    /// One value a point; a `Float64Array` on the page.
    #[serde(with = "typed_array::doubles")]
    pub values: Vec<f64>,
}

impl From<&PointPattern> for PatternData {
    fn from(pattern: &PointPattern) -> Self {
        let (min, size) = (pattern.domain().min(), pattern.domain().size());
        Self {
            domain: [min.x, min.y, size.x, size.y],
            boundary: pattern.boundary(),
            positions: pattern.positions().iter().flat_map(|point| [point.x, point.y]).collect(),
            classes: pattern.classes().to_vec(),
            class_names: pattern.class_names().to_vec(),
            attributes: pattern
                .attributes()
                .iter()
                .map(|Attribute { name, values }| AttributeData { name: name.clone(), values: values.clone() })
                .collect(),
        }
    }
}

impl TryFrom<PatternData> for PointPattern {
    type Error = PatternError;
    fn try_from(data: PatternData) -> Result<Self, PatternError> {
        let [x, y, width, height] = data.domain;
        let domain = Domain::new(DVec2::new(x, y), DVec2::new(width, height))?;
        let count = data.positions.len();
        if !count.is_multiple_of(2) {
            let points = count.div_ceil(2);
            return Err(PatternError::Length { what: "positions".to_owned(), count, points });
        }
        let positions = data.positions.chunks_exact(2).map(DVec2::from_slice).collect();
        let mut pattern =
            Self::new(domain, positions)?.with_boundary(data.boundary).with_classes(data.classes, data.class_names)?;
        for AttributeData { name, values } in data.attributes {
            pattern = pattern.with_attribute(Attribute { name, values })?;
        }
        Ok(pattern)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

    use serde_json::json;

    use super::*;

    fn data() -> PatternData {
        serde_json::from_value(json!({
            "domain": [1.0, 2.0, 4.0, 8.0], "boundary": "periodic", "positions": [1.1, 2.2, 5.0, 10.0], "classes": [1, 0],
            "classNames": ["oak", "elm"], "attributes": [{ "name": "radius", "values": [0.1, 0.2] }],
        }))
        .unwrap()
    }

    #[test]
    fn patterns_go_through_unchanged() {
        let pattern = PointPattern::try_from(data()).unwrap();
        assert_eq!(pattern.class_names(), ["oak", "elm"]);
        assert_eq!(pattern.positions()[1], DVec2::new(5.0, 10.0));
        assert_eq!(PatternData::from(&pattern), data());
    }

    #[test]
    fn what_is_no_pattern_is_refused() {
        type Spoil = fn(&mut PatternData);
        let cases: [(Spoil, &str); 9] = [
            (|data| data.positions.truncate(3), "positions has 3 values"),
            (|data| data.positions.clear(), "no points"),
            (|data| data.positions[0] = f64::NAN, "x is NaN"),
            (|data| data.positions[0] = 9.0, "outside the domain"),
            (|data| data.domain[2] = -1.0, "sides must be greater than 0"),
            (|data| data.classes[0] = 2, "class 2"),
            (|data| data.classes.truncate(1), "classes has 1 values"),
            (|data| data.class_names[0] = "elm".to_owned(), "another class"),
            (|data| data.attributes[0].values.truncate(1), "radius has 1 values"),
        ];
        for (spoil, words) in cases {
            let mut spoilt = data();
            spoil(&mut spoilt);
            let message = PointPattern::try_from(spoilt).unwrap_err().to_string();
            assert!(message.contains(words), "{message:?} without {words:?}");
        }
    }
}
