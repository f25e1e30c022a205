//! The ledger of effects: which a scene calls for, what each takes, and that the others take
//! nothing.

pub mod artificial_viscosity;
pub mod burn;
pub mod contact;

use serde::{Deserialize, Serialize};

use crate::scene::{CheckedScene, Eos, Transfer};
use crate::solver::particles::Columns;

/// What a scene may call for beside the motion of fluids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Artificial viscosity, and its limiter.
    Viscosity,
    /// Relaxation of the pressure or of volumes.
    Relaxation,
    /// The affine part of APIC's velocity.
    Affine,
    /// Stress as a tensor, of solids and of fluids with strength.
    Stress,
    /// Strength.
    Strength,
    /// Failure.
    Failure,
    /// Particles that are taken out at a limit.
    Erosion,
    /// Temperature.
    Temperature,
    /// Conduction of heat.
    Conduction,
    /// Pores that close.
    Pores,
    /// A detonation's front.
    Burn,
    /// Contact between velocity fields of the bodies' own.
    Contact,
    /// A body force.
    BodyForce,
    /// A grid that accelerates with a piston.
    AcceleratedGrid,
    /// Transmitting sides.
    TransmittingSides,
    /// Sides loaded by a pressure.
    LoadedSides,
}

impl Effect {
    /// Number of them.
    pub const COUNT: usize = Self::ALL.len();

    /// All of them, in order.
    pub const ALL: [Effect; 16] = [
        Effect::Viscosity,
        Effect::Relaxation,
        Effect::Affine,
        Effect::Stress,
        Effect::Strength,
        Effect::Failure,
        Effect::Erosion,
        Effect::Temperature,
        Effect::Conduction,
        Effect::Pores,
        Effect::Burn,
        Effect::Contact,
        Effect::BodyForce,
        Effect::AcceleratedGrid,
        Effect::TransmittingSides,
        Effect::LoadedSides,
    ];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Effect::Viscosity => "artificial viscosity",
            Effect::Relaxation => "relaxation",
            Effect::Affine => "affine velocity",
            Effect::Stress => "stress tensor",
            Effect::Strength => "strength",
            Effect::Failure => "failure",
            Effect::Erosion => "erosion",
            Effect::Temperature => "temperature",
            Effect::Conduction => "conduction",
            Effect::Pores => "pores",
            Effect::Burn => "burn",
            Effect::Contact => "contact",
            Effect::BodyForce => "body force",
            Effect::AcceleratedGrid => "accelerated grid",
            Effect::TransmittingSides => "transmitting sides",
            Effect::LoadedSides => "loaded sides",
        }
    }

    /// The effect that a column is there for; none: the motion itself.
    pub fn of_column(name: &str) -> Option<Effect> {
        Some(match name {
            "artificial_viscosity" | "viscosity_limiter" => Effect::Viscosity,
            "pressure_mid" | "compliance" => Effect::Relaxation,
            "plastic_strain" | "energy_mid" | "plastic_increment" | "plastic_work" => {
                Effect::Strength
            }
            "damage" | "released_energy" => Effect::Failure,
            "temperature" | "stored_work" => Effect::Temperature,
            "heat_capacity" | "heat_conductance" | "heat_received" => Effect::Conduction,
            "distension" => Effect::Pores,
            "lighting_time" | "burn_fraction" => Effect::Burn,
            "contact_impulse" | "current_volume" => Effect::Contact,
            _ if name.starts_with("displacement") => Effect::Contact,
            _ if name.starts_with("affine_") => Effect::Affine,
            _ if name.starts_with("deviator_") || name.starts_with("rate_") => Effect::Strength,
            // of the volume's stress the first component is the pressure's
            "stress_volume_xx" => return None,
            _ if name.starts_with("stress_") && name != "stress_volume" => Effect::Stress,
            _ if name.starts_with("body_force") || name.starts_with("reference_position") => {
                Effect::BodyForce
            }
            _ if name.starts_with("frame_force") => Effect::AcceleratedGrid,
            "load_volume" | "load_mark" => Effect::LoadedSides,
            _ if name.starts_with("side_") => Effect::TransmittingSides,
            _ => return None,
        })
    }

    /// Whether `scene` calls for it.
    fn is_on(self, scene: &CheckedScene) -> bool {
        let materials = || (0..scene.bodies.len()).map(|i| scene.material_of(i));
        let (whole, method) = (&scene.scene, &scene.scene.method);
        match self {
            Effect::Viscosity => whole.artificial_viscosity.is_some(),
            Effect::Relaxation => {
                method.pressure_relaxation.is_some() || method.volume_relaxation.is_some()
            }
            Effect::Affine => method.transfer == Transfer::Apic,
            Effect::Stress => scene.has_solids(),
            Effect::Strength => materials().any(|m| m.strength.is_some()),
            Effect::Failure => materials().any(|m| m.failure.is_some()),
            Effect::Erosion => scene.erodes(),
            Effect::Temperature => materials().any(|m| m.thermal.is_some()),
            Effect::Conduction => scene.conducts(),
            Effect::Pores => materials().any(|m| matches!(m.eos, Eos::PAlpha { .. })),
            Effect::Burn => materials().any(|m| m.eos.burn().is_some_and(|b| b.front().is_some())),
            Effect::Contact => scene.velocity_fields() > 1,
            Effect::BodyForce => whole.body_force.is_some(),
            Effect::AcceleratedGrid => scene.accelerates(),
            Effect::TransmittingSides => scene.transmits(),
            Effect::LoadedSides => scene.is_loaded(),
        }
    }
}

