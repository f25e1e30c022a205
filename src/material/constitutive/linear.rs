//! Particle loops over an equation of state that is linear in the energy.

use decomp::array::map;

use super::model::{FluidModel, MidStep, VolumeChange};
use crate::material::{EquationOfState, LinearPressure};

/// Particle loops over an equation of state that is linear in the energy.
pub(super) struct LinearEosKernel<E>(pub(super) E);

/// Number of particles computed together. Results go to arrays of their own: what does not overlap
/// can be vectorized.
const BLOCK: usize = 32;

/// Values of a column for a block of particles from `first` on: in the column itself if it has a
/// whole block, else in `rest`, with the zeros of `rest` after the last.
#[inline(always)]
fn block<'a>(column: &'a [f64], first: usize, rest: &'a mut [f64; BLOCK]) -> &'a [f64; BLOCK] {
    if let Some(whole) = column[first..].first_chunk() {
        return whole;
    }
    let last = &column[first..];
    rest[..last.len()].copy_from_slice(last);
    rest
}

/// The same for several columns.
#[inline(always)]
fn blocks<'a, const N: usize>(
    columns: [&'a [f64]; N],
    first: usize,
    rest: &'a mut [[f64; BLOCK]; N],
) -> [&'a [f64; BLOCK]; N] {
    let mut rest = rest.iter_mut();
    map(&columns, |column| block(column, first, rest.next().expect("one per column")))
}

/// Writes the values of a block of particles to a column.
#[inline(always)]
fn put(column: &mut [f64], first: usize, values: &[f64; BLOCK]) {
    match column[first..].first_chunk_mut() {
        Some(whole) => *whole = *values,
        None => {
            let rest = &mut column[first..];
            rest.copy_from_slice(&values[..rest.len()]);
        }
    }
}

impl<E: EquationOfState> FluidModel for LinearEosKernel<E> {
    fn mid_step(&self, mut particles: MidStep<'_>) {
        let columns = [
            particles.mass,
            particles.volume0,
            particles.jacobian,
            particles.jacobian_mid,
            particles.energy,
        ];
        let none = [0.0; BLOCK];
        let (mut rest, mut rest_q, mut rest_gradient) = ([none; 5], none, none);
        for first in (0..particles.mass.len()).step_by(BLOCK) {
            let [mass, volume0, j, j_mid, energy] = blocks(columns, first, &mut rest);
            let q = particles.q.map(|q| block(q, first, &mut rest_q));
            let against = q.unwrap_or(&none);
            let mut pressure = [0.0; BLOCK];
            for r in 0..BLOCK {
                let dv = (j_mid[r] - j[r]) * volume0[r] / mass[r];
                let LinearPressure { reference_pressure, gruneisen_rho } = self.0.linear(j_mid[r]);
                let linear = reference_pressure + gruneisen_rho * (energy[r] - against[r] * dv);
                pressure[r] = self.0.clamp_tension(linear / (1.0 + gruneisen_rho * dv));
            }
            let mut stress = pressure;
            if let Some(q) = q {
                (0..BLOCK).for_each(|r| stress[r] += q[r]);
            }
            (0..BLOCK).for_each(|r| stress[r] = stress[r] * volume0[r] * j_mid[r]);
            put(particles.stress_volume, first, &stress);
            let Some((out, compliances)) = &mut particles.compliance else { continue };
            let gradient = block(particles.gradient, first, &mut rest_gradient);
            let mut compliance = [0.0; BLOCK];
            for r in 0..BLOCK {
                let volume = volume0[r] * j_mid[r];
                let c2 = self.0.sound_speed_squared(j_mid[r], pressure[r]);
                let jump = particles.edge * gradient[r];
                let stiffness = mass[r] * (c2 + jump * jump) + particles.floor * volume;
                // computed in both cases, then selected: no branch
                let softness = volume * volume / stiffness;
                compliance[r] = if c2 > 0.0 { softness } else { 0.0 };
            }
            put(out, first, &pressure);
            put(compliances, first, &compliance);
        }
    }

