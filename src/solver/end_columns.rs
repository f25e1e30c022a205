//! Columns of the own particles that the end of a leapfrog step writes, for one particle or four at
//! a time with the same bits.

use std::ops::{Add, Mul, Sub};

use decomp::array::from_fn;
use wide::f64x4;

use super::gather::{OwnTensor, own, own_tensor, take_tensor, take_vector};
use super::nodal_sums::EndSums;
use super::scheme::Scheme;
use super::solid::{Taken, put_back};
use crate::shape::vector;
use crate::solver::patch::Patch;
use crate::transfer::VelocityUpdate;

/// Value of one particle, or values of four.
pub(super) trait Values:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
    /// Values in `column` from particle `first` on, with zeros beyond its end.
    fn load(column: &[f64], first: usize) -> Self;

    /// Writes the values to `column`, up to its end.
    fn store(self, column: &mut [f64], first: usize);
}

impl Values for f64 {
    #[inline(always)]
    fn load(column: &[f64], first: usize) -> Self {
        column[first]
    }

    #[inline(always)]
    fn store(self, column: &mut [f64], first: usize) {
        column[first] = self;
    }
}

impl Values for f64x4 {
    #[inline(always)]
    fn load(column: &[f64], first: usize) -> Self {
        match column[first..].first_chunk() {
            Some(values) => vector(values),
            None => from_fn(|k| column.get(first + k).copied().unwrap_or(0.0)).into(),
        }
    }

    #[inline(always)]
    fn store(self, column: &mut [f64], first: usize) {
        let column = &mut column[first..];
        match column.first_chunk_mut() {
            Some(values) => *values = self.to_array(),
            None => column.iter_mut().zip(self.to_array()).for_each(|(out, value)| *out = value),
        }
    }
}

/// The columns, taken out of their block: they are written while other columns are read.
pub(super) struct EndColumns<const D: usize> {
    position: [Vec<f64>; D],
    velocity: [Vec<f64>; D],
    divergence: Vec<f64>,
    gradient: Taken,
}

/// The own particles of these columns.
pub(super) struct OwnEnds<'a, const D: usize> {
    position: [&'a mut [f64]; D],
    velocity: [&'a mut [f64]; D],
    /// Divergence of the velocity [1/s].
    pub divergence: &'a mut [f64],
    gradient: OwnTensor<'a>,
}

impl<const D: usize> EndColumns<D> {
    /// The first `particles` of the columns.
    #[inline(always)]
    pub fn own(&mut self, particles: usize) -> OwnEnds<'_, D> {
        OwnEnds {
            position: own(&mut self.position, particles),
            velocity: own(&mut self.velocity, particles),
            divergence: &mut self.divergence[..particles],
            gradient: own_tensor(&mut self.gradient, particles),
        }
    }
}

impl<const D: usize> OwnEnds<'_, D> {
    /// Updates the particles from `first` on from their sums: if they move, their velocities and in
    /// `dt` [s] their positions, if they strain, their velocity gradients in the plane.
    #[inline(always)]
    pub fn put<T: Values>(
        &mut self,
        first: usize,
        at: &EndSums<D, T>,
        (update, dt): (VelocityUpdate, f64),
        [moves, strains]: [bool; 2],
    ) {
        for a in 0..if moves { D } else { 0 } {
            let (old, new) = (at.start[a], at.star[a]);
            let v = match update {
                VelocityUpdate::Blend(share) => {
                    T::load(self.velocity[a], first) * share + old * (1.0 - share) + (new - old)
                }
                VelocityUpdate::Filtered | VelocityUpdate::Affine => new,
            };
            v.store(self.velocity[a], first);
            (T::load(self.position[a], first) + new * dt).store(self.position[a], first);
        }
        if strains {
            if let Some(gradient) = &mut self.gradient {
                for a in 0..D {
                    for b in 0..D {
                        at.gradient[a][b].store(gradient[D * a + b], first);
                    }
                }
            }
            let trace = (1..D).fold(at.gradient[0][0], |sum, a| sum + at.gradient[a][a]);
            trace.store(self.divergence, first);
        }
    }
}

impl<const D: usize> Scheme<D> {
    /// Takes the columns out of a patch.
    pub(super) fn take_ends(&self, patch: &mut Patch<D>) -> EndColumns<D> {
        let (c, columns) = (&self.columns, &mut patch.block.columns);
        EndColumns {
            position: take_vector(columns, c.position),
            velocity: take_vector(columns, c.velocity),
            divergence: std::mem::take(&mut columns[c.divergence]),
            gradient: take_tensor(columns, c.velocity_gradient, D * D),
        }
    }

    /// Puts the columns back.
    pub(super) fn put_ends(&self, patch: &mut Patch<D>, taken: EndColumns<D>) {
        let (c, columns) = (&self.columns, &mut patch.block.columns);
        put_back(columns, c.position, taken.position);
        put_back(columns, c.velocity, taken.velocity);
        columns[c.divergence] = taken.divergence;
        if let Some(first) = c.velocity_gradient {
            put_back(columns, first, taken.gradient);
        }
    }
}
