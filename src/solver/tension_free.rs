//! Equations of state of particles that have failed and carry no tension, and of damaged ones that
//! carry a part of it.

use std::ops::Range;

use super::scheme::Scheme;
use crate::material::constitutive::{ConstitutiveModel, FailureModel, FluidModel, MidStep};
use crate::material::failure::Carried;
use crate::solver::patch::Patch;

/// Ranges of particles whose tension is reduced, or is not.
fn runs(damage: &[f64], gradual: bool) -> impl Iterator<Item = (bool, Range<usize>)> + '_ {
    let reduced = move |d: f64| d >= 1.0 || (gradual && d > 0.0);
    let mut at = 0;
    std::iter::from_fn(move || {
        let first = reduced(*damage.get(at)?);
        let start = at;
        at += damage[at..].iter().take_while(|&&d| reduced(d) == first).count();
        Some((first, start..at))
    })
}

/// Pressure and sound speed of particles that may have failed or, with a `gradual` failure model,
/// be damaged. A failed particle in tension is debris: it has no pressure, and its equation of
/// state reports no fault.
pub(super) fn refresh(
    (model, gradual, damage): (&dyn FluidModel, Option<&dyn FailureModel>, &[f64]),
    (jacobian, energy): (&[f64], &[f64]),
    mut history: Option<&mut [f64]>,
    (pressure, speed): (&mut [f64], &mut [f64]),
) -> Option<(usize, String)> {
    let mut found = None;
    for (reduced, particles) in runs(damage, gradual.is_some()) {
        if !reduced {
            let (p, c) = (&mut pressure[particles.clone()], &mut speed[particles.clone()]);
            let history = history.as_mut().map(|h| &mut h[particles.clone()]);
            let (j, e) = (&jacobian[particles.clone()], &energy[particles.clone()]);
            let fault = model.refresh(j, e, history, p, c);
            if let (None, Some((particle, what))) = (&found, fault) {
                found = Some((particles.start + particle, what));
            }
            continue;
        }
        for r in particles {
            let (p, c) = (&mut pressure[r..=r], &mut speed[r..=r]);
            let history = history.as_mut().map(|h| &mut h[r..=r]);
            if let (Some(gradual), true) = (gradual, damage[r] < 1.0) {
                let carried = gradual.carried(damage[r]);
                let fault = refresh_damaged(model, &carried, jacobian[r], energy[r], history, p, c);
                if let (None, Some(what)) = (&found, fault) {
                    found = Some((r, what));
                }
                continue;
            }
            let fault = model.refresh(&jacobian[r..=r], &energy[r..=r], history, p, c);
            let apart = p[0] < 0.0 && jacobian[r] > 0.0 && energy[r].is_finite();
            if p[0] < 0.0 {
                p[0] = 0.0;
            }
            if apart && (c[0].is_nan() || c[0] == 0.0) {
                c[0] = model.sound_speed_at(0.0);
            }
            if let (None, Some((_, what)), false) = (&found, fault, apart) {
                found = Some((r, what));
            }
        }
    }
    found
}

/// Pressure, sound speed and history variable of a damaged particle at the volume ratio `jacobian`
/// and `energy` [J/kg], one entry each; returns the fault of its state, if it has one.
fn refresh_damaged(
    model: &dyn FluidModel,
    carried: &Carried,
    jacobian: f64,
    energy: f64,
    mut history: Option<&mut [f64]>,
    pressure: &mut [f64],
    speed: &mut [f64],
) -> Option<String> {
    let start = history.as_ref().map(|h| h[0]);
    let mut state_at = |jacobian: f64| {
        if let (Some(history), Some(start)) = (&mut history, start) {
            history[0] = start;
        }
        let history = history.as_deref_mut();
        let fault = model.refresh(&[jacobian], &[energy], history, pressure, speed);
        (pressure[0], fault.map(|(_, what)| what))
    };
    let between = jacobian - carried.opening;
    let opens = carried.opening > 0.0 && between > 0.0;
    if let Some((tension, fault)) = opens.then(|| state_at(between))
        && is_stretched(between, tension, fault.is_some())
    {
        pressure[0] = carried.tension * tension;
        return fault;
    }
    let (intact, fault) = state_at(jacobian);
    let is_tension = intact < 0.0 && jacobian > 0.0 && energy.is_finite();
    if is_tension && carried.opening > 0.0 {
        // the cracks are closing, and the material between them is free of stress
        if let (Some(history), Some(start)) = (history, start) {
            history[0] = start;
        }
        (pressure[0], speed[0]) = (0.0, model.sound_speed_at(0.0));
        return None;
    }
    if is_tension {
        pressure[0] = carried.tension * intact;
    }
    fault
}

/// Whether material between cracks at the volume ratio `between` is in tension: an equation of state
/// may also give a negative pressure beyond the greatest compression for which it is valid.
fn is_stretched(between: f64, pressure: f64, fault: bool) -> bool {
    pressure < 0.0 && (between > 1.0 || !fault)
}

impl<const D: usize> Scheme<D> {
    /// Failure model of a body, if damage below 1 reduces its stress.
    pub(crate) fn gradual_failure(&self, body: usize) -> Option<&dyn FailureModel> {
        self.failures[body].as_deref().filter(|failure| failure.is_gradual())
    }

    /// Part of the stress that a particle of `body` with `damage` [-] carries.
    pub(crate) fn carried(&self, body: usize, damage: f64) -> Carried {
        self.failures[body].as_ref().map_or(Carried::WHOLE, |failure| failure.carried(damage))
    }

