//! The loops over an equation of state that is not linear in e, or has a history.
//!
//! What [`Model`] asks for is solved to rounding, row by row, with
//! [`energy_of_work`](crate::material::energy_of_work).

use super::{MidStep, Model, VolumeChange};
use crate::material::{HistoryEos, energy_of_work};

/// The loops over an equation of state of any form.
pub(super) struct Implicit<E>(pub E);

/// The history of row `r`; that of a material without one says nothing.
#[inline(always)]
fn of(history: &Option<&[f64]>, r: usize) -> f64 {
    history.map_or(0.0, |h| h[r])
}

impl<E: HistoryEos> Model for Implicit<E> {
    fn mid_step(&self, mut rows: MidStep<'_>) {
        for r in 0..rows.mass.len() {
            let (j, q) = (rows.jacobian_mid[r], rows.q.map_or(0.0, |q| q[r]));
            let dv = (j - rows.jacobian[r]) * rows.volume0[r] / rows.mass[r];
            let history = of(&rows.history, r);
            let at = |e: f64| self.0.at(j, e, history);
            let start = rows.energy[r];
            let (_, point, _) = energy_of_work(at, start - q * dv, dv, start);
            let volume = rows.volume0[r] * j;
            rows.stress_volume[r] = (point.pressure + q) * volume;
            if let Some((pressure, compliance)) = &mut rows.compliance {
                let c2 = point.sound_speed_squared;
                let jump = rows.edge * rows.gradient[r];
                let stiffness = rows.mass[r] * (c2 + jump * jump) + rows.floor * volume;
                pressure[r] = point.pressure;
                compliance[r] = if c2 > 0.0 { volume * volume / stiffness } else { 0.0 };
            }
        }
    }

    fn change_volume(&self, rows: VolumeChange<'_>) {
        for r in 0..rows.mass.len() {
            let (j, q) = (rows.after[r], rows.q.map_or(0.0, |q| q[r]));
            let dv = (j - rows.before[r]) * rows.volume0[r] / rows.mass[r];
            let history = of(&rows.history, r);
            let at = |e: f64| self.0.at(j, e, history);
            let start = rows.energy[r];
            let known = start - (0.5 * rows.pressure[r] + q) * dv;
            let (energy, point, _) = energy_of_work(at, known, 0.5 * dv, start);
            rows.energy[r] = energy;
            rows.pressure[r] = point.pressure;
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
                found = self.fault(j, e, now, point.pressure, sound_speed[r]).map(|why| (r, why));
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

impl<E: HistoryEos> Implicit<E> {
    /// Why a state lies outside of the model, if it does.
    fn fault(&self, j: f64, e: f64, history: f64, p: f64, sound_speed: f64) -> Option<String> {
        let why = if !(j.is_finite() && p.is_finite() && e.is_finite()) {
            "its state is not a number".into()
        } else if j <= 0.0 {
            format!("its volume is negative (J = {j:.6e})")
        } else if let Some(fault) = self.0.fault(j, e, history, p) {
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
    use crate::material::constitutive::Point;
    use crate::material::{IdealGas, MieGruneisen, Porous, Tillotson};

    const GAS: IdealGas = IdealGas { rho0: 2.0, gamma: 1.4 };

    fn mid_step(model: &dyn Model) -> [f64; 3] {
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
        model: &dyn Model,
        history: Option<&[f64]>,
        from: f64,
        to: f64,
        state: [f64; 2],
    ) -> [f64; 2] {
        change_against(model, None, history, [from, to], state)
    }

    fn change_against(
        model: &dyn Model,
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
        for (a, b) in mid_step(&Implicit(GAS)).into_iter().zip(mid_step(&Point(GAS))) {
            assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
        }
        let start = [0.4 * 2.0 * 3.0, 3.0];
        let both = [
            change(&Implicit(GAS), None, 1.0, 0.9, start),
            change(&Point(GAS), None, 1.0, 0.9, start),
        ];
        for (a, b) in both[0].into_iter().zip(both[1]) {
            assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
        }
        let viscous: [&dyn Model; 2] = [&Implicit(GAS), &Point(GAS)];
        let [a, b] =
            viscous.map(|model| change_against(model, Some(&[300.0]), None, [1.0, 0.9], start)[1]);
        assert!((a / b - 1.0).abs() < 1e-14 && a > both[0][1], "{a} {b}");
    }

    /// Of a smooth path in n steps: pressure and energy at its end.
    fn driven(model: &dyn Model, n: usize, to: f64) -> [f64; 2] {
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
        let model = Implicit(eos);
        let [exact, _] = driven(&model, 4000, 0.6);
        let error = |n| (driven(&model, n, 0.6)[0] / exact - 1.0).abs();
        let order = (error(20) / error(40)).log2();
        assert!((order - 2.0).abs() < 0.05, "{order} {}", error(40));
    }

    #[test]
    fn the_distension_is_brought_to_its_end() {
        let solid = MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 };
        let model = Implicit(Porous {
            solid,
            distension: 1.25,
            elastic_pressure: 0.1e9,
            compaction_pressure: 1.6e9,
        });
        let first = Model::first_history(&model).unwrap();
        let (mut alpha, mut p, mut c) = ([first], [0.0], [0.0]);
        assert_eq!(model.refresh(&[0.88], &[1e3], Some(&mut alpha), &mut p, &mut c), None);
        assert!(alpha[0] < 1.25 && alpha[0] > 1.0 && p[0] > 0.1e9);
        let crushed = alpha[0];
        assert_eq!(model.refresh(&[0.9], &[1e3], Some(&mut alpha), &mut p, &mut c), None);
        assert!(alpha[0] == crushed && p[0] < 0.1e9, "pores stay closed");
        let (_, told) = model.refresh(&[0.2], &[0.0], Some(&mut alpha), &mut p, &mut c).unwrap();
        assert!(told.contains("limit 1/s"), "{told}");
        // the work of a step goes by the pressure at its end
        let [p, e] = change(&model, Some(&[first]), 1.0, 0.88, [0.0, 0.0]);
        assert!((e / (0.5 * p * 0.12 * 1e-3 / 2.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_state_outside_of_the_model_is_named() {
        let model = Implicit(GAS);
        for (j, e, word) in [(-0.1, 1.0, "negative"), (0.9, f64::NAN, "not a number")] {
            let (mut p, mut c) = ([0.0; 2], [0.0; 2]);
            let (row, what) = model.refresh(&[0.9, j], &[1.0, e], None, &mut p, &mut c).unwrap();
            assert!(row == 1 && what.contains(word), "{what}");
        }
    }
}
