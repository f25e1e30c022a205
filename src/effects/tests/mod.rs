//! Tests of effects against closed answers, on one patch with a few particles: see
//! [`Fixture`](crate::solver::tests::fixture::Fixture).

mod accelerated_grid;
mod body_force;
mod burn;
mod conduction;
mod erosion;
mod failure;
mod loaded_sides;
mod pores;
mod strength;
mod temperature;
mod transmitting_sides;
mod wall_friction;
