//! Numerical scheme of a scene.

use super::body_models::{BodyModels, BodyWaves};
use super::columns::Columns;
use super::nodal_fields::Fields;
use super::parts::StepPart;
use crate::contact::ContactCondition;
use crate::material::Eos;
use crate::material::constitutive::{ConstitutiveModel, FailureModel, StrengthModel, ThermalModel};
use crate::scene::{
    CheckedScene, EnergyUpdate, FrameKind, Limiter, PressureRelaxation, ShapeKind, SideProperties,
    Stepping, StressUpdate,
};
use crate::shape::DomainExtent;
use crate::solver::artificial_viscosity::Viscosity;
use crate::transfer::TransferPlan;

/// Numerical scheme of a scene: grid, columns, nodal fields, material models of the bodies and options
/// of the method. It knows no effect.
pub struct Scheme<const D: usize> {
    /// Indices of the columns.
    pub columns: Columns,
    /// Indices of the nodal fields.
    pub fields: Fields,
    /// External forces on particles, each with the part of a step that it belongs to.
    pub(super) forces: Vec<(usize, usize)>,
    /// Part of a step that friction heat belongs to.
    pub(super) friction_part: usize,
    pub(super) transfer: TransferPlan,
    pub(super) stepping: Stepping,
    pub(super) stress_update: StressUpdate,
    /// Whether the work uses the velocity that conserves energy exactly.
    pub(crate) compatible: bool,
    pub(super) filter_heat: bool,
    pub(super) relaxation: Option<PressureRelaxation>,
    pub(super) volume_relaxation: Option<f64>,
    /// Share of the full mass matrix in the mass matrix of the force, whose rest is lumped [-].
    pub(crate) full_share: f64,
    pub(super) edge_mask: Option<f64>,
    /// Whether the edge mask acts on pairs of nodes.
    pub(super) masks_pairs: bool,
    pub(super) viscosity: Option<Viscosity>,
    /// Contact between bodies with separate velocity fields.
    pub(super) contact: Option<ContactCondition>,
    /// Number of velocity fields, each in a layer of the nodal arrays: one for all bodies, or one
    /// per body.
    pub layers: usize,
    /// Initial rho c^2 of each body [Pa].
    pub(super) stiffness: Vec<f64>,
    /// Initial acoustic impedance rho c of each body [Pa s/m].
    pub(super) impedances: Vec<f64>,
    /// Shear wave speed in each body at rest [m/s]; 0 in fluids without strength.
    pub(crate) shear_speeds: Vec<f64>,
    /// Impact speed of the scene, maximum over its bodies [m/s].
    pub(super) impact: f64,
    /// Greatest impulse that each body can return as adhesion under tension [Pa s].
    pub(super) max_adhesion_impulse: Vec<f64>,
    /// Constitutive model of each body.
    pub(crate) models: Vec<ConstitutiveModel>,
    /// Strength of each body's material, in addition to its equation of state.
    pub(crate) strengths: Vec<Option<Box<dyn StrengthModel>>>,
    /// Failure model of each body's material.
    pub(crate) failures: Vec<Option<Box<dyn FailureModel>>>,
    /// Thermal model of each body.
    pub(crate) thermals: Vec<Option<ThermalModel>>,
    /// Column of the history variable of each body's equation of state.
    pub(super) history: Vec<Option<usize>>,
    pub(super) shape: ShapeKind,
    /// Whether shape functions are evaluated at the initial positions of the particles.
    pub(crate) total_lagrangian: bool,
    /// Whether sums in a plane run over the corners of the particles.
    pub(super) by_corners: bool,
    /// Edges of a cell [m] and their inverse.
    pub(crate) cell: [f64; D],
    pub(super) inverse_cell: [f64; D],
    /// Edge of a square or line with the volume of a cell [m].
    pub(super) edge: f64,
    /// Lower corner of the domain [m] and its number of cells.
    pub(super) lower: [f64; D],
    pub(crate) cells: [i64; D],
    pub(super) sides: [[SideProperties; 2]; D],
    /// Directions with a no-slip wall.
    pub(super) no_slip: [bool; D],
    /// Whether x is a radius: radial motion then causes hoop strain.
    pub(crate) axisymmetric: bool,
    /// Longest half diagonal of a particle's domain [cells], if it is limited.
    pub(super) domain_limit: Option<f64>,
    /// Requirements of the effects.
    pub(super) of_effects: EffectLimits,
    /// Whether quiescent patches are skipped.
    pub(super) may_sleep: bool,
    /// Greatest initial speed, of bodies or sound [m/s].
    pub fastest: f64,
    /// Mass below which a node counts as empty [kg].
    pub(crate) empty_mass: f64,
    /// Nodal speed below which a node counts as at rest [m/s].
    pub(super) quiescent_speed: f64,
    /// Acceleration that brings a node to that speed while the fastest wave crosses a cell [m/s2].
    pub(super) still_acceleration: f64,
    /// Nodal pressure below which a node counts as free of stress [Pa].
    pub(super) still_pressure: f64,
}