/// One line of the ledger.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectUse {
    /// Name of the effect; `motion` is what every scene has.
    pub effect: String,
    /// Whether the scene calls for it.
    pub on: bool,
    /// Its columns of a particle.
    pub columns: Vec<String>,
    /// Bytes of a particle.
    pub bytes_per_particle: usize,
    /// Bytes of a ghost, in messages and memory.
    pub bytes_per_ghost: usize,
    /// Share of the time that patches compute [-], from samples of the run; none without a run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step_share: Option<f64>,
}

/// The ledger of a scene; `shares` are the effects' shares of the computing time, in the order of
/// [`Effect::ALL`].
pub fn ledger(
    scene: &CheckedScene,
    columns: &Columns,
    shares: Option<[f64; Effect::COUNT]>,
) -> Vec<EffectUse> {
    let line = |effect: Option<Effect>| {
        let own = || columns.specs.iter().filter(move |s| Effect::of_column(s.name) == effect);
        let share = shares.map(|all| match effect {
            Some(effect) => all[effect as usize],
            None => 1.0 - all.iter().sum::<f64>(),
        });
        let on = effect.is_none_or(|effect| effect.is_on(scene));
        EffectUse {
            effect: effect.map_or("motion", Effect::name).to_string(),
            on,
            columns: own().map(|s| s.name.to_string()).collect(),
            bytes_per_particle: 8 * own().count(),
            bytes_per_ghost: 8 * own().filter(|s| s.ghost).count(),
            step_share: share.map(|share| if on { share } else { 0.0 }),
        }
    };
    std::iter::once(None).chain(Effect::ALL.map(Some)).map(line).collect()
}

/// What is on, as lines of text.
pub fn ledger_lines(ledger: &[EffectUse]) -> Vec<Vec<String>> {
    let heading = ["effect", "bytes a particle", "bytes a ghost", "share of step"];
    let mut lines = vec![heading.map(String::from).to_vec()];
    lines.extend(ledger.iter().filter(|line| line.on).map(|line| {
        vec![
            line.effect.clone(),
            line.bytes_per_particle.to_string(),
            line.bytes_per_ghost.to_string(),
            line.step_share.map_or("-".into(), |share| format!("{:.1} %", 100.0 * share)),
        ]
    }));
    lines
}

/// What is off, in one line; it has no column, as the ledger's numbers are sums over those.
pub fn ledger_rest(ledger: &[EffectUse]) -> String {
    let off: Vec<&str> = ledger.iter().filter(|l| !l.on).map(|l| l.effect.as_str()).collect();
    let bytes: usize = ledger.iter().filter(|l| !l.on).map(|l| l.bytes_per_particle).sum();
    format!("off, {bytes} bytes and 0 % of the step: {}", off.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_off_has_no_column() {
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
            let scene = crate::scene::parse(&text, name, &[]).unwrap();
            let columns = Columns::new(&scene);
            let all = ledger(&scene, &columns, None);
            for line in &all {
                assert_eq!(line.on, line.bytes_per_particle > 0, "{name}: {line:?}");
            }
            let bytes: usize = all.iter().map(|line| line.bytes_per_particle).sum();
            assert_eq!(bytes, 8 * columns.specs.len(), "{name}");
        }
    }
}
