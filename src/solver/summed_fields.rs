//! Columns of particles that are summed, and nodal fields that hold the sums, taken out of a patch
//! while its other arrays are read.

use decomp::array;

use crate::solver::patch::Patch;
use crate::solver::scheme::Scheme;

/// The fields, owned.
pub(super) struct SummedFields<const D: usize> {
    mass: Vec<f64>,
    momentum: [Vec<f64>; D],
    force: [Vec<f64>; D],
    volume: Option<Vec<f64>>,
}

/// The fields as slices of equal length, so that the bounds of a window are checked only once.
pub(super) struct SummedSlices<'a, const D: usize> {
    /// Mass [kg].
    pub mass: &'a mut [f64],
    /// Momentum [kg m/s].
    pub momentum: [&'a mut [f64]; D],
    /// Internal force [N].
    pub force: [&'a mut [f64]; D],
    /// Filled volume [cells], with an edge mask.
    pub volume: Option<&'a mut [f64]>,
}

/// Columns of the particles of a patch, including ghosts, that are summed.
pub(super) struct SummedColumns<'a, const D: usize> {
    /// Mass [kg].
    pub mass: &'a [f64],
    /// Velocity [m/s].
    pub velocity: [&'a [f64]; D],
    /// Volume [cells], with an edge mask.
    pub filled: &'a [f64],
    /// Stress times volume [J], if forces are summed.
    pub stress: Option<&'a [f64]>,
    /// Angular momentum per unit mass [m2/s], with spin.
    pub moment: Option<&'a [f64]>,
}

impl<const D: usize> SummedColumns<'_, D> {
    /// Momentum of a particle in a plane along x and y [kg m/s], and its mass times its rate of
    /// rotation `omega` [1/s].
    #[inline(always)]
    pub fn motion(&self, r: usize, omega: f64) -> [f64; 3] {
        array::map(&[self.velocity[0][r], self.velocity[D - 1][r], omega], |v| self.mass[r] * v)
    }
}

impl<const D: usize> SummedFields<D> {
    /// The fields as slices.
    pub fn sums(&mut self) -> SummedSlices<'_, D> {
        let nodes = self.mass.len();
        SummedSlices {
            mass: &mut self.mass,
            momentum: array::parts_mut(&mut self.momentum, nodes),
            force: array::parts_mut(&mut self.force, nodes),
            volume: self.volume.as_mut().map(|field| &mut field[..nodes]),
        }
    }
}

impl<const D: usize> Scheme<D> {
    /// Takes the fields of sums out of a patch.
    pub(super) fn take_sums(&self, patch: &mut Patch<D>) -> SummedFields<D> {
        let f = &self.fields;
        let mut take = |k: usize| std::mem::take(&mut patch.nodes.fields[k]);
        SummedFields {
            mass: take(f.mass),
            momentum: array::from_fn(|a| take(f.lumped_velocity + a)),
            force: array::from_fn(|a| take(f.acceleration + a)),
            volume: self.edge_mask.map(|_| take(f.volume)),
        }
    }

    /// Puts the fields back.
    pub(super) fn put_sums(&self, patch: &mut Patch<D>, taken: SummedFields<D>) {
        let (f, fields) = (&self.fields, &mut patch.nodes.fields);
        fields[f.mass] = taken.mass;
        for (a, (momentum, force)) in taken.momentum.into_iter().zip(taken.force).enumerate() {
            fields[f.lumped_velocity + a] = momentum;
            fields[f.acceleration + a] = force;
        }
        if let Some(volume) = taken.volume {
            fields[f.volume] = volume;
        }
    }
}
