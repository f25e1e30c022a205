//! What a run counts: work done and left out, particles moved and departed, and the census that
//! shows that none is lost or doubled.

use decomp::{Census, ExactSum};

use super::{RunError, Simulation};
use crate::scene::CheckedScene;
use crate::scene::moving_frame::Frame;
use crate::solver::clock::Event;
use crate::solver::patch::{Given, Patch};

/// Steps between two counts of all particles: so rare that they cost nothing that shows.
pub(super) const CENSUS_EVERY: u64 = 100;

/// What a rank has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Particles times steps that this rank has computed.
    pub particle_steps: u64,
    /// Particles times steps that this rank's sleeping patches left out.
    pub skipped_particle_steps: u64,
    /// Sum over steps of what the busiest rank computed, alike on all ranks.
    pub busiest_particle_steps: u64,
    /// Times that patches moved, alike on all ranks.
    pub balances: u64,
    /// Patches that this rank gave away.
    pub patches_moved: u64,
    /// Times that a step was redone half as long, alike on all ranks.
    pub redone_steps: u64,
    /// Particles that passed from a patch of this rank to another patch.
    pub migrated: u64,
}

/// What has left, in the frame of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Left<const D: usize> {
    /// Number of particles.
    pub count: u64,
    /// Mass [kg].
    pub mass: f64,
    /// Momentum [kg m/s].
    pub momentum: [f64; D],
    /// Kinetic energy [J].
    pub kinetic: f64,
    /// Internal energy [J].
    pub internal: f64,
}

impl<const D: usize> Left<D> {
    /// Nothing.
    pub const NONE: Self =
        Left { count: 0, mass: 0.0, momentum: [0.0; D], kinetic: 0.0, internal: 0.0 };

    /// With what has left in another way.
    pub fn and(&self, other: &Self) -> Self {
        Left {
            count: self.count + other.count,
            mass: self.mass + other.mass,
            momentum: std::array::from_fn(|a| self.momentum[a] + other.momentum[a]),
            kinetic: self.kinetic + other.kinetic,
            internal: self.internal + other.internal,
        }
    }
}

/// What has left, by the way that it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ways<const D: usize> {
    /// By outflows.
    pub outflow: Left<D>,
    /// By erosion.
    pub erosion: Left<D>,
}

/// What has left this rank's patches: sums that do not depend on who counted.
#[derive(Clone, Debug)]
pub(super) struct Outflow<const D: usize> {
    pub(super) census: Census,
    /// Mass, kinetic and internal energy, momentum of what has left by outflows, and where
    /// particles may be eroded the same of those, and their number.
    pub(super) sums: Vec<ExactSum>,
}

impl<const D: usize> Outflow<D> {
    /// Nothing so far. The sums' resolution is chosen by the scene: 2^-80 of a particle at some
    /// times the fastest speed of the start, with room for 2^46 of that.
    pub fn new(scene: &CheckedScene) -> Self {
        let mass = largest_mass(scene);
        let speed = scene.bodies.iter().fold(1e3, |s: f64, c| s.max(c.top_speed)) * 1e3;
        let energy = mass * speed * speed;
        let largest = || [mass, energy, energy].into_iter().chain([mass * speed; D]);
        let eroded = scene.erodes().then(|| largest().chain([1.0]));
        let all = largest().chain(eroded.into_iter().flatten());
        Outflow { census: Census::default(), sums: all.map(ExactSum::new).collect() }
    }

    /// Books what has left in a step, which `grid` says how the grid moves at the end of.
    pub fn take(&mut self, patches: &mut [Patch<D>], grid: [f64; D]) {
        for gone in patches.iter_mut().flat_map(|p| p.departed.drain(..)) {
            let m = gone.mass;
            let v: [f64; D] = std::array::from_fn(|a| gone.velocity[a] + grid[a]);
            self.census.add(gone.id, m);
            let kinetic = 0.5 * m * v.iter().map(|v| v * v).sum::<f64>();
            let terms = [m, kinetic, m * gone.energy].into_iter().chain(v.map(|v| m * v));
            let first = if gone.eroded { left_sums(D) } else { 0 };
            let book = self.sums[first..].iter_mut();
            match gone.eroded {
                true => book.zip(terms.chain([1.0])).for_each(|(sum, term)| sum.add(term)),
                false => book.zip(terms).for_each(|(sum, term)| sum.add(term)),
            }
        }
    }
}

