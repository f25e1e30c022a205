//! Contact detection: whether two bodies touch at a node, from their gap, their contact pressure
//! and their contact impulse.

use crate::solver::clock::timed;
use crate::solver::contact::vectors::norm;
use crate::solver::contact::{Member, Touch};
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

/// Fraction of u at which bodies with only their initial contact impulse separate: an oscillation
/// opens an interface slowly, while bodies that really separate do so at once.
const PARTS: f64 = 0.05;

/// Edge of a body at a node with several bodies.
#[derive(Clone, Copy)]
struct BodyEdge {
    /// Position of the edge along the normal, relative to the node [m].
    reach: f64,
    /// p + q at the edge [Pa].
    stress: f64,
    /// Impulse that it may return as adhesion [Pa s].
    contact_impulse: f64,
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
    /// or if they were pressed together and adhere: see [`MAX_ADHESION`](crate::contact::MAX_ADHESION).
    pub(super) fn touch(
        &self,
        patch: &Patch<D>,
        index: [i64; D],
        touches: &[Touch],
        [a, b]: [&Member<D>; 2],
        normal: &[f64; D],
        dt: f64,
    ) -> bool {
        let edges = |direction: &[f64; D]| {
            let first = self.edge(patch, index, touches, a.layer, direction)?;
            let second = self.edge(patch, index, touches, b.layer, &direction.map(|n| -n))?;
            Some((first, second))
        };
        let Some((first, second)) = edges(normal) else { return false };
        let cell = self.cell.iter().copied().fold(f64::INFINITY, f64::min);
        let mut gap = -(first.reach + second.reach) / cell;
        // near a corner the normal lies between the normals of two faces, and along it the bodies
        // seem to overlap; a gap along any of these directions counts
        if D > 1 {
            let faces = [a.gradient, b.gradient.map(|g| -g)];
            let axes = (0..D).map(|k| {
                let mut axis = [0.0; D];
                axis[k] = normal[k].signum();
                axis
            });
            for direction in faces.into_iter().chain(axes) {
                let length = norm(&direction);
                if length > 0.0
                    && let Some((first, second)) = edges(&direction.map(|x| x / length))
                {
                    gap = gap.max(-(first.reach + second.reach) / cell);
                }
            }
        }
        let stress = 0.5 * (first.stress + second.stress);
        let strain = stress / self.stiffness[a.layer].min(self.stiffness[b.layer]);
        if gap >= CLOSED + strain.clamp(0.0, HELD) {
            return false;
        }
        let closing = (0..D).map(|k| (a.velocity[k] - b.velocity[k]) * normal[k]).sum::<f64>();
        // both carry the same force: noise may have reduced the impulse of one of them
        let contact_impulse = first.contact_impulse.max(second.contact_impulse);
        let least =
            HOLDS * self.max_adhesion_impulse[a.layer].min(self.max_adhesion_impulse[b.layer]);
        // twice, as rounding errors also add to the impulse
        let start = 2.0 * self.starting_pull(a.layer).max(self.starting_pull(b.layer));
        let slow = -PARTS * self.impact;
        let mass = a.mass * b.mass / (a.mass + b.mass);
        mass * closing + self.area(index, [a, b]) * dt * stress > 0.0
            || (contact_impulse > least
                && contact_impulse + dt * stress > 0.0
                && (contact_impulse > start || closing > slow))
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

    /// Updates the contact impulse of the own particles: the time integral of the mean p + q over a
    /// step of `dt`, limited to the range from 0 to the greatest adhesion impulse.
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
            impulse[r] = (impulse[r] + dt * stress).clamp(0.0, most);
        }
        patch.block.columns[contact_impulse] = impulse;
    }

    /// Edge of the body in `layer` along `normal`, among the particles that touch a node.
    fn edge(
        &self,
        patch: &Patch<D>,
        index: [i64; D],
        touches: &[Touch],
        layer: usize,
        normal: &[f64; D],
    ) -> Option<BodyEdge> {
        let c = &self.columns;
        let column = |k: usize| &patch.block.columns[k];
        let filled = column(c.current_volume.expect("contact has the column"));
        let contact_impulse = column(c.contact_impulse.expect("contact has the column"));
        let mut edge: Option<BodyEdge> = None;
        let particles = touches.iter().map(|t| t.particle as usize);
        for r in particles.filter(|&r| self.layer_of(patch, r) == layer) {
            let along = |v: [f64; D]| (0..D).map(|a| v[a] * self.cell[a] * normal[a]).sum::<f64>();
            let centre = along(self.place(patch, r, index));
            let half = match c.half_edges {
                None => along([0.5 * filled[r]; D]).abs(),
                Some(first) => {
                    let edge = |k: usize| {
                        along(decomp::array::from_fn(|a| column(first + 2 * k + a)[r])).abs()
                    };
                    edge(0) + edge(1)
                }
            };
            let reach = centre + half;
            if edge.is_none_or(|e| reach > e.reach) {
                let around = if self.axisymmetric { self.radius(patch, r).abs() } else { 1.0 };
                let volume = filled[r] * self.cell.iter().product::<f64>() * around;
                let stress = self.pressing(patch, r, normal) / volume;
                edge = Some(BodyEdge { reach, stress, contact_impulse: contact_impulse[r] });
            }
        }
        edge
    }
}
