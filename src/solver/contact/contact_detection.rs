//! Contact detection: whether two bodies touch at a node, from their gap, their contact pressure
//! and their contact impulse.

use crate::contact::{BodyPair, ContactParticle, ContactPlane, reach};
use crate::solver::clock::timed;
use crate::solver::contact::Member;
use crate::solver::contact::vectors::norm;
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;
use crate::solver::scheme::Scheme;

/// Bodies without stress touch if the gap between their edges is smaller than this [cells].
const CLOSED: f64 = 0.01;

/// Bodies under compression stay in contact over a gap as wide as the compression of a cell, up to
/// this [cells]: while a wave passes, the lengths and positions of the outermost particles are
/// slightly inconsistent.
const HELD: f64 = 0.1;

/// Fraction of the greatest adhesion impulse below which bodies do not adhere: well above the
/// impulse of rounding errors.
const HOLDS: f64 = 1e-3;

/// Initial contact impulse as a fraction of the greatest one, before any pressure: an oscillation
/// ahead of the first shock may start with tension, and would open the interface between two parts
/// of a cut body.
const AT_START: f64 = 0.1;

/// Impulse of uninterrupted pressure after which bodies no longer adhere, as a multiple of the
/// greatest adhesion impulse: 0.2 rho h u. A shock gives it in less than the time in which it
/// crosses a cell. An oscillation ahead of a shock changes its sign before.
const PRESSED: f64 = 10.0;

/// Fraction of u at which bodies with only their initial contact impulse separate, and above which
/// bodies that slide do not adhere: an oscillation opens an interface slowly, while bodies that
/// really separate do so at once.
const PARTS: f64 = 0.05;

/// Edge of a body at a node with several bodies.
#[derive(Clone, Copy)]
struct BodyEdge {
    /// p + q at the edge [Pa].
    stress: f64,
    /// Impulse that it may return as adhesion [Pa s].
    contact_impulse: f64,
    /// Whether a wave has pressed on it, so that it no longer adheres.
    is_pressed: bool,
}

/// Contact impulse of a particle after a step with the impulse `added` of p + q, if it can return
/// at most `most` as adhesion [all Pa s]. Pressure adds to it without interruption up to
/// [`PRESSED`], where it stays; tension takes from what the particle can return.
fn next_contact_impulse(impulse: f64, added: f64, most: f64) -> f64 {
    let pressed = PRESSED * most;
    if impulse >= pressed {
        pressed
    } else if added >= 0.0 {
        (impulse + added).min(pressed)
    } else {
        (impulse.min(most) + added).max(0.0)
    }
}

impl<const D: usize> Scheme<D> {
    /// Whether two bodies touch at a node. They do if the gap between the edges of their particles
    /// is closed, and without contact they would overlap by the end of a step of `dt`, with m the
    /// reduced mass, u the closing speed, A the area and s the mean p + q of their edges,
    ///
    /// ```text
    /// m u + A s dt > 0,
    /// ```
    ///
    /// or if they do not slide, no wave has pressed them together yet, and they adhere: see
    /// [`MAX_ADHESION`](crate::contact::MAX_ADHESION).
    pub(super) fn touch(
        &self,
        patch: &Patch<D>,
        index: [i64; D],
        particles: &BodyPair<'_, D>,
        [a, b]: [&Member<D>; 2],
        plane: &ContactPlane<D>,
        dt: f64,
    ) -> bool {
        if plane.gap >= CLOSED + HELD {
            return false;
        }
        let (normal, gap) = (&plane.normal, plane.gap);
        let first = self.edge(patch, particles.particles[0], normal, a.layer);
        let second = self.edge(patch, particles.particles[1], &normal.map(|n| -n), b.layer);
        let (Some(first), Some(second)) = (first, second) else { return false };
        let stress = 0.5 * (first.stress + second.stress);
        let strain = stress / self.stiffness[a.layer].min(self.stiffness[b.layer]);
        if gap >= CLOSED + strain.clamp(0.0, HELD) {
            return false;
        }
        let apart: [f64; D] = decomp::array::from_fn(|k| a.velocity[k] - b.velocity[k]);
        let closing = (0..D).map(|k| apart[k] * normal[k]).sum::<f64>();
        let slip: [f64; D] = decomp::array::from_fn(|k| apart[k] - closing * normal[k]);
        // both carry the same force: noise may have reduced the impulse of one of them
        let contact_impulse = first.contact_impulse.max(second.contact_impulse);
        let least =
            HOLDS * self.max_adhesion_impulse[a.layer].min(self.max_adhesion_impulse[b.layer]);
        // twice, as rounding errors also add to the impulse
        let start = 2.0 * self.starting_pull(a.layer).max(self.starting_pull(b.layer));
        let slow = -PARTS * self.impact;
        let mass = a.mass * b.mass / (a.mass + b.mass);
        let held = !(first.is_pressed || second.is_pressed)
            && contact_impulse > least
            && contact_impulse + dt * stress > 0.0
            && (contact_impulse > start || closing > slow);
        mass * closing + self.area(index, [a, b]) * dt * stress > 0.0
            || (held && !self.slides(norm(&slip)))
    }