/// Number of sums of what has left in one way, in so many dimensions.
pub(super) fn left_sums(dimension: usize) -> usize {
    3 + dimension
}

/// About the mass of the heaviest particle [kg].
fn largest_mass(scene: &CheckedScene) -> f64 {
    let bodies = scene.scene.bodies.iter().zip(&scene.bodies);
    bodies
        .map(|(b, c)| {
            let size = c.upper.iter().zip(&c.lower).map(|(u, l)| u - l);
            let density = scene.scene.materials[&b.material].density;
            density * size.product::<f64>() / c.particles as f64
        })
        .fold(0.0, f64::max)
}

/// What sides have given the nodes of this rank's patches: sums that do not depend on who
/// counted.
#[derive(Clone, Debug)]
pub(super) struct SideBooks<const D: usize> {
    /// Work, impulse.
    pub(super) sums: Vec<ExactSum>,
}

impl<const D: usize> SideBooks<D> {
    /// Nothing so far. The sums' resolution is 2^-80 of what a particle has at the `fastest` speed
    /// of the start, of bodies or sound [m/s], with room for 2^46 of that.
    pub fn new(scene: &CheckedScene, fastest: f64) -> Self {
        let momentum = largest_mass(scene) * fastest;
        let largest = std::iter::once(momentum * fastest).chain([momentum; D]);
        SideBooks { sums: largest.map(ExactSum::new).collect() }
    }

    /// Books what stays with those who leave a grid that accelerates, at the end of a step at
    /// `time`: see [`Frame::energy_ahead`].
    pub fn take_leave(&mut self, patches: &[Patch<D>], frame: &Frame<D>, time: f64) {
        let grid = frame.velocity(time);
        for gone in patches.iter().flat_map(|p| &p.departed) {
            let m = gone.mass;
            let momentum = std::array::from_fn(|a| m * (gone.velocity[a] + grid[a]));
            self.sums[0].add(frame.energy_ahead(time, m, &momentum));
        }
    }

    /// Books what the sides have given in a step.
    pub fn take(&mut self, patches: &mut [Patch<D>]) {
        for given in patches.iter_mut().flat_map(|p| p.given.drain(..)) {
            let terms = std::iter::once(given.work).chain(given.impulse);
            self.sums.iter_mut().zip(terms).for_each(|(sum, term)| sum.add(term));
        }
    }
}

