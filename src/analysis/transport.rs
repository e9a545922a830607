//! Distances between two sets of points: Chamfer, Wasserstein, and the paper's comparison by patches.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::cloud::Cloud;
use super::error::AnalysisError;
use super::pair_correlation::{PairCorrelationSettings, pair_correlation};
use super::spacing::relative_radius;
use crate::pattern::Boundary;

/// Most points of a set in an exact assignment, whose cost grows with the cube: some seconds at this size.
pub const MAX_ASSIGNMENT: usize = 3000;

/// The Chamfer distance: the mean distance from a point of `a` to the nearest of `b`, plus the same from `b` to `a`;
/// distances are not squared. This reading matches the magnitudes Huang et al. (2022, table 1) report.
///
/// # Errors
/// When a set is empty.
pub fn chamfer(a: &[DVec2], b: &[DVec2]) -> Result<f64, AnalysisError> {
    not_empty("the Chamfer distance", a, b)?;
    let one_way = |from: &[DVec2], to: &[DVec2]| {
        let nearest =
            |point: DVec2| to.iter().map(|other| point.distance_squared(*other)).fold(f64::INFINITY, f64::min);
        from.iter().map(|&point| nearest(point).sqrt()).sum::<f64>() / from.len() as f64
    };
    Ok(one_way(a, b) + one_way(b, a))
}

/// The Wasserstein distance: the root of the summed squared distances of the best one-to-one assignment. With sets of
/// different sizes every point of the smaller one is assigned, and the rest of the larger one stays over. Not divided
/// by the number of points, as matches the magnitudes Huang et al. (2022, table 1) report.
///
/// # Errors
/// When a set is empty, or the smaller one has over [`MAX_ASSIGNMENT`] points.
pub fn wasserstein(a: &[DVec2], b: &[DVec2]) -> Result<f64, AnalysisError> {
    const WHAT: &str = "the Wasserstein distance";
    not_empty(WHAT, a, b)?;
    let (few, many) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    if many.len() > MAX_ASSIGNMENT {
        return Err(AnalysisError::TooManyPoints { what: WHAT, count: many.len(), max: MAX_ASSIGNMENT });
    }
    let partner = assignment(few.len(), many.len(), |i, j| few[i].distance_squared(many[j]));
    let sum: f64 = few.iter().zip(partner).map(|(point, j)| point.distance_squared(many[j])).sum();
    Ok(sum.sqrt())
}

fn not_empty(what: &'static str, a: &[DVec2], b: &[DVec2]) -> Result<(), AnalysisError> {
    if a.is_empty() || b.is_empty() {
        return Err(AnalysisError::TooFewPoints { what, count: 0, needed: 1 });
    }
    Ok(())
}

/// The cheapest assignment of every row to a column of its own: the column of each row. `cost(row, column)` must be
/// finite; there must be at least as many columns as rows, else the rows beyond have no partner and are left out.
///
/// Jonker & Volgenant's (1987) shortest augmenting paths, the rectangular way (Crouse 2016): O(rows² · columns) time,
/// O(rows + columns) memory.
fn assignment(rows: usize, columns: usize, cost: impl Fn(usize, usize) -> f64) -> Vec<usize> {
    let rows = rows.min(columns);
    const FREE: usize = usize::MAX;
    let mut row_of = vec![FREE; columns];
    let mut column_of = vec![FREE; rows];
    let (mut row_price, mut column_price) = (vec![0.0; rows], vec![0.0; columns]);
    let mut shortest = vec![0.0; columns];
    let mut before = vec![FREE; columns];
    let mut rest: Vec<usize> = Vec::with_capacity(columns);
    let mut visited_columns: Vec<usize> = Vec::with_capacity(columns);
    for start in 0..rows {
        // Dijkstra over columns, from a row without a partner to a column without one.
        shortest.fill(f64::INFINITY);
        rest.clear();
        rest.extend(0..columns);
        visited_columns.clear();
        let (mut row, mut length) = (start, 0.0);
        let sink = loop {
            let (mut nearest, mut at) = (f64::INFINITY, 0);
            for (place, &column) in rest.iter().enumerate() {
                let through = length + cost(row, column) - row_price[row] - column_price[column];
                if through < shortest[column] {
                    shortest[column] = through;
                    before[column] = row;
                }
                // Among equals a column without a partner ends the path at once.
                let better = shortest[column] < nearest;
                if better || (shortest[column] == nearest && row_of[column] == FREE) {
                    (nearest, at) = (shortest[column], place);
                }
            }
            length = nearest;
            let column = rest.swap_remove(at);
            visited_columns.push(column);
            if row_of[column] == FREE {
                break column;
            }
            row = row_of[column];
        };
        row_price[start] += length;
        for &column in &visited_columns {
            let slack = length - shortest[column];
            column_price[column] -= slack;
            if row_of[column] != FREE {
                row_price[row_of[column]] += slack;
            }
        }
        // Turn the path round.
        let mut column = sink;
        loop {
            let row = before[column];
            row_of[column] = row;
            std::mem::swap(&mut column, &mut column_of[row]);
            if row == start {
                break;
            }
        }
    }
    column_of
}

