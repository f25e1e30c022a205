//! The scene as it stands in the JSON file: plain structs and the bounds of single numbers.
//!
//! The bounds are attributes of the fields: the JSON schema shows them, and reading a scene
//! checks them against that same schema. What two keys say of each other is not known here.

mod body;
mod contact;
mod estimate;
mod method;
mod motion;
mod output;
mod time_function;
mod watch;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use body::*;
pub use contact::*;
pub use estimate::*;
pub use method::*;
pub use motion::*;
pub use output::*;
pub use time_function::*;
pub use watch::*;

pub use crate::geometry::region::*;
pub use crate::material::definition::*;

/// A scene: everything that a run is told.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// One line that names the run in tables and pictures.
    pub title: String,
    /// What the scene is, and the sources of its constants.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// The grid.
    pub domain: Domain,
    /// When to end, and the length of steps.
    pub time: Time,
    /// The scheme.
    pub method: Method,
    /// How the work is shared; it changes no bit of the results.
    #[serde(default)]
    pub decomposition: Decomposition,
    /// Materials by name; each whole, or by `library` or `file` with keys beside it that override.
    #[schemars(with = "BTreeMap<String, MaterialSource>")]
    pub materials: BTreeMap<String, Material>,
    /// Bodies; their order numbers the particles.
    #[schemars(length(min = 1))]
    pub bodies: Vec<Body>,
    /// Artificial viscosity; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub artificial_viscosity: Option<ArtificialViscosity>,
    /// A force per mass on every particle; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body_force: Option<BodyForce>,
    /// What bodies do to each other where they touch; absent: one velocity field for all of them,
    /// so that they meet through the grid and stick together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<Contact>,
    /// What stands at the sides of the domain; absent: free on every side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub boundary: Option<Boundary>,
    /// The watch over the run; absent: with the bounds that hold for every scene.
    #[serde(default, skip_serializing_if = "Watch::is_default")]
    pub watch: Watch,
    /// What is written.
    #[serde(default)]
    pub output: Output,
    /// The exact solution that the run is held against.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<Reference>,
    /// A statement of the run's own errors; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_estimate: Option<ErrorEstimate>,
}

/// The domain, a box of cells cut into patches.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Domain {
    /// Lower corner [m]; its length is the dimension of the scene.
    #[schemars(length(min = 1))]
    pub lower: Vec<f64>,
    /// Upper corner [m].
    pub upper: Vec<f64>,
    /// Edge of a cell [m], one number or one a direction; the domain is a whole number of cells.
    pub cell_size: CellSize,
    /// What the two directions of a plane stand for.
    #[serde(default, skip_serializing_if = "Geometry::is_plane_strain")]
    pub geometry: Geometry,
    /// Patches in each direction; absent: chosen from ranks and threads, and printed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1)))]
    pub patches: Option<Vec<usize>>,
}

/// What the two directions of a plane stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Geometry {
    /// Cartesian x and y, nothing strains across them; on a line the only one.
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

/// How the work is shared.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Decomposition {
    /// Moving patches between ranks so that none waits for the busiest.
    pub balance: Balance,
    /// Compute the inner patches of a rank while messages to its outer ones are on their way.
    pub overlap: bool,
    /// Leave out patches at rest that no wave has reached.
    pub skip_quiet: bool,
    /// Threads a rank; `--threads` wins.
    #[schemars(range(min = 1, max = 1024))]
    pub threads: usize,
    /// How filters that reach over several cells get what lies beyond a patch; absent: the
    /// cheaper for the patches at hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub filter_halo: Option<FilterHalo>,
}

impl Default for Decomposition {
    fn default() -> Self {
        Decomposition {
            balance: Balance::default(),
            overlap: true,
            skip_quiet: true,
            threads: 1,
            filter_halo: None,
        }
    }
}

/// When patches move between ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Balance {
    /// Steps between two looks at the ranks' loads; 0: patches stay where they start.
    pub every: u64,
    /// What counts as a patch's load.
    pub cost: BalanceCost,
}

impl Default for Balance {
    fn default() -> Self {
        Balance { every: 50, cost: BalanceCost::Time }
    }
}

/// What counts as a patch's load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BalanceCost {
    /// The time that its phases take, measured and smoothed.
    Time,
    /// The particles that it computes: where patches go is then the same in every run.
    Particles,
}