impl<const D: usize> Simulation<'_, D> {
    /// What transmitting sides, pressures, friction on walls and the grid's own acceleration have
    /// given so far, as seen in the grid's frame. Collective.
    pub fn given(&self) -> Given<D> {
        let mut sums = self.side_books.sums.clone();
        ExactSum::over_ranks(self.comm, &mut sums);
        let impulse = std::array::from_fn(|a| sums[1 + a].value());
        Given { work: sums[0].value(), impulse }
    }

    /// Counts what the step computed and left out; returns the particles computed.
    pub(super) fn count_step(&mut self) -> u64 {
        let (mut computed, mut skipped) = (0, 0);
        for patch in &self.patches {
            let rows = patch.block.own() as u64;
            if patch.rest.asleep() { skipped += rows } else { computed += rows }
        }
        if self.step == 0 {
            return 0;
        }
        self.tally.particle_steps += computed;
        self.tally.skipped_particle_steps += skipped;
        computed
    }

    /// What this rank has counted so far.
    pub fn tally(&mut self) -> Tally {
        self.tally.migrated += self.plan.rows.take_migrated();
        self.tally
    }

    /// What patches did on the timeline, with the patch's number: those of this rank, and those
    /// that it gave away.
    pub fn take_patch_events(&mut self) -> Vec<(usize, Event)> {
        let mine = self.layout.patches_of(self.comm.rank());
        for (patch, index) in self.patches.iter_mut().zip(mine) {
            let events = patch.watch.events.drain(..);
            self.given_events.extend(events.map(|e| (index, e)));
        }
        std::mem::take(&mut self.given_events)
    }

    /// The particles of this rank.
    pub fn particles(&self) -> u64 {
        self.patches.iter().map(|p| p.block.own() as u64).sum()
    }

    /// What has left, by outflows and by erosion. Collective.
    pub fn left(&self) -> Left<D> {
        let Ways { outflow, erosion } = self.ways();
        outflow.and(&erosion)
    }

    /// What has left, by the way that it took. Collective.
    pub fn ways(&self) -> Ways<D> {
        let mut sums = self.outflow.sums.clone();
        ExactSum::over_ranks(self.comm, &mut sums);
        let count = self.outflow.census.over_ranks(self.comm).rows;
        let book = |first: usize, count: u64| {
            let value = |k: usize| sums[first + k].value();
            Left {
                count,
                mass: value(0),
                kinetic: value(1),
                internal: value(2),
                momentum: std::array::from_fn(|a| value(3 + a)),
            }
        };
        let second = left_sums(D);
        // the last of its sums is the number of those eroded
        let eroded = (sums.len() > second).then(|| sums[2 * second].value() as u64);
        Ways {
            outflow: book(0, count - eroded.unwrap_or(0)),
            erosion: eroded.map_or(Left::NONE, |eroded| book(second, eroded)),
        }
    }

    /// The particles of all ranks, those that have left among them: their ids and masses never
    /// change. Collective.
    pub(super) fn count(&self) -> Census {
        let mass = self.stepper.columns.mass;
        let mut census = self.outflow.census;
        for block in self.patches.iter().map(|p| &p.block) {
            for (id, m) in block.ids[..block.own()].iter().zip(&block.columns[mass]) {
                census.add(*id, *m);
            }
        }
        census.over_ranks(self.comm)
    }

    /// Ends the run if a particle was lost, doubled or has changed its mass. Collective.
    pub(super) fn check_census(&self) -> Result<(), RunError> {
        let now = self.count();
        if now == self.census {
            return Ok(());
        }
        let (before, now) = (self.census.rows, now.rows);
        Err(RunError::Lost { time: self.time, step: self.step, before, now })
    }
}

#[cfg(test)]
mod tests {
    use decomp::Serial;

    use super::*;
    use crate::scene;

    #[test]
    fn particles_lost_doubled_or_changed_end_the_run() {
        let text = include_bytes!("../../inputs/sod.json");
        let sets = ["domain.patches=[4]".to_string()];
        let scene = scene::parse(text, "sod.json", &sets).unwrap();
        let faults: [fn(&mut Patch<1>); 3] = [
            |patch| {
                patch.block.drop_ghosts();
                patch.block.remove(&[3]);
            },
            |patch| {
                let row: Vec<f64> = patch.block.columns.iter().map(|c| c[0]).collect();
                let (id, cell) = (patch.block.ids[0], patch.block.cells[0]);
                patch.block.drop_ghosts();
                patch.block.push(id, cell, &row);
            },
            |patch| {
                let specs = patch.block.specs();
                let mass = specs.iter().position(|s| s.name == "mass").unwrap();
                patch.block.columns[mass][0] *= 1.0 + 1e-15;
            },
        ];
        for fault in faults {
            let mut simulation = Simulation::<1>::new(&scene, &Serial, 1).unwrap();
            simulation.advance(scene.scene.time.end).unwrap();
            assert!(simulation.check_census().is_ok());
            fault(&mut simulation.patches[1]);
            let error = simulation.check_census().unwrap_err();
            assert!(matches!(error, RunError::Lost { step: 1, .. }), "{error}");
        }
    }
}