    fn change_volume(&self, particles: VolumeChange<'_>) {
        let columns = [particles.mass, particles.volume0, particles.before, particles.after];
        let none = [0.0; BLOCK];
        let (mut rest, mut rest_q) = ([none; 4], none);
        for first in (0..particles.mass.len()).step_by(BLOCK) {
            let [mass, volume0, before, after] = blocks(columns, first, &mut rest);
            let q = particles.q.map_or(&none, |q| block(q, first, &mut rest_q));
            let mut pressures = *block(particles.pressure, first, &mut { none });
            let mut energies = *block(particles.energy, first, &mut { none });
            for r in 0..BLOCK {
                let dv = (after[r] - before[r]) * volume0[r] / mass[r];
                let LinearPressure { reference_pressure, gruneisen_rho } = self.0.linear(after[r]);
                let energy = (energies[r]
                    - (0.5 * (pressures[r] + reference_pressure) + q[r]) * dv)
                    / (1.0 + 0.5 * gruneisen_rho * dv);
                let pressure = reference_pressure + gruneisen_rho * energy;
                let clamped = self.0.clamp_tension(pressure);
                // tension that the material does not carry does no work
                energies[r] = energy + 0.5 * (pressure - clamped) * dv;
                pressures[r] = clamped;
            }
            put(particles.energy, first, &energies);
            put(particles.pressure, first, &pressures);
        }
    }

    fn refresh(
        &self,
        jacobian: &[f64],
        energy: &[f64],
        _history: Option<&mut [f64]>,
        pressure: &mut [f64],
        sound_speed: &mut [f64],
    ) -> Option<(usize, String)> {
        let n = jacobian.len();
        let (energy, pressure, sound_speed) =
            (&energy[..n], &mut pressure[..n], &mut sound_speed[..n]);
        let mut sound = true;
        for r in 0..n {
            let p = self.0.pressure(jacobian[r], energy[r]);
            let c2 = self.0.sound_speed_squared(jacobian[r], p);
            pressure[r] = p;
            sound_speed[r] = c2.sqrt();
            // a comparison with NaN is false
            sound &= jacobian[r] > 0.0 && c2 >= 0.0 && p.abs() < f64::INFINITY;
            sound &= self.0.check_validity(jacobian[r], p).is_none();
        }
        if sound {
            return None;
        }
        (0..n).find_map(|r| {
            let (j, p) = (jacobian[r], pressure[r]);
            let rho = self.0.reference_density() / j;
            let state = format!("density {rho:.6e} kg/m3, pressure {p:.6e} Pa");
            if !(j.is_finite() && p.is_finite() && energy[r].is_finite()) {
                Some((r, format!("its state is not a number ({state})")))
            } else if j <= 0.0 {
                Some((r, format!("its volume is negative (J = {j:.6e})")))
            } else if let Some(fault) = self.0.check_validity(j, p) {
                Some((r, format!("it is {fault} ({state})")))
            } else if sound_speed[r].is_nan() {
                Some((r, format!("its sound speed is imaginary ({state})")))
            } else {
                None
            }
        })
    }

    fn energy_at(&self, pressure: f64) -> f64 {
        self.0.energy_at(1.0, pressure)
    }

