//! Numerical method and artificial viscosity.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::shape::ShapeKind;
use crate::transfer::Transfer;

/// Numerical method. Omitted options default to the textbook form.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Method {
    /// Shape function, which gives the weights of the nodes for each particle.
    pub shape: ShapeKind,
    /// Configuration in which shape functions are evaluated; default `updated_lagrangian`.
    #[serde(default, skip_serializing_if = "FrameKind::is_default")]
    pub frame: FrameKind,
    /// Transfer: the way in which the velocity of a particle follows from the nodal velocities.
    pub transfer: Transfer,
    /// Order of the stress update within a leapfrog step; default `last`.
    #[serde(default)]
    pub stress_update: StressUpdate,
    /// Time levels of stress and shape functions within a step; default `leapfrog`.
    #[serde(default)]
    pub stepping: Stepping,
    /// Form of the stress work in the internal energy; default `textbook`.
    #[serde(default)]
    pub energy: EnergyUpdate,
    /// Add the kinetic energy that the filter of the transfer removes to the internal energy of the
    /// same particle, as heat; default false.
    #[serde(default)]
    pub filter_heat: bool,
    /// Spreading of numerical heat over particles that share nodes, against particles at edges and
    /// in jets that are too hot; absent: none. Numerical heat is the change of the internal
    /// energy by the filter, and by the difference between the work of the method and the work at the
    /// mean nodal velocity. Requires `midpoint` stepping, and `filter_heat` or
    /// the energy `compatible`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heat_spreading: Option<HeatSpreadingOptions>,
    /// Each particle carries the angular momentum of its own rotation, which takes part in the mass
    /// matrix: angular momentum is then conserved to rounding by FMPM of any order; default false.
    /// Requires a plane without axial symmetry, `midpoint` stepping and a transfer `fmpm`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub spin: bool,
    /// Limiter of the fluxes between nodes in the series of FMPM on a line, against tension ahead of
    /// shocks and weak elastic precursors; absent: none. Requires `midpoint` stepping, a transfer
    /// `fmpm` of order 2 or more, and no contact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flux_limiter: Option<FluxLimiter>,
    /// Share of the lumped mass in the mass matrix of the force; the rest is the full mass matrix
    /// [-]; absent: 0. Central differences in time make short waves too fast. This share slows them,
    /// which reduces the tension ahead of shocks. With two particles per cell, 3/16 of the square of
    /// the Courant number compensates most of this error. Requires a transfer `fmpm` of order 2 or
    /// more, and no flux limiter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 0.5), extend("exclusiveMinimum" = 0.0))]
    pub mass_lumping: Option<f64>,
    /// Relaxation of the particle pressure towards its projection on the grid; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_relaxation: Option<PressureRelaxation>,
    /// Fraction of the mismatch between the volume of fluid particles and the space available to
    /// them that one step removes, at constant energy [-]. Requires `edge_mask`, which provides the
    /// filled volume; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1.0), extend("exclusiveMinimum" = 0.0))]
    pub volume_relaxation: Option<f64>,
    /// Smallest filled fraction of a node's volume at which the inverse of the filter acts on the
    /// nodal force [-]; with a body force or an accelerated grid between pairs of such nodes, so that
    /// a uniform force accelerates all particles alike; absent: no mask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0), extend("exclusiveMaximum" = 1.0))]
    pub edge_mask: Option<f64>,
    /// Largest half diagonal of a particle domain in a plane, or half length in one dimension
    /// [cells], for shape functions over a deforming domain. If material expands further, such as a
    /// gas that escapes into empty space, its state stays continuous but the particle domains no
    /// longer touch. With a limit of 4 the density of a gas that escapes in one dimension is wrong
    /// by 1 to 2 %, in the total-Lagrangian frame by 0.4 %. A longer domain in a plane is shortened;
    /// edges less than 2 degrees apart first become orthogonal. Absent: no limit; a particle longer
    /// than the stencil ends the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 8.0), extend("exclusiveMinimum" = 0.0))]
    pub domain_limit: Option<f64>,
}

/// Configuration in which the shape functions of the grid are evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrameKind {
    /// Current particle positions: material moves through the grid.
    #[default]
    UpdatedLagrangian,
    /// Initial particle positions: the grid moves with the material, so that no particle changes
    /// cells, and gradients are pushed forward by the deformation (de Vaucorbeil, Nguyen &
    /// Hutchinson 2020). Requires bodies that touch at the start.
    TotalLagrangian,
}