/// Limits that the effects of a scene impose on the scheme.
pub(super) struct EffectLimits {
    /// Longest step of diffusive effects at a Courant number of 1 [s].
    pub diffusion_step: f64,
    /// Greatest number of products with a nodal matrix of an effect.
    pub products: u32,
    /// Number of nodal matrices of the effects.
    pub matrices: usize,
    /// Whether there are any effects, which may need the weights of the particles.
    pub any: bool,
}

/// Fraction of the fastest speed of a scene below which nodal velocities count as zero; the limits
/// of acceleration, heat and pressure follow from it. It applies to all patches, quiescent or not.
const STILL: f64 = 1.0 / (1u64 << 50) as f64;

/// Smallest stiffness of a gas in pressure relaxation, over the pressure that counts as zero: 2^-30
/// of the stiffness of the scene. Rounding errors of pressure then change no volume.
const COLD: f64 = (1u64 << 20) as f64;

/// Courant number of a step in which the pressure relaxes by its rate.
const RELAXATION_COURANT: f64 = 0.4;

/// Edge of a square or line with the volume of a cell [m]; exact if all edges are equal.
fn mean_edge<const D: usize>(cell: [f64; D]) -> f64 {
    match cell.iter().all(|&h| h == cell[0]) {
        true => cell[0],
        false => cell.iter().product::<f64>().powf(1.0 / D as f64),
    }
}

impl<const D: usize> Scheme<D> {
    /// Numerical heat below which it is no longer spread [J/kg].
    pub(crate) fn still_heat(&self) -> f64 {
        self.fastest * self.fastest * STILL
    }

    /// Scheme of `scene` with the `models` of its bodies, and the columns and nodal fields that the
    /// effects have completed.
    pub(super) fn new(
        scene: &CheckedScene,
        models: BodyModels,
        columns: Columns,
        fields: Fields,
        of_effects: EffectLimits,
    ) -> Self {
        let method = &scene.scene.method;
        let cell: [f64; D] = std::array::from_fn(|a| scene.cell_size[a]);
        let volume: f64 = cell.iter().product();
        let smallest = cell.iter().copied().fold(f64::INFINITY, f64::min);
        let waves = BodyWaves::new::<D>(scene, &models, smallest);
        let densest =
            (0..scene.bodies.len()).map(|i| scene.material_of(i).density).fold(0.0, f64::max);
        // volume of a cell, with axial symmetry per radian at the outermost radius
        let around = match scene.axisymmetric() {
            true => scene.scene.domain.lower[0] + scene.cells[0] as f64 * cell[0],
            false => 1.0,
        };
        let edge = mean_edge(cell);
        let contact = contact_condition(scene);
        let friction_part = if rubs::<D>(contact) { None } else { columns.wall_friction_part };
        let owner = |column: usize| columns.owners[column].expect("a force is an effect's");
        let fastest = waves.fastest;
        Scheme {
            by_corners: has_corner_sums::<D>(scene, &columns, &of_effects),
            failures: models.failures(scene, &waves.shear_speeds, edge),
            history: models.histories(&columns),
            forces: columns.forces.iter().map(|&force| (force, owner(force))).collect(),
            friction_part: friction_part.unwrap_or(StepPart::Contact as usize),
            of_effects,
            columns,
            fields,
            transfer: method.transfer.plan(),
            stepping: method.stepping,
            stress_update: method.stress_update,
            compatible: method.energy == EnergyUpdate::Compatible,
            filter_heat: method.filter_heat,
            relaxation: method.pressure_relaxation,
            volume_relaxation: method.volume_relaxation,
            full_share: 1.0 - method.mass_lumping.unwrap_or(0.0),
            edge_mask: method.edge_mask,
            masks_pairs: masks_pairs(scene),
            viscosity: scene.scene.artificial_viscosity.as_ref().map(|v| Viscosity::new(v, edge)),
            contact,
            layers: scene.velocity_fields(),
            stiffness: waves.stiffness,
            impedances: waves.impedances,
            impact: waves.impact,
            max_adhesion_impulse: waves.max_adhesion_impulse,
            shear_speeds: waves.shear_speeds,
            thermals: models.thermals,
            models: models.models,
            strengths: models.strengths,
            shape: method.shape,
            total_lagrangian: method.frame == FrameKind::TotalLagrangian,
            cell,
            inverse_cell: cell.map(|h| 1.0 / h),
            edge,
            lower: std::array::from_fn(|a| scene.scene.domain.lower[a]),
            cells: std::array::from_fn(|a| scene.cells[a] as i64),
            no_slip: scene.side_properties().map(|ends| ends.iter().any(|side| side.no_slip)),
            sides: scene.side_properties(),
            axisymmetric: scene.axisymmetric(),
            domain_limit: method.domain_limit,
            may_sleep: scene.skips_quiet(),
            fastest,
            // the content of such a node is below the rounding of its neighbours
            empty_mass: densest * volume * around * 2f64.powi(-90),
            // far ahead of a wave, values would decay until they are denormal numbers; below this
            // fraction of the speeds of the scene they are below the rounding of the values behind
            // the wave
            quiescent_speed: fastest * STILL,
            still_acceleration: fastest * fastest * STILL / smallest,
            still_pressure: densest * fastest * fastest * STILL,
        }
    }

