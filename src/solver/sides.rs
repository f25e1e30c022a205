//! Sides of the domain that are more than a mirror or an opening, in the sums of each patch.
//!
//! A transmitting side stands for more of the same material, so that its traction is that of a
//! wave that leaves: with the outward normal n and the state at rest p0, u0 of the body there
//!
//! ```text
//! T = -n p0 - Z_n n.(u - u0) n - Z_s (u - u0)_s      Z_n = (rho0 c0 + rho c)/2,  Z_s = rho c_s
//! A_i = sum V G_i.n,  f_i = A_i T_i
//! ```
//!
//! A dashpot of the material's impedance (Lysmer & Kuhlemeyer 1969). Through a simple wave that
//! runs into material at rest dp = rho c du, whose integral by the trapezoidal rule has the mean
//! of the impedances at rest and now. That is exact to second order in u, as is the isentrope for a
//! shock (Courant & Friedrichs 1948). sum V G_i is the surface of what the particles fill, in the
//! quadrature of the internal force: a uniform pressure is held to rounding wherever the outermost
//! particle ends, so that nothing is felt as one leaves. The velocity is that of the middle of the
//! step, found together with the force on lumped masses, which no step is too long for. It is
//! taken to the node with each particle's gradient of it across the side, which the last two steps
//! foretell for the middle of this one: without, it is that of a place a third of a cell within,
//! where a wave that leaves has been earlier; and by the gradient of the last step alone a shock's
//! front of three cells gives back 2.0 % instead of 1.5 %.
//!
//! A wall with friction takes from each of its nodes no more momentum along it than it holds, and
//! no more than the coefficient times what the wall gives across it (Coulomb): on lumped masses, so
//! to rounding for FLIP, PIC and APIC. XPIC and FMPM take less from a body that strikes the wall than
//! lumped masses would in a step: its friction is up to 1.9 times Coulomb's in the first steps of a
//! blow, and 1.1 to 1.3 times over all of it.
//!
//! Before a wall without slip particles have images that move the opposite way in each direction
//! and are under the opposite forces; nodes on it are at rest, and those beyond move as images do.
//! Velocity is then zero all along the wall, for fields that are linear there exactly.

use decomp::{IndexBox, Parity};

use super::{MOST_NODES, Stepper, Waves, with_width};
use crate::effects::Effect;
use crate::material::constitutive::Matter;
use crate::scene::{CheckedScene, Side};
use crate::solver::clock::spend;
use crate::solver::patch::{Given, Patch, SideForce};
use crate::solver::transfer::{Row, add};

/// The state in which a body starts: that of the material beyond a transmitting side.
pub(super) struct Rest<const D: usize> {
    /// Pressure [Pa].
    pressure: f64,
    /// Velocity as seen from the grid [m/s].
    velocity: [f64; D],
    /// rho0 c0 [Pa s/m].
    impedance: f64,
    /// Speed of shear waves [m/s].
    shear_speed: f64,
}

/// Where something is as seen through the mirrors of one direction.
#[derive(Clone, Copy, PartialEq)]
enum Seen {
    Itself,
    /// Beyond an odd number of walls without slip.
    Turned,
    /// On such a wall.
    OnWall,
}

impl<const D: usize> Rest<D> {
    /// One a body.
    pub(super) fn of(scene: &CheckedScene, models: &[Matter], waves: &[Waves]) -> Vec<Self> {
        let grid = scene.grid_velocity::<D>();
        let bodies = scene.scene.bodies.iter().zip(&scene.bodies).zip(models.iter().zip(waves));
        bodies
            .map(|((body, checked), (model, waves))| Rest {
                pressure: body.pressure,
                velocity: std::array::from_fn(|a| checked.velocity[a] - grid[a]),
                impedance: scene.scene.materials[&body.material].density
                    * waves.fastest(model.sound_speed_at(body.pressure)),
                shear_speed: waves.shear,
            })
            .collect()
    }
}