    fn sound_speed_at(&self, pressure: f64) -> f64 {
        self.0.sound_speed_squared(1.0, pressure).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{IdealGas, MieGruneisen};

    const GAS: LinearEosKernel<IdealGas> = LinearEosKernel(IdealGas { rho0: 2.0, gamma: 1.4 });

    #[test]
    fn mid_step_pressure_has_the_energy_of_its_own_work() {
        let (j, j_mid, e, q) = ([1.0], [0.98], [3.0], [0.2]);
        let mut stress = [0.0];
        GAS.mid_step(MidStep {
            mass: &[0.02],
            volume0: &[0.01],
            jacobian: &j,
            jacobian_mid: &j_mid,
            energy: &e,
            q: Some(&q),
            history: None,
            gradient: &[0.0],
            edge: 1.0,
            floor: 0.0,
            stress_volume: &mut stress,
            compliance: None,
        });
        let p = stress[0] / (0.01 * 0.98) - 0.2;
        let dv = (0.98 - 1.0) / 2.0;
        let e_mid = 3.0 - (p + 0.2) * dv;
        assert!((p - GAS.0.pressure(0.98, e_mid)).abs() < 1e-14);
    }

    #[test]
    fn change_of_volume_is_second_order_along_an_isentrope() {
        let error = |steps: usize| {
            let (mut p, mut e) = ([GAS.0.pressure(1.0, 3.0)], [3.0]);
            let start = p[0];
            for k in 0..steps {
                let at = |k: usize| [1.0 - 0.4 * k as f64 / steps as f64];
                GAS.change_volume(VolumeChange {
                    mass: &[0.02],
                    volume0: &[0.01],
                    before: &at(k),
                    after: &at(k + 1),
                    q: None,
                    pressure: &mut p,
                    energy: &mut e,
                    history: None,
                });
            }
            (p[0] / (start * 0.6f64.powf(-1.4)) - 1.0).abs()
        };
        let order = (error(20) / error(40)).log2();
        assert!((order - 2.0).abs() < 0.05, "{order}");
    }

    /// A block, some of the next, and their ends: each particle as if it were alone.
    #[test]
    fn particles_beside_others_are_those_alone() {
        const N: usize = 2 * BLOCK + 7;
        let values = |seed: usize, from: f64| -> [f64; N] {
            decomp::array::from_fn(|r| from + 0.1 * ((r * 7 + seed) % 13) as f64 / 13.0)
        };
        let [mass, volume0, j, j_mid, energy, q] =
            [0.02, 0.01, 0.95, 0.93, 3.0, 0.2].map(|from| values((1e3 * from) as usize, from));
        let run = |r: std::ops::Range<usize>| {
            let n = r.len();
            let [mut stress, mut p, mut w] = [0; 3].map(|_| vec![0.0; n]);
            GAS.mid_step(MidStep {
                mass: &mass[r.clone()],
                volume0: &volume0[r.clone()],
                jacobian: &j[r.clone()],
                jacobian_mid: &j_mid[r.clone()],
                energy: &energy[r.clone()],
                q: Some(&q[r.clone()]),
                history: None,
                gradient: &q[r.clone()],
                edge: 0.1,
                floor: 1e-3,
                stress_volume: &mut stress,
                compliance: Some((&mut p, &mut w)),
            });
            let (mut pressure, mut e) = (p.clone(), energy[r.clone()].to_vec());
            GAS.change_volume(VolumeChange {
                mass: &mass[r.clone()],
                volume0: &volume0[r.clone()],
                before: &j[r.clone()],
                after: &j_mid[r.clone()],
                q: Some(&q[r]),
                pressure: &mut pressure,
                energy: &mut e,
                history: None,
            });
            [stress, p, w, pressure, e]
        };
        let all = run(0..N);
        assert!(all.iter().flatten().all(|value| *value != 0.0));
        for r in 0..N {
            assert_eq!(all.each_ref().map(|column| column[r]), run(r..r + 1).map(|one| one[0]));
        }
    }

    #[test]
    fn a_gas_short_of_energy_bears_no_tension() {
        let (mut p, mut c) = ([1.0; 2], [1.0; 2]);
        assert_eq!(GAS.refresh(&[1.0, 0.5], &[-1e-32, -1e-3], None, &mut p, &mut c), None);
        assert_eq!((p, c), ([0.0; 2], [0.0; 2]));
        assert!(GAS.refresh(&[1.0], &[f64::NAN], None, &mut p[..1], &mut c[..1]).is_some());
        let mut stress = [1.0];
        GAS.mid_step(MidStep {
            mass: &[0.02],
            volume0: &[0.01],
            jacobian: &[1.0],
            jacobian_mid: &[1.2],
            energy: &[-1e-3],
            q: Some(&[0.5]),
            history: None,
            gradient: &[0.0],
            edge: 1.0,
            floor: 0.0,
            stress_volume: &mut stress,
            compliance: None,
        });
        assert_eq!(stress, [0.5 * 0.01 * 1.2], "viscosity alone");
        // expansion takes no work, and all work of the viscosity is kept
        let (mut p, mut e) = ([0.0], [-1e-3]);
        GAS.change_volume(VolumeChange {
            mass: &[0.02],
            volume0: &[0.01],
            before: &[1.0],
            after: &[1.2],
            q: Some(&[0.5]),
            pressure: &mut p,
            energy: &mut e,
            history: None,
        });
        assert_eq!(p, [0.0]);
        assert!((e[0] + 1e-3 + 0.5 * 0.2 * 0.5).abs() < 1e-16, "{e:?}");
    }

    #[test]
    fn a_state_outside_of_the_model_is_named() {
        let copper =
            LinearEosKernel(MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 });
        let fault_at = |j: f64, e: f64| {
            let (mut p, mut c) = ([0.0; 2], [0.0; 2]);
            copper.refresh(&[0.9, j], &[0.0, e], None, &mut p, &mut c)
        };
        assert_eq!(fault_at(0.9, 0.0), None);
        for (j, e, word) in [
            (0.2, 0.0, "limit 1/s"),
            (1.5, 0.0, "tension"),
            (-0.1, 0.0, "negative"),
            (0.9, f64::NAN, "not a number"),
        ] {
            let (particle, what) = fault_at(j, e).unwrap();
            assert_eq!(particle, 1);
            assert!(what.contains(word), "{what}");
        }
    }
}
