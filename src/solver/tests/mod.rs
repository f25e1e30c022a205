//! Tests of single kernels of the step against closed answers, on one patch with a few particles.
//!
//! Cells have an edge of 1 m, and numbers are chosen so that the answers follow by hand.

pub(crate) mod fixture;

mod cells;
mod contact;
mod corner_sums;
mod flux_limiter;
mod gather;
mod particle_cells;
mod particle_domains;
mod particle_update;
mod relaxation;
mod scatter;
mod series;
mod sides;
mod solid;
mod spin;
mod steps;
mod total_lagrangian;
mod wide_particles;
