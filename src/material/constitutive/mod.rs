//! What a material does to rows of particles: called once a run of rows of one body, the loop
//! inside knows its equation of state.
//!
//! Knows no grid, no messages, no dimension.
//!
//! # Adding a model from outside
//!
//! A program that uses this library may bring models of its own, without a change to it: an
//! [`EquationOfState`] (linear in the energy) or [`GeneralEos`](crate::material::GeneralEos), and a
//! [`Strength`](crate::material::strength::Strength). [`Outside`] makes them ready, and
//! [`Simulation::with_models`](crate::simulation::Simulation::with_models) takes them in place of
//! those that the scene names for a material:
//!
//! ```ignore
//! let models = |material: &str| {
//!     (material == "metal").then(|| Outside::fluid(MY_EOS).with_strength(MY_STRENGTH))
//! };
//! let simulation = Simulation::<1>::with_models(&scene, &Serial, 1, &models)?;
//! ```
//!
//! The scene goes on to say what a run has columns for, so a material with a strength from outside
//! names one there, and one whose equation of state is from outside names a fluid without a history.
//! The loops over rows are compiled for the model, as they are for those of the library. What is
//! written to files, scored or drawn by `flyer-mpm SCENE.json` knows the scene alone.
//! `examples/custom_material.rs` is a whole program.

mod custom_model;
mod deviatoric_update;
mod erosion;
mod failure;
mod general;
mod heat;
mod least_energy;
mod registry;
mod solid;

pub use custom_model::Outside;
pub use deviatoric_update::{DeviatorRows, Flow, FlowRows, RateRows};
pub use erosion::Erosion;
pub use failure::{Criterion, Ductile, Loaded};
pub use heat::{Isentrope, Thermal};
pub use least_energy::least_energy;
pub use registry::{build, equation, products};
pub use solid::{PlaneStrain, Solid, Strain, TensorRows};

use crate::material::definition::{self, Failure, HeatSource, Material, TensionMeasure};
use crate::material::strength::{JohnsonCook, Softening, SteinbergGuinan, VonMises};
use crate::material::{EquationOfState, Linear};

/// What a body is made of, as the step sees it.
pub enum Matter {
    /// Bears pressure alone.
    Fluid(Box<dyn Model>),
    /// Bears shear too.
    Solid(Box<dyn Solid>),
}

impl Matter {
    /// Sound speed of the material at its density and `pressure` [m/s].
    pub fn sound_speed_at(&self, pressure: f64) -> f64 {
        match self {
            Matter::Fluid(model) => model.sound_speed_at(pressure),
            Matter::Solid(solid) => solid.sound_speed_at_rest(),
        }
    }

    /// Speed of a shear wave in the material at rest [m/s]; none in a fluid.
    pub fn shear_speed(&self) -> f64 {
        match self {
            Matter::Fluid(_) => 0.0,
            Matter::Solid(solid) => solid.shear_speed_at_rest(),
        }
    }

    /// The specific internal energy at which the material at rest is at `pressure` [J/kg]; none
    /// in a solid, which starts without stress.
    pub fn energy_at(&self, pressure: f64) -> f64 {
        match self {
            Matter::Fluid(model) => model.energy_at(pressure),
            Matter::Solid(_) => 0.0,
        }
    }
}

/// Rows at the middle of a step; see [`Model::mid_step`].
pub struct MidStep<'a> {
    /// Mass [kg].
    pub mass: &'a [f64],
    /// Volume at J = 1 [m3].
    pub volume0: &'a [f64],
    /// J at the start of the step.
    pub jacobian: &'a [f64],
    /// J at the middle of the step.
    pub jacobian_mid: &'a [f64],
    /// Specific internal energy at the start of the step [J/kg].
    pub energy: &'a [f64],
    /// Divergence D of the velocity [1/s].
    pub gradient: &'a [f64],
    /// Edge h of a cell [m].
    pub edge: f64,
    /// Stiffness S above what rounding leaves in a cold gas [Pa].
    pub floor: f64,
    /// Artificial viscosity [Pa], if there is any.
    pub q: Option<&'a [f64]>,
    /// History at the start of the step, of a material with one.
    pub history: Option<&'a [f64]>,
    /// Set to (p + q) V [J].
    pub stress_volume: &'a mut [f64],
    /// Set to p [Pa] and to V^2/(m (c^2 + (h D)^2) + S V) [m3/Pa], if wanted: -dV/dp along the
    /// isentrope, bounded where a gas has next to no pressure, so that what a cell's jump of
    /// velocity may raise it by stands for it. 0 without any.
    pub compliance: Option<(&'a mut [f64], &'a mut [f64])>,
}

