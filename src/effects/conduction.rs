//! Heat conduction by nodal temperatures, explicit in time.
//!
//! ```text
//! C_i = sum m cv N,  T_i = sum m cv N T/C_i
//! Q_i = -sum V k grad T . G_i        grad T = sum T_i G_i at each particle
//! e += dt cv sum N Q_i/C_i + r cv (N P - T)
//! ```
//!
//! Heat that one node loses another node gains, so that energy is conserved to rounding. The part
//! of the particle temperatures that the grid cannot represent would persist for ever; each step
//! removes the share r of it. P = sum_(l<4) K^l T_i is the projection of the particle temperatures
//! through the full matrix of capacities, as in [`relaxation`](crate::solver::relaxation) of the
//! pressure.
//!
//! Sides are insulated unless a temperature Tb is prescribed. Image particles beyond such a side
//! have the temperature 2 Tb - T, so that the side has the temperature Tb and heat flows across it;
//! the heat received is the sum over the particles. Source: Tao, Zhang, Chen & Zhang (2016), nodal
//! form of the generalized interpolation material point method for heat conduction.

use decomp::{Block, Parity};

use crate::scene::CheckedScene;
use crate::shape::with_width;
use crate::solver::Scheme;
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Account, Effect, Package, Phase, Setup, StepContext};
use crate::solver::exchange::Nodal;
use crate::solver::nodal_matrix::NodalMatrix;
use crate::solver::patch::Patch;
use crate::solver::series::ScalarSeries;

/// Number of terms in the series of the projection.
const ORDER: u32 = 4;

/// Share r of the temperature that the grid cannot represent that one step removes [-].
const UNSEEN: f64 = 0.1;

/// Builder of [`HeatConduction`] in the effect registry.
pub struct Conduction;

/// Heat conduction.
pub struct HeatConduction<const D: usize> {
    /// Conductivity [W/(m K)] and specific heat [J/(kg K)] of each body; none if it does not
    /// conduct.
    bodies: Vec<Option<[f64; 2]>>,
    /// Prescribed temperatures of the sides [K].
    held: [[Option<f64>; 2]; D],
    /// Longest stable step at a Courant number of 1 [s].
    longest_step: f64,
    /// Heat capacity m cv [J/K].
    capacity: usize,
    /// Conductivity times volume k V [W m/K].
    conductance: usize,
    /// Accumulated heat received [J], if a side has a prescribed temperature.
    received: Option<usize>,
    /// Temperature [K].
    temperature: usize,
    fields: HeatFields,
    /// Number of the matrix of heat capacities among the nodal matrices.
    matrix: usize,
}

/// Nodal fields.
#[derive(Clone, Copy)]
struct HeatFields {
    /// Inverse heat capacity 1/C_i [K/J], 0 at nodes without heat capacity.
    inverse: usize,
    /// Temperature T_i [K].
    temperature: usize,
    /// Temperature projected through the full matrix of capacities [K].
    projected: usize,
    /// Rate of the nodal temperature [K/s].
    rate: usize,
}

/// Location relative to the sides of prescribed temperature.
enum HeatedSide {
    Itself,
    /// Beyond a side of this temperature [K].
    Beyond(f64),
    /// On a side of this temperature [K].
    On(f64),
}

impl Package for Conduction {
    const NAME: &'static str = "conduction";

    fn is_active(scene: &CheckedScene) -> bool {
        scene.conducts()
    }

    fn declare(scene: &CheckedScene, d: &mut Declare<'_>) {
        d.scalar("heat_capacity", "J/K", Role::GhostScratch);
        d.scalar("heat_conductance", "W m/K", Role::GhostScratch);
        if scene.holds_temperature() {
            d.scalar("heat_received", "J", Role::State);
        }
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        let (scene, columns) = (setup.scene, setup.columns);
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
        let matrix = setup.matrices;
        setup.matrices += 1;
        let mut field = || setup.fields.add(1);
        Box::new(HeatConduction::<D> {
            bodies,
            held: scene.held_temperatures(),
            // a quarter of the hat functions' limit h^2/(2 D kappa) and half: particles are
            // smaller than cells, and compressed material conducts as much over a shorter length
            longest_step: smallest * smallest / (4.0 * D as f64 * fastest),
            capacity: columns.get("heat_capacity"),
            conductance: columns.get("heat_conductance"),
            received: columns.find("heat_received"),
            temperature: columns.temperature.expect("what conducts has a temperature"),
            fields: HeatFields {
                inverse: field(),
                temperature: field(),
                projected: field(),
                rate: field(),
            },
            matrix,
        })
    }
}