/// How a filter that reaches over several cells gets what lies beyond a patch. The bits are the
/// same; the cost is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FilterHalo {
    /// The owners send finished nodal values after each product.
    Exchange,
    /// Ghosts come from so far that each patch computes them for itself.
    Deep,
}

/// Edge of a cell [m].
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum CellSize {
    /// The same in each direction.
    Uniform(#[schemars(extend("exclusiveMinimum" = 0.0, "minimum" = 0.0))] f64),
    /// One a direction.
    PerDirection(
        #[schemars(extend(
            "items" = {"type": "number", "exclusiveMinimum": 0.0, "minimum": 0.0}
        ))]
        Vec<f64>,
    ),
}

/// Time.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// End of the run [s].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub end: f64,
    /// Courant number, in (0, 1] [-].
    #[serde(default = "default_courant")]
    #[schemars(range(max = 1.0), extend("exclusiveMinimum" = 0.0))]
    pub courant: f64,
    /// Wall time from the program's start after which the run writes a checkpoint and ends, to be
    /// gone on with [s]; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub wall_limit: Option<f64>,
}

fn default_courant() -> f64 {
    0.4
}

/// The sides of the domain; one left out is free.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Boundary {
    /// Side at the lower end of x.
    pub x_lower: Side,
    /// Side at the upper end of x.
    pub x_upper: Side,
    /// Side at the lower end of y, in a plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y_lower: Option<Side>,
    /// Side at the upper end of y, in a plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y_upper: Option<Side>,
    /// Temperatures that rigid sides are held at, where heat is conducted; the others are
    /// insulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature: Option<SideTemperatures>,
}

/// Temperatures of sides [K].
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SideTemperatures {
    /// At the lower end of x.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub x_lower: Option<f64>,
    /// At the upper end of x.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub x_upper: Option<f64>,
    /// At the lower end of y, in a plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub y_lower: Option<f64>,
    /// At the upper end of y, in a plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub y_upper: Option<f64>,
}

/// What stands at one side of the domain.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Nothing: a particle that passes it ends the run.
    #[default]
    Free,
    /// A plane of symmetry.
    Symmetry,
    /// A rigid wall along which material slides freely: the same as symmetry.
    Wall,
    /// A rigid wall that material sticks to, in a plane.
    NoSlip,
    /// A rigid wall that material slides along against Coulomb's friction of this coefficient
    /// [-], in a plane: it sticks while that takes no more than the coefficient times what it
    /// presses with.
    Friction(#[schemars(range(min = 0.0))] f64),
    /// Joined to the opposite side.
    Periodic,
    /// Open: a particle that passes it leaves the run, and is booked.
    Outflow,
    /// Open, as if the same material went on beyond it: waves pass it and do not come back, and a
    /// particle that passes it leaves the run, and is booked.
    Transmitting,
    /// A rigid piston with this velocity across the side [m/s]; the grid travels with it. A
    /// number, pairs of time [s] and velocity, a ramp, or the name of a CSV file of columns time
    /// and velocity.
    Velocity(Course),
    /// A pressure [Pa] on the surface of the bodies that touch this side at the start, wherever it
    /// moves: a number, pairs of time [s] and pressure, a ramp, or the name of a CSV file of
    /// columns time and pressure. Free otherwise.
    Pressure(Course),
}

impl Side {
    /// Velocity of a side that lets nothing through, at the start [m/s].
    pub fn rigid_velocity(&self) -> Option<f64> {
        self.rigid_course().map(|course| course.at(0.0))
    }

    /// Velocity of a side that lets nothing through, over time [m/s].
    pub fn rigid_course(&self) -> Option<Course> {
        match self {
            Side::Symmetry | Side::Wall | Side::NoSlip | Side::Friction(_) => {
                Some(Course::Constant(0.0))
            }
            Side::Velocity(course) => Some(course.clone()),
            Side::Free
            | Side::Periodic
            | Side::Outflow
            | Side::Transmitting
            | Side::Pressure(_) => None,
        }
    }

    /// Whether particles that pass it leave the run.
    pub fn lets_out(&self) -> bool {
        matches!(self, Side::Outflow | Side::Transmitting)
    }
}
