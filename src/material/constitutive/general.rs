//! Particle loops over an equation of state that is not linear in e, or has a history.
//!
//! The equations of [`FluidModel`] are solved to rounding per particle with
//! [`energy_of_work`](crate::material::energy_of_work).

use super::model::{FluidModel, MidStep, VolumeChange};
use crate::material::{HistoryEos, energy_of_work};

/// Particle loops over an equation of state of any form.
pub(super) struct NonlinearEosKernel<E>(pub E);

/// History variable of particle `r`; 0 for a material without one, which ignores it.
#[inline(always)]
fn of(history: &Option<&[f64]>, r: usize) -> f64 {
    history.map_or(0.0, |h| h[r])
}

impl<E: HistoryEos> FluidModel for NonlinearEosKernel<E> {
    fn mid_step(&self, mut particles: MidStep<'_>) {
        for r in 0..particles.mass.len() {
            let (j, q) = (particles.jacobian_mid[r], particles.q.map_or(0.0, |q| q[r]));
            let dv = (j - particles.jacobian[r]) * particles.volume0[r] / particles.mass[r];
            let history = of(&particles.history, r);
            let at = |e: f64| self.0.at(j, e, history);
            let start = particles.energy[r];
            let (_, point, _) = energy_of_work(at, start - q * dv, dv, start);
            let volume = particles.volume0[r] * j;
            particles.stress_volume[r] = (point.pressure + q) * volume;
            if let Some((pressure, compliance)) = &mut particles.compliance {
                let c2 = point.sound_speed_squared;
                let jump = particles.edge * particles.gradient[r];
                let stiffness = particles.mass[r] * (c2 + jump * jump) + particles.floor * volume;
                pressure[r] = point.pressure;
                compliance[r] = if c2 > 0.0 { volume * volume / stiffness } else { 0.0 };
            }
        }
    }

    fn change_volume(&self, particles: VolumeChange<'_>) {
        for r in 0..particles.mass.len() {
            let (j, q) = (particles.after[r], particles.q.map_or(0.0, |q| q[r]));
            let dv = (j - particles.before[r]) * particles.volume0[r] / particles.mass[r];
            let history = of(&particles.history, r);
            let at = |e: f64| self.0.at(j, e, history);
            let start = particles.energy[r];
            let known = start - (0.5 * particles.pressure[r] + q) * dv;
            let (energy, point, _) = energy_of_work(at, known, 0.5 * dv, start);
            particles.energy[r] = energy;
            particles.pressure[r] = point.pressure;
        }
    }

    fn refresh(
        &self,
        jacobian: &[f64],
        energy: &[f64],
        mut history: Option<&mut [f64]>,
        pressure: &mut [f64],
        sound_speed: &mut [f64],
    ) -> Option<(usize, String)> {
        let mut found = None;
        for r in 0..jacobian.len() {
            let (j, e) = (jacobian[r], energy[r]);
            let before = history.as_ref().map_or(0.0, |h| h[r]);
            let (point, now) = self.0.at(j, e, before);
            pressure[r] = point.pressure;
            sound_speed[r] = point.sound_speed_squared.sqrt();
            if let Some(history) = &mut history {
                history[r] = now;
            }
            if found.is_none() {
                found = self
                    .check_validity(j, e, now, point.pressure, sound_speed[r])
                    .map(|why| (r, why));
            }
        }
        found
    }

    fn energy_at(&self, pressure: f64) -> f64 {
        self.0.energy_at(pressure)
    }

    fn sound_speed_at(&self, pressure: f64) -> f64 {
        let history = self.0.first_history().unwrap_or(0.0);
        let (point, _) = self.0.at(1.0, self.0.energy_at(pressure), history);
        point.sound_speed_squared.max(0.0).sqrt()
    }

    fn first_history(&self) -> Option<f64> {
        self.0.first_history()
    }
}

