//! A rigid piston; the grid moves with it.

use super::{Course, SideProperties};

/// A piston with the velocity `course` normal to the side [m/s].
pub(super) fn properties(course: &Course) -> SideProperties {
    SideProperties {
        rigid_velocity: Some(course.clone()),
        moves_grid: true,
        ..SideProperties::wall()
    }
}
