//! Diagnostics of the particles: sums, tables, followed particles.

use decomp::{exact_sums, gather_particles};
use sha2::{Digest, Sha256};

use super::run::Simulation;
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

    /// All particles, and the digest of every bit of the whole state in order of id, at rank 0;
    /// `None` on other ranks. Collective.
    pub fn gather(&self) -> Option<(ParticleTable, String)> {
        let c = &self.stepper.columns;
        let state = c.state();
        let (ids, columns) =
            gather_particles(self.comm, self.patches.iter().map(|p| &p.block), &state);
        if self.comm.rank() != 0 {
            return None;
        }
        let digest = digest(&ids, &self.by_name(&state, &columns));
        let mut places = vec![usize::MAX; self.stepper.columns.specs.len()];
        state.iter().enumerate().for_each(|(place, &k)| places[k] = place);
        Some((self.table(&ids, |k| &columns[places[k]]), digest))
    }

    /// Columns of the `state` sorted by name, so that the digest does not depend on the order of
    /// declaration.
    fn by_name<'b>(&self, state: &[usize], columns: &'b [Vec<f64>]) -> Vec<&'b [f64]> {
        let name = |k: &usize| self.stepper.columns.specs[state[*k]].name;
        let mut order: Vec<usize> = (0..state.len()).collect();
        order.sort_by_key(name);
        order.into_iter().map(|k| &columns[k][..]).collect()
    }

    fn table<'b>(&self, ids: &[u64], column: impl Fn(usize) -> &'b Vec<f64>) -> ParticleTable {
        let c = &self.stepper.columns;
        let (grid, travel) = (self.frame.velocity(self.time), self.frame.travel(self.time));
        let moved = |a: usize| -> Vec<f64> {
            column(c.position + a).iter().map(|x| x + travel[a]).collect()
        };
        let place: [Vec<f64>; D] = std::array::from_fn(moved);
        // particles are in order of id
        let mut order: Vec<(f64, usize)> = place[0].iter().copied().zip(0..).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let order: Vec<usize> = order.into_iter().map(|(_, particle)| particle).collect();
        let taken = |values: &Vec<f64>| pick(&order, |r| values[r]);
        let named = |name: &str, unit: &str, values| TableColumn {
            name: name.into(),
            unit: unit.into(),
            values,
        };
        let (m, v0, j) = (column(c.mass), column(c.volume0), column(c.jacobian));
        let q = c.viscosity.map(&column);
        let coordinates = ["x", "y"].into_iter().zip(&place);
        let mut columns: Vec<TableColumn> =
            coordinates.map(|(name, x)| named(name, "m", taken(x))).collect();
        columns.push(named("pressure", "Pa", taken(column(c.pressure))));
        let names = if D == 1 { ["velocity", ""] } else { ["velocity_x", "velocity_y"] };
        for (a, name) in names.into_iter().enumerate().take(D) {
            let v = column(c.velocity + a);
            columns.push(named(name, "m/s", pick(&order, |r| v[r] + grid[a])));
        }
        columns.extend([
            named("density", "kg/m3", pick(&order, |r| m[r] / (v0[r] * j[r]))),
            named("specific_internal_energy", "J/kg", taken(column(c.energy))),
            named("artificial_viscosity", "Pa", q.map_or_else(|| vec![0.0; ids.len()], taken)),
        ]);
        if let Some(reference) = c.initial_position.filter(|_| c.shows_initial_position) {
            for (a, name) in ["reference_x", "reference_y"].into_iter().enumerate() {
                columns.push(named(name, "m", taken(column(reference + a))));
            }
        }
        if let Some(stress) = c.stress {
            let names = ["stress_xx", "stress_yy", "stress_xy"];
            let count = if D == 1 { 1 } else { 3 };
            for (k, name) in names.into_iter().enumerate().take(count) {
                columns.push(named(name, "Pa", taken(column(stress + k))));
            }
            // out of plane the component follows from the zero trace; on a line each takes half
            let (p, xx) = (column(c.pressure), column(stress));
            let yy = (D > 1).then(|| column(stress + 1));
            let across = |r: usize| {
                let rest = -3.0 * p[r] - xx[r];
                yy.map_or(0.5 * rest, |yy| rest - yy[r])
            };
            columns.push(named("stress_zz", "Pa", pick(&order, across)));
        }
        for output in &c.outputs {
            columns.push(named(output.name, output.unit, taken(column(c.get(output.column)))));
        }
        if D > 1 {
            columns.push(named("volume", "m3", pick(&order, |r| v0[r] * j[r])));
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
            half_edges: self.half_edges(&order, &column),
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

    /// Position [m] and pressure [Pa] of every `stride`th particle by id, sorted by x, at rank 0;
    /// empty on other ranks. Collective.
    pub fn sample_pressure(&self, stride: u64) -> Vec<(f64, f64)> {
        let c = &self.stepper.columns;
        let shift = self.frame.travel(self.time)[0];
        let mut words = Vec::new();
        for patch in &self.patches {
            for particle in 0..patch.block.own() {
                if patch.block.ids[particle].is_multiple_of(stride) {
                    words.push((patch.block.columns[c.position][particle] + shift).to_bits());
                    words.push(patch.block.columns[c.pressure][particle].to_bits());
                }
            }
        }
        let all = self.comm.gather(&words);
        let mut points: Vec<(f64, f64)> = all
            .iter()
            .flat_map(|w| w.chunks(2))
            .map(|w| (f64::from_bits(w[0]), f64::from_bits(w[1])))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
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

/// SHA-256 of particles: id and columns of each, as little-endian bytes.
fn digest(ids: &[u64], columns: &[&[f64]]) -> String {
    // many particles at a time, so that the digest processes long blocks
    const PARTICLES_AT_ONCE: usize = 256;
    let width = 1 + columns.len();
    let mut words = vec![[0; 8]; PARTICLES_AT_ONCE * width];
    let mut digest = Sha256::new();
    for from in (0..ids.len()).step_by(PARTICLES_AT_ONCE) {
        let particles = from..ids.len().min(from + PARTICLES_AT_ONCE);
        let words = &mut words[..particles.len() * width];
        let places = words.iter_mut().step_by(width);
        places.zip(&ids[particles.clone()]).for_each(|(word, id)| *word = id.to_le_bytes());
        for (k, column) in columns.iter().enumerate() {
            let places = words[1 + k..].iter_mut().step_by(width);
            places.zip(&column[particles.clone()]).for_each(|(word, v)| *word = v.to_le_bytes());
        }
        digest.update(words.as_flattened());
    }
    digest.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_is_that_of_particles_one_after_the_other() {
        // more particles than one block, and not a multiple of it
        let ids: Vec<u64> = (0..700).map(|k| 3 * k).collect();
        let column = |c: usize| (0..700).map(|r| 0.1 * (c as f64 + 2.0) * f64::from(r)).collect();
        let columns: Vec<Vec<f64>> = (0..3).map(column).collect();
        let mut bytes = Vec::new();
        for (particle, id) in ids.iter().enumerate() {
            bytes.extend(id.to_le_bytes());
            columns.iter().for_each(|c| bytes.extend(c[particle].to_le_bytes()));
        }
        let whole = Sha256::digest(&bytes);
        assert_eq!(
            digest(&ids, &columns.iter().map(|c| &c[..]).collect::<Vec<_>>()),
            whole.iter().map(|b| format!("{b:02x}")).collect::<String>()
        );
    }
}
