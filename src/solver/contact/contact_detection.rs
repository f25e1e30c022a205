//! Whether two bodies touch at a node: their gap, what they press with, and for how long they have
//! been pressed.

use crate::effects::contact::{Member, Touch};
use crate::solver::patch::Patch;
use crate::solver::{Stepper, norm};

/// Bodies without stress touch if their edges are nearer than this [cells].
const CLOSED: f64 = 0.01;

/// Bodies that press on each other stay in contact over a gap as wide as their compression of a
/// cell, up to this [cells]: as a wave passes, the outermost particles' lengths and places are a
/// little out of step.
const HELD: f64 = 0.1;

/// Share of rho h u, with u the speed of the scene's impacts and h a cell's edge, that bodies which
/// were pressed together may pull on each other with before they part: what runs ahead of a shock
/// swings, and an interface that opened at each swing would send some of it back. They never give
/// back more than they were pressed with, or start with, so no pull lasts.
pub(in crate::solver) const PULL: f64 = 0.02;

/// Share of that below which bodies do not hold: well above what rounding presses with.
const HOLDS: f64 = 1e-3;

/// Share of the most with which bodies start, though nothing has pressed them yet: what runs ahead
/// of the first shock may swing to the pulling side first, and at a cut of a body into two it would
/// open the cut.
const AT_START: f64 = 0.1;

/// Share of u at which bodies part that have no more than what they started with: a swing opens an
/// interface slowly, and bodies that truly recede part at once.
const PARTS: f64 = 0.05;

/// The outermost part of a body at a meeting.
#[derive(Clone, Copy)]
struct Edge {
    /// How far it reaches along the normal, seen from the node [m].
    reach: f64,
    /// p + q there [Pa].
    stress: f64,
    /// The impulse that it may give back [Pa s].
    pressed: f64,
}

impl<const D: usize> Stepper<D> {
    /// Whether two bodies touch at a node: the gap between the edges of their particles is closed,
    /// and apart from each other they would overlap by the end of a step of `dt`, with m the
    /// reduced mass, u the speed at which they approach, A the area and s the mean p + q of their
    /// edges,
    ///
    /// ```text
    /// m u + A s dt > 0,
    /// ```
    ///
    /// or they have been pressed together and hold: see [`PULL`].
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
        // near a corner the normal is between those of two faces, and along it the bodies seem to
        // overlap; a gap along any direction is one
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
        // the force on both is the same: noise has taken from one what the other still has
        let pressed = first.pressed.max(second.pressed);
        let least = HOLDS * self.most_pull[a.layer].min(self.most_pull[b.layer]);
        // rounding presses, too
        let start = 2.0 * self.starting_pull(a.layer).max(self.starting_pull(b.layer));
        let slow = -PARTS * self.impact;
        let mass = a.mass * b.mass / (a.mass + b.mass);
        mass * closing + self.area(index, [a, b]) * dt * stress > 0.0
            || (pressed > least
                && pressed + dt * stress > 0.0
                && (pressed > start || closing > slow))
    }

    /// The impulse that a body may give back before anything has pressed it [Pa s].
    pub(in crate::solver) fn starting_pull(&self, body: usize) -> f64 {
        AT_START * self.most_pull[body]
    }

    /// The node's share of the area between two bodies [m2], from the gradients of their volumes.
    fn area(&self, index: [i64; D], [a, b]: [&Member<D>; 2]) -> f64 {
        let cell: f64 = self.cell.iter().product();
        let around = match self.axisymmetric {
            true => (self.lower[0] + index[0] as f64 * self.cell[0]).abs(),
            false => 1.0,
        };
        0.5 * (norm(&a.gradient) + norm(&b.gradient)) * cell * around
    }

    /// What the own rows have been pressed with, less what they have been pulled with: the time
    /// integral of the mean p + q over a step of `dt`, between 0 and the most that an interface may
    /// give back.
    pub(in crate::solver) fn find_pressed(&self, patch: &mut Patch<D>, jacobian: usize, dt: f64) {
        let Some(pressed) = self.columns.pressed else { return };
        let c = &self.columns;
        let n = patch.block.own();
        let mut impulse = std::mem::take(&mut patch.block.columns[pressed]);
        impulse.truncate(n);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (volume0, j, body) = (column(c.volume0), column(jacobian), column(c.body));
        let xx = column(c.stress_volume);
        let yy = column(c.stress_volume + usize::from(self.tensor_stress()));
        for r in 0..n {
            let stress = 0.5 * (xx[r] + yy[r]) / (volume0[r] * j[r]);
            let most = self.most_pull[body[r] as usize];
            impulse[r] = (impulse[r] + dt * stress).clamp(0.0, most);
        }
        patch.block.columns[pressed] = impulse;
    }

    /// The edge of the body in `layer` along `normal`, among the rows that touch a node.
    fn edge(
        &self,
        patch: &Patch<D>,
        index: [i64; D],
        touches: &[Touch],
        layer: usize,
        normal: &[f64; D],
    ) -> Option<Edge> {
        let c = &self.columns;
        let column = |k: usize| &patch.block.columns[k];
        let filled = column(c.room.expect("contact has the column"));
        let pressed = column(c.pressed.expect("contact has the column"));
        let mut edge: Option<Edge> = None;
        let rows = touches.iter().map(|t| t.row as usize);
        for r in rows.filter(|&r| self.layer_of(patch, r) == layer) {
            let along = |v: [f64; D]| (0..D).map(|a| v[a] * self.cell[a] * normal[a]).sum::<f64>();
            let centre = along(self.place(patch, r, index));
            let half = match c.half_edges {
                None => along([0.5 * filled[r]; D]).abs(),
                Some(first) => {
                    let edge = |k: usize| {
                        along(std::array::from_fn(|a| column(first + 2 * k + a)[r])).abs()
                    };
                    edge(0) + edge(1)
                }
            };
            let reach = centre + half;
            if edge.is_none_or(|e| reach > e.reach) {
                let around = if self.axisymmetric { self.radius(patch, r).abs() } else { 1.0 };
                let volume = filled[r] * self.cell.iter().product::<f64>() * around;
                let stress = self.pressing(patch, r, normal) / volume;
                edge = Some(Edge { reach, stress, pressed: pressed[r] });
            }
        }
        edge
    }
}