impl<const D: usize> Effect<D> for HeatConduction<D> {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::ParticleForce, Phase::NodalStart, Phase::Solve]
    }

    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        match phase {
            Phase::ParticleForce => self.find_conductance(step, patch),
            _ => self.scatter(step.scheme, patch),
        }
    }

    /// Finds the rate of the nodal temperature and transfers it to the own particles.
    fn solve(&self, step: &StepContext<'_, D>, nodal: &mut Nodal<'_, D>) {
        let f = self.fields;
        let series = ScalarSeries {
            sum: f.projected,
            first: f.temperature,
            order: ORDER,
            matrix: self.matrix,
            inverse: f.inverse,
        };
        let others = [(f.inverse, Parity::Even), (f.temperature, Parity::Even)];
        step.scheme.sum_scalar(nodal, step.effects, "heat series", &others, series, |patch| {
            self.find_rate(step.scheme, patch);
        });
        nodal.refresh(&[(f.rate, Parity::Even)]);
        nodal.each("heat", |patch| {
            self.set_sides(step.scheme, patch, f.rate, |_| 0.0);
            self.gather(step, patch);
        });
    }

    fn has_boundary(&self) -> bool {
        true
    }

    /// Sets temperatures that have just been exchanged on and beyond sides of prescribed
    /// temperature.
    fn set_boundary(&self, s: &Scheme<D>, patch: &mut Patch<D>, fields: &[(usize, Parity)]) {
        let f = self.fields;
        for (field, _) in fields.iter().filter(|(k, _)| *k == f.temperature || *k == f.projected) {
            self.set_sides(s, patch, *field, |held| held);
        }
    }

    fn totals(
        &self,
        block: &Block<D>,
        particles: std::ops::Range<usize>,
        _: [f64; D],
        add: &mut dyn FnMut(Account, &[f64]),
    ) {
        if let Some(received) = self.received {
            add(Account::ExternalHeat, &block.columns[received][particles]);
        }
    }

    fn products(&self) -> u32 {
        ORDER
    }

    fn diffusion_step(&self) -> f64 {
        self.longest_step
    }
}

