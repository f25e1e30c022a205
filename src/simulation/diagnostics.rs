//! Diagnostics of the particles: sums, tables, followed particles.

use std::cell::OnceCell;

use decomp::{Shares, exact_sums};

use super::run::Simulation;
use super::state_digest::StateDigest;
use crate::simulation::{ParticleTable, TableColumn};
use crate::solver::effect::Account;

/// Sums over all particles, bitwise the same for any layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Totals<const D: usize> {
    /// Mass [kg].
    pub mass: f64,
    /// Momentum [kg m/s].
    pub momentum: [f64; D],
    /// Sum of m |v| [kg m/s].
    pub absolute_momentum: f64,
    /// Kinetic energy, with that of the spin of particles [J].
    pub kinetic: f64,
    /// Internal energy [J].
    pub internal: f64,
    /// Accumulated work of the body force [J].
    pub body_force_work: f64,
    /// Accumulated impulse of the body force [kg m/s].
    pub body_force_impulse: [f64; D],
    /// Accumulated heat from sides of prescribed temperature [J].
    pub conducted: f64,
    /// Number of failed particles.
    pub failed: u64,
    /// Number of particles with a damage between 0 and 1.
    pub damaged: u64,
    /// Elastic energy that failure has converted to heat so far [J].
    pub released: f64,
}

/// State of a followed particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed<const D: usize> {
    /// Its position [m].
    pub position: [f64; D],
    /// Its velocity [m/s].
    pub velocity: [f64; D],
    /// Its pressure [Pa].
    pub pressure: f64,
    /// Its pressure if the traction across x were zero, as on a free surface [Pa]: 0 in a fluid,
    /// the xx component of the deviator if the material has strength.
    pub free_pressure: f64,
    /// Half of its length [m]; in a plane half the edge of a square of its volume.
    pub half_length: f64,
}

/// Order of the particles of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RowOrder {
    /// By x, ties by id.
    Position,
    /// As in the share.
    Share,
}

/// Adds a column: its name, its unit, and the function of its values.
type PutColumn<'a> = dyn FnMut(&str, &str, &dyn Fn() -> Vec<f64>) + 'a;

/// Name by which the parallelograms of the particles are wanted.
pub const HALF_EDGES: &str = "half_edges";

