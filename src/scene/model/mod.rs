//! The scene as stored in the JSON file: plain structs with the bounds of single numbers.
//!
//! The bounds are attributes of the fields. The JSON schema shows them, and every scene is checked
//! against that schema when it is read. Conditions between two keys are checked elsewhere.

mod body;
mod estimate;
mod method;
mod monitor;
mod motion;
mod output;
mod planned_quantity;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use body::*;
pub use estimate::*;
pub use method::*;
pub use monitor::*;
pub use motion::*;
pub use output::*;
pub use planned_quantity::PlannedQuantity;
pub(crate) use planned_quantity::planned_quantities;

pub use crate::balance::BalanceCost;
pub use crate::contact::{Contact, Normals};
pub use crate::geometry::region::*;
pub use crate::material::definition::*;
pub use crate::shape::ShapeKind;
pub use crate::side::{Course, Ramp, Side, SideProperties};
pub use crate::transfer::Transfer;

/// Scene format that this program reads; incremented whenever a key is renamed.
pub const FORMAT: u32 = 2;

/// A scene: the complete input of a run.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Scene {
    /// Format of the scene; absent: the current format, the only one that is accepted.
    #[serde(default = "present_format")]
    #[schemars(range(min = 1))]
    pub format: u32,
    /// Title of the run in tables, pictures and the terminal; one line.
    pub title: String,
    /// Description of the scene, with the sources of its constants.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// Size of the computational domain, its cells and its patches.
    pub domain: Domain,
    /// End time of the run, and control of the time step.
    pub time: Time,
    /// Numerical method, in full: the name of a preset is expanded when a scene is read.
    pub method: Method,
    /// Distribution of the work over ranks and threads; it changes no bit of the results.
    #[serde(default)]
    pub decomposition: Decomposition,
    /// Materials by name: each given in full, or by `library` or `file` together with keys that
    /// override single values.
    #[schemars(with = "BTreeMap<String, MaterialSource>")]
    pub materials: BTreeMap<String, Material>,
    /// The bodies. Particles are numbered from 0 in this order.
    #[schemars(length(min = 1))]
    pub bodies: Vec<Body>,
    /// Artificial viscosity; absent: that of the method's preset, or none if the method is given in
    /// full; null: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub artificial_viscosity: Option<ArtificialViscosity>,
    /// Length on each side of an interface over which the initial velocities of two bodies that touch
    /// and approach each other on a line change to a common one, at the same momentum [cells]. 1
    /// reduces the error of the energy at the interface from some 100 to 10 to 30 %, and the shocks
    /// arrive up to 0.15 cells later; absent: the velocities jump.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 10.0), extend("exclusiveMinimum" = 0.0))]
    pub impact_smoothing: Option<f64>,
    /// Force per unit mass on every particle, such as gravity; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body_force: Option<BodyForce>,
    /// Contact law between bodies; absent: one velocity field for all bodies, so that they interact
    /// through the grid and stick together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<Contact>,
    /// Conditions at the sides of the domain; absent: every side is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub boundary: Option<Boundary>,
    /// Bounds of the run-time checks, and the response to a violated bound; absent: the default
    /// bounds, which hold for every scene.
    #[serde(default, skip_serializing_if = "Monitor::is_default")]
    pub monitor: Monitor,
    /// Files that the run writes; absent: a profile at the end of the run, pictures and
    /// `results.hdf5`.
    #[serde(default)]
    pub output: Output,
    /// Exact solution with which the results are compared; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<Reference>,
    /// Estimate of the run's own errors; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_estimate: Option<ErrorEstimate>,
    /// Values of the keys of effects, by name.
    #[serde(flatten)]
    #[schemars(skip)]
    pub effects: BTreeMap<String, Value>,
}

fn present_format() -> u32 {
    FORMAT
}

/// The computational domain: a box of cells, divided into patches.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Domain {
    /// Coordinates of the lower corner of the domain [m]; their number is the dimension of the
    /// scene.
    #[schemars(length(min = 1))]
    pub lower: Vec<f64>,
    /// Coordinates of the upper corner of the domain, each above that of the lower corner [m].
    pub upper: Vec<f64>,
    /// Edge of a cell, one number for all directions or one per direction [m]; the domain must be a
    /// whole number of cells. With half the edge a run on a line takes four times the work, in a
    /// plane eight times.
    pub cell_size: CellSize,
    /// Coordinate system of a plane; default `plane_strain`.
    #[serde(default, skip_serializing_if = "Geometry::is_plane_strain")]
    pub geometry: Geometry,
    /// Number of patches in each direction. If absent, or if ranks have several threads and there are
    /// fewer patches than threads in total, the program chooses the patches and prints their numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1)))]
    pub patches: Option<Vec<usize>>,
}

