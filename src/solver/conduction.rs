//! Conduction of heat by nodal temperatures, explicit in time.
//!
//! ```text
//! C_i = sum m cv N,  T_i = sum m cv N T/C_i
//! Q_i = -sum V k grad T . G_i        grad T = sum T_i G_i at each row
//! e += dt cv sum N Q_i/C_i + r cv (N P - T)
//! ```
//!
//! What one node gives another gets, so that energy is kept to rounding. What the grid does not see
//! of the rows' temperatures would stay for ever: r of it goes in a step, P = sum_(l<4) K^l T_i being
//! their projection through the full matrix of capacities, as in [`relaxation`](super::relaxation)
//! of the pressure. A side is insulated. One that is held at a temperature
//! Tb has images of rows beyond it at 2 Tb - T, so that Tb stands on it and heat flows across; what
//! comes in is what the rows get in all. Source: Tao, Zhang, Chen & Zhang (2016), nodal form of the
//! generalized interpolation material point method for heat conduction.

use decomp::Parity;

use super::{MOST_NODES, Nodal, Stepper, with_width};
use crate::scene::CheckedScene;
use crate::solver::nodal_fields::ConductionFields;
use crate::solver::patch::Patch;

/// Terms of the projection's series.
pub(super) const ORDER: u32 = 4;

/// Share of what the grid does not see that a step takes away.
const UNSEEN: f64 = 0.1;

/// How a scene conducts heat.
pub(super) struct Conduction<const D: usize> {
    /// Conductivity [W/(m K)] and specific heat [J/(kg K)] of each body; none conduct nothing.
    bodies: Vec<Option<[f64; 2]>>,
    /// Temperatures that sides are held at [K].
    held: [[Option<f64>; 2]; D],
    /// The longest stable step at a Courant number of 1 [s].
    pub(super) step: f64,
}

impl<const D: usize> Conduction<D> {
    /// What `scene` calls for, if anything.
    pub(super) fn new(scene: &CheckedScene) -> Option<Self> {
        if !scene.conducts() {
            return None;
        }
        let bodies: Vec<_> = (0..scene.bodies.len())
            .map(|i| {
                let thermal = scene.material_of(i).thermal?;
                thermal.conductivity.map(|k| [k, thermal.specific_heat])
            })
            .collect();
        let fastest = (bodies.iter().enumerate())
            .filter_map(|(i, body)| body.map(|[k, cv]| k / (cv * scene.material_of(i).density)))
            .fold(0.0, f64::max);
        let smallest = scene.cell_size.iter().copied().fold(f64::INFINITY, f64::min);
        Some(Conduction {
            bodies,
            held: scene.held_temperatures(),
            // a quarter of the hat functions' limit h^2/(2 D kappa) and half: particles are
            // smaller than cells, and what is compressed conducts as much over less
            step: smallest * smallest / (4.0 * D as f64 * fastest),
        })
    }
}

/// Where something is as seen through a side that is held at a temperature.
enum Seen {
    Itself,
    /// Beyond a side at this temperature.
    Beyond(f64),
    /// On it.
    On(f64),
}

