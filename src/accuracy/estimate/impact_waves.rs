//! Exact times of the waves of a plain impact: whether a plateau is left behind the shock.
//!
//! The release wave from the rear of the flyer runs through the plateau, catches the shock and
//! weakens it. From then on the pressure behind the shock falls, and no plateau is left. The times
//! follow from the equations of state alone, so that no exact profile is needed.

use super::surroundings::surroundings;
use crate::accuracy::reference::impact_of;
use crate::exact::{Impact, Release};
use crate::scene::{CheckedScene, FlyerImpact};

/// The waves of an impact of two fluids with straight Us-up lines.
#[derive(Clone, Debug)]
pub struct ImpactWaves {
    /// The two bodies.
    pub impact: Impact,
    /// States and times of the waves, from the time of contact.
    pub release: Release,
}

/// What the exact waves tell about the plateau behind the shock at some time.
#[derive(Clone, Debug, PartialEq)]
pub enum PlateauLeft {
    /// There is a plateau of this length \[m\].
    Length(f64),
    /// There is none, for this reason.
    None(String),
    /// The waves are not known at this time.
    Unknown,
}

impl ImpactWaves {
    /// The waves of the impact of the other body on `body`. `None` unless the scene has two fluids
    /// at zero pressure with straight Us-up lines, free surfaces, and no forces.
    pub fn new(scene: &CheckedScene, body: usize) -> Option<ImpactWaves> {
        let named = |b: usize| scene.scene.bodies[b].name.clone();
        let is_plain = |b: usize| {
            let (own, material) = (&scene.scene.bodies[b], scene.material_of(b));
            let is_fluid = material.strength.is_none()
                && material.failure.is_none()
                && material.erosion.is_none()
                && material.eos.straight(material.density).is_some();
            is_fluid && own.pressure == 0.0 && own.velocity_field.is_none()
        };
        if scene.bodies.len() != 2 || ![0, 1].into_iter().all(is_plain) {
            return None;
        }
        if !surroundings(scene).is_empty() {
            return None;
        }
        let impact = FlyerImpact { flyer: named(1 - body), target: named(body), front: None };
        let (impact, _) = impact_of(scene, &impact).ok()?;
        let release = impact.release(4).ok()?;
        Some(ImpactWaves { impact, release })
    }

    /// Compressions 1 - rho0/rho of the struck and of the striking body behind the shocks \[-\].
    pub fn compressions(&self) -> Option<[f64; 2]> {
        let behind = &self.release.states[0];
        let compression = |rho0: f64, rho: Option<f64>| Some(1.0 - rho0 / rho?);
        let Impact { target, flyer, .. } = &self.impact;
        Some([
            compression(target.material.rho0, behind.rho_target)?,
            compression(flyer.material.rho0, behind.rho_flyer)?,
        ])
    }

    /// The plateau in the struck body at the time `t` of the scene \[s\].
    pub fn plateau(&self, t: f64) -> PlateauLeft {
        let (release, target) = (&self.release, &self.impact.target);
        let since = t - self.impact.contact_time;
        if since <= 0.0 {
            return PlateauLeft::None("the bodies have not met yet".into());
        }
        let shock = release.target_shock * since;
        if shock >= target.upper - target.lower {
            return PlateauLeft::Unknown;
        }
        if since >= release.catch_up_time {
            let caught = self.impact.contact_time + release.catch_up_time;
            return PlateauLeft::None(format!(
                "the release wave from the rear of the flyer has caught the shock at {:.4} us",
                1e6 * caught
            ));
        }
        let head = release.target_head * (since - release.head_time).max(0.0);
        let compression = release.states[0].rho_target.unwrap_or(target.material.rho0);
        PlateauLeft::Length((shock - head) * target.material.rho0 / compression)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::reference::ReferenceSolution;
    use crate::input;

    /// `inputs/flyer.json` with these changes.
    fn flyer(changes: &[(&str, serde_json::Value)]) -> CheckedScene {
        let mut scene = crate::accuracy::plan::standard();
        for (path, value) in changes {
            *scene.pointer_mut(path).unwrap() = value.clone();
        }
        input::parse(scene.to_string().as_bytes(), "flyer.json", &[]).unwrap()
    }

    #[test]
    fn the_plateau_is_that_of_the_exact_profile() {
        let scene = flyer(&[]);
        let waves = ImpactWaves::new(&scene, 1).unwrap();
        let Some(ReferenceSolution::Impact(exact)) = ReferenceSolution::new(&scene).unwrap() else {
            panic!("the scene has a reference");
        };
        for snapshot in &exact.solution.snapshots[..3] {
            let [from, to] = snapshot.landmarks.as_ref().unwrap().plateau.unwrap();
            let PlateauLeft::Length(length) = waves.plateau(snapshot.time) else {
                panic!("no plateau at {}", snapshot.time);
            };
            assert!((length / (to - from) - 1.0).abs() < 1e-9, "{length} {from} {to}");
        }
        assert_eq!(waves.plateau(0.0), PlateauLeft::None("the bodies have not met yet".into()));
    }

    #[test]
    fn compressions_are_those_of_the_impedance_match() {
        // u/Us of rho_t u (c_t + s_t u) = rho_f (V - u) (c_f + s_f (V - u)), solved by bisection
        let waves = ImpactWaves::new(&flyer(&[]), 1).unwrap();
        let [struck, striking] = waves.compressions().unwrap();
        assert!((struck - 0.109_478_360_181).abs() < 1e-9, "{struck}");
        assert!((striking - 0.070_238_730_101).abs() < 1e-9, "{striking}");
    }

    #[test]
    fn no_plateau_is_left_once_the_shock_is_caught() {
        // half of the flyer of 0.5 mm, whose release catches the shock at 1.742580 us
        let scene = flyer(&[("/bodies/0/box/lower", serde_json::json!([-2.5e-4]))]);
        let waves = ImpactWaves::new(&scene, 1).unwrap();
        assert!(matches!(waves.plateau(0.871e-6), PlateauLeft::Length(l) if l < 1e-5));
        let PlateauLeft::None(reason) = waves.plateau(0.8715e-6) else { panic!("a plateau") };
        assert!(reason.ends_with("has caught the shock at 0.8713 us"), "{reason}");
        // the shock has reached the end of the target
        let scene = flyer(&[("/bodies/1/box/upper", serde_json::json!([1e-3]))]);
        let waves = ImpactWaves::new(&scene, 1).unwrap();
        assert_eq!(waves.plateau(2e-7), PlateauLeft::Unknown);
    }
}
