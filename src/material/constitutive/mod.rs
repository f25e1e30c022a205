//! Constitutive update of particles. The step calls a model once per run of particles of one body;
//! the particle loop inside is compiled for the equation of state.
//!
//! Independent of grid, communication and dimension.
//!
//! # Adding a model from outside
//!
//! A program that uses this library can supply its own models without changing the library: an
//! [`EquationOfState`] (linear in the energy) or [`GeneralEos`](crate::material::GeneralEos), and a
//! [`StrengthLaw`]. [`CustomModel`] wraps them, and
//! [`Simulation::with_models`](crate::simulation::Simulation::with_models) uses them in place of
//! those that the scene names for a material:
//!
//! ```ignore
//! let models = |material: &str| {
//!     (material == "metal").then(|| CustomModel::fluid(MY_EOS).with_strength(MY_STRENGTH))
//! };
//! let simulation = Simulation::<1>::with_models(&scene, &Serial, 1, &models)?;
//! ```
//!
//! The scene still determines the columns of a run. A material with a custom strength must
//! therefore name some strength in the scene, and a material with a custom equation of state must
//! name a fluid without a history. The particle loops are compiled for the custom model, as for the
//! models of the library. Files, scores and plots of `flyer-mpm SCENE.json` depend on the scene
//! only. `examples/custom_material.rs` is a complete program.

mod custom_model;
mod damage_update;
mod deviatoric_update;
mod erosion;
mod general;
mod heat;
mod least_energy;
mod registry;
mod solid;

pub use custom_model::CustomModel;
pub use damage_update::{DamageUpdate, FailureModel};
pub use deviatoric_update::{Deviators, StrengthModel, StrengthUpdate, VelocityGradients};
pub use erosion::ErosionCriterion;
pub use heat::{TemperatureIsentrope, ThermalModel};
pub use least_energy::least_energy;
pub use registry::{build, equation};
pub use solid::{PlaneStrain, SolidModel, Strain, TensorColumns};

use crate::material::definition::{HeatSource, Material};
use crate::material::failure::{FailureLaw, FailureVisitor, RestState, StrengthBeside};
use crate::material::strength::{StrengthLaw, StrengthVisitor};
use crate::material::{EquationOfState, LinearPressure};

/// Model of the material of a body, as called by the step.
pub enum ConstitutiveModel {
    /// Equation of state that carries pressure only.
    Fluid(Box<dyn FluidModel>),
    /// Elastic solid, which carries shear too.
    Solid(Box<dyn SolidModel>),
}

impl ConstitutiveModel {
    /// Sound speed of the material at rest density and `pressure` [m/s].
    pub fn sound_speed_at(&self, pressure: f64) -> f64 {
        match self {
            ConstitutiveModel::Fluid(model) => model.sound_speed_at(pressure),
            ConstitutiveModel::Solid(solid) => solid.sound_speed_at_rest(),
        }
    }

    /// Shear wave speed in the material at rest [m/s]; 0 for a fluid.
    pub fn shear_speed(&self) -> f64 {
        match self {
            ConstitutiveModel::Fluid(_) => 0.0,
            ConstitutiveModel::Solid(solid) => solid.shear_speed_at_rest(),
        }
    }

    /// Specific internal energy at which the material at rest has `pressure` [J/kg]; 0 for a solid,
    /// which starts without stress.
    pub fn energy_at(&self, pressure: f64) -> f64 {
        match self {
            ConstitutiveModel::Fluid(model) => model.energy_at(pressure),
            ConstitutiveModel::Solid(_) => 0.0,
        }
    }
}

