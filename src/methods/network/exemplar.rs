//! The exemplar, prepared for placing its classes one after another.

use glam::DVec2;

use super::maps;
use super::parameters::{ClassMaps, Parameters};
use super::{NetworkError, Schedule};
use crate::analysis::{AnalysisError, Cloud, check_radii};
use crate::engine::Weights;
use crate::finish::Reference;
use crate::pattern::PointPattern;

/// What a run asks of its exemplar again and again. Lengths are in exemplar units.
#[derive(Clone, Debug)]
pub(super) struct PreparedExemplar {
    /// Mean distance to the nearest neighbour, the paper's d.
    pub(super) spacing: f64,
    /// Points per unit area.
    pub(super) density: f64,
    /// Width and height.
    pub(super) size: DVec2,
    pub(super) positions: Vec<DVec2>,
    /// For each class its points.
    pub(super) members: Vec<Vec<usize>>,
    /// What every point weighs in the bands of its attributes.
    columns: Vec<Vec<f64>>,
    /// The classes that have points, in the order in which they are placed.
    pub(super) order: Vec<usize>,
    /// For every point when its class is placed, from 0.
    turns: Vec<u16>,
    /// Radii of the disks that the points stand for, where they are to overlap as they do here.
    pub(super) radii: Option<Vec<f64>>,
    class_maps: ClassMaps,
}

impl PreparedExemplar {
    /// # Errors
    /// When it has no spacing to measure, or a radius is none.
    pub(super) fn new(exemplar: &PointPattern, parameters: &Parameters) -> Result<Self, NetworkError> {
        let spacing = exemplar
            .mean_spacing()
            .ok_or(NetworkError::Exemplar("it needs at least two points at different positions"))?;
        let mut members = vec![Vec::new(); exemplar.class_names().len()];
        for (point, &class) in exemplar.classes().iter().enumerate() {
            members[usize::from(class)].push(point);
        }
        let order = parameters.class_order.of(exemplar);
        let turn = |class: u16| order.iter().position(|&other| other == usize::from(class)).unwrap_or(0) as u16;
        Ok(Self {
            spacing,
            density: density(exemplar),
            size: exemplar.domain().size_in_exemplar_units(),
            positions: exemplar.positions_in_exemplar_units(),
            members,
            columns: maps::columns(exemplar),
            turns: exemplar.classes().iter().map(|&class| turn(class)).collect(),
            order,
            radii: if parameters.disk_overlap > 0.0 { disk_radii(exemplar)? } else { None },
            class_maps: parameters.class_maps,
        })
    }

    /// The ladder for these parameters.
    pub(super) fn schedule(&self, parameters: &Parameters) -> Schedule {
        let expansion = DVec2::new(parameters.expansion_x, parameters.expansion_y);
        Schedule::new(parameters, self.spacing, self.density, self.size * expansion)
    }

    /// The points of the class whose turn it is and of those placed before it.
    pub(super) fn seen(&self, turn: usize) -> Vec<usize> {
        self.order[..=turn].iter().flat_map(|&class| self.members[class].iter().copied()).collect()
    }

    /// What points weigh that carry the values of these exemplar points, once `placed` classes are there. `classes` are
    /// the exemplar's.
    pub(super) fn weights(&self, classes: &[u16], placed: usize, sources: &[usize]) -> Weights {
        maps::weights(&self.columns, classes, &self.order[..placed], self.class_maps, sources)
    }

    /// How many points of a class an output of `area` exemplars has (Huang et al. 2022, §4.4).
    pub(super) fn output_count(&self, class: usize, area: f64) -> usize {
        ((self.members[class].len() as f64 * area).round() as usize).max(1)
    }

    /// What a class is compared with when its turn comes: `seen` is that of [`Self::seen`].
    ///
    /// # Errors
    /// Never for a valid exemplar; the cloud checks itself nevertheless.
    pub(super) fn reference<'a>(
        &'a self,
        exemplar: &'a PointPattern,
        seen: &'a [usize],
        class: usize,
    ) -> Result<Reference<'a>, AnalysisError> {
        let positions = seen.iter().map(|&point| self.positions[point]).collect();
        let classes = seen.iter().map(|&point| exemplar.classes()[point]).collect();
        Ok(Reference {
            exemplar,
            seen,
            cloud: Cloud::new(positions, self.size, exemplar.boundary())?.with_classes(classes)?,
            class: class as u16,
            turns: &self.turns,
            radii: self.radii.as_deref(),
        })
    }
}

/// Radii of a pattern's disks in exemplar units: those of its attribute `radius`, if it has one.
fn disk_radii(exemplar: &PointPattern) -> Result<Option<Vec<f64>>, AnalysisError> {
    let Some(radii) = exemplar.radii_in(exemplar.domain().exemplar_unit()) else { return Ok(None) };
    check_radii(&Cloud::of(exemplar), &radii)?;
    Ok(Some(radii))
}

/// Points per unit area, in exemplar units.
fn density(exemplar: &PointPattern) -> f64 {
    let size = exemplar.domain().size_in_exemplar_units();
    exemplar.len() as f64 / (size.x * size.y)
}