impl FrameKind {
    fn is_default(&self) -> bool {
        *self == FrameKind::default()
    }
}

/// Order of the stress update within a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StressUpdate {
    /// After the momentum update, from the new nodal velocity (USL).
    #[default]
    Last,
    /// Before the momentum update, from the old nodal velocity (USF).
    First,
    /// After the momentum update, from the new particle velocity mapped to the nodes again (MUSL).
    ModifiedLast,
}

/// Time levels of stress and shape functions within a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stepping {
    /// Stress and shape functions at the start of the step.
    #[default]
    Leapfrog,
    /// Stress and shape functions at the middle of the step.
    Midpoint,
}

/// Form of the stress work in the internal energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EnergyUpdate {
    /// -(p + q) dv of the particle's own volume change, by the mid-point rule. With mid-point steps
    /// this is the work of the mean of the old and new nodal velocity.
    #[default]
    Textbook,
    /// Work with the nodal velocity that conserves the sum of kinetic and internal energy to
    /// rounding.
    Compatible,
}

/// Spreading of numerical heat over particles that share nodes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "HeatSpreading")]
pub struct HeatSpreadingOptions {
    /// Mean number of steps over which numerical heat is spread [-]. 50 steps spread it over about
    /// five cells.
    #[schemars(range(min = 1.0, max = 1000.0))]
    pub steps: f64,
}

/// Relaxation of the particle pressure towards its projection on the grid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressureRelaxation {
    /// Fraction of the deviation that a relaxation removes in a step of Courant number 0.4 or more
    /// [-]; in shorter steps the fraction is in proportion to the Courant number.
    #[schemars(range(max = 1.0), extend("exclusiveMinimum" = 0.0))]
    pub rate: f64,
    /// Number of steps between two relaxations; 1: every step. A larger value costs less time and
    /// damps less.
    #[schemars(range(min = 1))]
    pub interval: u32,
}

/// Limiter of the fluxes between nodes in the series of FMPM.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FluxLimiter {
    /// Number of nodes on each side whose values bound those of a node: 1, or 2 for looser limits.
    #[schemars(range(min = 1, max = 2))]
    pub neighbours: u32,
}

/// Artificial viscosity: q = rho (linear c h |D| + quadratic h^2 D^2) in compression, and
/// q = -rho expansion c h D in expansion.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArtificialViscosity {
    /// Coefficient a1 of the linear term [-]; 0: no linear term. A larger value damps oscillations
    /// behind shocks more, and makes weak shocks wider.
    #[schemars(range(min = 0.0))]
    pub linear: f64,
    /// Coefficient a2 of the quadratic term [-]; 0: no quadratic term. A larger value reduces the
    /// overshoot of strong shocks, and makes them wider.
    #[schemars(range(min = 0.0))]
    pub quadratic: f64,
    /// Coefficient a3 of the linear term in expansion [-]; absent: no viscosity in expansion. It
    /// damps the other half of the oscillations behind shocks. Without a limiter it also smears
    /// releases. The tension that it adds is not limited by `tension_cutoff`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub expansion: Option<f64>,
    /// Growth of the quadratic coefficient in strong shocks; absent: it is constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth: Option<ViscosityGrowth>,
    /// Limiter that reduces the viscosity where the velocity is smooth; absent: full viscosity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limiter: Option<Limiter>,
    /// Terms that the limiter reduces; default `linear`.
    #[serde(default)]
    pub limited: LimitedTerms,
}

/// Growth of the quadratic coefficient of the artificial viscosity with the velocity jump over a
/// cell: a2 = min(`max`, `quadratic` + `rate` h |D|/c).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ViscosityGrowth {
    /// Increase of the coefficient per unit of h |D|/c, the velocity jump over the sound speed [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub rate: f64,
    /// Upper limit of the quadratic coefficient [-], greater than `quadratic`.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub max: f64,
}

/// Limiter of the artificial viscosity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Limiter {
    /// Reduction from the ratios of the velocity gradients of neighbouring cells (Christensen
    /// 1990).
    Christensen,
    /// Reduction from the smallest nodal mean of the velocity gradient around the particle.
    Nodal,
}

/// Terms that the limiter reduces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitedTerms {
    /// The limiter reduces only the linear term.
    #[default]
    Linear,
    /// The limiter reduces the linear and the quadratic term.
    Both,
}
