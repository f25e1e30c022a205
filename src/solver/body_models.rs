//! Material models of the bodies, and wave speeds of the bodies at the start.

use super::columns::Columns;
use crate::contact::MAX_ADHESION;
use crate::material::constitutive::{
    self, ConstitutiveModel, CustomModel, FailureModel, StrengthModel, ThermalModel,
};
use crate::material::failure::RestState;
use crate::material::strength::MaterialState;
use crate::scene::{CheckedScene, Material};

/// Material models of each body.
pub(super) struct BodyModels {
    /// Constitutive model of each body.
    pub models: Vec<ConstitutiveModel>,
    /// Strength of each body; `None` without one.
    pub strengths: Vec<Option<Box<dyn StrengthModel>>>,
    /// Temperature model of each body; `None` without one.
    pub thermals: Vec<Option<ThermalModel>>,
}

impl BodyModels {
    /// Models of `scene`, replaced by custom models from `outside`, which is called with the
    /// material name once per body.
    ///
    /// # Errors
    ///
    /// Name of the material, and the reason why it cannot use the custom model.
    pub fn new(
        scene: &CheckedScene,
        outside: &dyn Fn(&str) -> Option<CustomModel>,
    ) -> Result<Self, (String, String)> {
        let materials = || (0..scene.bodies.len()).map(|i| scene.material_of(i));
        let mut models: Vec<ConstitutiveModel> = materials().map(constitutive::build).collect();
        let mut strengths: Vec<_> = materials().map(constitutive::strength_model).collect();
        for (b, (model, strength)) in
            scene.scene.bodies.iter().zip(models.iter_mut().zip(&mut strengths))
        {
            if let Some(own) = outside(&b.material) {
                own.replace(&scene.scene.materials[&b.material], model, strength)
                    .map_err(|reason| (b.material.clone(), reason))?;
            }
        }
        let thermals = materials().zip(&models);
        let thermals = thermals.map(|(m, model)| constitutive::thermal_of(m, model)).collect();
        Ok(BodyModels { models, strengths, thermals })
    }

    /// Failure model of each body's material, with the shear wave speed of each body at rest [m/s]
    /// and the edge of a cell [m].
    pub fn failures(
        &self,
        scene: &CheckedScene,
        shear_speeds: &[f64],
        cell: f64,
    ) -> Vec<Option<Box<dyn FailureModel>>> {
        let of = |(i, (model, shear)): (usize, (&ConstitutiveModel, &f64))| {
            let material = scene.material_of(i);
            let density = material.density;
            let bulk_modulus = density * model.sound_speed_at(0.0).powi(2);
            let shear_modulus = density * shear.powi(2);
            let rest = RestState { density, bulk_modulus, shear_modulus, cell };
            constitutive::failure_model(material, &rest)
        };
        self.models.iter().zip(shear_speeds).enumerate().map(of).collect()
    }

    /// Column of the history variable of each body's equation of state.
    pub fn histories(&self, columns: &Columns) -> Vec<Option<usize>> {
        let history = columns.history.iter().zip(&self.models).map(|(column, model)| match model {
            ConstitutiveModel::Fluid(model) => column.filter(|_| model.first_history().is_some()),
            ConstitutiveModel::Solid(_) => None,
        });
        history.collect()
    }
}

/// Wave speeds in a body at rest.
struct Waves {
    /// Shear wave speed [m/s]; 0 in a fluid without strength.
    shear: f64,
    /// Contribution of shear to the square of the sound speed, 4 G/(3 rho) of a material with
    /// strength [m2/s2].
    added: f64,
}

impl Waves {
    fn of(
        material: &Material,
        model: &ConstitutiveModel,
        strength: Option<&dyn StrengthModel>,
    ) -> Self {
        let rest = MaterialState {
            compression: 1.0,
            pressure: 0.0,
            temperature: material.thermal.map_or(f64::NAN, |t| t.reference_temperature),
        };
        match strength {
            None => Waves { shear: model.shear_speed(), added: 0.0 },
            Some(strength) => {
                let square = strength.shear_modulus(&rest) / material.density;
                Waves { shear: square.sqrt(), added: 4.0 / 3.0 * square }
            }
        }
    }

    /// Speed of the fastest wave, if the sound speed without strength is `sound` [m/s].
    fn fastest(&self, sound: f64) -> f64 {
        if self.added > 0.0 { (sound * sound + self.added).sqrt() } else { sound }
    }
}

/// Waves of the bodies of a scene at the start.
pub(super) struct BodyWaves {
    /// Initial rho c^2 of each body [Pa].
    pub stiffness: Vec<f64>,
    /// Initial acoustic impedance rho c of each body [Pa s/m].
    pub impedances: Vec<f64>,
    /// Shear wave speed in each body at rest [m/s]; 0 in fluids without strength.
    pub shear_speeds: Vec<f64>,
    /// Impact speed of the scene, maximum over its bodies [m/s].
    pub impact: f64,
    /// Greatest impulse that each body can return as adhesion under tension [Pa s].
    pub max_adhesion_impulse: Vec<f64>,
    /// Greatest initial speed, of bodies or sound [m/s].
    pub fastest: f64,
}

impl BodyWaves {
    /// Waves of the bodies of `scene`, with `smallest` the shortest edge of a cell [m].
    pub fn new<const D: usize>(scene: &CheckedScene, models: &BodyModels, smallest: f64) -> Self {
        let bodies = &scene.scene.bodies;
        let of = |i: usize| (scene.material_of(i), &models.models[i]);
        let waves: Vec<Waves> = (0..bodies.len())
            .map(|i| Waves::of(of(i).0, of(i).1, models.strengths[i].as_deref()))
            .collect();
        let fastest = (0..bodies.len())
            .map(|i| {
                let checked = &scene.bodies[i];
                let pressure = checked.motion.and_then(|m| m.top_pressure());
                let pressure = pressure.unwrap_or(bodies[i].pressure);
                waves[i].fastest(of(i).1.sound_speed_at(pressure)).max(checked.top_speed)
            })
            .fold(0.0, f64::max);
        // pressure, density and speed of the fastest wave
        let starts: Vec<[f64; 3]> = (0..bodies.len())
            .map(|i| {
                let (material, model) = of(i);
                let pressure = bodies[i].pressure;
                [pressure, material.density, waves[i].fastest(model.sound_speed_at(pressure))]
            })
            .collect();
        let impact = scene.impact_speed::<D>();
        let speed = |[pressure, density, c]: [f64; 3]| impact.max(pressure.abs() / (density * c));
        let pull = |at: &[f64; 3]| MAX_ADHESION * at[1] * smallest * speed(*at);
        BodyWaves {
            stiffness: starts.iter().map(|[_, density, c]| density * c.powi(2)).collect(),
            impedances: starts.iter().map(|[_, density, c]| density * c).collect(),
            shear_speeds: waves.iter().map(|w| w.shear).collect(),
            impact: starts.iter().map(|at| speed(*at)).fold(0.0, f64::max),
            max_adhesion_impulse: starts.iter().map(pull).collect(),
            fastest,
        }
    }
}
