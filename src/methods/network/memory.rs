//! Whether a run fits into memory and on a grid, and what to do where it does not.

use glam::DVec2;

use super::NetworkError;
use super::exemplar::PreparedExemplar;
use super::parameters::Parameters;
use crate::engine::ScaleSetup;
use crate::engine::cpu::CpuEngine;
use crate::pattern::PointPattern;

/// Bytes a run takes at its peak, with these parameters.
fn needed(exemplar: &PointPattern, prepared: &PreparedExemplar, parameters: &Parameters) -> u64 {
    let output_size = prepared.size * DVec2::new(parameters.expansion_x, parameters.expansion_y);
    // The last class sees all maps.
    let weights = prepared.weights(exemplar.classes(), prepared.order.len(), &[]);
    let area = parameters.expansion_x * parameters.expansion_y;
    let points = (exemplar.len() as f64 * area).ceil() as usize;
    let schedule = prepared.schedule(parameters);
    let bytes = schedule.scales.iter().map(|scale| {
        let settings = parameters.scale_settings(scale, (0, 0));
        let positions = prepared.positions.clone();
        let setup = ScaleSetup {
            exemplar_weights: weights.clone(),
            ..ScaleSetup::new(&settings, positions, prepared.size, exemplar.boundary(), output_size)
        };
        CpuEngine::bytes_for(&setup, parameters.channels as usize, points)
    });
    bytes.max().unwrap_or(0)
}

/// The widest σ in sides of the domain. It grows with how much the points gather, and the grid's margin with it: at this
/// width an iteration takes about as long as twenty of an exemplar whose points fill it. Clusters that fit into their
/// domain stay below 1.
const WIDEST_SIGMA: f64 = 4.0;

/// Checks that a run fits into `limit` bytes, and that the points fill enough of their domain for a grid to hold both.
///
/// # Errors
/// [`NetworkError::Crowded`] where they don't, and [`NetworkError::Memory`] when it does not, with what would fit, changing one parameter at a time.
pub(super) fn check(
    exemplar: &PointPattern,
    prepared: &PreparedExemplar,
    parameters: &Parameters,
    limit: u64,
) -> Result<(), NetworkError> {
    let schedule = prepared.schedule(parameters);
    let widest = schedule.scales.iter().map(|scale| scale.sigma).fold(0.0, f64::max);
    // Clark & Evans's index: where it is not small, a wide σ was asked for by the parameters.
    let aggregation = 2.0 * prepared.spacing * prepared.density.sqrt();
    if widest > WIDEST_SIGMA && aggregation < 0.25 {
        return Err(NetworkError::Crowded { times: 1.0 / aggregation, points: exemplar.len() });
    }
    let needed_bytes = needed(exemplar, prepared, parameters);
    if needed_bytes <= limit {
        return Ok(());
    }
    let fits = |change: &dyn Fn(&mut Parameters)| {
        let mut changed = parameters.clone();
        change(&mut changed);
        needed(exemplar, prepared, &changed) <= limit
    };
    let mut ways = Vec::new();
    if let Some(channels) =
        (4..parameters.channels).rev().find(|&c| c % 4 == 0 && fits(&|p: &mut Parameters| p.channels = c))
    {
        ways.push(format!("'channels' to {channels}"));
    }
    let shrink = |share: f64| (parameters.expansion_x * share, parameters.expansion_y * share);
    if let Some((x, y)) = (1..20)
        .rev()
        .map(|i| shrink(f64::from(i) / 20.0))
        .find(|&(x, y)| x >= 0.25 && y >= 0.25 && fits(&|p: &mut Parameters| (p.expansion_x, p.expansion_y) = (x, y)))
    {
        ways.push(format!("the expansion to {x:.2} × {y:.2}"));
    }
    let grid = |g: u32| {
        fits(&|p: &mut Parameters| {
            p.grid_max = g;
            p.grid_min = p.grid_min.min(g);
        })
    };
    if let Some(grid) = (16..parameters.grid_max).rev().step_by(4).find(|&g| grid(g)) {
        ways.push(format!("'grid-max' to {grid}"));
    }
    if ways.is_empty() {
        ways.push("'channels', the expansion and 'grid-max' together".to_owned());
    }
    let mb = |bytes: u64| bytes.div_ceil(1_000_000);
    let lower = ways.join(" or ");
    Err(NetworkError::Memory { needed_mb: mb(needed_bytes), limit_mb: limit / 1_000_000, lower })
}