impl<const D: usize> HeatConduction<D> {
    /// Heat capacity m cv and conductance k V of the own particles.
    fn find_conductance(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let c = &step.scheme.columns;
        let n = patch.block.own();
        let mut take = |k: usize| {
            let mut column = std::mem::take(&mut patch.block.columns[k]);
            column.resize(n, 0.0);
            column
        };
        let (mut capacity, mut conductance) = (take(self.capacity), take(self.conductance));
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, volume0, j) = (column(c.mass), column(c.volume0), column(step.jacobian));
        let body = column(c.body);
        for r in 0..n {
            let [k, cv] = self.bodies[body[r] as usize].unwrap_or_default();
            capacity[r] = cv * mass[r];
            conductance[r] = k * volume0[r] * j[r];
        }
        patch.block.columns[self.capacity] = capacity;
        patch.block.columns[self.conductance] = conductance;
    }

    fn seen(&self, s: &Scheme<D>, axis: usize, place: i64) -> HeatedSide {
        let whole = 2 * s.cells[axis];
        let [lower, upper] = self.held[axis];
        match (lower, upper) {
            (Some(held), _) if place == 0 => HeatedSide::On(held),
            (Some(held), _) if place < 0 => HeatedSide::Beyond(held),
            (_, Some(held)) if place == whole => HeatedSide::On(held),
            (_, Some(held)) if place > whole => HeatedSide::Beyond(held),
            _ => HeatedSide::Itself,
        }
    }

    /// Sums the nodal temperature on the nodes that the patch computes.
    fn scatter(&self, s: &Scheme<D>, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            e: &HeatConduction<D>,
        ) {
            let f = e.fields;
            let nodes = patch.nodes.layers * patch.nodes.nodes.count();
            if patch.matrices.len() <= e.matrix {
                patch.matrices.resize_with(e.matrix + 1, NodalMatrix::default);
            }
            let matrix = &mut patch.matrices[e.matrix];
            let capacity = &patch.block.columns[e.capacity][..patch.block.particles()];
            matrix.start::<K, D>(nodes, capacity.iter().copied());
            let [inverse, temperature, projected] =
                patch.nodes.fields_mut([f.inverse, f.temperature, f.projected]);
            inverse.fill(0.0);
            temperature.fill(0.0);
            let t = &patch.block.columns[e.temperature];
            for r in patch.runs.iter().cloned().flatten() {
                if capacity[r] == 0.0 {
                    continue;
                }
                let mut of = t[r];
                for axis in 0..D {
                    let place = 2 * i64::from(patch.block.cells[r][axis]) + 1;
                    if let HeatedSide::Beyond(held) = e.seen(s, axis, place) {
                        of = 2.0 * held - of;
                    }
                }
                let (weights, c) = (patch.stencils.particle::<K, D>(r), capacity[r]);
                weights.add(inverse, weights.values, |n| n * c);
                weights.add(temperature, weights.values, |n| n * (c * of));
                matrix.add(&weights, c);
            }
            matrix.finish::<D>();
            for i in patch.active_lines.iter().cloned().flatten() {
                inverse[i] = if inverse[i] > 0.0 { 1.0 / inverse[i] } else { 0.0 };
                temperature[i] *= inverse[i];
            }
            projected.copy_from_slice(temperature);
        }
        with_width!(patch.stencils.width, go(patch, s, self));
    }

    /// Sets nodal values on sides of prescribed temperature, and mirrors them beyond: `on` maps the
    /// prescribed temperature to the value on the side; beyond the side the value is twice that
    /// minus the old value.
    fn set_sides(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        field: usize,
        on: impl Fn(f64) -> f64,
    ) {
        let all = patch.nodes.nodes;
        for axis in (0..D).filter(|&a| self.held[a] != [None; 2]) {
            for index in all.lower[axis]..all.upper[axis] {
                let seen = self.seen(s, axis, 2 * index);
                if matches!(seen, HeatedSide::Itself) {
                    continue;
                }
                let mut line = all;
                (line.lower[axis], line.upper[axis]) = (index, index + 1);
                for layer in patch.nodes.fields[field].chunks_mut(all.count()) {
                    for at in line.lines_in(&all).flatten() {
                        layer[at] = match seen {
                            HeatedSide::On(held) => on(held),
                            HeatedSide::Beyond(held) => 2.0 * on(held) - layer[at],
                            HeatedSide::Itself => layer[at],
                        };
                    }
                }
            }
        }
    }

    fn find_rate(&self, s: &Scheme<D>, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            _: &Scheme<D>,
            e: &HeatConduction<D>,
        ) {
            let f = e.fields;
            let conductance = &patch.block.columns[e.conductance];
            let [inverse, temperature, rate] =
                patch.nodes.fields_mut([f.inverse, f.temperature, f.rate]);
            rate.fill(0.0);
            for r in patch.runs.iter().cloned().flatten() {
                if conductance[r] == 0.0 {
                    continue;
                }
                let weights = patch.stencils.particle::<K, D>(r);
                for a in 0..D {
                    let flux = -conductance[r] * weights.dot(weights.gradient(a), temperature);
                    weights.add(rate, weights.gradient(a), |g| g * flux);
                }
            }
            for i in patch.active_lines.iter().cloned().flatten() {
                rate[i] *= inverse[i];
            }
        }
        with_width!(patch.stencils.width, go(patch, s, self));
    }

    fn gather(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            e: &HeatConduction<D>,
            dt: f64,
        ) {
            let (c, f) = (&s.columns, e.fields);
            let n = patch.block.own();
            for r in 0..n {
                let body = patch.block.columns[c.body][r] as usize;
                let Some([_, cv]) = e.bodies[body] else { continue };
                let weights = patch.stencils.particle::<K, D>(r);
                let unseen = weights.dot(weights.values, &patch.nodes.fields[f.projected])
                    - patch.block.columns[e.temperature][r];
                let rise =
                    dt * weights.dot(weights.values, &patch.nodes.fields[f.rate]) + UNSEEN * unseen;
                patch.block.columns[c.energy][r] += cv * rise;
                let mass = patch.block.columns[c.mass][r];
                if s.thermals[body].as_ref().is_some_and(|t| t.isentrope.is_none()) {
                    patch.block.columns[e.temperature][r] += rise;
                }
                if let Some(received) = e.received {
                    patch.block.columns[received][r] += mass * cv * rise;
                }
            }
        }
        with_width!(patch.stencils.width, go(patch, step.scheme, self, step.dt));
    }
}

#[cfg(test)]
#[path = "tests/conduction.rs"]
mod tests;