/// Arguments of [`FluidModel::mid_step`]; arrays have one entry per particle.
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
    /// Edge length h of a cell [m].
    pub edge: f64,
    /// Stiffness S, greater than rounding leaves in a cold gas [Pa].
    pub floor: f64,
    /// Artificial viscosity [Pa], if active.
    pub q: Option<&'a [f64]>,
    /// History variable at the start of the step, if the material has one.
    pub history: Option<&'a [f64]>,
    /// Output: (p + q) V [J].
    pub stress_volume: &'a mut [f64],
    /// Output, if requested: p [Pa], and V^2/(m (c^2 + (h D)^2) + S V) [m3/Pa], which is -dV/dp
    /// along the isentrope. Where a gas has nearly no pressure, the pressure that the velocity jump
    /// over a cell can generate replaces it and bounds the value. 0 without stiffness.
    pub compliance: Option<(&'a mut [f64], &'a mut [f64])>,
}

/// Arguments of [`FluidModel::change_volume`]; arrays have one entry per particle.
pub struct VolumeChange<'a> {
    /// Mass [kg].
    pub mass: &'a [f64],
    /// Volume at J = 1 [m3].
    pub volume0: &'a [f64],
    /// J before the change.
    pub before: &'a [f64],
    /// J after the change.
    pub after: &'a [f64],
    /// Artificial viscosity during the change [Pa], if active.
    pub q: Option<&'a [f64]>,
    /// Pressure [Pa], updated in place.
    pub pressure: &'a mut [f64],
    /// Specific internal energy [J/kg], updated in place.
    pub energy: &'a mut [f64],
    /// History variable before the change, if the material has one.
    pub history: Option<&'a [f64]>,
}

/// Equation of state of a fluid, as called by the step.
pub trait FluidModel: Send + Sync {
    /// Sets the stress at the middle of the step, with the energy after the work of the half-step:
    /// p = (f + g (e - q dv))/(1 + g dv) from e_mid = e - (p + q) dv, where dv is the change of
    /// specific volume since the start of the step.
    fn mid_step(&self, particles: MidStep<'_>);

    /// Updates energy and pressure after a change of volume by the trapezoidal rule,
    /// e' = e - ((p + p')/2 + q) dv, solved together with p' = f + g e'.
    fn change_volume(&self, particles: VolumeChange<'_>);

    /// Sets pressure [Pa] and sound speed [m/s] from J and e, and updates the history variable, if
    /// the material has one, to the end of the step. Returns the first particle whose state is
    /// outside the range of the model, and the reason.
    fn refresh(
        &self,
        jacobian: &[f64],
        energy: &[f64],
        history: Option<&mut [f64]>,
        pressure: &mut [f64],
        sound_speed: &mut [f64],
    ) -> Option<(usize, String)>;

    /// Specific internal energy at which the material at rest has `pressure` [J/kg].
    fn energy_at(&self, pressure: f64) -> f64;

    /// Sound speed of the material at rest density and `pressure` [m/s].
    fn sound_speed_at(&self, pressure: f64) -> f64;

    /// Initial history variable; `None` for most materials, which have no such column.
    fn first_history(&self) -> Option<f64> {
        None
    }
}

/// Strength model of a fluid material, if the scene names one.
pub fn strength_model(material: &Material) -> Option<Box<dyn StrengthModel>> {
    struct Build(f64);
    impl StrengthVisitor for Build {
        type Output = Box<dyn StrengthModel>;

        fn visit<L: StrengthLaw>(self, law: L) -> Self::Output {
            Box::new(deviatoric_update::StrengthKernel(law.with_density(self.0)))
        }
    }
    material.strength.map(|strength| strength.visit(Build(material.density)))
}

/// Failure model of a material with the properties `rest`, if the scene names one.
pub fn failure_model(material: &Material, rest: &RestState) -> Option<Box<dyn FailureModel>> {
    struct Build<'a>(StrengthBeside, &'a RestState);
    impl FailureVisitor for Build<'_> {
        type Output = Box<dyn FailureModel>;

        fn visit<L: FailureLaw>(self, law: L) -> Self::Output {
            let law = law.with_rest_state(self.1);
            Box::new(damage_update::FailureKernel { law, strength: self.0 })
        }
    }
    material.failure.map(|failure| failure.visit(Build(material.strength_beside(), rest)))
}