/// Rows after a change of volume; see [`Model::change_volume`].
pub struct VolumeChange<'a> {
    /// Mass [kg].
    pub mass: &'a [f64],
    /// Volume at J = 1 [m3].
    pub volume0: &'a [f64],
    /// J before.
    pub before: &'a [f64],
    /// J after.
    pub after: &'a [f64],
    /// Artificial viscosity during the change [Pa], if there is any.
    pub q: Option<&'a [f64]>,
    /// Pressure before, set to that after [Pa].
    pub pressure: &'a mut [f64],
    /// Specific internal energy before, set to that after [J/kg].
    pub energy: &'a mut [f64],
    /// History before, of a material with one.
    pub history: Option<&'a [f64]>,
}

/// A fluid, as the step sees it.
pub trait Model: Send + Sync {
    /// Stress at the middle of the step, with the energy that the half-step's work gives:
    /// p = (f + g (e - q dv))/(1 + g dv) from e_mid = e - (p + q) dv, dv the change of specific
    /// volume so far.
    fn mid_step(&self, rows: MidStep<'_>);

    /// Energy and pressure after a change of volume by the mid-point rule,
    /// e' = e - ((p + p')/2 + q) dv, solved together with p' = f + g e'.
    fn change_volume(&self, rows: VolumeChange<'_>);

    /// Sets pressure [Pa] and sound speed [m/s] of rows from J and e, and brings the history of a
    /// material with one to its end. Tells the first row whose state lies outside of the model,
    /// and why.
    fn refresh(
        &self,
        jacobian: &[f64],
        energy: &[f64],
        history: Option<&mut [f64]>,
        pressure: &mut [f64],
        sound_speed: &mut [f64],
    ) -> Option<(usize, String)>;

    /// The specific internal energy at which the material at rest is at `pressure` [J/kg].
    fn energy_at(&self, pressure: f64) -> f64;

    /// Sound speed of the material at its density and `pressure` [m/s].
    fn sound_speed_at(&self, pressure: f64) -> f64;

    /// The history that the material starts with; none of most materials, which have no such
    /// column.
    fn first_history(&self) -> Option<f64> {
        None
    }
}

/// What a fluid's material bears of shear, if its scene says so.
pub fn flow_of(material: &Material) -> Option<Box<dyn Flow>> {
    use deviatoric_update::Shearing;
    Some(match material.strength? {
        definition::Strength::VonMises { shear_modulus, yield_stress, hardening } => {
            Box::new(Shearing(VonMises { shear_modulus, yield_stress, hardening }))
        }
        definition::Strength::JohnsonCook {
            shear_modulus,
            a,
            b,
            n,
            c,
            reference_rate,
            softening,
        } => {
            let softening = softening.map(|s| Softening {
                m: s.m,
                room: s.reference_temperature,
                melt: s.melt_temperature,
            });
            let model = JohnsonCook { shear_modulus, a, b, n, c, reference_rate, softening };
            Box::new(Shearing(model))
        }
        definition::Strength::SteinbergGuinan {
            shear_modulus,
            yield_stress,
            beta,
            n,
            initial_strain,
            max_yield_stress,
            pressure_hardening,
            temperature_softening,
        } => Box::new(Shearing(SteinbergGuinan {
            shear_modulus,
            yield_stress,
            beta,
            n,
            initial_strain,
            most: max_yield_stress,
            by_pressure: pressure_hardening,
            by_temperature: temperature_softening,
        })),
    })
}

/// When a material fails, if its scene says so.
pub fn criterion_of(material: &Material) -> Option<Criterion> {
    Some(match material.failure? {
        Failure::TensionLimit { stress, measure: TensionMeasure::PrincipalStress } => {
            Criterion::PrincipalStress(stress)
        }
        Failure::TensionLimit { stress, measure: TensionMeasure::MeanStress } => {
            Criterion::MeanTension(stress)
        }
        Failure::JohnsonCook { d1, d2, d3, d4, d5, reference_rate } => {
            let temperatures = match material.strength {
                Some(definition::Strength::JohnsonCook { softening, .. }) => {
                    softening.map(|s| [s.reference_temperature, s.melt_temperature])
                }
                _ => None,
            };
            Criterion::Ductile(Ductile { d: [d1, d2, d3, d4, d5], reference_rate, temperatures })
        }
    })
}

/// When a material's particles are taken out, if its scene says so.
pub fn erosion_of(material: &Material) -> Option<Erosion> {
    let named = material.erosion?;
    let limit = |named: Option<f64>| named.unwrap_or(f64::INFINITY);
    Some(Erosion {
        plastic_strain: limit(named.plastic_strain),
        volume_ratio: limit(named.volume_ratio),
    })
}

/// How a material's temperature follows, if its scene says so; `matter` is its model.
pub fn thermal_of(material: &Material, matter: &Matter) -> Option<Thermal> {
    let named = material.thermal?;
    let isentrope = match (named.source, matter) {
        (HeatSource::Energy, Matter::Fluid(model)) => {
            Some(Isentrope::new(model.as_ref(), material.density))
        }
        _ => None,
    };
    Some(Thermal {
        specific_heat: named.specific_heat,
        rest: named.reference_temperature,
        taylor_quinney: named.taylor_quinney,
        conductivity: named.conductivity,
        isentrope,
    })
}

/// The loops over an equation of state.
struct Point<E>(E);

impl<E: EquationOfState> Model for Point<E> {
    fn mid_step(&self, rows: MidStep<'_>) {
        let n = rows.mass.len();
        let (mass, volume0, j, j_mid) =
            (rows.mass, &rows.volume0[..n], &rows.jacobian[..n], &rows.jacobian_mid[..n]);
        let (energy, out) = (&rows.energy[..n], &mut rows.stress_volume[..n]);
        let gradient = &rows.gradient[..n];
        let pressure_at = |r: usize, q: f64| {
            let dv = (j_mid[r] - j[r]) * volume0[r] / mass[r];
            let Linear { cold, energy_factor } = self.0.linear(j_mid[r]);
            let linear = cold + energy_factor * (energy[r] - q * dv);
            self.0.borne(linear / (1.0 + energy_factor * dv))
        };
        // one pressure for both, where both are wanted
        if let Some((pressure, compliance)) = rows.compliance {
            let (pressure, compliance) = (&mut pressure[..n], &mut compliance[..n]);
            for r in 0..n {
                let p = pressure_at(r, rows.q.map_or(0.0, |q| q[r]));
                out[r] = rows.q.map_or(p, |q| p + q[r]) * volume0[r] * j_mid[r];
                let volume = volume0[r] * j_mid[r];
                let c2 = self.0.sound_speed_squared(j_mid[r], p);
                let jump = rows.edge * gradient[r];
                let stiffness = mass[r] * (c2 + jump * jump) + rows.floor * volume;
                pressure[r] = p;
                compliance[r] = if c2 > 0.0 { volume * volume / stiffness } else { 0.0 };
            }
            return;
        }
        match rows.q {
            Some(q) => {
                for r in 0..n {
                    out[r] = (pressure_at(r, q[r]) + q[r]) * volume0[r] * j_mid[r];
                }
            }
            None => {
                for r in 0..n {
                    out[r] = pressure_at(r, 0.0) * volume0[r] * j_mid[r];
                }
            }
        }
    }

    fn change_volume(&self, rows: VolumeChange<'_>) {
        for r in 0..rows.mass.len() {
            let dv = (rows.after[r] - rows.before[r]) * rows.volume0[r] / rows.mass[r];
            let q = rows.q.map_or(0.0, |q| q[r]);
            let Linear { cold, energy_factor } = self.0.linear(rows.after[r]);
            let energy = (rows.energy[r] - (0.5 * (rows.pressure[r] + cold) + q) * dv)
                / (1.0 + 0.5 * energy_factor * dv);
            let pressure = cold + energy_factor * energy;
            let borne = self.0.borne(pressure);
            // what the material does not bear does no work
            rows.energy[r] = energy + 0.5 * (pressure - borne) * dv;
            rows.pressure[r] = borne;
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
            sound &= self.0.fault(jacobian[r], p).is_none();
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
            } else if let Some(fault) = self.0.fault(j, p) {
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

    const GAS: Point<IdealGas> = Point(IdealGas { rho0: 2.0, gamma: 1.4 });

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
        // it takes no work to expand, and all the work of viscosity is kept
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
        let copper = Point(MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 });
        let told = |j: f64, e: f64| {
            let (mut p, mut c) = ([0.0; 2], [0.0; 2]);
            copper.refresh(&[0.9, j], &[0.0, e], None, &mut p, &mut c)
        };
        assert_eq!(told(0.9, 0.0), None);
        for (j, e, word) in [
            (0.2, 0.0, "limit 1/s"),
            (1.5, 0.0, "tension"),
            (-0.1, 0.0, "negative"),
            (0.9, f64::NAN, "not a number"),
        ] {
            let (row, what) = told(j, e).unwrap();
            assert_eq!(row, 1);
            assert!(what.contains(word), "{what}");
        }
    }
}