impl<const D: usize> Simulation<'_, D> {
    /// Sums over all particles in the frame of the scene. Collective.
    pub fn totals(&self) -> Totals<D> {
        let c = &self.stepper.columns;
        let grid = self.frame.velocity(self.time);
        let [
            mass,
            absolute_momentum,
            kinetic,
            internal,
            x,
            y,
            work,
            pull_x,
            pull_y,
            conducted,
            failed,
            released,
            damaged,
        ] = exact_sums(self.comm, |add: &mut dyn FnMut(usize, &[f64])| {
            for block in self.patches.iter().map(|patch| &patch.block) {
                for from in (0..block.own()).step_by(PARTICLES_AT_ONCE) {
                    let particles = from..block.own().min(from + PARTICLES_AT_ONCE);
                    let n = particles.len();
                    let column = |k: usize| &block.columns[k][particles.clone()][..n];
                    let (m, e) = (column(c.mass), column(c.energy));
                    let v: [&[f64]; D] = std::array::from_fn(|a| column(c.velocity + a));
                    let v = |a: usize, r: usize| v[a][r] + grid[a];
                    let squared = |r: usize| (0..D).map(|a| v(a, r) * v(a, r)).sum::<f64>();
                    let speed = |r| if D == 1 { v(0, r).abs() } else { squared(r).sqrt() };
                    let mut terms = Terms { add, n };
                    terms.each(0, |r| m[r]);
                    terms.each(1, |r| m[r] * speed(r));
                    terms.each(2, |r| 0.5 * m[r] * squared(r));
                    if c.spin.is_some() {
                        let from = particles.start;
                        let of = |r| self.stepper.spin_energy(&block.columns, from + r);
                        terms.each(2, |r| m[r] * of(r));
                    }
                    terms.each(3, |r| m[r] * e[r]);
                    for a in 0..D {
                        terms.each(4 + a, |r| m[r] * v(a, r));
                    }
                    for effect in self.stepper.effects.iter() {
                        effect.totals(block, particles.clone(), grid, &mut |account, terms| {
                            add(number_of(account), terms);
                        });
                    }
                }
            }
        });
        let momentum = std::array::from_fn(|a| [x, y][a]);
        Totals {
            mass,
            momentum,
            absolute_momentum,
            kinetic,
            internal,
            body_force_work: work,
            body_force_impulse: std::array::from_fn(|a| [pull_x, pull_y][a]),
            conducted,
            failed: failed as u64,
            damaged: damaged as u64,
            released,
        }
    }

    /// Contact force between bodies in the last step [N], in 1-D per unit area and in a plane per
    /// unit depth: sums over all contact nodes of the normal and of the tangential force. Zero
    /// without contact. Collective.
    pub fn contact_force(&self) -> [f64; 2] {
        exact_sums(self.comm, |add: &mut dyn FnMut(usize, &[f64])| {
            let forces = self.patches.iter().flat_map(|p| &p.contact.forces);
            for forces in forces.chain(&self.given_contact) {
                forces.iter().enumerate().for_each(|(k, &force)| add(k, &[force]));
            }
        })
    }

    /// All particles, sorted by x, and the [digest](Simulation::digest) of the state, at rank 0;
    /// `None` on other ranks. Collective.
    pub fn gather(&self) -> Option<(ParticleTable, String)> {
        let digest = self.digest();
        let table = self.table(&self.shares(1), RowOrder::Position, &|_| true);
        (self.comm.rank() == 0).then_some((table, digest))
    }

    /// The columns that `wanted` names of all particles, sorted by x, at rank 0; `None` on other
    /// ranks. Collective.
    pub fn gather_columns(&self, wanted: &dyn Fn(&str) -> bool) -> Option<ParticleTable> {
        let table = self.table(&self.shares(1), RowOrder::Position, wanted);
        (self.comm.rank() == 0).then_some(table)
    }

    /// This rank's share of all particles, by id: the shares of the ranks, one after the other, are
    /// all particles in order of id. It has the columns that `wanted` names. Collective.
    pub fn share(&self, wanted: &dyn Fn(&str) -> bool) -> ParticleTable {
        self.table(&self.shares(self.comm.size()), RowOrder::Share, wanted)
    }

    fn shares(&self, ranks: usize) -> Shares<'_, D> {
        let blocks = self.patches.iter().map(|p| &p.block);
        Shares::by_id(self.comm, blocks, self.scene.particles, ranks)
    }

    /// Digest of every bit of the whole state of all particles, in hexadecimal. Collective.
    pub fn digest(&self) -> String {
        let c = &self.stepper.columns;
        let mut digest = StateDigest::default();
        for block in self.patches.iter().map(|p| &p.block) {
            let columns = c.state().into_iter().map(|k| &block.columns[k][..block.own()]).collect();
            digest.add(&block.ids[..block.own()], &self.by_name(columns));
        }
        digest.over_ranks(self.comm).to_hexadecimal()
    }

    /// The columns of the state sorted by name, so that the digest does not depend on the order of
    /// declaration.
    pub(super) fn by_name<'b>(&self, columns: Vec<&'b [f64]>) -> Vec<&'b [f64]> {
        let c = &self.stepper.columns;
        let names = c.state().into_iter().map(|k| c.specs[k].name);
        let mut named: Vec<(&str, &[f64])> = names.zip(columns).collect();
        named.sort_by_key(|(name, _)| *name);
        named.into_iter().map(|(_, column)| column).collect()
    }

    /// The table of this rank's share of the particles, with the columns that `wanted` names, the
    /// coordinates always. Collective.
    pub(super) fn table(
        &self,
        shares: &Shares<'_, D>,
        rows: RowOrder,
        wanted: &dyn Fn(&str) -> bool,
    ) -> ParticleTable {
        let c = &self.stepper.columns;
        let fetched: Vec<OnceCell<Vec<f64>>> = c.specs.iter().map(|_| OnceCell::new()).collect();
        // all ranks ask for the same columns in the same order
        let column = |k: usize| fetched[k].get_or_init(|| shares.column(k));
        let ids = &shares.ids;
        let (grid, travel) = (self.frame.velocity(self.time), self.frame.travel(self.time));
        let moved = |a: usize| -> Vec<f64> {
            column(c.position + a).iter().map(|x| x + travel[a]).collect()
        };
        let place: [Vec<f64>; D] = std::array::from_fn(moved);
        let mut order: Vec<usize> = (0..ids.len()).collect();
        if rows == RowOrder::Position {
            // particles are in order of id
            let mut places: Vec<(f64, usize)> = place[0].iter().copied().zip(0..).collect();
            places.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            order = places.into_iter().map(|(_, particle)| particle).collect();
        }
        let taken = |values: &[f64]| pick(&order, |r| values[r]);
        let mut columns: Vec<TableColumn> = Vec::new();
        let mut put = |name: &str, unit: &str, values: &dyn Fn() -> Vec<f64>| {
            if wanted(name) {
                columns.push(TableColumn {
                    name: name.into(),
                    unit: unit.into(),
                    values: values(),
                });
            }
        };
        for (name, x) in ["x", "y"].into_iter().zip(&place) {
            put(name, "m", &|| taken(x));
        }
        put("pressure", "Pa", &|| taken(column(c.pressure)));
        let names = if D == 1 { ["velocity", ""] } else { ["velocity_x", "velocity_y"] };
        for (a, name) in names.into_iter().enumerate().take(D) {
            put(name, "m/s", &|| {
                let v = column(c.velocity + a);
                pick(&order, |r| v[r] + grid[a])
            });
        }
        put("density", "kg/m3", &|| {
            let (m, v0, j) = (column(c.mass), column(c.volume0), column(c.jacobian));
            pick(&order, |r| m[r] / (v0[r] * j[r]))
        });
        put("specific_internal_energy", "J/kg", &|| taken(column(c.energy)));
        put("artificial_viscosity", "Pa", &|| match c.viscosity {
            Some(q) => taken(column(q)),
            None => vec![0.0; ids.len()],
        });
        if let Some(reference) = c.initial_position.filter(|_| c.shows_initial_position) {
            for (a, name) in ["reference_x", "reference_y"].into_iter().enumerate() {
                put(name, "m", &|| taken(column(reference + a)));
            }
        }
        if let Some(stress) = c.stress {
            let names = ["stress_xx", "stress_yy", "stress_xy"];
            let count = if D == 1 { 1 } else { 3 };
            for (k, name) in names.into_iter().enumerate().take(count) {
                put(name, "Pa", &|| taken(column(stress + k)));
            }
            // out of plane the component follows from the zero trace; on a line each takes half
            put("stress_zz", "Pa", &|| {
                let (p, xx) = (column(c.pressure), column(stress));
                let yy = (D > 1).then(|| column(stress + 1));
                pick(&order, |r| {
                    let rest = -3.0 * p[r] - xx[r];
                    yy.map_or(0.5 * rest, |yy| rest - yy[r])
                })
            });
        }
        for output in &c.outputs {
            put(output.name, output.unit, &|| taken(column(c.get(output.column))));
        }
        if D > 1 {
            put("volume", "m3", &|| {
                let (v0, j) = (column(c.volume0), column(c.jacobian));
                pick(&order, |r| v0[r] * j[r])
            });
        }
        if rows == RowOrder::Share {
            put("mass", "kg", &|| taken(column(c.mass)));
            if c.tension_free.iter().any(Option::is_some) {
                let failed = |r: usize| match c.tension_free[column(c.body)[r] as usize] {
                    Some(k) if column(k)[r] >= 1.0 => 1.0,
                    _ => 0.0,
                };
                put("failed", "-", &|| pick(&order, failed));
            }
            self.put_strain(&order, &column, &mut put);
        }
        let bodies = column(c.body);
        let body: Vec<u32> = order.iter().map(|&r| bodies[r] as u32).collect();
        ParticleTable {
            time: self.time,
            dimension: D,
            ids: order.iter().map(|&r| ids[r]).collect(),
            material: body.iter().map(|&b| self.scene.bodies[b as usize].material as u32).collect(),
            materials: self.scene.scene.materials.keys().cloned().collect(),
            body,
            columns,
            half_edges: if wanted(HALF_EDGES) {
                self.half_edges(&order, &column)
            } else {
                Vec::new()
            },
        }
    }

    /// Adds the components of the Green-Lagrange strain E = (F^T F - 1)/2 [-], if the particles carry
    /// a deformation gradient F; on a line F is the volume ratio. The component zz of an axisymmetric
    /// domain is that of the hoops, F_zz = J / det F; in a plane it is 0.
    fn put_strain<'b>(
        &self,
        order: &[usize],
        column: &impl Fn(usize) -> &'b Vec<f64>,
        put: &mut PutColumn<'_>,
    ) {
        let c = &self.stepper.columns;
        if D == 1 {
            put("strain_xx", "-", &|| {
                let j = column(c.jacobian);
                pick(order, |r| 0.5 * (j[r] * j[r] - 1.0))
            });
            return;
        }
        let Some(first) = c.deformation else { return };
        let component = |a: usize, b: usize| {
            // xx, xy, yx, yy: column a of F is F_xa, F_ya
            let of = |a: usize| [column(first + a), column(first + 2 + a)];
            let ([xa, ya], [xb, yb]) = (of(a), of(b));
            let unit = if a == b { 1.0 } else { 0.0 };
            pick(order, |r| 0.5 * (xa[r] * xb[r] + ya[r] * yb[r] - unit))
        };
        put("strain_xx", "-", &|| component(0, 0));
        put("strain_yy", "-", &|| component(1, 1));
        put("strain_xy", "-", &|| component(0, 1));
        if self.scene.axisymmetric() {
            put("strain_zz", "-", &|| {
                let f: [&Vec<f64>; 4] = std::array::from_fn(|k| column(first + k));
                let j = column(c.jacobian);
                let hoop = |r: usize| j[r] / (f[0][r] * f[3][r] - f[1][r] * f[2][r]);
                pick(order, |r| 0.5 * (hoop(r) * hoop(r) - 1.0))
            });
        }
    }

    /// In a plane the half edges of the particles' parallelograms [m]; a particle without one gets
    /// a square of its volume.
    fn half_edges<'b>(
        &self,
        order: &[usize],
        column: &impl Fn(usize) -> &'b Vec<f64>,
    ) -> Vec<[[f64; 2]; 2]> {
        let c = &self.stepper.columns;
        if D == 1 {
            return Vec::new();
        }
        if let (Some(half), Some(f)) = (c.half_lengths, c.deformation) {
            let half = [column(half), column(half + 1)];
            let f: [&Vec<f64>; 4] = std::array::from_fn(|k| column(f + k));
            let edge = |a: usize, r: usize| [f[a][r] * half[a][r], f[a + 2][r] * half[a][r]];
            return order.iter().map(|&r| [edge(0, r), edge(1, r)]).collect();
        }
        let (v0, j) = (column(c.volume0), column(c.jacobian));
        let about = self.scene.axisymmetric().then(|| column(c.position));
        let edges = |r: usize| {
            let area = v0[r] * j[r] / about.map_or(1.0, |radius| radius[r]);
            let half = 0.5 * area.max(0.0).sqrt();
            [[half, 0.0], [0.0, half]]
        };
        order.iter().map(|&r| edges(r)).collect()
    }

    /// Particles with the ids in `wanted` (in order) at rank 0; `None` for a removed particle.
    /// Empty on other ranks. Collective.
    pub fn follow(&self, wanted: &[u64]) -> Vec<Option<Followed<D>>> {
        let c = &self.stepper.columns;
        let (grid, travel) = (self.frame.velocity(self.time), self.frame.travel(self.time));
        let mut words = Vec::new();
        // most ids differ from all wanted ids in their last bits
        let bit = |id: u64| 1u64 << (id % 64);
        let some = wanted.iter().fold(0, |bits, &id| bits | bit(id));
        for patch in &self.patches {
            let column = |k: usize, r: usize| patch.block.columns[k][r];
            for (particle, &id) in patch.block.ids[..patch.block.own()].iter().enumerate() {
                if some & bit(id) == 0 || !wanted.contains(&id) {
                    continue;
                }
                let volume = column(c.volume0, particle) * column(c.jacobian, particle);
                let half = 0.5 * if D == 1 { volume } else { volume.sqrt() };
                words.push(id);
                for a in 0..D {
                    let x = column(c.position + a, particle) + travel[a];
                    let v = column(c.velocity + a, particle) + grid[a];
                    words.extend([x, v].map(f64::to_bits));
                }
                let p = column(c.pressure, particle);
                let free = c.stress.map_or(0.0, |stress| p + column(stress, particle));
                words.extend([p, free, half].map(f64::to_bits));
            }
        }
        let all = self.comm.gather(&words);
        if self.comm.rank() != 0 {
            return Vec::new();
        }
        let particles: Vec<&[u64]> = all.iter().flat_map(|w| w.chunks(4 + 2 * D)).collect();
        let value = |w: &[u64], k: usize| f64::from_bits(w[k]);
        wanted
            .iter()
            .map(|id| {
                particles.iter().find(|w| w[0] == *id).map(|w| Followed {
                    position: std::array::from_fn(|a| value(w, 1 + 2 * a)),
                    velocity: std::array::from_fn(|a| value(w, 2 + 2 * a)),
                    pressure: value(w, 1 + 2 * D),
                    free_pressure: value(w, 2 + 2 * D),
                    half_length: value(w, 3 + 2 * D),
                })
            })
            .collect()
    }

    /// The columns that `wanted` names of every `stride`th particle by id, sorted by x, ties by id, at
    /// rank 0; columns without values on other ranks. Collective.
    pub fn sample(&self, stride: u64, wanted: &dyn Fn(&str) -> bool) -> Vec<TableColumn> {
        let own = self.patches.iter().map(|patch| &patch.block);
        let sampled = |id: u64| id.is_multiple_of(stride).then_some(id);
        let shares = Shares::of_own(self.comm, own, |block, r| sampled(block.ids[r]));
        let ParticleTable { ids, mut columns, .. } = self.table(&shares, RowOrder::Share, wanted);
        let values = columns.iter().map(|c| &c.values);
        let mut words = ids.clone();
        words.extend(values.flatten().map(|value| value.to_bits()));
        let all = self.comm.gather(&words);
        let column = |k: usize| -> Vec<u64> {
            let of_rank = all.iter().flat_map(|words| {
                let count = words.len() / (1 + columns.len());
                &words[k * count..(k + 1) * count]
            });
            of_rank.copied().collect()
        };
        let ids = column(0);
        let values: Vec<Vec<f64>> = (0..columns.len())
            .map(|k| column(1 + k).into_iter().map(f64::from_bits).collect())
            .collect();
        let mut order: Vec<usize> = (0..ids.len()).collect();
        let x = &values[0];
        order.sort_unstable_by(|&a, &b| x[a].total_cmp(&x[b]).then(ids[a].cmp(&ids[b])));
        for (column, values) in columns.iter_mut().zip(&values) {
            column.values = pick(&order, |r| values[r]);
        }
        columns
    }
}

/// Index of an account among the sums over all particles.
fn number_of(account: Account) -> usize {
    match account {
        Account::ExternalWork => 6,
        Account::ExternalImpulse(direction) => 7 + direction,
        Account::ExternalHeat => 9,
        Account::FailedParticles => 10,
        Account::ReleasedEnergy => 11,
        Account::DamagedParticles => 12,
    }
}

/// Number of particles whose terms of a sum are computed at a time.
const PARTICLES_AT_ONCE: usize = 128;

/// Adds the terms of some particles to their sums.
struct Terms<'a> {
    add: &'a mut dyn FnMut(usize, &[f64]),
    /// Number of particles.
    n: usize,
}

impl Terms<'_> {
    /// Adds the term `of` each particle to sum number `sum`.
    #[inline(always)]
    fn each(&mut self, sum: usize, of: impl Fn(usize) -> f64) {
        let mut terms = [0.0; PARTICLES_AT_ONCE];
        for r in 0..self.n {
            terms[r] = of(r);
        }
        (self.add)(sum, &terms[..self.n]);
    }
}

/// Values `of` each particle, in the order of a table.
fn pick(order: &[usize], of: impl Fn(usize) -> f64) -> Vec<f64> {
    order.iter().map(|&r| of(r)).collect()
}
