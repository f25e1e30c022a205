//! Ledger of a scene: the parts of a step that it uses, with their memory and computing time.

use serde::{Deserialize, Serialize};

use super::EffectRegistry;
use crate::scene::CheckedScene;
use crate::solver::columns::Columns;
use crate::solver::effect::{part_names, uses_part};

/// One line of the ledger.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectUse {
    /// Name of the effect; `motion` is the part that every scene has.
    pub effect: String,
    /// Whether the scene uses it.
    pub active: bool,
    /// Its particle columns.
    pub columns: Vec<String>,
    /// Bytes per particle.
    pub bytes_per_particle: usize,
    /// Bytes per ghost, in messages and memory.
    pub bytes_per_ghost: usize,
    /// Share of the computing time of patches [-], sampled in the run; none without a run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step_share: Option<f64>,
}

/// Ledger of a scene; `shares` are the shares of the [parts] of a step in the computing time [-].
pub fn ledger(scene: &CheckedScene, columns: &Columns, shares: Option<&[f64]>) -> Vec<EffectUse> {
    let line = |name: &str, part: Option<usize>| {
        let specs = || columns.specs.iter().zip(&columns.owners);
        let own = || specs().filter(move |(_, owner)| **owner == part).map(|(spec, _)| spec);
        let share = shares.map(|all| match part {
            Some(part) => all.get(part).copied().unwrap_or(0.0),
            None => 1.0 - all.iter().sum::<f64>(),
        });
        EffectUse {
            effect: name.to_string(),
            active: part.is_none_or(|part| uses_part::<EffectRegistry>(part, scene)),
            columns: own().map(|s| s.name.to_string()).collect(),
            bytes_per_particle: 8 * own().count(),
            bytes_per_ghost: 8 * own().filter(|s| s.ghost).count(),
            step_share: share,
        }
    };
    let names = part_names::<EffectRegistry>();
    let parts = names.iter().enumerate().map(|(part, name)| line(name, Some(part)));
    std::iter::once(line("motion", None)).chain(parts).collect()
}

/// Active lines of the ledger, as text.
pub fn ledger_lines(ledger: &[EffectUse]) -> Vec<Vec<String>> {
    let heading = ["effect", "bytes per particle", "bytes per ghost", "share of step"];
    let mut lines = vec![heading.map(String::from).to_vec()];
    lines.extend(ledger.iter().filter(|line| line.active).map(|line| {
        vec![
            line.effect.clone(),
            line.bytes_per_particle.to_string(),
            line.bytes_per_ghost.to_string(),
            line.step_share.map_or("-".into(), |share| format!("{:.1} %", 100.0 * share)),
        ]
    }));
    lines
}

/// Inactive effects in one line; bytes and share are sums over their declared columns and measured
/// times.
pub fn ledger_rest(ledger: &[EffectUse]) -> String {
    let off = || ledger.iter().filter(|line| !line.active);
    let names: Vec<&str> = off().map(|line| line.effect.as_str()).collect();
    let bytes: usize = off().map(|line| line.bytes_per_particle).sum();
    // a sum of no terms is -0
    let share: f64 = off().filter_map(|line| line.step_share).fold(0.0, |sum, share| sum + share);
    format!("off, {bytes} bytes and {:.0} % of the step: {}", 100.0 * share, names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_that_was_not_measured_is_no_negative_zero() {
        assert!(ledger_rest(&[]).contains("and 0 % of the step"));
    }

    #[test]
    fn effects_that_are_off_have_no_column() {
        let root = env!("CARGO_MANIFEST_DIR");
        for name in [
            "flyer",
            "piston_elastic_plastic",
            "spall",
            "soft_flyer",
            "vortex",
            "detonation",
            "porous_impact",
        ] {
            let text = std::fs::read(format!("{root}/inputs/{name}.json")).unwrap();
            let scene = crate::input::parse(&text, name, &[]).unwrap();
            let columns = crate::effects::columns(&scene);
            let all = ledger(&scene, &columns, None);
            for line in &all {
                assert_eq!(line.active, line.bytes_per_particle > 0, "{name}: {line:?}");
            }
            let bytes: usize = all.iter().map(|line| line.bytes_per_particle).sum();
            assert_eq!(bytes, 8 * columns.specs.len(), "{name}");
        }
    }
}
