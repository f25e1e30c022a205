//! What is written, and the exact solution that a run is held against.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is written.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Profiles: every particle at given times.
    pub profiles: Profiles,
    /// Histories; absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub histories: Option<Histories>,
    /// Checkpoints, from which a run can go on; absent: one every ten minutes of wall time, the last
    /// two kept until the run has ended well.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checkpoint: Option<Checkpoints>,
    /// Write `results.hdf5`.
    pub hdf5: bool,
    /// Draw the pictures.
    pub pictures: bool,
    /// What `flyer-mpm plan` has foretold, which the run is held against at its end; absent:
    /// nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<Planned>,
}

/// What has been foretold of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Planned {
    /// File of the scene that was planned; a plan of another scene does not replace this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// The quantity.
    pub quantity: PlannedQuantity,
    /// Its relative error that was wanted [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub wanted: f64,
    /// The error to expect [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub error: f64,
    /// User CPU time of the time loop [s].
    #[schemars(range(min = 0.0))]
    pub cpu_seconds: f64,
    /// Its wall time [s].
    #[schemars(range(min = 0.0))]
    pub wall_seconds: f64,
    /// Whether the error is a guess, for the schemes were not measured on such scenes.
    #[serde(default)]
    pub guess: bool,
}

/// What a plan is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlannedQuantity {
    /// Pressure of the plateau behind the shock.
    PlateauPressure,
    /// Relative L1 of each profile's pressure.
    L1,
    /// Time of arrival at a place.
    ArrivalTime,
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

/// When checkpoints are written, each at the first step's end past its time, in
/// `<folder of the results>.checkpoints`. Without a time: every ten minutes of wall time. They change
/// no bit of the results.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Checkpoints {
    /// Simulated time from one to the next [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub every_seconds: Option<f64>,
    /// Steps from one to the next.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub every_steps: Option<u64>,
    /// Times [s], increasing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0.0}))]
    pub at_times: Vec<f64>,
    /// Wall time from one to the next [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub every_wall_seconds: Option<f64>,
    /// The last so many stay, after the end too; 0: none are written.
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

/// Profiles.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Profiles {
    /// Times [s], increasing, each met exactly; empty: the end alone.
    #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0.0}))]
    pub times: Vec<f64>,
}

/// Histories of faces, tracers, energies and momentum. The pressure of a face that is a free surface
/// is that of the surface: 0, or the deviator's xx component where the material has strength.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Histories {
    /// Time from one row to the next [s]; a row is taken at the first step's end past it.
    /// Absent: a two hundredth of the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub interval: Option<f64>,
    /// Particles that are followed.
    #[serde(default)]
    pub tracers: Vec<Tracer>,
}

/// A particle that is followed.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tracer {
    /// Name of its columns.
    pub name: String,
    /// Body it belongs to.
    pub body: String,
    /// The particle that starts nearest to this place is taken [m].
    pub at: Vec<f64>,
}

/// The exact solution that a run is held against.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Reference {
    /// A plate strikes a target (Burghardt 2010).
    FlyerImpact(FlyerImpact),
    /// Two ideal gases, the diaphragm removed at the start (Sod 1978).
    Riemann(Riemann),
    /// A body runs into a rigid wall or is driven by a piston: one steady shock.
    WallImpact(WallImpact),
    /// A piston whose velocity changes smoothly drives a body (Courant & Friedrichs 1948).
    SimpleWave(SimpleWave),
    /// The generalized vortex (Kamojjala et al. 2015): `displacement_l2`.
    Vortex(NamedBody),
    /// A free body that spins: `angular_momentum_loss`, `energy_loss`, `kinetic_energy_loss`.
    Rotation(NamedBody),
    /// A shear layer: `velocity_rms`.
    ShearLayer(NamedBody),
    /// Gresho's vortex: `velocity_rms`, `pressure_rms`, `pressure_form_rms`.
    Gresho(NamedBody),
    /// Noh's problem: `mean_density`, `mean_density_error`, `density_l1`.
    Noh(NamedNoh),
}

/// A body, whose first motion and material give the constants of the exact solution.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NamedBody {
    /// The body; profiles are scored in it.
    pub body: String,
}

/// Noh's problem in a body that starts with a `radial` velocity, or about an axis with a velocity
/// towards it.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NamedNoh {
    /// The body.
    pub body: String,
    /// What the gas closes in on.
    pub symmetry: NohSymmetry,
    /// Least and greatest distance from there between which the density is averaged [m].
    #[schemars(length(min = 2))]
    pub between: Vec<f64>,
}

/// What a gas closes in on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NohSymmetry {
    /// A plane, on a line.
    Planar,
    /// An axis: a point in plane strain, or the axis itself in axisymmetry.
    Cylindrical,
    /// A point on the axis, in axisymmetry.
    Spherical,
}

/// Two names of bodies; all else comes from them.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlyerImpact {
    /// The plate that strikes.
    pub flyer: String,
    /// The plate that is struck; profiles are scored in it.
    pub target: String,
    /// How the waves lie in a plane; absent: along x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front: Option<Front>,
}

/// Plane waves in a plane, and what of the material is scored against them.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Front {
    /// Angle from the x axis to the direction along which the waves run [degrees].
    #[serde(default)]
    pub angle: f64,
    /// A point on the line along which they are followed [m]; at an angle the interface passes
    /// through it.
    pub about: Vec<f64>,
    /// Particles nearer to that line than this are scored [m]; absent: all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub half_width: Option<f64>,
    /// Two places along the line, counted from `about`, between which they are scored [m];
    /// absent: everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
}

/// Two names of bodies that touch.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Riemann {
    /// The body on the lower side.
    pub left: String,
    /// The body on the upper side.
    pub right: String,
    /// How the waves lie in a plane; absent: along x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front: Option<Front>,
}

/// The body that the piston drives.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SimpleWave {
    /// The body.
    pub body: String,
}

/// The body that runs into the wall.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WallImpact {
    /// The body.
    pub body: String,
}