/// The paper's comparison (Huang et al. 2022, §5): the output is cut into patches of about the exemplar's size, each
/// stretched onto the exemplar's rectangle and compared with it; numbers are means over the patches. With an output
/// of twice the exemplar's width and height these are its four patches.
///
/// Lengths are in the exemplar's unit. Low is not good by itself for Chamfer and Wasserstein: below independent
/// samples of a stochastic pattern they mean that positions were copied.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatchComparison {
    /// Columns and rows of patches.
    pub patches: [usize; 2],
    /// Mean of [`chamfer`].
    pub chamfer: f64,
    /// Mean of [`wasserstein`]; none with over [`MAX_ASSIGNMENT`] points.
    pub wasserstein: Option<f64>,
    /// Mean squared error of the pair correlation, both sides as windows, with Öztireli & Gross's kernel.
    pub pair_correlation_error: f64,
    /// The same with a kernel 25 times narrower, which matches the magnitudes of the paper's table 1 and is mostly the
    /// noise of the estimate.
    pub narrow_pair_correlation_error: f64,
    /// Mean of ρ.
    pub relative_radius: f64,
}

/// Compares by patches; see [`PatchComparison`]. The output must be in the exemplar's unit. Patches with fewer than
/// two points are left out.
///
/// # Errors
/// When the exemplar has fewer than two points, or every patch has.
pub fn compare_patches(exemplar: &Cloud, output: &Cloud) -> Result<PatchComparison, AnalysisError> {
    const WHAT: &str = "a comparison by patches";
    exemplar.at_least(WHAT, 2)?;
    // A patch of a tile is a window: both sides are treated as one.
    let exemplar = Cloud::new(exemplar.points().to_vec(), exemplar.size(), Boundary::Open)?;
    let count = (output.size() / exemplar.size()).round().clamp(DVec2::ONE, DVec2::splat(64.0));
    let patches = [count.x as usize, count.y as usize];
    let settings = PairCorrelationSettings::suited_to(&exemplar);
    let narrow = settings.with_sigma(settings.sigma / 25.0);
    let target = pair_correlation(&exemplar, &settings)?;
    let narrow_target = pair_correlation(&exemplar, &narrow)?;

    let mut contents = vec![Vec::new(); patches[0] * patches[1]];
    for &point in output.points() {
        let place = point / output.size() * count;
        let [column, row] = [(place.x as usize).min(patches[0] - 1), (place.y as usize).min(patches[1] - 1)];
        let inside = (place - DVec2::new(column as f64, row as f64)).clamp(DVec2::ZERO, DVec2::ONE);
        contents[row * patches[0] + column].push(inside * exemplar.size());
    }
    contents.retain(|points| points.len() >= 2);
    if contents.is_empty() {
        return Err(AnalysisError::TooFewPoints { what: WHAT, count: output.len(), needed: 2 });
    }
    let number = contents.len() as f64;
    let mut sums = [0.0; 4];
    let mut transport = Some(0.0);
    for points in contents {
        sums[0] += chamfer(exemplar.points(), &points)?;
        transport = match (transport, wasserstein(exemplar.points(), &points)) {
            (Some(sum), Ok(distance)) => Some(sum + distance),
            _ => None,
        };
        let patch = Cloud::new(points, exemplar.size(), Boundary::Open)?;
        let error = |target: &super::PairCorrelation, settings: &PairCorrelationSettings| {
            pair_correlation(&patch, settings).map(|own| own.mean_squared_difference(target).unwrap_or(f64::INFINITY))
        };
        sums[1] += error(&target, &settings)?;
        sums[2] += error(&narrow_target, &narrow)?;
        sums[3] += relative_radius(&patch)?;
    }
    let [chamfer, pair_correlation_error, narrow_pair_correlation_error, relative_radius] =
        sums.map(|sum| sum / number);
    Ok(PatchComparison {
        patches,
        chamfer,
        wasserstein: transport.map(|sum| sum / number),
        pair_correlation_error,
        narrow_pair_correlation_error,
        relative_radius,
    })
}