    /// Shortest edge of a cell [m].
    pub fn shortest_edge(&self) -> f64 {
        self.cell.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Whether the domain of the shape function grows with the particle.
    pub fn grows(&self) -> bool {
        self.extent() == DomainExtent::Current
    }

    pub(super) fn extent(&self) -> DomainExtent {
        self.shape.extent()
    }

    /// Whether the shape function depends on a deforming domain.
    pub(super) fn domains_deform(&self) -> bool {
        self.extent() == DomainExtent::Current && !self.total_lagrangian
    }

    /// Smallest stiffness of a gas in pressure relaxation [Pa].
    pub(super) fn least_stiffness(&self) -> f64 {
        COLD * self.still_pressure
    }

    /// Fraction [-] of the deviation that step number `step` (from 1) with the Courant number
    /// `courant` relaxes, if it relaxes the pressure.
    pub(super) fn relaxes(&self, step: u64, courant: f64) -> Option<f64> {
        let relaxation = self.relaxation.filter(|r| step.is_multiple_of(r.interval as u64))?;
        Some(relaxation.rate * (courant / RELAXATION_COURANT).min(1.0))
    }
}

/// Whether sums run over the corners of the particles: in leapfrog steps of fluids with linear CPDI in a
/// plane, by FLIP and PIC. All that needs the weights of a particle on its nodes excludes it: a tensor
/// of stress, the mass matrix, APIC, the total-Lagrangian frame, axial symmetry, velocity fields of
/// several bodies, no-slip walls, the nodal limiter and any effect. Edge mask, spin, relaxation and
/// compatible energy are only for mid-point steps.
fn has_corner_sums<const D: usize>(
    scene: &CheckedScene,
    columns: &Columns,
    of_effects: &EffectLimits,
) -> bool {
    let method = &scene.scene.method;
    let transfer = method.transfer.plan();
    let viscosity = scene.scene.artificial_viscosity.as_ref();
    let has_nodal_limiter = viscosity.is_some_and(|v| v.limiter == Some(Limiter::Nodal));
    let has_no_slip = || scene.side_properties::<D>().as_flattened().iter().any(|s| s.no_slip);
    D > 1
        && method.shape.has_corners()
        && method.stepping == Stepping::Leapfrog
        && method.frame == FrameKind::UpdatedLagrangian
        && !(transfer.needs_matrix(false) || transfer.is_affine() || has_nodal_limiter)
        && !(scene.axisymmetric() || scene.velocity_fields() > 1 || has_no_slip())
        && !(columns.stress.is_some() || of_effects.any)
}

/// Whether the relaxation conserves the sum of V0 ln J, not that of V. The volume ratio of a particle
/// grows by its divergence times itself, as the size of the space around it does, except on a line
/// in the total-Lagrangian frame, which adds volume. Gases expand by different factors on both sides
/// of a contact discontinuity, where the sum of V0 ln J is not the space that they fill.
pub(super) fn relaxes_ratio(scene: &CheckedScene) -> bool {
    let method = &scene.scene.method;
    let adds = scene.dimension == 1 && method.frame == FrameKind::TotalLagrangian;
    method.pressure_relaxation.is_some() && !adds && !scene.has_eos(Eos::is_gas)
}

/// Whether the edge mask leaves pairs of nodes out of the mass matrix, so that a uniform force gives
/// a uniform acceleration. Otherwise it acts on the nodes, before each product of the force and
/// after each product of the work: without a uniform force both are equally accurate, and waves
/// leave transmitting sides better; with spin a pair of nodes has a block of two by two instead of
/// a number; with contact the nodes of a pair may belong to several bodies. The flux
/// limiter acts on pairs.
fn masks_pairs(scene: &CheckedScene) -> bool {
    let method = &scene.scene.method;
    let uniform = scene.scene.body_force.is_some() || scene.accelerates();
    let excluded = method.spin || scene.velocity_fields() > 1 || scene.transmits();
    method.flux_limiter.is_some() || (uniform && !excluded)
}

/// Condition at the contact plane, if bodies of `scene` have separate velocity fields.
pub(super) fn contact_condition(scene: &CheckedScene) -> Option<ContactCondition> {
    let contact = scene.scene.contact.and_then(|contact| contact.condition());
    contact.filter(|_| scene.velocity_fields() > 1)
}

/// Whether bodies in contact rub against each other: on a line there is no tangential motion.
pub(super) fn rubs<const D: usize>(contact: Option<ContactCondition>) -> bool {
    D > 1 && contact.is_some_and(|c| c.coefficient.is_some())
}
