//! The scheme and the artificial viscosity.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The scheme. Options left out take the plain textbook form.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Method {
    /// Shape function.
    pub shape: ShapeKind,
    /// Where shape functions see the particles.
    #[serde(default, skip_serializing_if = "FrameKind::is_default")]
    pub frame: FrameKind,
    /// Transfer of velocity from the grid to the particles.
    pub transfer: Transfer,
    /// When stress is updated within a leapfrog step.
    #[serde(default)]
    pub stress_update: StressUpdate,
    /// How a step is centred in time.
    #[serde(default)]
    pub stepping: Stepping,
    /// How the work of the stress is counted into the internal energy.
    #[serde(default)]
    pub energy: EnergyUpdate,
    /// Give the kinetic energy that the transfer's filter takes back to the same particle as
    /// heat.
    #[serde(default)]
    pub filter_heat: bool,
    /// Relaxation of the pressure towards its projection on the grid; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_relaxation: Option<PressureRelaxation>,
    /// Share of what fluid particles fill too much or too little of the space around them, by
    /// their volumes, that one step takes away at their energy; with an edge mask, which knows
    /// what is filled [-]; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1.0), extend("exclusiveMinimum" = 0.0))]
    pub volume_relaxation: Option<f64>,
    /// Fraction of a node's volume that must hold material for the filter's inverse to act on
    /// its force [-]; absent: no mask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0), extend("exclusiveMaximum" = 1.0))]
    pub edge_mask: Option<f64>,
    /// Longest half diagonal of a particle's domain in a plane, half length on a line [cells], for
    /// shape functions over a domain that deforms. Material that expands further, such as a gas
    /// that escapes into empty space, stays continuous in its state, but the domains of its
    /// particles no longer touch: with a limit of 4 the density of a gas that escapes on a line is
    /// off by 1 to 2 %, in the total-Lagrangian frame by 0.4 %. Absent: no limit, and a particle longer than the stencil ends the
    /// run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 8.0), extend("exclusiveMinimum" = 0.0))]
    pub domain_limit: Option<f64>,
}

/// Shape functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShapeKind {
    /// Hat functions at the particle's centre (Sulsky, Chen & Schreyer 1994).
    Linear,
    /// Hat functions averaged over the particle's undeformed size (Bardenhagen & Kober 2004).
    Gimp,
    /// Hat functions interpolated from the corners of the deforming particle (Sadeghirad,
    /// Brannon & Burghardt 2011).
    Cpdi,
    /// Quadratic B-splines at the particle's centre (Steffen, Kirby & Berzins 2008).
    BsplineQuadratic,
    /// Cubic B-splines at the particle's centre (Steffen, Kirby & Berzins 2008).
    BsplineCubic,
    /// Quadratic B-splines averaged over the deforming particle.
    CpdiBsplineQuadratic,
}

/// Frames in which the grid's functions are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrameKind {
    /// At the particles' current places: material moves through the grid.
    #[default]
    UpdatedLagrangian,
    /// At the particles' first places: the grid moves with the material, so that no particle
    /// changes cells, and gradients are pushed forward by the deformation (de Vaucorbeil, Nguyen
    /// & Hutchinson 2020). For bodies that touch at the start.
    TotalLagrangian,
}

impl FrameKind {
    fn is_default(&self) -> bool {
        *self == FrameKind::default()
    }
}

/// Transfers of velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Transfer {
    /// Adds the nodal change of velocity to the particle's (Brackbill & Ruppel 1986).
    Flip,
    /// Takes the nodal velocity (Harlow 1964).
    Pic,
    /// Takes the nodal velocity and its affine part (Jiang et al. 2015).
    Apic,
    /// This share of FLIP, the rest PIC [-].
    FlipPic(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// Filters the particle's velocity, by this order (Hammerquist & Nairn 2017).
    Xpic(#[schemars(range(min = 1, max = 50))] u32),
    /// Full mass matrix by a series of this order, for velocity and force (Nairn & Hammerquist 2021).
    Fmpm(#[schemars(range(min = 1, max = 50))] u32),
}

/// Orders of the stress update.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StressUpdate {
    /// After the momentum, from the new nodal velocity (USL).
    #[default]
    Last,
    /// Before the momentum, from the old nodal velocity (USF).
    First,
    /// After the momentum, from the new particle velocity mapped to the nodes again (MUSL).
    ModifiedLast,
}

/// How a step is centred in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stepping {
    /// Stress and shape functions at the start of the step.
    #[default]
    Leapfrog,
    /// Stress and shape functions at the middle of the step.
    Midpoint,
}

/// How the work of the stress is counted into the internal energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EnergyUpdate {
    /// -(p + q) dv along the particle's own change of volume, by the mid-point rule. With
    /// mid-point steps this is the work of the mean of the old and new nodal velocity.
    #[default]
    Textbook,
    /// With the nodal velocity that makes kinetic and internal energy add up to rounding.
    Compatible,
}

/// Relaxation of the pressure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressureRelaxation {
    /// Fraction of the deviation that one relaxation takes away [-].
    #[schemars(range(max = 1.0), extend("exclusiveMinimum" = 0.0))]
    pub rate: f64,
    /// Steps from one relaxation to the next.
    #[schemars(range(min = 1))]
    pub interval: u32,
}

/// Artificial viscosity q = rho (linear c h |D| + quadratic h^2 D^2), in compression alone.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArtificialViscosity {
    /// Coefficient of the linear term [-].
    #[schemars(range(min = 0.0))]
    pub linear: f64,
    /// Coefficient of the quadratic term [-].
    #[schemars(range(min = 0.0))]
    pub quadratic: f64,
    /// How the quadratic coefficient grows in strong shocks; absent: it is constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth: Option<ViscosityGrowth>,
    /// Takes viscosity away where the velocity is smooth; absent: full viscosity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limiter: Option<Limiter>,
    /// The terms that the limiter acts on.
    #[serde(default)]
    pub limited: LimitedTerms,
}

/// How the quadratic coefficient of the artificial viscosity grows with the jump of velocity over a
/// cell: a2 = min(`most`, `quadratic` + `rate` h |D|/c).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ViscosityGrowth {
    /// Growth over the jump's share of the sound speed [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub rate: f64,
    /// The greatest quadratic coefficient, above `quadratic` [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub most: f64,
}

/// Limiters of the artificial viscosity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Limiter {
    /// From the ratios of the neighbouring cells' gradients (Christensen 1990).
    Christensen,
    /// From the least nodal mean of the gradient about the particle.
    Nodal,
}

/// Terms that a limiter acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitedTerms {
    /// The linear term.
    #[default]
    Linear,
    /// Both terms.
    Both,
}
