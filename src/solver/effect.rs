//! Interface between effects and the solver: columns and nodal fields that an effect declares, and
//! phases of the step in which it acts.
//!
//! A step is the same for every scene; [`Phase`] lists the points where effects act. The solver
//! runs and times the effects of a scene without knowing their names. An inactive effect adds no
//! columns, fields, messages or calls.

use decomp::{Block, Parity};

use super::clock;
use super::columns::Columns;
use super::declare::Declare;
use super::exchange::Nodal;
use super::nodal_fields::Fields;
use super::parts::StepPart;
use super::patch::Patch;
use super::scheme::Scheme;
use crate::scene::{CheckedScene, EffectKey};

/// Points of a step where effects act, in order.
///
/// Mid-point stepping has all phases except [`PressureUpdate`](Phase::PressureUpdate) and
/// [`StressUpdate`](Phase::StressUpdate); leapfrog stepping all except
/// [`MidState`](Phase::MidState) and [`MidStress`](Phase::MidStress).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Particles, before the equation of state is evaluated at the middle of the step.
    MidState,
    /// Particles, after pressure and viscosity at the middle of the step.
    MidStress,
    /// Particles, after their stress: forces and input of nodal sums, at the time of the forces.
    ParticleForce,
    /// Nodes, after the sums of mass, momentum and internal force: forces on nodes.
    NodalForce,
    /// Nodes, after velocity and acceleration on the nodes that a patch computes: further nodal
    /// sums.
    NodalStart,
    /// Nodes, after the velocity at the end of the step: impulses of friction on nodes.
    EndVelocity,
    /// Nodes, after all nodal velocities; exchanges of nodal values are possible.
    Solve,
    /// Own particles, before velocity, position, volume and energy are updated from the grid.
    Gather,
    /// Own particles, after this update.
    Gathered,
    /// Own particles, after the equation of state has followed a change of volume.
    PressureUpdate,
    /// Own particles, after all effects in `PressureUpdate`.
    StressUpdate,
    /// Own particles at the end of the step, before pressure is computed.
    EndState,
    /// Own particles, after pressure and sound speed by their equations of state.
    EndTemperature,
    /// Own particles, after all effects in `EndTemperature`.
    EndSoundSpeed,
    /// Own particles, after their whole state.
    End,
}

impl Phase {
    /// Number of phases.
    const COUNT: usize = Phase::End as usize + 1;
}

/// Context of a step for its effects.
#[derive(Clone, Copy)]
pub struct StepContext<'a, const D: usize> {
    /// Grid, columns and materials.
    pub scheme: &'a Scheme<D>,
    /// Effects of the scene.
    pub effects: &'a Effects<D>,
    /// Time at the start of the step [s].
    pub start: f64,
    /// Time of the stress and the forces [s].
    pub time: f64,
    /// Length of the step [s].
    pub dt: f64,
    /// Column of the volume ratio at the time of the forces.
    pub jacobian: usize,
}

impl<const D: usize> StepContext<'_, D> {
    /// Time of the middle of the step [s].
    pub fn middle(&self) -> f64 {
        match self.scheme.columns.jacobian_mid {
            Some(_) => self.time,
            None => self.time + 0.5 * self.dt,
        }
    }
}

/// Accounts: sums over all particles to which effects add.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Account {
    /// Accumulated work of external forces [J].
    ExternalWork,
    /// Accumulated impulse of external forces along a direction [N s].
    ExternalImpulse(usize),
    /// Accumulated heat received through sides [J].
    ExternalHeat,
    /// Number of failed particles.
    FailedParticles,
    /// Number of particles with a damage between 0 and 1.
    DamagedParticles,
    /// Accumulated elastic energy that failure has converted to heat [J].
    ReleasedEnergy,
}

/// Particle at the start of a run.
#[derive(Clone, Copy)]
pub struct NewParticle<'a, const D: usize> {
    /// The scene.
    pub scene: &'a CheckedScene,
    /// Index of its body.
    pub body: usize,
    /// Its position [m].
    pub centre: [f64; D],
    /// Edges of its box [m].
    pub size: [f64; D],
}

/// Actions of an effect in the steps of a scene that uses it.
pub trait Effect<const D: usize>: Send + Sync {
    /// Phases in which it acts.
    fn phases(&self) -> &'static [Phase];