    /// Pressure that particle `r` of `body`, a fluid, carries at the volume ratio in its column and
    /// `energy` [J/kg]; its history variable stays as it is.
    pub(crate) fn carried_pressure(
        &self,
        patch: &Patch<D>,
        body: usize,
        r: usize,
        energy: f64,
    ) -> f64 {
        let (ConstitutiveModel::Fluid(model), Some(damage)) =
            (&self.models[body], self.columns.tension_free[body])
        else {
            return 0.0;
        };
        let carried = self.carried(body, patch.block.columns[damage][r]);
        let jacobian = patch.block.columns[self.columns.jacobian][r];
        let mut history = self.history[body].map(|h| [patch.block.columns[h][r]]);
        let history = history.as_mut().map(|h| &mut h[..]);
        let [mut p, mut c] = [[0.0]; 2];
        refresh_damaged(model.as_ref(), &carried, jacobian, energy, history, &mut p, &mut c);
        p[0]
    }

    /// Pressure of the material between the open cracks of particle `r` of `body`, a fluid, at the
    /// middle of the step [Pa], and its compliance; see [`MidStep::compliance`].
    pub(crate) fn mid_pressure_between_cracks(
        &self,
        patch: &Patch<D>,
        body: usize,
        r: usize,
        opening: f64,
    ) -> [f64; 2] {
        let (c, ConstitutiveModel::Fluid(model)) = (&self.columns, &self.models[body]) else {
            return [0.0; 2];
        };
        let column = |k: usize| &patch.block.columns[k][r..=r];
        let mid = c.jacobian_mid.expect("mid-point stepping has the column");
        let energy = column(c.energy_mid.unwrap_or(c.energy));
        let between = [column(c.jacobian)[0] - opening, column(mid)[0] - opening];
        let [mut stress, mut pressure, mut compliance] = [[0.0]; 3];
        let is_valid = between.iter().all(|&jacobian| {
            let mut history = self.history[body].map(|h| [patch.block.columns[h][r]]);
            let history = history.as_mut().map(|h| &mut h[..]);
            let fault = model.refresh(&[jacobian], energy, history, &mut pressure, &mut stress);
            jacobian > 0.0 && (fault.is_none() || jacobian > 1.0)
        });
        if !is_valid {
            // the cracks are closing
            return [0.0; 2];
        }
        model.mid_step(MidStep {
            mass: column(c.mass),
            volume0: column(c.volume0),
            jacobian: &between[..1],
            jacobian_mid: &between[1..],
            energy,
            gradient: column(c.divergence),
            edge: self.edge,
            floor: self.least_stiffness(),
            q: c.viscosity.map(column),
            history: self.history[body].map(column),
            stress_volume: &mut stress,
            compliance: Some((&mut pressure, &mut compliance)),
        });
        [pressure[0], compliance[0]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::constitutive;
    use crate::scene::Material;

    /// Pressure by [`refresh_damaged`], which reports no fault, and that of intact material at the volume ratio `at`.
    fn pressures(carried: &Carried, jacobian: f64, at: f64) -> [f64; 2] {
        let material: Material = serde_json::from_str(
            r#"{"density": 2785.0,
                "eos": {"type": "mie_gruneisen", "c0": 5386.0, "s": 1.339, "gamma0": 2.1}}"#,
        )
        .unwrap();
        let ConstitutiveModel::Fluid(model) = constitutive::build(&material) else {
            panic!("a fluid");
        };
        let [mut pressure, mut intact, mut speed] = [[0.0]; 3];
        let model = model.as_ref();
        let fault = refresh_damaged(model, carried, jacobian, 2e3, None, &mut pressure, &mut speed);
        assert_eq!(fault, None);
        model.refresh(&[at], &[2e3], None, &mut intact, &mut speed);
        [pressure[0], intact[0]]
    }

    #[test]
    fn damage_reduces_tension_alone() {
        let half = Carried { tension: 0.25, ..Carried::WHOLE };
        let [tension, whole] = pressures(&half, 1.02, 1.02);
        assert!(whole < -1e8 && tension == 0.25 * whole, "{tension:e} {whole:e}");
        let [pressed, whole] = pressures(&half, 0.99, 0.99);
        assert!(whole > 1e8 && pressed == whole);
    }

    #[test]
    fn the_material_between_open_cracks_is_stretched_less() {
        let cracked = Carried { opening: 0.05, ..Carried::WHOLE };
        let [tension, between] = pressures(&cracked, 1.07, 1.07 - 0.05);
        assert!(between < -1e8 && tension == between, "{tension:e} {between:e}");
        // while cracks close they carry nothing
        let [closing, whole] = pressures(&cracked, 1.04, 1.04);
        assert!(closing == 0.0 && whole < -1e8);
        // nor are they a fault, however wide, though the equation of state is not valid at the
        // compression that J less the opening would be, nor intact material at J
        for opening in [0.5, 0.9, 1.0, 2.0] {
            let wide = Carried { opening, ..Carried::WHOLE };
            for jacobian in [1.02, 1.1, 1.3, 1.49] {
                assert_eq!(pressures(&wide, jacobian, 1.0)[0], 0.0, "{opening} at {jacobian}");
            }
        }
        let [closed, whole] = pressures(&cracked, 0.99, 0.99);
        assert!(whole > 1e8 && closed == whole);
    }
}