impl<const D: usize> Stepper<D> {
    /// Fields that the sums of a side take.
    pub(super) fn side_sums(scene: &CheckedScene) -> usize {
        match (scene.transmits(), scene.has_frictional_wall() || scene.is_loaded()) {
            (true, _) => 1 + 3 * D,
            (false, true) => 2,
            (false, false) => 0,
        }
    }

    /// What transmitting sides look at of the own rows, at volume ratio `jacobian` (a column).
    pub(super) fn find_impedance(&self, patch: &mut Patch<D>, jacobian: usize) {
        let Some(side) = self.columns.side else { return };
        let c = &self.columns;
        let n = patch.block.own();
        let mut take = |k: usize| std::mem::take(&mut patch.block.columns[k]);
        let (mut volume, mut impedance) = (take(side.volume), take(side.impedance));
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, volume0, j) = (column(c.mass), column(c.volume0), column(jacobian));
        let (speed, body) = (column(c.sound_speed), column(c.body));
        volume.clear();
        volume.extend((0..n).map(|r| volume0[r] * j[r]));
        impedance.clear();
        impedance.extend((0..n).map(|r| {
            0.5 * (self.rest[body[r] as usize].impedance + mass[r] / volume[r] * speed[r])
        }));
        patch.block.columns[side.volume] = volume;
        patch.block.columns[side.impedance] = impedance;
        let whole = c.velocity_gradient.unwrap_or(c.gradient);
        for k in 0..D * D {
            let [last, before, to] = patch
                .block
                .columns
                .get_disjoint_mut([whole + k, side.gradient_before + k, side.gradient + k])
                .expect("columns differ");
            to.clear();
            // a step of much less than the one before only sees a little too far ahead
            to.extend((0..n).map(|r| last[r] + 0.5 * (last[r] - before[r])));
            before[..n].copy_from_slice(&last[..n]);
        }
        if self.total {
            self.pull_gradient(patch, side.gradient, jacobian);
        }
    }

    /// Adds the forces of the sides at `time` [s] to those on the nodes, for a step of `dt`.
    pub(super) fn push_at_sides(&self, patch: &mut Patch<D>, time: f64, dt: f64) {
        patch.side_forces.clear();
        for (axis, end) in (0..D).flat_map(|a| [(a, 0), (a, 1)]) {
            match &self.sides[axis][end] {
                Side::Transmitting => self.transmit(patch, axis, end, time, dt),
                Side::Friction(coefficient) => self.rub_wall(patch, axis, end, *coefficient, dt),
                Side::Pressure(load) => spend(Effect::LoadedSides, patch, |patch| {
                    self.press(patch, axis, end, load.at(time));
                }),
                _ => {}
            }
        }
    }

    /// The nodes that a patch computes whose index along `axis` is between two, a box a layer;
    /// `None` if there are none. The sums of a side are set to zero where there are some.
    pub(super) fn start_side(
        &self,
        patch: &mut Patch<D>,
        axis: usize,
        from: i64,
        to: i64,
        sums: usize,
    ) -> Option<Vec<IndexBox<D>>> {
        let boxes: Vec<IndexBox<D>> = (patch.active.iter())
            .map(|active| {
                let mut part = *active;
                part.lower[axis] = part.lower[axis].max(from);
                part.upper[axis] = part.upper[axis].min(to);
                part
            })
            .collect();
        if boxes.iter().all(IndexBox::is_empty) {
            return None;
        }
        for field in &mut patch.nodes.fields[self.fields.side..self.fields.side + sums] {
            field.fill(0.0);
        }
        Some(boxes)
    }

    /// The force of a transmitting side.
    fn transmit(&self, patch: &mut Patch<D>, axis: usize, end: usize, time: f64, dt: f64) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            axis: usize,
            end: usize,
            gained: [f64; D],
            dt: f64,
        ) {
            // once a particle has left, what is next to it ends no further in than its own length;
            // a shape function sees that from two cells away
            let depth = patch.reach_length.ceil() as i64 + 2;
            let (side, outward) = if end == 0 { (0, -1.0) } else { (s.cells[axis], 1.0) };
            let (from, to) =
                if end == 0 { (i64::MIN, depth + 1) } else { (side - depth, i64::MAX) };
            let Some(boxes) = s.start_side(patch, axis, from, to, 1 + 3 * D) else { return };
            let reach = depth + K as i64 + 1;
            let near = |cell: i64| (cell - side).abs() <= reach;
            s.sum_impedance::<K>(patch, axis, outward, gained, near);
            for (layer, part) in boxes.into_iter().enumerate().filter(|(_, p)| !p.is_empty()) {
                for index in part.iter() {
                    s.transmit_at(patch, layer, index, dt);
                }
            }
        }
        let gained = self.gained_velocity(time, dt);
        with_width!(patch.stencils.width, go(patch, self, axis, end, gained, dt));
    }

    /// Sums over the rows near a side: its surface sum V G.n, and for each direction sum m Z N,
    /// sum m N (n p0 - Z u0), and what the momentum grows by up to the nodes,
    /// sum m N du/dn (x_i - x). The grid has `gained` a velocity since the start [m/s].
    fn sum_impedance<const K: usize>(
        &self,
        patch: &mut Patch<D>,
        axis: usize,
        outward: f64,
        gained: [f64; D],
        near: impl Fn(i64) -> bool,
    ) {
        let c = &self.columns;
        let side = c.side.expect("a transmitting side has the columns");
        let first = self.fields.side;
        let mut sums: Vec<Vec<f64>> = (first..first + 1 + 3 * D)
            .map(|k| std::mem::take(&mut patch.nodes.fields[k]))
            .collect();
        let column = |k: usize| &patch.block.columns[k];
        for r in patch.runs.iter().cloned().flatten() {
            if !near(i64::from(patch.block.cells[r][axis])) {
                continue;
            }
            let row = patch.stencils.row::<K, D>(r);
            let (m, v) = (column(c.mass)[r], outward * column(side.volume)[r]);
            let rest = &self.rest[column(c.body)[r] as usize];
            row.add(&mut sums[0], row.gradient(axis), |g| g * v);
            if self.axisymmetric && axis == 0 {
                let hoop = v / self.radius(patch, r);
                row.add(&mut sums[0], row.values, |n| n * hoop);
            }
            let apart = self.offset(patch, r, row.first)[axis];
            for a in 0..D {
                let (z, pressure) = match a == axis {
                    true => (column(side.impedance)[r], outward * rest.pressure),
                    false => (m / column(side.volume)[r] * rest.shear_speed, 0.0),
                };
                let still = pressure - z * (rest.velocity[a] - gained[a]);
                row.add(&mut sums[1 + a], row.values, |n| n * m * z);
                row.add(&mut sums[1 + D + a], row.values, |n| n * m * still);
                let growth = m * column(side.gradient + D * a + axis)[r] * self.cell[axis];
                for line in 0..Row::<K, D>::LINES {
                    let terms = std::array::from_fn(|k| {
                        let nodes = if axis == 0 { k } else { line } as f64;
                        row.values[line][k] * growth * (apart + nodes)
                    });
                    let first = row.first + line * row.stride;
                    add::<K>(&mut sums[1 + 2 * D + a], first, terms);
                }
            }
        }
        for (k, sum) in sums.into_iter().enumerate() {
            patch.nodes.fields[first + k] = sum;
        }
    }

    /// The force of a transmitting side on a node.
    fn transmit_at(&self, patch: &mut Patch<D>, layer: usize, index: [i64; D], dt: f64) {
        let f = &self.fields;
        let at = layer * patch.nodes.nodes.count() + patch.nodes.nodes.flat(index);
        let value = |k: usize| patch.nodes.fields[k][at];
        let (mass, area) = (value(f.mass), value(f.side));
        // a surface that looks inward belongs to a body that has left the side
        if area <= 0.0 || mass <= self.empty_mass {
            return;
        }
        let force = std::array::from_fn(|a| {
            let sum = |k: usize| value(f.side + 1 + D * k + a);
            let (z, still, momentum) = (sum(0) / mass, sum(1) / mass, value(f.lumped + a) + sum(2));
            let pushed = value(f.acceleration + a) - area * still;
            let mean = (momentum + 0.5 * dt * pushed) / (mass + 0.5 * dt * area * z);
            -area * (still + z * mean)
        });
        self.push(patch, at, index, force, false);
    }

    /// Adds the force of a side to that on a node, and notes it.
    pub(super) fn push(
        &self,
        patch: &mut Patch<D>,
        at: usize,
        index: [i64; D],
        force: [f64; D],
        rubs: bool,
    ) {
        for (a, force) in force.iter().enumerate() {
            patch.nodes.fields[self.fields.acceleration + a][at] += force;
        }
        if force != [0.0; D] {
            let share = self.share_of(patch, index);
            patch.side_forces.push(SideForce { at, share, force, rubs });
        }
    }

    /// The friction of a wall.
    fn rub_wall(&self, patch: &mut Patch<D>, axis: usize, end: usize, coefficient: f64, dt: f64) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            axis: usize,
            end: usize,
            coefficient: f64,
            dt: f64,
        ) {
            let wall = if end == 0 { 0 } else { s.cells[axis] };
            let Some(boxes) = s.start_side(patch, axis, wall, wall + 1, 2) else { return };
            s.sum_pressing::<K>(patch, axis, wall, dt);
            for (layer, part) in boxes.into_iter().enumerate().filter(|(_, p)| !p.is_empty()) {
                for index in part.iter() {
                    let pressed = s.pressed(patch, layer, index, axis, end, dt, K);
                    s.rub_at(patch, layer, index, axis, coefficient * pressed, dt);
                }
            }
        }
        with_width!(patch.stencils.width, go(patch, self, axis, end, coefficient, dt));
    }

    /// Sums of mass and of the impulse across the wall that would be there without it, over the
    /// rows near a wall that are no images in it.
    fn sum_pressing<const K: usize>(&self, patch: &mut Patch<D>, axis: usize, wall: i64, dt: f64) {
        let c = &self.columns;
        let first = self.fields.side;
        let [mut masses, mut impulses] =
            [0, 1].map(|k| std::mem::take(&mut patch.nodes.fields[first + k]));
        let moved = self.moved();
        for r in patch.runs.iter().cloned().flatten() {
            let cell = i64::from(patch.block.cells[r][axis]);
            if !(0..self.cells[axis]).contains(&cell) || (cell - wall).abs() > K as i64 {
                continue;
            }
            let row = patch.stencils.row::<K, D>(r);
            let column = |k: usize| patch.block.columns[k][r];
            let m = column(c.mass);
            let forces = c.body_force.map(|c| c.force).into_iter().chain(c.frame_force);
            let pulled = forces.map(|k| column(k + axis)).fold(0.0, |sum, f| sum + f);
            let impulse = moved * m * column(c.velocity + axis) + dt * pulled;
            row.add(&mut masses, row.values, |n| n * m);
            row.add(&mut impulses, row.values, |n| n * impulse);
            if let Some(affine) = c.affine {
                // APIC: m N C (x_i - x_p), as in the nodal sums
                let offset = self.offset(patch, r, row.first);
                let mc: [f64; D] =
                    std::array::from_fn(|b| m * column(affine + D * axis + b) * self.cell[b]);
                for line in 0..Row::<K, D>::LINES {
                    let across =
                        if D == 1 { 0.0 } else { mc[D - 1] * (offset[D - 1] + line as f64) };
                    let terms = std::array::from_fn(|k| {
                        row.values[line][k] * (across + mc[0] * (offset[0] + k as f64))
                    });
                    add::<K>(&mut impulses, row.first + line * row.stride, terms);
                }
            }
            self.add_stress(patch, &row, r, axis, dt, &mut impulses);
        }
        patch.nodes.fields[first] = masses;
        patch.nodes.fields[first + 1] = impulses;
    }

    /// Adds `scale` times the internal force of a row along `axis` to the nodes of `field`.
    #[inline(always)]
    fn add_stress<const K: usize>(
        &self,
        patch: &Patch<D>,
        row: &Row<'_, K, D>,
        r: usize,
        axis: usize,
        scale: f64,
        field: &mut [f64],
    ) {
        let s = |k: usize| scale * patch.block.columns[self.columns.stress_volume + k][r];
        if self.tensor_stress() {
            let along = [[s(0), s(2)], [s(2), s(1)]][axis];
            for (b, s) in along.into_iter().enumerate() {
                row.add(field, row.gradient(b), |g| g * s);
            }
        } else {
            row.add(field, row.gradient(axis), |g| g * s(0));
        }
        if self.axisymmetric && axis == 0 {
            let hoop = s(if self.tensor_stress() { 3 } else { 0 }) / self.radius(patch, r);
            row.add(field, row.values, |n| n * hoop);
        }
    }

    /// The impulse in `dt` of a wall about one of its nodes on what is no image [N s], on lumped
    /// masses: each node and its image share their impulse.
    // one place for where a node is; a struct of its arguments would be used once
    #[allow(clippy::too_many_arguments)]
    fn pressed(
        &self,
        patch: &Patch<D>,
        layer: usize,
        index: [i64; D],
        axis: usize,
        end: usize,
        dt: f64,
        width: usize,
    ) -> f64 {
        let (f, nodes) = (&self.fields, &patch.nodes.nodes);
        let outward = if end == 0 { -1 } else { 1 };
        let place = |k: i64| {
            let mut at = index;
            at[axis] += k * outward;
            nodes.contains(at).then(|| layer * nodes.count() + nodes.flat(at))
        };
        let value = |k: usize, at: usize| patch.nodes.fields[k][at];
        let own = |at: usize| value(f.side + 1, at);
        let mut sum = place(0).map_or(0.0, own);
        for k in 1..=width as i64 {
            let (Some(beyond), Some(before)) = (place(k), place(-k)) else { break };
            let (m, both) = (value(f.side, beyond), value(f.mass, before));
            if both > self.empty_mass {
                let all = self.moved() * value(f.lumped + axis, before)
                    + dt * value(f.acceleration + axis, before);
                // the image's part is that of the node beyond, turned about
                let inner = all + own(beyond);
                sum += 2.0 * (m * inner + (both - m) * own(beyond)) / both;
            }
        }
        (outward as f64 * sum).max(0.0)
    }

    /// Friction on a node of a wall that takes no more than `most` of momentum [N s] from what is
    /// no image.
    fn rub_at(
        &self,
        patch: &mut Patch<D>,
        layer: usize,
        index: [i64; D],
        axis: usize,
        most: f64,
        dt: f64,
    ) {
        let f = &self.fields;
        let at = layer * patch.nodes.nodes.count() + patch.nodes.nodes.flat(index);
        if patch.nodes.fields[f.mass][at] <= self.empty_mass {
            return;
        }
        let force = std::array::from_fn(|a| {
            let value = |k: usize| patch.nodes.fields[k + a][at];
            // the sums hold each row twice, as itself and as its image
            let held = value(f.lumped) + dt * value(f.acceleration);
            if a == axis { 0.0 } else { -held.clamp(-2.0 * most, 2.0 * most) / dt }
        });
        self.push(patch, at, index, force, true);
    }

    /// What the sides have given the own nodes in a step of `dt`, to the books.
    pub(super) fn book_sides(&self, patch: &mut Patch<D>, dt: f64) {
        let f = &self.fields;
        let fields = &patch.nodes.fields;
        let own = patch.side_forces.iter().filter(|p| p.share > 0.0);
        patch.given.extend(own.map(|pushed| {
            let scale = pushed.share * dt;
            let power = (0..D).map(|a| {
                let velocity = match self.compatible {
                    true => fields[f.work + a][pushed.at],
                    false => {
                        0.5 * (fields[f.velocity + a][pushed.at]
                            + fields[f.velocity_star + a][pushed.at])
                    }
                };
                pushed.force[a] * velocity
            });
            let work = if pushed.rubs { 0.0 } else { scale * power.sum::<f64>() };
            Given { work, impulse: pushed.force.map(|force| scale * force) }
        }));
    }

    /// How a place along `axis`, in half cells, is seen through walls without slip.
    fn seen(&self, axis: usize, place: i64) -> Seen {
        let whole = 2 * self.cells[axis];
        let holds = |wall: i64| self.sides[axis][wall.rem_euclid(2) as usize] == Side::NoSlip;
        if place % whole == 0 && holds(place / whole) {
            return Seen::OnWall;
        }
        // walls between the place and the domain: beyond each the other side follows
        let walls = match place < 0 {
            true => place.div_euclid(whole) + 1..=0,
            false => 1..=(place - 1).div_euclid(whole),
        };
        match walls.filter(|&wall| holds(wall)).count() % 2 {
            0 => Seen::Itself,
            _ => Seen::Turned,
        }
    }

    /// Whether a row is the image of one in walls without slip across `axis`.
    fn is_turned(&self, patch: &Patch<D>, row: usize, axis: usize) -> bool {
        self.seen(axis, 2 * i64::from(patch.block.cells[row][axis]) + 1) == Seen::Turned
    }

    /// Turns the motion along walls without slip of the ghosts beyond them: the mirrors of the
    /// decomposition turn that across alone. To be called once they have come.
    pub(super) fn turn_images(&self, patch: &mut Patch<D>) {
        let c = &self.columns;
        for axis in (0..D).filter(|&a| self.no_slip[a]) {
            for row in patch.block.own()..patch.block.rows() {
                if !self.is_turned(patch, row, axis) {
                    continue;
                }
                for a in (0..D).filter(|&a| a != axis) {
                    let affine = c.affine.map(|k| k + D * a..k + D * (a + 1));
                    let forces = c.body_force.map(|c| c.force).into_iter().chain(c.frame_force);
                    let vectors = std::iter::once(c.velocity + a).chain(forces.map(|k| k + a));
                    for k in vectors.chain(affine.into_iter().flatten()) {
                        patch.block.columns[k][row] *= -1.0;
                    }
                }
            }
        }
    }

    /// Turns the internal force along walls without slip of the rows beyond them, once it has been
    /// summed up.
    pub(super) fn turn_forces(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>, axis: usize) {
            for a in (0..D).filter(|&a| a != axis) {
                let field = s.fields.acceleration + a;
                let mut force = std::mem::take(&mut patch.nodes.fields[field]);
                for r in patch.runs.iter().cloned().flatten() {
                    if r >= patch.block.own() && s.is_turned(patch, r, axis) {
                        let row = patch.stencils.row::<K, D>(r);
                        s.add_stress(patch, &row, r, a, -2.0, &mut force);
                    }
                }
                patch.nodes.fields[field] = force;
            }
        }
        for axis in (0..D).filter(|&a| self.no_slip[a]) {
            with_width!(patch.stencils.width, go(patch, self, axis));
        }
    }

    /// Sets the vectors among `fields`, just made whole, to zero along walls without slip, and
    /// turns them beyond.
    pub(super) fn hold(&self, patch: &mut Patch<D>, fields: &[(usize, Parity)]) {
        for axis in (0..D).filter(|&a| self.no_slip[a]) {
            let all = patch.nodes.nodes;
            for index in all.lower[axis]..all.upper[axis] {
                let seen = self.seen(axis, 2 * index);
                if seen == Seen::Itself {
                    continue;
                }
                let mut line = all;
                (line.lower[axis], line.upper[axis]) = (index, index + 1);
                let along =
                    fields.iter().filter(|(_, p)| matches!(p, Parity::Odd(a) if *a != axis));
                for (field, _) in along {
                    let values = &mut patch.nodes.fields[*field];
                    for layer in values.chunks_mut(all.count()) {
                        for value in line.lines_in(&all).flatten() {
                            let turned = -layer[value];
                            layer[value] = if seen == Seen::OnWall { 0.0 } else { turned };
                        }
                    }
                }
            }
        }
    }
}