    /// Whether bodies with a slip of `speed` [m/s] slide, so that they do not adhere.
    pub(super) fn slides(&self, speed: f64) -> bool {
        speed > PARTS * self.impact
    }

    /// Initial contact impulse of a body, before any pressure [Pa s].
    pub(in crate::solver) fn starting_pull(&self, body: usize) -> f64 {
        AT_START * self.max_adhesion_impulse[body]
    }

    /// The node's share of the contact area of two bodies [m2], from the gradients of their
    /// volumes.
    fn area(&self, index: [i64; D], [a, b]: [&Member<D>; 2]) -> f64 {
        let cell: f64 = self.cell.iter().product();
        let around = match self.axisymmetric {
            true => (self.lower[0] + index[0] as f64 * self.cell[0]).abs(),
            false => 1.0,
        };
        0.5 * (norm(&a.gradient) + norm(&b.gradient)) * cell * around
    }

    /// Updates the contact impulse of the own particles by the mean p + q in a step of `dt`: see
    /// [`next_contact_impulse`].
    pub(in crate::solver) fn find_contact_impulse(
        &self,
        patch: &mut Patch<D>,
        jacobian: usize,
        dt: f64,
    ) {
        let Some(column) = self.columns.contact_impulse else { return };
        timed(StepPart::Contact as usize, patch, |patch| {
            self.add_contact_impulse(patch, column, jacobian, dt);
        });
    }

    fn add_contact_impulse(
        &self,
        patch: &mut Patch<D>,
        contact_impulse: usize,
        jacobian: usize,
        dt: f64,
    ) {
        let c = &self.columns;
        let n = patch.block.own();
        let mut impulse = std::mem::take(&mut patch.block.columns[contact_impulse]);
        impulse.truncate(n);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (volume0, j, body) = (column(c.volume0), column(jacobian), column(c.body));
        let xx = column(c.stress_volume);
        let yy = column(c.stress_volume + usize::from(self.tensor_stress()));
        for r in 0..n {
            let stress = 0.5 * (xx[r] + yy[r]) / (volume0[r] * j[r]);
            let most = self.max_adhesion_impulse[body[r] as usize];
            impulse[r] = next_contact_impulse(impulse[r], dt * stress, most);
        }
        patch.block.columns[contact_impulse] = impulse;
    }

    /// Edge along `normal` of the `body` with `particles` at a node.
    fn edge(
        &self,
        patch: &Patch<D>,
        particles: &[ContactParticle<D>],
        normal: &[f64; D],
        body: usize,
    ) -> Option<BodyEdge> {
        let (_, particle) = reach(particles, normal)?;
        let (c, r) = (&self.columns, particle as usize);
        let column = |k: Option<usize>| patch.block.columns[k.expect("contact has the column")][r];
        let around = if self.axisymmetric { self.radius(patch, r).abs() } else { 1.0 };
        let volume = column(c.current_volume) * self.cell.iter().product::<f64>() * around;
        let stress = self.pressing(patch, r, normal) / volume;
        let (impulse, most) = (column(c.contact_impulse), self.max_adhesion_impulse[body]);
        let is_pressed = impulse >= PRESSED * most;
        Some(BodyEdge { stress, contact_impulse: impulse.min(most), is_pressed })
    }
}
