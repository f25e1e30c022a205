//! Model of the material of a body: interface between the step and the equations of state.

use super::solid::SolidModel;

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
    /// Volume ratio J at the start of the step [-].
    pub jacobian: &'a [f64],
    /// Volume ratio J at the middle of the step [-].
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
    /// History variable at the start of the step in the unit of its column, if the material has
    /// one.
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
    /// Volume ratio J before the change [-].
    pub before: &'a [f64],
    /// Volume ratio J after the change [-].
    pub after: &'a [f64],
    /// Artificial viscosity during the change [Pa], if active.
    pub q: Option<&'a [f64]>,
    /// Pressure [Pa], updated in place.
    pub pressure: &'a mut [f64],
    /// Specific internal energy [J/kg], updated in place.
    pub energy: &'a mut [f64],
    /// History variable before the change in the unit of its column, if the material has one.
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
