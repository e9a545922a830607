//! Whether a run fits into memory, and what to lower where it does not.

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

/// Checks that a run fits into `limit` bytes.
///
/// # Errors
/// [`NetworkError::Memory`] when it does not, with what would fit, changing one parameter at a time.
pub(super) fn check(
    exemplar: &PointPattern,
    prepared: &PreparedExemplar,
    parameters: &Parameters,
    limit: u64,
) -> Result<(), NetworkError> {
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