    /// Acts on a patch; not called for [`Phase::Solve`].
    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let _ = (phase, step, patch);
    }

    /// Acts in [`Phase::Solve`]. Collective between neighbours.
    fn solve(&self, step: &StepContext<'_, D>, nodal: &mut Nodal<'_, D>) {
        let _ = (step, nodal);
    }

    /// Sets boundary values in nodal fields that have just been exchanged.
    fn set_boundary(&self, scheme: &Scheme<D>, patch: &mut Patch<D>, fields: &[(usize, Parity)]) {
        let _ = (scheme, patch, fields);
    }

    /// Whether [`Effect::set_boundary`] does anything.
    fn has_boundary(&self) -> bool {
        false
    }

    /// Writes the initial values of a particle's columns.
    fn initialize(&self, particle: &NewParticle<'_, D>, values: &mut [f64]) {
        let _ = (particle, values);
    }

    /// Whether the effect may change an own particle at rest; called only if
    /// [`Effect::changes_particles_at_rest`] holds.
    fn may_act(&self, patch: &Patch<D>, particle: usize) -> bool {
        let _ = (patch, particle);
        false
    }

    /// Whether the effect may change particles at rest.
    fn changes_particles_at_rest(&self) -> bool {
        false
    }

    /// Adds the contributions of some own particles of a block to the accounts, in the frame of a
    /// scene whose grid moves at `grid_velocity` [m/s].
    fn totals(
        &self,
        block: &Block<D>,
        particles: std::ops::Range<usize>,
        grid_velocity: [f64; D],
        add: &mut dyn FnMut(Account, &[f64]),
    ) {
        let _ = (block, particles, grid_velocity, add);
    }

    /// Number of products with a nodal matrix between sums over particles and the gather.
    fn products(&self) -> u32 {
        0
    }

    /// Longest stable step at a Courant number of 1 on the undeformed grid, for effects whose limit
    /// is proportional to the square of the cell size [s].
    fn diffusion_step(&self) -> f64 {
        f64::INFINITY
    }
}

/// Input for building effects, after all columns are declared.
pub struct Setup<'a, const D: usize> {
    /// The scene.
    pub scene: &'a CheckedScene,
    /// The columns of all effects.
    pub columns: &'a Columns,
    /// Nodal fields, to which an effect adds its own.
    pub fields: &'a mut Fields,
    /// Number of effects' nodal matrices so far: an effect that needs one takes this number.
    pub matrices: usize,
}

/// Entry of an effect in the registry of a program.
pub trait Package {
    /// Name in tables.
    const NAME: &'static str;

    /// Key of the effect at the top of a scene, if it has one.
    fn key() -> Option<EffectKey> {
        None
    }

    /// Whether `scene` uses the effect.
    fn is_active(scene: &CheckedScene) -> bool;

    /// Declares the columns of the effect.
    fn declare(scene: &CheckedScene, columns: &mut Declare<'_>) {
        let _ = (scene, columns);
    }

    /// Builds the effect for a scene that uses it.
    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>>;
}

/// Registry of the effects of a program.
pub trait Registry {
    /// Names of the effects, in order.
    const NAMES: &'static [&'static str];

    /// Keys of the effects at the top of a scene.
    fn keys() -> Vec<EffectKey>;

    /// Whether `scene` uses effect number `effect`.
    fn is_active(effect: usize, scene: &CheckedScene) -> bool;

    /// Declares the columns of the effects that `scene` uses.
    fn declare(scene: &CheckedScene, columns: &mut Declare<'_>);

    /// Builds the effects that a scene uses, with their numbers.
    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Vec<(usize, Box<dyn Effect<D>>)>;
}

/// Names of all parts of a step in a program with the effects of `R`.
pub fn part_names<R: Registry>() -> Vec<&'static str> {
    StepPart::NAMES.iter().chain(R::NAMES).copied().collect()
}

/// Whether `scene` uses part number `part` of a step.
pub fn uses_part<R: Registry>(part: usize, scene: &CheckedScene) -> bool {
    match StepPart::ALL.get(part) {
        Some(part) => part.is_active(scene),
        None => R::is_active(part - StepPart::COUNT, scene),
    }
}

/// Effects of a scene, and the effects that act in each phase.
pub struct Effects<const D: usize> {
    /// Each with its number among the [parts](super::parts) of a step.
    all: Vec<(usize, Box<dyn Effect<D>>)>,
    acting: [smallvec::SmallVec<[usize; 4]>; Phase::COUNT],
}

impl<const D: usize> Effects<D> {
    /// Effects with their numbers among the parts of a step.
    pub(super) fn new(all: Vec<(usize, Box<dyn Effect<D>>)>) -> Self {
        let mut acting: [smallvec::SmallVec<[usize; 4]>; Phase::COUNT] = Default::default();
        for (k, (_, effect)) in all.iter().enumerate() {
            effect.phases().iter().for_each(|phase| acting[*phase as usize].push(k));
        }
        Effects { all, acting }
    }

    /// Runs and times the effects of a phase on a patch.
    #[inline]
    pub(super) fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        for &k in &self.acting[phase as usize] {
            let (part, effect) = &self.all[k];
            clock::timed(*part, patch, |patch| effect.act(phase, step, patch));
        }
    }

    /// Runs and times [`Phase::Solve`]. Collective between neighbours.
    pub(super) fn solve(&self, step: &StepContext<'_, D>, nodal: &mut Nodal<'_, D>) {
        for &k in &self.acting[Phase::Solve as usize] {
            let (part, effect) = &self.all[k];
            nodal.count_as(Some(*part));
            effect.solve(step, nodal);
            nodal.count_as(None);
        }
    }

    /// Sets boundary values in nodal fields that have just been exchanged.
    pub(super) fn set_boundary(
        &self,
        scheme: &Scheme<D>,
        patch: &mut Patch<D>,
        fields: &[(usize, Parity)],
    ) {
        for (_, effect) in self.all.iter().filter(|(_, effect)| effect.has_boundary()) {
            effect.set_boundary(scheme, patch, fields);
        }
    }

    /// All effects.
    pub fn iter(&self) -> impl Iterator<Item = &dyn Effect<D>> {
        self.all.iter().map(|(_, effect)| &**effect)
    }
}
