//! Material state of a particle: deviator, temperature and the input of the strength model.

use std::ops::Range;

use decomp::Block;

use super::scheme::Scheme;
use crate::material::constitutive::{ConstitutiveModel, Deviators, RestIsentrope};
use crate::material::strength::MaterialState;
use crate::scene::CheckedScene;
use crate::solver::patch::Patch;

/// Number of points of isentropes for elastic energies on each side of rest.
const ISENTROPE_POINTS: usize = 100;

impl<const D: usize> Scheme<D> {
    /// Columns of the deviator, from `first` on.
    pub(crate) fn deviator<'a>(
        &self,
        patch: &'a Patch<D>,
        first: usize,
        particles: Range<usize>,
    ) -> Deviators<'a> {
        let column = |k: usize| &patch.block.columns[first + k][particles.clone()];
        Deviators { xx: column(0), plane: (D > 1).then(|| [column(1), column(2)]) }
    }

    /// Input of the strength model for a particle, at the volume ratio `jacobian` and `pressure`
    /// [Pa].
    pub(crate) fn condition(
        &self,
        patch: &Patch<D>,
        r: usize,
        jacobian: f64,
        pressure: f64,
    ) -> MaterialState {
        let temperature = self.columns.temperature.map_or(f64::NAN, |t| patch.block.columns[t][r]);
        MaterialState { compression: 1.0 / jacobian, pressure, temperature }
    }

    /// Plastic work per unit mass that the plastic strain of own particle `r`, in column `strain`,
    /// needs at the present yield stress of the particle [J/kg]; 0 without strength.
    pub fn plastic_heat(&self, block: &Block<D>, r: usize, strain: usize) -> f64 {
        let c = &self.columns;
        let column = |k: usize| block.columns[k][r];
        let Some(strength) = &self.strengths[column(c.body) as usize] else { return 0.0 };
        let (strain, jacobian) = (column(strain), column(c.jacobian));
        let temperature = c.temperature.map_or(f64::NAN, column);
        let at = MaterialState {
            compression: 1.0 / jacobian,
            pressure: column(c.pressure),
            temperature,
        };
        let volume = column(c.volume0) * jacobian;
        strength.yield_stress(strain, &at) * strain * volume / column(c.mass)
    }

    /// Isentrope of body `body` through its material at rest, for elastic energies; `None` for elastic
    /// solids, and for materials with a history, which have no single isentrope.
    pub fn isentrope(&self, scene: &CheckedScene, body: usize) -> Option<RestIsentrope> {
        match &self.models[body] {
            ConstitutiveModel::Fluid(model) if model.first_history().is_none() => {
                let density = scene.material_of(body).density;
                Some(RestIsentrope::with_points(model.as_ref(), density, ISENTROPE_POINTS))
            }
            _ => None,
        }
    }

    /// Elastic energy of own particle `r` per unit mass [J/kg]: that of an elastic solid; of a fluid
    /// that of its `isentrope` in compression, and -p (J - 1)/(2 rho0) in tension. The latter is a
    /// lower bound, which is also valid where a failure or a limit has reduced the tension.
    pub fn elastic_energy(
        &self,
        block: &Block<D>,
        r: usize,
        isentrope: Option<&RestIsentrope>,
    ) -> f64 {
        let c = &self.columns;
        let column = |k: usize| block.columns[k][r];
        let jacobian = column(c.jacobian);
        match &self.models[column(c.body) as usize] {
            ConstitutiveModel::Solid(solid) => {
                let strain = self.strain(block, r..r + 1, 0.0, &block.columns[c.jacobian]);
                solid.stored_energy(strain, 0)
            }
            ConstitutiveModel::Fluid(_) if jacobian < 1.0 => {
                isentrope.map_or(0.0, |isentrope| isentrope.at(jacobian)[0])
            }
            ConstitutiveModel::Fluid(_) => {
                let tension = (-column(c.pressure)).max(0.0);
                0.5 * tension * (jacobian - 1.0) * column(c.volume0) / column(c.mass)
            }
        }
    }

    /// Heat that own particle `r` lacks to reach absolute zero, per unit mass [J/kg]: cv max(0,
    /// -T); `None` without a temperature.
    pub fn heat_below_zero_kelvin(&self, block: &Block<D>, r: usize) -> Option<f64> {
        let temperature = block.columns[self.columns.temperature?][r];
        let thermal = self.thermals[block.columns[self.columns.body][r] as usize].as_ref()?;
        // max() would ignore NaN
        Some(if temperature >= 0.0 { 0.0 } else { -thermal.specific_heat * temperature })
    }

    /// Temperature of a particle from its energy [K]; `None` if it does not follow from the energy.
    /// `before` is the temperature for the strength model [K].
    pub(crate) fn temperature(
        &self,
        patch: &Patch<D>,
        body: usize,
        r: usize,
        pressure: f64,
        before: f64,
    ) -> Option<f64> {
        let c = &self.columns;
        let of = self.thermals[body].as_ref()?;
        of.isentrope.as_ref()?;
        let column = |k: usize| patch.block.columns[k][r];
        let j = column(c.jacobian);
        let damage = c.tension_free[body].map_or(0.0, column);
        let gradual = self.gradual_failure(body).filter(|_| damage < 1.0);
        let carried = gradual.map(|failure| failure.carried(damage));
        let mut energy = column(c.energy);
        if let (Some(first), Some(strength)) = (c.deviator, &self.strengths[body]) {
            let s = self.deviator(patch, first, r..r + 1).at(0);
            let at = MaterialState { compression: 1.0 / j, pressure, temperature: before };
            let modulus = strength.shear_modulus(&at) * carried.map_or(1.0, |c| c.shear);
            if modulus > 0.0 {
                energy -=
                    s.double_dot(&s) * column(c.volume0) * j / (4.0 * modulus * column(c.mass));
            }
        }
        energy -= c.stored_work.map_or(0.0, column);
        // failed material that has separated is not stretched beyond its initial volume
        let failed = damage >= 1.0;
        let stretch = match carried {
            _ if failed => j.min(1.0),
            // the stretch at which intact material has the elastic energy of the damaged one
            Some(c) if j > 1.0 => 1.0 + c.tension.sqrt() * (j - c.opening - 1.0).max(0.0),
            _ => j,
        };
        of.temperature(stretch, energy)
    }
}
