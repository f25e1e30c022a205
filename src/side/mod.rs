//! Sides of the domain: one file per kind, one line per kind in the list below.
//!
//! Each kind is described by its [`SideProperties`]; checks, solver and effects depend only on
//! them. This module is independent of particles, fields and messages.

mod time_function;

use decomp::SideKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use time_function::{Course, Ramp};

/// Defines the kinds of side from a list of `module::Name(parameter: attribute type),`. The module
/// has the name of the kind in scenes and the function `properties`.
macro_rules! sides {
    ($(
        $(#[$attribute:meta])+
        $module:ident::$name:ident $(($value:ident: $(#[$range:meta])? $type:ty))?,
    )+) => {
        $(mod $module;)+

        /// Condition at one side of the domain.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum Side {
            $($(#[$attribute])+ $name $(($(#[$range])? $type))?,)+
        }

        impl Side {
            /// Name of the kind in scenes.
            pub fn name(&self) -> &'static str {
                match self { $(Side::$name { .. } => stringify!($module),)+ }
            }

            /// Properties that checks, solver and effects depend on.
            pub fn properties(&self) -> SideProperties {
                match self { $(Side::$name $(($value))? => $module::properties($($value)?),)+ }
            }
        }
    };
}

sides! {
    /// No condition: a particle that passes the side ends the run.
    #[default]
    free::Free,
    /// A plane of symmetry.
    symmetry::Symmetry,
    /// A rigid wall without friction; equivalent to `symmetry`.
    wall::Wall,
    /// A rigid wall to which material sticks, in a plane.
    no_slip::NoSlip,
    /// A rigid wall with Coulomb friction of this coefficient [-], in a plane: material sticks
    /// while the tangential force is at most the coefficient times the normal force, and slides
    /// otherwise.
    friction::Friction(coefficient: #[schemars(range(min = 0.0))] f64),
    /// Periodic: joined to the opposite side.
    periodic::Periodic,
    /// Open: a particle that passes the side leaves the run, and its loss is recorded.
    outflow::Outflow,
    /// Open and non-reflecting, as if the same material continued beyond the side: waves leave
    /// without reflection. A particle that passes the side leaves the run, and its loss is
    /// recorded.
    transmitting::Transmitting,
    /// A rigid piston with this velocity normal to the side [m/s]; the grid moves with it. A
    /// number, pairs of time [s] and velocity, a ramp, or the name of a CSV file with the columns
    /// time and velocity.
    velocity::Velocity(course: Course),
    /// A pressure [Pa] on the surface of the bodies that touch this side at the start; it follows
    /// the surface. A number, pairs of time [s] and pressure, a ramp, or the name of a CSV file
    /// with the columns time and pressure. Otherwise the side is free.
    pressure::Pressure(load: Course),
}

impl Side {
    /// Time function of the kind: its pressure, or the velocity of a rigid side.
    pub fn course(&self) -> Option<Course> {
        let SideProperties { rigid_velocity, pressure, .. } = self.properties();
        rigid_velocity.or(pressure)
    }
}

/// Properties of a side of the domain.
#[derive(Clone, Debug, PartialEq)]
pub struct SideProperties {
    /// Kind of ghost copies of particles and nodes beyond the side.
    pub ghosts: SideKind,
    /// Whether particles that pass the side leave the run.
    pub lets_out: bool,
    /// Velocity of a rigid side in its normal direction over time [m/s].
    pub rigid_velocity: Option<Course>,
    /// Whether the grid moves with the rigid side (a piston).
    pub moves_grid: bool,
    /// Pressure over time on the surface of the bodies that touch the side at the start [Pa].
    pub pressure: Option<Course>,
    /// Coulomb friction coefficient of a wall [-]; `None`: no friction.
    pub friction: Option<f64>,
    /// Whether material sticks to the wall.
    pub no_slip: bool,
    /// Whether waves pass the side without reflection.
    pub absorbs_waves: bool,
    /// Whether the side is a plane of symmetry, which may be the axis of an axisymmetric domain.
    pub symmetric: bool,
}

impl SideProperties {
    /// No condition: a particle that passes the side ends the run.
    fn open() -> Self {
        SideProperties {
            ghosts: SideKind::Open,
            lets_out: false,
            rigid_velocity: None,
            moves_grid: false,
            pressure: None,
            friction: None,
            no_slip: false,
            absorbs_waves: false,
            symmetric: false,
        }
    }

    /// A rigid wall at rest without friction.
    fn wall() -> Self {
        SideProperties {
            ghosts: SideKind::Mirror,
            rigid_velocity: Some(Course::Constant(0.0)),
            ..SideProperties::open()
        }
    }

    /// Whether the side is rigid, so that no material passes it.
    pub fn is_rigid(&self) -> bool {
        self.rigid_velocity.is_some()
    }

    /// Whether the side is joined to the opposite one.
    pub fn is_periodic(&self) -> bool {
        self.ghosts == SideKind::Wrap
    }

    /// Whether the side resists tangential motion, which requires a plane.
    pub fn resists_sliding(&self) -> bool {
        self.no_slip || self.friction.is_some()
    }

    /// Whether the side acts on material as a wall, periodic side, load or absorber of waves.
    pub fn acts_on_material(&self) -> bool {
        self.ghosts != SideKind::Open || self.pressure.is_some() || self.absorbs_waves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_have_the_names_of_the_kinds_in_scenes() {
        let course = || Course::Constant(1.0);
        let plain = [Side::Free, Side::Symmetry, Side::Wall, Side::NoSlip, Side::Periodic];
        let open = [Side::Outflow, Side::Transmitting];
        for side in plain.into_iter().chain(open) {
            assert_eq!(serde_json::json!(side), side.name());
        }
        for side in [Side::Friction(0.3), Side::Velocity(course()), Side::Pressure(course())] {
            assert!(serde_json::json!(side).get(side.name()).is_some(), "{side:?}");
        }
    }
}