impl<E: HistoryEos> NonlinearEosKernel<E> {
    /// Reason why a state is outside the range of the model, if it is.
    fn check_validity(
        &self,
        j: f64,
        e: f64,
        history: f64,
        p: f64,
        sound_speed: f64,
    ) -> Option<String> {
        let why = if !(j.is_finite() && p.is_finite() && e.is_finite()) {
            "its state is not a number".into()
        } else if j <= 0.0 {
            format!("its volume is negative (J = {j:.6e})")
        } else if let Some(fault) = self.0.check_validity(j, e, history, p) {
            format!("it is {fault}")
        } else if sound_speed.is_nan() {
            "its sound speed is imaginary".into()
        } else {
            return None;
        };
        let rho = self.0.reference_density() / j;
        Some(format!("{why} (density {rho:.6e} kg/m3, pressure {p:.6e} Pa, energy {e:.6e} J/kg)"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::constitutive::linear::LinearEosKernel;
    use crate::material::{IdealGas, MieGruneisen, Porous, Tillotson};

    const GAS: IdealGas = IdealGas { rho0: 2.0, gamma: 1.4 };

    fn mid_step(model: &dyn FluidModel) -> [f64; 3] {
        let (mut stress, mut p, mut w) = ([0.0], [0.0], [0.0]);
        model.mid_step(MidStep {
            mass: &[0.02],
            volume0: &[0.01],
            jacobian: &[1.0],
            jacobian_mid: &[0.95],
            energy: &[3.0],
            gradient: &[-1.0],
            edge: 0.1,
            floor: 1e-3,
            q: Some(&[0.2]),
            history: None,
            stress_volume: &mut stress,
            compliance: Some((&mut p, &mut w)),
        });
        [stress[0], p[0], w[0]]
    }

    fn change(
        model: &dyn FluidModel,
        history: Option<&[f64]>,
        from: f64,
        to: f64,
        state: [f64; 2],
    ) -> [f64; 2] {
        change_against(model, None, history, [from, to], state)
    }

    fn change_against(
        model: &dyn FluidModel,
        q: Option<&[f64]>,
        history: Option<&[f64]>,
        [from, to]: [f64; 2],
        state: [f64; 2],
    ) -> [f64; 2] {
        let ([mut p], [mut e]) = ([[state[0]]], [[state[1]]]);
        model.change_volume(VolumeChange {
            mass: &[2.0],
            volume0: &[1e-3],
            before: &[from],
            after: &[to],
            q,
            pressure: &mut p,
            energy: &mut e,
            history,
        });
        [p[0], e[0]]
    }

    #[test]
    fn a_linear_equation_gives_the_same_either_way() {
        for (a, b) in
            mid_step(&NonlinearEosKernel(GAS)).into_iter().zip(mid_step(&LinearEosKernel(GAS)))
        {
            assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
        }
        let start = [0.4 * 2.0 * 3.0, 3.0];
        let both = [
            change(&NonlinearEosKernel(GAS), None, 1.0, 0.9, start),
            change(&LinearEosKernel(GAS), None, 1.0, 0.9, start),
        ];
        for (a, b) in both[0].into_iter().zip(both[1]) {
            assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
        }
        let viscous: [&dyn FluidModel; 2] = [&NonlinearEosKernel(GAS), &LinearEosKernel(GAS)];
        let [a, b] =
            viscous.map(|model| change_against(model, Some(&[300.0]), None, [1.0, 0.9], start)[1]);
        assert!((a / b - 1.0).abs() < 1e-14 && a > both[0][1], "{a} {b}");
    }

    /// Pressure and energy at the end of a smooth path in n steps.
    fn driven(model: &dyn FluidModel, n: usize, to: f64) -> [f64; 2] {
        let mut state = [0.0, 0.0];
        for k in 0..n {
            let at = |k: usize| 1.0 + (to - 1.0) * k as f64 / n as f64;
            state = change(model, None, at(k), at(k + 1), state);
        }
        state
    }

    #[test]
    fn tillotson_is_second_order_along_its_isentrope() {
        let eos = Tillotson {
            rho0: 2000.0,
            a: 0.5,
            b: 1.63,
            bulk_modulus: 75.2e9,
            second_modulus: 65e9,
            alpha: 5.0,
            beta: 5.0,
            e0: 5e6,
            e_iv: 3e6,
            e_cv: 13.9e6,
        };
        let model = NonlinearEosKernel(eos);
        let [exact, _] = driven(&model, 4000, 0.6);
        let error = |n| (driven(&model, n, 0.6)[0] / exact - 1.0).abs();
        let order = (error(20) / error(40)).log2();
        assert!((order - 2.0).abs() < 0.05, "{order} {}", error(40));
    }

    #[test]
    fn the_distension_is_brought_to_its_end() {
        let solid = MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 };
        let model = NonlinearEosKernel(Porous {
            solid,
            distension: 1.25,
            elastic_pressure: 0.1e9,
            full_compaction_pressure: 1.6e9,
        });
        let first = FluidModel::first_history(&model).unwrap();
        let (mut alpha, mut p, mut c) = ([first], [0.0], [0.0]);
        assert_eq!(model.refresh(&[0.88], &[1e3], Some(&mut alpha), &mut p, &mut c), None);
        assert!(alpha[0] < 1.25 && alpha[0] > 1.0 && p[0] > 0.1e9);
        let crushed = alpha[0];
        assert_eq!(model.refresh(&[0.9], &[1e3], Some(&mut alpha), &mut p, &mut c), None);
        assert!(alpha[0] == crushed && p[0] < 0.1e9, "pores stay closed");
        let (_, fault) = model.refresh(&[0.2], &[0.0], Some(&mut alpha), &mut p, &mut c).unwrap();
        assert!(fault.contains("limit 1/s"), "{fault}");
        // the work of a step uses the pressure at its end
        let [p, e] = change(&model, Some(&[first]), 1.0, 0.88, [0.0, 0.0]);
        assert!((e / (0.5 * p * 0.12 * 1e-3 / 2.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_state_outside_of_the_model_is_named() {
        let model = NonlinearEosKernel(GAS);
        for (j, e, word) in [(-0.1, 1.0, "negative"), (0.9, f64::NAN, "not a number")] {
            let (mut p, mut c) = ([0.0; 2], [0.0; 2]);
            let (particle, what) =
                model.refresh(&[0.9, j], &[1.0, e], None, &mut p, &mut c).unwrap();
            assert!(particle == 1 && what.contains(word), "{what}");
        }
    }
}