impl<const D: usize> Stepper<D> {
    /// Heat capacity and conductance of the own rows at volume ratio `jacobian` (a column).
    pub(super) fn find_conductance(&self, patch: &mut Patch<D>, jacobian: usize) {
        let c = &self.columns;
        let (Some(conduction), Some(columns)) =
            (&self.conduction, c.thermal.and_then(|t| t.conduction))
        else {
            return;
        };
        let n = patch.block.own();
        let mut take = |k: usize| {
            let mut column = std::mem::take(&mut patch.block.columns[k]);
            column.resize(n, 0.0);
            column
        };
        let (mut capacity, mut conductance) = (take(columns.capacity), take(columns.conductance));
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, volume0, j) = (column(c.mass), column(c.volume0), column(jacobian));
        let body = column(c.body);
        for r in 0..n {
            let [k, cv] = conduction.bodies[body[r] as usize].unwrap_or_default();
            capacity[r] = cv * mass[r];
            conductance[r] = k * volume0[r] * j[r];
        }
        patch.block.columns[columns.capacity] = capacity;
        patch.block.columns[columns.conductance] = conductance;
    }

    fn seen_held(&self, conduction: &Conduction<D>, axis: usize, place: i64) -> Seen {
        let whole = 2 * self.cells[axis];
        let [lower, upper] = conduction.held[axis];
        match (lower, upper) {
            (Some(held), _) if place == 0 => Seen::On(held),
            (Some(held), _) if place < 0 => Seen::Beyond(held),
            (_, Some(held)) if place == whole => Seen::On(held),
            (_, Some(held)) if place > whole => Seen::Beyond(held),
            _ => Seen::Itself,
        }
    }

    /// Nodal temperature on the nodes that the patch computes.
    pub(super) fn scatter_heat(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            conduction: &Conduction<D>,
            f: ConductionFields,
        ) {
            let thermal = s.columns.thermal.expect("conduction has the columns");
            let columns = thermal.conduction.expect("likewise");
            let (nodes, stride) =
                (patch.nodes.layers * patch.nodes.nodes.count(), patch.nodes.nodes.extent(0));
            patch.capacity_band.clear(nodes, K, D, stride);
            let [inverse, temperature, projected] =
                patch.nodes.fields_mut([f.inverse, f.temperature, f.projected]);
            inverse.fill(0.0);
            temperature.fill(0.0);
            let column = |k: usize| &patch.block.columns[k];
            let (capacity, t) = (column(columns.capacity), column(thermal.temperature));
            for r in patch.runs.iter().cloned().flatten() {
                if capacity[r] == 0.0 {
                    continue;
                }
                let mut of = t[r];
                for axis in 0..D {
                    let place = 2 * i64::from(patch.block.cells[r][axis]) + 1;
                    if let Seen::Beyond(held) = s.seen_held(conduction, axis, place) {
                        of = 2.0 * held - of;
                    }
                }
                let (row, c) = (patch.stencils.row::<K, D>(r), capacity[r]);
                row.add(inverse, row.values, |n| n * c);
                row.add(temperature, row.values, |n| n * (c * of));
                patch.capacity_band.add(&row, c);
            }
            patch.capacity_band.finish();
            for i in patch.active_lines.iter().cloned().flatten() {
                inverse[i] = if inverse[i] > 0.0 { 1.0 / inverse[i] } else { 0.0 };
                temperature[i] *= inverse[i];
            }
            projected.copy_from_slice(temperature);
        }
        let (Some(conduction), Some(f)) = (&self.conduction, self.fields.conduction) else {
            return;
        };
        with_width!(patch.stencils.width, go(patch, self, conduction, f));
    }

    /// Sets nodal values on held sides and turns them beyond: `on` gives the value on a side held
    /// at a temperature, beyond it is twice that less the value.
    fn hold_sides(
        &self,
        patch: &mut Patch<D>,
        conduction: &Conduction<D>,
        field: usize,
        on: impl Fn(f64) -> f64,
    ) {
        let all = patch.nodes.nodes;
        for axis in (0..D).filter(|&a| conduction.held[a] != [None; 2]) {
            for index in all.lower[axis]..all.upper[axis] {
                let seen = self.seen_held(conduction, axis, 2 * index);
                if matches!(seen, Seen::Itself) {
                    continue;
                }
                let mut line = all;
                (line.lower[axis], line.upper[axis]) = (index, index + 1);
                for layer in patch.nodes.fields[field].chunks_mut(all.count()) {
                    for at in line.lines_in(&all).flatten() {
                        layer[at] = match seen {
                            Seen::On(held) => on(held),
                            Seen::Beyond(held) => 2.0 * on(held) - layer[at],
                            Seen::Itself => layer[at],
                        };
                    }
                }
            }
        }
    }

    /// Rate of the nodal temperature, and what the own rows get of it in `dt`. Collective between
    /// neighbours.
    pub(super) fn conduct(&self, nodal: &mut Nodal<'_, D>, dt: f64) {
        let (Some(conduction), Some(f)) = (&self.conduction, self.fields.conduction) else {
            return;
        };
        self.project_temperature(nodal, f, |patch| self.find_heat_rate(patch, f));
        nodal.refresh(&[(f.rate, Parity::Even)]);
        nodal.each("heat", |patch| {
            self.hold_sides(patch, conduction, f.rate, |_| 0.0);
            self.gather_heat(patch, f, dt);
        });
    }

    /// Sets temperatures among `fields`, just made whole, on held sides and beyond.
    pub(super) fn hold_temperature(&self, patch: &mut Patch<D>, fields: &[(usize, Parity)]) {
        let (Some(conduction), Some(f)) = (&self.conduction, self.fields.conduction) else {
            return;
        };
        for (field, _) in fields.iter().filter(|(k, _)| *k == f.temperature || *k == f.projected) {
            self.hold_sides(patch, conduction, *field, |held| held);
        }
    }

    fn find_heat_rate(&self, patch: &mut Patch<D>, f: ConductionFields) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            f: ConductionFields,
        ) {
            let columns = s.columns.thermal.and_then(|t| t.conduction).expect("has the columns");
            let conductance = &patch.block.columns[columns.conductance];
            let [inverse, temperature, rate] =
                patch.nodes.fields_mut([f.inverse, f.temperature, f.rate]);
            rate.fill(0.0);
            for r in patch.runs.iter().cloned().flatten() {
                if conductance[r] == 0.0 {
                    continue;
                }
                let row = patch.stencils.row::<K, D>(r);
                for a in 0..D {
                    let flux = -conductance[r] * row.dot(row.gradient(a), temperature);
                    row.add(rate, row.gradient(a), |g| g * flux);
                }
            }
            for i in patch.active_lines.iter().cloned().flatten() {
                rate[i] *= inverse[i];
            }
        }
        with_width!(patch.stencils.width, go(patch, self, f));
    }

    fn gather_heat(&self, patch: &mut Patch<D>, f: ConductionFields, dt: f64) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            f: ConductionFields,
            dt: f64,
        ) {
            let c = &s.columns;
            let thermal = c.thermal.expect("conduction has the columns");
            let conduction = s.conduction.as_ref().expect("likewise");
            let n = patch.block.own();
            for r in 0..n {
                let body = patch.block.columns[c.body][r] as usize;
                let Some([_, cv]) = conduction.bodies[body] else { continue };
                let row = patch.stencils.row::<K, D>(r);
                let unseen = row.dot(row.values, &patch.nodes.fields[f.projected])
                    - patch.block.columns[thermal.temperature][r];
                let rise = dt * row.dot(row.values, &patch.nodes.fields[f.rate]) + UNSEEN * unseen;
                patch.block.columns[c.energy][r] += cv * rise;
                let mass = patch.block.columns[c.mass][r];
                if s.thermals[body].as_ref().is_some_and(|t| t.isentrope.is_none()) {
                    patch.block.columns[thermal.temperature][r] += rise;
                }
                if let Some(received) = thermal.received {
                    patch.block.columns[received][r] += mass * cv * rise;
                }
            }
        }
        with_width!(patch.stencils.width, go(patch, self, f, dt));
    }
}