/// Erosion limits of a material, if the scene gives any.
pub fn erosion_of(material: &Material) -> Option<ErosionCriterion> {
    let named = material.erosion?;
    let limit = |named: Option<f64>| named.unwrap_or(f64::INFINITY);
    Some(ErosionCriterion {
        plastic_strain: limit(named.plastic_strain),
        volume_ratio: limit(named.volume_ratio),
    })
}

/// Temperature model of a material, if the scene gives one; `matter` is its constitutive model.
pub fn thermal_of(material: &Material, matter: &ConstitutiveModel) -> Option<ThermalModel> {
    let named = material.thermal?;
    let isentrope = match (named.source, matter) {
        (HeatSource::Energy, ConstitutiveModel::Fluid(model)) => {
            Some(TemperatureIsentrope::new(model.as_ref(), material.density))
        }
        _ => None,
    };
    Some(ThermalModel {
        specific_heat: named.specific_heat,
        rest: named.reference_temperature,
        taylor_quinney: named.taylor_quinney,
        conductivity: named.conductivity,
        isentrope,
    })
}

/// Particle loops over an equation of state that is linear in the energy.
struct LinearEosKernel<E>(E);

impl<E: EquationOfState> FluidModel for LinearEosKernel<E> {
    fn mid_step(&self, particles: MidStep<'_>) {
        let n = particles.mass.len();
        let (mass, volume0, j, j_mid) = (
            particles.mass,
            &particles.volume0[..n],
            &particles.jacobian[..n],
            &particles.jacobian_mid[..n],
        );
        let (energy, out) = (&particles.energy[..n], &mut particles.stress_volume[..n]);
        let gradient = &particles.gradient[..n];
        let pressure_at = |r: usize, q: f64| {
            let dv = (j_mid[r] - j[r]) * volume0[r] / mass[r];
            let LinearPressure { reference_pressure, gruneisen_rho } = self.0.linear(j_mid[r]);
            let linear = reference_pressure + gruneisen_rho * (energy[r] - q * dv);
            self.0.clamp_tension(linear / (1.0 + gruneisen_rho * dv))
        };
        // compute the pressure once if both outputs are requested
        if let Some((pressure, compliance)) = particles.compliance {
            let (pressure, compliance) = (&mut pressure[..n], &mut compliance[..n]);
            for r in 0..n {
                let p = pressure_at(r, particles.q.map_or(0.0, |q| q[r]));
                out[r] = particles.q.map_or(p, |q| p + q[r]) * volume0[r] * j_mid[r];
                let volume = volume0[r] * j_mid[r];
                let c2 = self.0.sound_speed_squared(j_mid[r], p);
                let jump = particles.edge * gradient[r];
                let stiffness = mass[r] * (c2 + jump * jump) + particles.floor * volume;
                pressure[r] = p;
                compliance[r] = if c2 > 0.0 { volume * volume / stiffness } else { 0.0 };
            }
            return;
        }
        match particles.q {
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

    fn change_volume(&self, particles: VolumeChange<'_>) {
        for r in 0..particles.mass.len() {
            let dv = (particles.after[r] - particles.before[r]) * particles.volume0[r]
                / particles.mass[r];
            let q = particles.q.map_or(0.0, |q| q[r]);
            let LinearPressure { reference_pressure, gruneisen_rho } =
                self.0.linear(particles.after[r]);
            let energy = (particles.energy[r]
                - (0.5 * (particles.pressure[r] + reference_pressure) + q) * dv)
                / (1.0 + 0.5 * gruneisen_rho * dv);
            let pressure = reference_pressure + gruneisen_rho * energy;
            let clamped = self.0.clamp_tension(pressure);
            // tension that the material does not carry does no work
            particles.energy[r] = energy + 0.5 * (pressure - clamped) * dv;
            particles.pressure[r] = clamped;
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
            let (particle, what) = told(j, e).unwrap();
            assert_eq!(particle, 1);
            assert!(what.contains(word), "{what}");
        }
    }
}
