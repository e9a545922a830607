//! How much the disks of a pattern overlap.

use std::f64::consts::PI;
use std::ops::Add;

use serde::{Deserialize, Serialize};

use super::cloud::Cloud;
use super::error::AnalysisError;

/// Area that two disks of radii `a` and `b` share when their centres are `distance` apart: a lens, the smaller disk
/// where it lies within the other, 0 where they only touch.
#[must_use]
pub fn lens_area(distance: f64, a: f64, b: f64) -> f64 {
    if distance >= a + b {
        return 0.0;
    }
    if distance <= (a - b).abs() {
        return PI * a.min(b).powi(2);
    }
    // A circular segment of each disk, cut off by the chord through both intersections.
    let segment = |own: f64, other: f64| {
        let to_chord = (distance * distance + own * own - other * other) / (2.0 * distance);
        let half_chord = (own * own - to_chord * to_chord).max(0.0).sqrt();
        own * own * libm::atan2(half_chord, to_chord) - to_chord * half_chord
    };
    segment(a, b) + segment(b, a)
}

/// Refuses radii that are none: not one a point, negative, not finite, or over half of the cloud's longer side.
///
/// # Errors
/// The first offence, with the point it belongs to.
pub fn check_radii(cloud: &Cloud, radii: &[f64]) -> Result<(), AnalysisError> {
    if radii.len() != cloud.len() {
        return Err(AnalysisError::Radii { count: radii.len(), points: cloud.len() });
    }
    let max = 0.5 * cloud.size().max_element();
    match radii.iter().position(|radius| !(0.0..=max).contains(radius)) {
        Some(index) => Err(AnalysisError::Radius { index, value: radii[index], max }),
        None => Ok(()),
    }
}

/// Overlaps of the disks of two classes, or of one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClassOverlap {
    /// Index of a class.
    pub a: u16,
    /// Index of the other, not below `a`.
    pub b: u16,
    /// How many pairs overlap.
    pub pairs: usize,
    /// Sum of the areas that they share, in the cloud's unit.
    pub area: f64,
    /// Largest relative penetration.
    pub deepest: f64,
}

/// How much disks overlap. Whole disks count, also where they reach over the border of a window; on a torus each image
/// makes a pair of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OverlapStatistics {
    /// Sum of the areas of all disks, in the cloud's unit.
    pub disk_area: f64,
    /// Sum over all pairs of the area that the two share. Where three meet it counts three times.
    pub overlap_area: f64,
    /// `overlap_area / disk_area`, 0 without disks.
    pub fraction: f64,
    /// How many pairs overlap.
    pub pairs: usize,
    /// Largest relative penetration, `1 − distance / (sum of the radii)`: 0 where disks at most touch, 1 where two have
    /// one centre.
    pub deepest: f64,
    /// The same by classes; classes without overlaps are left out.
    pub classes: Vec<ClassOverlap>,
}

impl OverlapStatistics {
    /// Below this relative penetration two disks touch: the difference is a rounding of their positions.
    pub const TOUCH: f64 = 1e-9;

    /// Measures the disks of `radii` about the points of `cloud`, in the same unit.
    ///
    /// # Errors
    /// When there is not one radius a point, or one can't be used; see [`check_radii`].
    pub fn of(cloud: &Cloud, radii: &[f64]) -> Result<Self, AnalysisError> {
        check_radii(cloud, radii)?;
        let disk_area = radii.iter().map(|radius| PI * radius * radius).fold(0.0, Add::add);
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let classes = cloud.class_count();
        let mut between: Vec<ClassOverlap> = (0..classes * classes)
            .map(|at| ClassOverlap {
                a: (at / classes) as u16,
                b: (at % classes) as u16,
                pairs: 0,
                area: 0.0,
                deepest: 0.0,
            })
            .collect();
        cloud.neighbours().pairs(2.0 * largest, |i, j, offset| {
            let (distance, sum) = (offset.length(), radii[i] + radii[j]);
            // Also false where both are points without extent.
            if distance < (1.0 - Self::TOUCH) * sum {
                let (a, b) = (cloud.classes()[i].min(cloud.classes()[j]), cloud.classes()[i].max(cloud.classes()[j]));
                let both = &mut between[usize::from(a) * classes + usize::from(b)];
                both.pairs += 1;
                both.area += lens_area(distance, radii[i], radii[j]);
                both.deepest = both.deepest.max(1.0 - distance / sum);
            }
        });
        between.retain(|both| both.pairs > 0);
        // An empty sum is −0.
        let overlap_area = between.iter().map(|both| both.area).fold(0.0, Add::add);
        Ok(Self {
            disk_area,
            overlap_area,
            fraction: if disk_area > 0.0 { overlap_area / disk_area } else { 0.0 },
            pairs: between.iter().map(|both| both.pairs).sum(),
            deepest: between.iter().map(|both| both.deepest).fold(0.0, f64::max),
            classes: between,
        })
    }
}
