//! What a person sees of a file before its points are used.

use super::{Column, Note, Origin, Reading, oddities};
use crate::pattern::{Attribute, Boundary, Domain, PointPattern};

/// Counts, ranges and whatever looks odd.
#[derive(Clone, Debug, PartialEq)]
pub struct Preview {
    /// How many points there are.
    pub points: usize,
    /// The classes in their order.
    pub classes: Vec<ClassPreview>,
    /// The attributes in their order.
    pub attributes: Vec<AttributePreview>,
    /// Lower and upper corner.
    pub domain: [f64; 4],
    /// Whether the file or the caller told the domain; otherwise it was found from the points.
    pub is_domain_declared: bool,
    /// Whether it is a window or a tile.
    pub boundary: Boundary,
    /// Mean distance to the nearest neighbour in the pattern's own unit, when there is one.
    pub spacing: Option<f64>,
    /// Other rectangles that the points may have been cut from: a word, lower and upper corner.
    pub domains: Vec<(&'static str, [f64; 4])>,
    /// What there was to choose from, of a table, records or GeoJSON.
    pub columns: Vec<Column>,
    /// How the file named and placed things.
    pub origin: Origin,
    /// What was left out, changed or looks odd.
    pub notes: Vec<Note>,
}

/// One class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassPreview {
    /// Its name.
    pub name: String,
    /// How many points it has.
    pub count: usize,
}

/// One attribute.
#[derive(Clone, Debug, PartialEq)]
pub struct AttributePreview {
    /// Its name.
    pub name: String,
    /// Its smallest value.
    pub min: f64,
    /// Its largest value.
    pub max: f64,
}

impl Preview {
    /// Of a file that was read.
    #[must_use]
    pub fn of(reading: &Reading) -> Self {
        let mut preview = Self::of_pattern(&reading.pattern);
        preview.is_domain_declared = reading.is_domain_declared;
        preview.domains = reading.domains.iter().map(|&(name, domain)| (name, corners(domain))).collect();
        preview.columns = reading.columns.clone();
        preview.origin = reading.origin.clone();
        preview.notes.splice(0..0, reading.notes.iter().cloned());
        preview
    }

    /// Of a pattern whose domain is known.
    #[must_use]
    pub fn of_pattern(pattern: &PointPattern) -> Self {
        let mut counts = vec![0; pattern.class_names().len()];
        for &class in pattern.classes() {
            counts[usize::from(class)] += 1;
        }
        let classes = pattern.class_names().iter().zip(counts);
        let spacing = pattern.mean_spacing().map(|spacing| spacing * pattern.domain().exemplar_unit());
        Self {
            points: pattern.len(),
            classes: classes.map(|(name, count)| ClassPreview { name: name.clone(), count }).collect(),
            attributes: pattern.attributes().iter().map(range_of).collect(),
            domain: corners(pattern.domain()),
            is_domain_declared: true,
            boundary: pattern.boundary(),
            spacing,
            domains: Vec::new(),
            columns: Vec::new(),
            origin: Origin::default(),
            notes: oddities(pattern),
        }
    }
}

fn corners(domain: Domain) -> [f64; 4] {
    let (min, max) = (domain.min(), domain.max());
    [min.x, min.y, max.x, max.y]
}

fn range_of(attribute: &Attribute) -> AttributePreview {
    let (min, max) = attribute.range();
    AttributePreview { name: attribute.name.clone(), min, max }
}
