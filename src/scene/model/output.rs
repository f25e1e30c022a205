//! Output files, and the exact solution with which a run is compared.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::planned_quantity::PlannedQuantity;

/// Output files of a run.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Profiles: the state of every particle at given times.
    pub profiles: Profiles,
    /// Histories of faces, tracers, energies and momentum; absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub histories: Option<Histories>,
    /// Checkpoints, from which a run can be restarted; absent: one every ten minutes of wall time,
    /// of which the last two are kept and deleted after a successful run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checkpoint: Option<Checkpoints>,
    /// Write `results.hdf5`; default true.
    pub hdf5: bool,
    /// Draw the pictures; default true.
    pub pictures: bool,
    /// Prediction of `flyer-mpm plan`, with which the run is compared at its end; absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<Planned>,
}

/// Predicted error and cost of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Planned {
    /// File of the scene that was planned; a plan of another scene does not replace this planned
    /// scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Quantity whose error is planned.
    pub quantity: PlannedQuantity,
    /// Target for the relative error [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub wanted: f64,
    /// Predicted relative error [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub error: f64,
    /// Predicted user CPU time of the time loop [s].
    #[schemars(range(min = 0.0))]
    pub cpu_seconds: f64,
    /// Predicted wall time of the time loop [s].
    #[schemars(range(min = 0.0))]
    pub wall_seconds: f64,
    /// Whether the predicted error is a guess because the schemes were not measured on such scenes;
    /// default false.
    #[serde(default)]
    pub guess: bool,
}

impl Default for Output {
    fn default() -> Self {
        Output {
            profiles: Profiles::default(),
            histories: None,
            checkpoint: None,
            hdf5: true,
            pictures: true,
            plan: None,
        }
    }
}

/// Checkpoint schedule. A checkpoint is written at the end of the first step past its time, to
/// `<folder of the results>.checkpoints`. If no key gives a time: every ten minutes of wall time.
/// Checkpoints change no bit of the results.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Checkpoints {
    /// Simulated time between checkpoints [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub every_seconds: Option<f64>,
    /// Number of steps between checkpoints.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub every_steps: Option<u64>,
    /// Simulated times of checkpoints [s], increasing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0.0}))]
    pub at_times: Vec<f64>,
    /// Wall time between checkpoints [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub every_wall_seconds: Option<f64>,
    /// Number of most recent checkpoints to keep, also after the end of the run; default 2; 0: none
    /// are written.
    pub keep: u64,
}

impl Default for Checkpoints {
    fn default() -> Self {
        Checkpoints {
            every_seconds: None,
            every_steps: None,
            at_times: Vec::new(),
            every_wall_seconds: None,
            keep: 2,
        }
    }
}

/// Times of the profiles.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Profiles {
    /// Times [s], increasing; time steps end exactly at them. Empty (default): only the end of the
    /// run.
    #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0.0}))]
    pub times: Vec<f64>,
}

/// Histories of faces, tracers, energies and momentum. The pressure of a face that is a free
/// surface is the pressure of the surface: 0, or the xx component of the deviator if the material
/// has strength.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Histories {
    /// Time between rows [s]; a row is written at the end of the first step past its time. Absent:
    /// 1/200 of `time.end`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub interval: Option<f64>,
    /// Particles whose history is recorded; default: none.
    #[serde(default)]
    pub tracers: Vec<Tracer>,
}

/// A particle whose history is recorded.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tracer {
    /// Name used for its columns.
    pub name: String,
    /// Name of the body to which it belongs.
    pub body: String,
    /// Initial position [m]; the particle whose initial position is nearest is recorded.
    pub at: Vec<f64>,
}

/// Exact solution with which a run is compared.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Reference {
    /// A flyer plate strikes a target (Burghardt 2010).
    FlyerImpact(FlyerImpact),
    /// Two ideal gases, separated by a diaphragm that is removed at the start (Sod 1978).
    Riemann(Riemann),
    /// One steady shock: a body runs into a rigid wall or is driven by a piston.
    WallImpact(WallImpact),
    /// A simple wave: a body driven by a piston whose velocity changes smoothly (Courant &
    /// Friedrichs 1948).
    SimpleWave(SimpleWave),
    /// The generalized vortex (Kamojjala et al. 2015); reports `displacement_l2`.
    Vortex(NamedBody),
    /// A free rotating body; reports `angular_momentum_loss`, `energy_loss`, `kinetic_energy_loss`.
    Rotation(NamedBody),
    /// A shear layer; reports `velocity_rms`.
    ShearLayer(NamedBody),
    /// The Gresho vortex; reports `velocity_rms`, `pressure_rms`, `pressure_form_rms`.
    Gresho(NamedBody),
    /// Noh's problem; reports `mean_density`, `mean_density_error`, `density_l1`.
    Noh(NamedNoh),
}

/// The body whose initial motion and material give the constants of the exact solution.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NamedBody {
    /// Name of the body; its profiles are scored.
    pub body: String,
}

/// Noh's problem in a body with an initial `radial` velocity, or with an initial velocity towards
/// the axis of an axisymmetric domain.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NamedNoh {
    /// Name of the body.
    pub body: String,
    /// Symmetry of the implosion.
    pub symmetry: NohSymmetry,
    /// Smallest and largest distance from the centre between which the density is averaged [m].
    #[schemars(length(min = 2))]
    pub between: Vec<f64>,
}

/// Symmetry of the implosion of Noh's problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NohSymmetry {
    /// Towards a plane, in one dimension.
    Planar,
    /// Towards an axis: a point in plane strain, or the axis of an axisymmetric domain.
    Cylindrical,
    /// Towards a point on the axis of an axisymmetric domain.
    Spherical,
}

/// Flyer and target of an impact; all constants of the exact solution follow from these bodies.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlyerImpact {
    /// Name of the body that strikes.
    pub flyer: String,
    /// Name of the body that is struck; its profiles are scored.
    pub target: String,
    /// Direction of the waves in a plane; absent: along x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front: Option<Front>,
}

/// Direction of plane waves in a plane, and the region whose particles are scored.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Front {
    /// Angle from the x axis to the direction of wave propagation [degrees]; default 0.
    #[serde(default)]
    pub angle: f64,
    /// A point on the line along which the waves are followed [m]; at an angle other than 0 the
    /// interface passes through it.
    pub about: Vec<f64>,
    /// Only particles nearer to this line are scored [m]; absent: all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub half_width: Option<f64>,
    /// Two positions along the line, measured from `about`; only particles between them are scored
    /// [m]. Absent: everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
}

/// The two bodies of a Riemann problem, which touch at the start.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Riemann {
    /// Name of the body on the lower side.
    pub left: String,
    /// Name of the body on the upper side.
    pub right: String,
    /// Direction of the waves in a plane; absent: along x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front: Option<Front>,
}

/// The body that the piston drives.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SimpleWave {
    /// Name of the body.
    pub body: String,
}

/// The body that runs into the wall.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WallImpact {
    /// Name of the body.
    pub body: String,
}