/// Coordinate system of a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Geometry {
    /// Cartesian x and y, no strain out of the plane; the only choice in one dimension.
    #[default]
    PlaneStrain,
    /// x is the radius and y the axis; masses and energies are per radian.
    Axisymmetric,
}

impl Geometry {
    fn is_plane_strain(&self) -> bool {
        *self == Geometry::PlaneStrain
    }
}

/// Distribution of the work over ranks and threads.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Decomposition {
    /// Load balancing: the rule by which patches migrate between ranks.
    pub balance: Balance,
    /// Compute the inner patches of a rank while messages for its outer patches are in transit;
    /// default true.
    pub overlap: bool,
    /// Skip quiescent patches, which no wave has reached; default true.
    pub skip_quiescent: bool,
    /// Number of threads on which each rank computes its patches, default 1; the option `--threads`
    /// takes precedence. It changes no bit of the results.
    #[schemars(range(min = 1, max = 1024))]
    pub threads: usize,
    /// Ghost data for filters that extend over several cells; absent: the cheaper choice for the
    /// given patches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub filter_halo: Option<FilterHalo>,
}

impl Default for Decomposition {
    fn default() -> Self {
        Decomposition {
            balance: Balance::default(),
            overlap: true,
            skip_quiescent: true,
            threads: 1,
            filter_halo: None,
        }
    }
}

/// Load balancing: when patches migrate between ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Balance {
    /// Steps between load measurements, default 50; 0: patches do not migrate.
    pub every: u64,
    /// Measure of the load of a patch; default `time`.
    pub cost: BalanceCost,
}

impl Default for Balance {
    fn default() -> Self {
        Balance { every: 50, cost: BalanceCost::Time }
    }
}

/// Ghost data for a filter that extends over several cells. Both choices give the same bits at
/// different cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FilterHalo {
    /// The owners send the final nodal values after each product.
    Exchange,
    /// Ghosts extend so far that each patch computes these values itself.
    Redundant,
}

/// Edge of a cell [m].
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum CellSize {
    /// The same edge in each direction.
    Uniform(#[schemars(extend("exclusiveMinimum" = 0.0, "minimum" = 0.0))] f64),
    /// One edge per direction.
    PerDirection(
        #[schemars(extend(
            "items" = {"type": "number", "exclusiveMinimum": 0.0, "minimum": 0.0}
        ))]
        Vec<f64>,
    ),
}

/// End time and time step control.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Simulated time at which the run ends; it starts at 0 [s].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub end: f64,
    /// Courant number [-], above 0 and at most 1: the time step over the time in which the fastest
    /// wave crosses a cell; default 0.4. A larger value gives fewer steps; above the limit of the
    /// method the run becomes unstable.
    #[serde(default = "default_courant")]
    #[schemars(range(max = 1.0), extend("exclusiveMinimum" = 0.0))]
    pub courant: f64,
    /// Wall time since the program's start after which the run writes a checkpoint and ends, to be
    /// restarted later [s]; absent: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub wall_limit: Option<f64>,
}

/// Courant number of a scene that gives none [-].
pub fn default_courant() -> f64 {
    0.4
}

/// Conditions at the sides of the domain; an omitted side is free.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Boundary {
    /// Condition at the side at the lower end of x; default `free`. In an axisymmetric domain that
    /// begins at x = 0 it must be `symmetry`.
    pub x_lower: Side,
    /// Condition at the side at the upper end of x; default `free`.
    pub x_upper: Side,
    /// Condition at the side at the lower end of y, in a plane; default `free`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y_lower: Option<Side>,
    /// Condition at the side at the upper end of y, in a plane; default `free`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y_upper: Option<Side>,
    /// Fixed temperatures of rigid sides, for scenes with heat conduction; the other sides are
    /// insulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature: Option<SideTemperatures>,
}

/// Fixed temperatures of the sides [K].
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SideTemperatures {
    /// Fixed temperature of the side at the lower end of x [K]; absent: the side is insulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub x_lower: Option<f64>,
    /// Fixed temperature of the side at the upper end of x [K]; absent: the side is insulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub x_upper: Option<f64>,
    /// Fixed temperature of the side at the lower end of y, in a plane [K]; absent: the side is
    /// insulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub y_lower: Option<f64>,
    /// Fixed temperature of the side at the upper end of y, in a plane [K]; absent: the side is
    /// insulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub y_upper: Option<f64>,
}
