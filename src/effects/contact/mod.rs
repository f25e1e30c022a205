//! Contact between bodies that have velocity fields of their own.
//!
//! Each body's sums stand in a layer of the nodal arrays: mass, momentum, force, mass matrix. The
//! nodes that rows of several bodies touch are *meetings*; a pair of bodies that is in contact
//! there shares the degrees of freedom across the contact plane, which is one velocity for both
//! normal to it (and all of it while friction holds). With m_i the lumped masses, D their diagonal
//! matrix and Pi the projection on the velocities that are so shared, orthogonal in the scalar
//! product of D, K = 1 - D^-1 M of one body becomes
//!
//! ```text
//! Pi K = Pi (1 - D^-1 M)
//! ```
//!
//! on shared velocities: every sum over mass and every product with M is followed by Pi, a few
//! nodes' work. All that the one-body formulas say, filters, the force's inverse, exact energy,
//! pressure relaxation, then holds as it stands, momentum is exact, and what is lost as two bodies
//! become one at a node is heat of the particles there.
//!
//! Bodies are in contact where the edges of their particles, at the middle of the step, leave no
//! gap, and apart they would overlap by its end: so nothing happens a cell early, as it does where
//! the grid alone decides (Bardenhagen, Brackbill & Sulsky 2000), and nothing sticks. Bodies that
//! were pressed together hold a little while when pulled on, for an interface that opened at each
//! ripple ahead of a shock would scatter it.
//!
//! Knows no materials, no messages.

mod contact_constraint;
mod contact_nodes;
mod multi_body_constraint;
mod normal;

pub use contact_constraint::{Booked, ContactNodes, Joint};
pub use contact_nodes::{Member, Touch};
pub use multi_body_constraint::Knot;
pub use normal::{INSET, Point, logistic_regression, volume_gradient};

use crate::scene::{self, Normals};

/// What happens along the plane of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Coulomb's coefficient [-]; none: no friction.
    pub coefficient: Option<f64>,
    /// Where normals come from.
    pub normals: Normals,
}

impl Contact {
    /// The contact of a scene whose bodies have velocity fields of their own.
    pub fn new(contact: &scene::Contact) -> Option<Self> {
        match *contact {
            scene::Contact::Stick {} => None,
            scene::Contact::Frictionless { normals } => {
                Some(Contact { coefficient: None, normals })
            }
            scene::Contact::Friction { coefficient, normals } => {
                Some(Contact { coefficient: Some(coefficient), normals })
            }
        }
    }
}
