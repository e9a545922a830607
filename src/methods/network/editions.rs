//! What presets were before. A link names a preset and what differs from it; it says by the presets' edition which values
//! it means, and keeps them when presets change.
//!
//! Whoever changes a preset, or what suits lattices, once links of the present edition are about: raise [`EDITION`], and
//! say in `BEFORE` what held until then. A parameter that did not exist gets the value that does nothing. As long as no
//! such link is about there is nothing to do but to record the presets anew:
//! `cargo test --test link -- --ignored record_the_presets`.

use serde_json::Value;

use super::parameters::{PARAMETERS, Parameters};
use super::presets::Preset;
use crate::pattern::PointPattern;

/// The edition of the presets' values. Links of the first one do not say so.
pub const EDITION: u32 = 1;

/// Values a preset had.
#[derive(Clone, Copy, Debug)]
struct Before {
    /// The last edition that had them.
    until: u32,
    preset: Preset,
    /// For lattices, for all others, or for both.
    lattices: Option<bool>,
    /// Names and values as in links.
    values: &'static [(&'static str, &'static str)],
}

/// The newest first. For example, after `alignment` of Fast was raised from 20 and lattices got another
/// `sigma-coarse-cells`, and `EDITION` became 2:
/// `Before { until: 1, preset: Preset::Fast, lattices: None, values: &[("alignment", "20")] }`,
/// `Before { until: 1, preset: Preset::Fast, lattices: Some(true), values: &[("sigma-coarse-cells", "0.45")] }`.
const BEFORE: [Before; 0] = [];

/// What of a preset was different for this exemplar in an earlier edition, under the names in files.
#[must_use]
pub fn values_before(edition: u32, preset: Preset, exemplar: &PointPattern) -> Vec<(&'static str, Value)> {
    // Most links are of this edition, and whether points are a lattice takes a while.
    if edition >= EDITION { Vec::new() } else { differences(&BEFORE, edition, preset, exemplar) }
}

fn differences(table: &[Before], edition: u32, preset: Preset, exemplar: &PointPattern) -> Vec<(&'static str, Value)> {
    let is_lattice = Parameters::is_lattice(exemplar);
    let holds = |before: &&Before| {
        before.until >= edition && before.preset == preset && before.lattices.is_none_or(|wanted| wanted == is_lattice)
    };
    let mut values: Vec<(&'static str, Value)> = Vec::new();
    for &(name, text) in table.iter().filter(holds).flat_map(|before| before.values) {
        let value = text.parse::<f64>().map_or_else(|_| Value::from(text), Value::from);
        let parameter = PARAMETERS.iter().find(|parameter| parameter.name == name);
        let Some(value) = parameter.and_then(|parameter| parameter.nearest(&value)) else { continue };
        // What held longer ago comes later.
        values.retain(|(other, _)| *other != name);
        values.push((name, value));
    }
    values
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::gallery;

    #[test]
    fn a_link_gets_what_held_in_its_edition() {
        let all = |until, preset, values| Before { until, preset, lattices: None, values };
        let table = [
            all(3, Preset::Fast, &[("alignment", "40"), ("class-maps", "pooled")]),
            all(2, Preset::Fast, &[("alignment", "30")]),
            all(2, Preset::Best, &[("alignment", "99")]),
            Before { until: 1, preset: Preset::Fast, lattices: Some(true), values: &[("frequency", "2.5")] },
            Before { until: 1, preset: Preset::Fast, lattices: Some(false), values: &[("frequency", "3.5")] },
            all(1, Preset::Fast, &[("no-such-thing", "1")]),
        ];
        let of = |edition, name: &str| {
            let exemplar = gallery::find(name).map(gallery::Entry::exemplar);
            exemplar.map(|exemplar| differences(&table, edition, Preset::Fast, &exemplar)).unwrap_or_default()
        };
        assert_eq!(of(4, "rings"), []);
        assert_eq!(of(3, "rings"), [("alignment", json!(40)), ("class-maps", json!("pooled"))]);
        assert_eq!(of(2, "rings"), [("class-maps", json!("pooled")), ("alignment", json!(30))]);
        assert_eq!(of(1, "rings").last(), Some(&("frequency", json!(3.5))));
        assert_eq!(of(1, "square-grid").last(), Some(&("frequency", json!(2.5))));
    }

    #[test]
    fn what_is_said_of_earlier_presets_can_be_used() {
        for before in BEFORE {
            assert!(before.until < EDITION, "edition {} is still the present one", before.until);
            for (name, text) in before.values {
                let value = text.parse::<f64>().map_or_else(|_| Value::from(*text), Value::from);
                let parameter = PARAMETERS.iter().find(|parameter| parameter.name == *name);
                let allowed = parameter.and_then(|parameter| parameter.nearest(&value));
                assert!(allowed.is_some_and(|it| it == value || it.as_f64() == value.as_f64()), "{name} {text}");
            }
        }
    }
}
