//! One time step, written like the description of the method in a paper.
//!
//! [`Scheme`] holds grid, columns, nodal fields and material models of a scene, [`Stepper`] also its
//! effects; [`Steps::advance`] runs the phases of [`midpoint`] or [`leapfrog`]. [`World`] joins
//! physics and messages: it runs a phase on every patch, and the exchanges between phases.

pub mod artificial_viscosity;
pub mod band;
mod body_models;
pub mod clock;
pub mod columns;
mod contact;
mod corner_sums;
pub mod declare;
pub mod effect;
mod end_columns;
pub mod exchange;
mod find_weights;
mod flux_limiter;
pub mod gather;
mod gather_midpoint;
mod initial_state;
pub mod leapfrog;
mod material_state;
pub mod memory;
pub mod midpoint;
mod midpoint_update;
mod motion_columns;
pub mod nodal_fields;
pub mod nodal_matrix;
mod nodal_sums;
mod packed;
mod particle_cells;
mod particle_domains;
pub mod particle_matrix;
pub mod particle_update;
pub mod particle_weights;
pub mod particles;
pub mod parts;
pub mod patch;
mod reach;
pub mod relaxation;
pub mod scatter;
mod scatter_groups;
pub mod scheme;
pub mod series;
pub mod shape_weights;
pub mod sides;
mod solid;
mod spin;
mod stepper;
mod summed_fields;
mod tension_free;
mod total_lagrangian;

pub use contact::SelfContact;
pub use exchange::{Nodal, Sleep, World};
pub use reach::StencilRadius;
pub use scheme::Scheme;
pub use stepper::Stepper;

#[cfg(test)]
pub(crate) mod tests;
