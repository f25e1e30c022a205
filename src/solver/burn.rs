//! Histories of materials, and the burnt fraction of explosives, which goes by the clock.

use smallvec::SmallVec;

use super::Stepper;
use crate::effects::burn::burnt;
use crate::material::constitutive::{self, Matter};
use crate::scene::{CheckedScene, Eos};
use crate::solver::particles::Columns;
use crate::solver::patch::Patch;

/// How a body burns.
pub(super) struct Burns {
    /// Time in which the front passes a place [s].
    duration: f64,
    /// 1/(1 - V_CJ), where compression burns too.
    by_compression: Option<f64>,
}

impl Burns {
    /// One a body, if any burns.
    pub(super) fn of(scene: &CheckedScene) -> Option<Vec<Option<Burns>>> {
        let of = |i: usize| {
            let material = scene.material_of(i);
            let front = material.eos.burn()?.front()?;
            let products = constitutive::products(&material.eos, material.density)?;
            let compression = || 1.0 / (1.0 - products.detonation().jacobian);
            Some(Burns {
                duration: front.width / front.detonation_velocity,
                by_compression: front.compression.then(compression),
            })
        };
        let all: Vec<_> = (0..scene.bodies.len()).map(of).collect();
        all.iter().any(Option::is_some).then_some(all)
    }
}

/// The column of the history of each body's material.
pub(super) fn histories(
    columns: &Columns,
    models: &[Matter],
    scene: &CheckedScene,
) -> Vec<Option<usize>> {
    let of = |(i, model): (usize, &Matter)| {
        let Matter::Fluid(model) = model else { return None };
        model.first_history()?;
        match scene.material_of(i).eos {
            Eos::PAlpha { .. } => columns.distension,
            _ => columns.burn.map(|c| c.fraction),
        }
    };
    models.iter().enumerate().map(of).collect()
}

/// Columns out of their block, with their numbers.
pub(super) type Histories = SmallVec<[(usize, Vec<f64>); 2]>;

impl<const D: usize> Stepper<D> {
    /// Takes the columns of histories out of a patch's block.
    pub(super) fn take_histories(&self, patch: &mut Patch<D>) -> Histories {
        let c = &self.columns;
        let numbers = c.distension.into_iter().chain(c.burn.map(|c| c.fraction));
        numbers.map(|k| (k, std::mem::take(&mut patch.block.columns[k]))).collect()
    }

    /// The burnt fraction of the own rows at `time` [s] and the volume ratio `jacobian` (a column);
    /// it never falls.
    pub(super) fn burn(&self, patch: &mut Patch<D>, time: f64, jacobian: usize) {
        let (Some(burns), Some(c)) = (&self.burns, self.columns.burn) else { return };
        let n = patch.block.own();
        let mut fraction = std::mem::take(&mut patch.block.columns[c.fraction]);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (lit, j) = (column(c.lighting_time), column(jacobian));
        for (body, rows) in super::particle_update::bodies(column(self.columns.body)) {
            let Some(burns) = &burns[body] else { continue };
            for r in rows {
                let mut now = burnt(time, lit[r], burns.duration);
                if let Some(scale) = burns.by_compression {
                    now = now.max(((1.0 - j[r]) * scale).min(1.0));
                }
                fraction[r] = fraction[r].max(now);
            }
        }
        patch.block.columns[c.fraction] = fraction;
    }
}
