//! Quantities that a rank accumulates over the run: counts, removed particles, work of the sides.

use decomp::{Census, ExactSum};

use crate::scene::CheckedScene;
use crate::scene::moving_frame::Frame;
use crate::solver::patch::Patch;

/// Steps between two counts of all particles: rare enough to have no measurable cost.
pub(super) const CENSUS_EVERY: u64 = 100;

/// Counters of a rank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Particle steps (particles times steps) that this rank has computed.
    pub particle_steps: u64,
    /// Particle steps that the quiescent patches of this rank have skipped.
    pub skipped_particle_steps: u64,
    /// Sum over steps of the particles computed by the busiest rank; the same on all ranks.
    pub busiest_particle_steps: u64,
    /// Number of times that patches moved between ranks; the same on all ranks.
    pub balances: u64,
    /// Patches that this rank has handed to other ranks.
    pub patches_moved: u64,
    /// Steps repeated with half the length; the same on all ranks.
    pub redone_steps: u64,
    /// Particles that moved from a patch of this rank to another patch.
    pub migrated: u64,
}

/// Sums over particles removed from the run, in the frame of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Removed<const D: usize> {
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

impl<const D: usize> Removed<D> {
    /// No particles.
    pub const NONE: Self =
        Removed { count: 0, mass: 0.0, momentum: [0.0; D], kinetic: 0.0, internal: 0.0 };

    /// Sum of both.
    pub fn and(&self, other: &Self) -> Self {
        Removed {
            count: self.count + other.count,
            mass: self.mass + other.mass,
            momentum: std::array::from_fn(|a| self.momentum[a] + other.momentum[a]),
            kinetic: self.kinetic + other.kinetic,
            internal: self.internal + other.internal,
        }
    }
}

/// Removed particles by kind of removal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemovedByKind<const D: usize> {
    /// Removed at outflow sides.
    pub outflow: Removed<D>,
    /// Removed by erosion.
    pub erosion: Removed<D>,
}

/// Sums over the particles removed from patches of this rank; they do not depend on which rank
/// sums.
#[derive(Clone, Debug)]
pub(super) struct RemovedSums<const D: usize> {
    pub(super) census: Census,
    /// Mass, kinetic energy, internal energy and momentum removed at outflow sides; if particles
    /// may erode, the same sums of eroded particles, and their number.
    pub(super) sums: Vec<ExactSum>,
}

impl<const D: usize> RemovedSums<D> {
    /// Empty sums. Their resolution follows from the scene: 2^-80 of a particle at a few times the
    /// fastest initial speed, with room for 2^46 such particles.
    pub fn new(scene: &CheckedScene) -> Self {
        let mass = largest_mass(scene);
        let speed = scene.bodies.iter().fold(1e3, |s: f64, c| s.max(c.top_speed)) * 1e3;
        let energy = mass * speed * speed;
        let largest = || [mass, energy, energy].into_iter().chain([mass * speed; D]);
        let eroded = scene.erodes().then(|| largest().chain([1.0]));
        let all = largest().chain(eroded.into_iter().flatten());
        RemovedSums { census: Census::default(), sums: all.map(ExactSum::new).collect() }
    }

    /// Adds the particles removed in a step; `grid` is the velocity of the grid at the end of the
    /// step [m/s].
    pub fn take(&mut self, patches: &mut [Patch<D>], grid: [f64; D]) {
        for gone in patches.iter_mut().flat_map(|p| p.removed.drain(..)) {
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

/// Number of sums over removed particles of one kind, by dimension.
pub(super) fn left_sums(dimension: usize) -> usize {
    3 + dimension
}

/// Approximate mass of the heaviest particle [kg].
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

/// Sums of the work and impulse of sides on the nodes of this rank's patches; they do not depend on
/// which rank sums.
#[derive(Clone, Debug)]
pub(super) struct SideBooks<const D: usize> {
    /// Work [J], then impulse [N s].
    pub(super) sums: Vec<ExactSum>,
}

impl<const D: usize> SideBooks<D> {
    /// Empty sums. Their resolution is 2^-80 of the values of a particle at the `fastest` initial
    /// speed of bodies or sound [m/s], with room for 2^46 such particles.
    pub fn new(scene: &CheckedScene, fastest: f64) -> Self {
        let momentum = largest_mass(scene) * fastest;
        let largest = std::iter::once(momentum * fastest).chain([momentum; D]);
        SideBooks { sums: largest.map(ExactSum::new).collect() }
    }

    /// Adds the energy that removed particles keep from an accelerating grid, at the end of a step
    /// at `time` [s]: see [`Frame::energy_ahead`].
    pub fn take_leave(&mut self, patches: &[Patch<D>], frame: &Frame<D>, time: f64) {
        let grid = frame.velocity(time);
        for gone in patches.iter().flat_map(|p| &p.removed) {
            let m = gone.mass;
            let momentum = std::array::from_fn(|a| m * (gone.velocity[a] + grid[a]));
            self.sums[0].add(frame.energy_ahead(time, m, &momentum));
        }
    }

    /// Adds the work and impulse of the sides in a step.
    pub fn take(&mut self, patches: &mut [Patch<D>]) {
        for given in patches.iter_mut().flat_map(|p| p.boundary_work.drain(..)) {
            let terms = std::iter::once(given.work).chain(given.impulse);
            self.sums.iter_mut().zip(terms).for_each(|(sum, term)| sum.add(term));
        }
    }
}
