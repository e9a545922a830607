//! Which steps of [`crate::finish`] follow which scale.

use super::parameters::Parameters;
use crate::finish::Finishing;

/// What is put right after a scale that `left` others follow; none when nothing is.
pub(super) fn finishing_after(parameters: &Parameters, left: usize, has_disks: bool) -> Option<Finishing> {
    let &Parameters { repair_scales, iterations_polish, .. } = parameters;
    if repair_scales > 0 && left >= repair_scales as usize {
        return None;
    }
    let finishing = Finishing {
        spacing_floor: parameters.spacing_floor,
        relocation: parameters.relocation,
        alignment: if left == 0 { parameters.alignment } else { 0 },
        // Before the last pass too, which then gives moved points their places.
        single_moves: if left <= usize::from(iterations_polish > 0) { parameters.transplants } else { 0 },
        disk_overlap: parameters.disk_overlap,
        value_swaps: parameters.value_swaps,
        is_last: left == 0,
    };
    (!finishing.is_idle(has_disks)).then_some(finishing)
}

#[cfg(test)]
mod tests {
    use super::super::Preset;
    use super::*;

    #[test]
    fn fast_finishes_every_scale_and_paper_its_last() {
        let fast = Parameters::preset(Preset::Fast);
        let after = |parameters: &Parameters, left| finishing_after(parameters, left, false);
        let steps = |left| after(&fast, left).map(|it| (it.alignment > 0, it.single_moves > 0, it.is_last));
        assert_eq!(
            [4, 1, 0].map(steps),
            [Some((false, false, false)), Some((false, true, false)), Some((true, true, true))]
        );
        let paper = Parameters::preset(Preset::Paper);
        assert!(after(&paper, 1).is_none() && after(&paper, 0).is_some());
        let none = Parameters {
            spacing_floor: 0.0,
            relocation: 0.0,
            alignment: 0,
            transplants: 0,
            value_swaps: 0,
            ..Parameters::preset(Preset::Fast)
        };
        assert!(after(&none, 0).is_none());
        assert!(finishing_after(&none, 0, true).is_some(), "disks are parted all the same");
    }
}
