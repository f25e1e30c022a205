//! Output files, and the exact solution with which a run is compared.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::planned_quantity::PlannedQuantity;

/// Output files of a run.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Times of the profiles; a profile is a table of the state of every particle at one time.
    pub profiles: Profiles,
    /// Fields: quantities of all particles at many times, for pictures and films; absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fields: Option<FieldOutput>,
    /// Quantities of faces, tracers and gauges, energies and momentum over time, written to
    /// `histories.csv`; absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub histories: Option<Histories>,
    /// Checkpoints, from which a run can be restarted; absent: one every ten minutes of wall time,
    /// of which the last two are kept and deleted after a successful run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checkpoint: Option<Checkpoints>,
    /// Whether the run writes its profiles to `results.hdf5`, for ParaView and Python; default
    /// true.
    pub hdf5: bool,
    /// Whether the run draws its pictures (PNG and SVG); default true.
    pub pictures: bool,
    /// Quantities of which a run on a line draws an x-t diagram besides that of the pressure, such as
    /// `velocity`, `density`, `temperature`, `damage`; of `stress` and `strain` the component along x.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub diagrams: Vec<String>,
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
    /// Relative error that the plan was to reach [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub wanted: f64,
    /// Predicted relative error of the quantity [-].
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
            fields: None,
            histories: None,
            checkpoint: None,
            hdf5: true,
            pictures: true,
            diagrams: Vec::new(),
            plan: None,
        }
    }
}

/// Fields of all particles at many times. A frame is written at the end of the first step past its
/// time, as the run goes, so that a run that fails, stops or is killed leaves all frames until then in
/// `<folder of the results>.unfinished`. Frames change no bit of the results. Either `every` or `times`
/// is needed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FieldOutput {
    /// Simulated time between two frames [s]; the first frame is at time 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub every: Option<f64>,
    /// Simulated times of the frames [s], increasing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("items" = {"type": "number", "minimum": 0.0}))]
    pub times: Vec<f64>,
    /// Quantities, such as `velocity`, `pressure`, `density`, `specific_internal_energy`, `stress`,
    /// `strain`, `mass`, `failed`; absent: all that the scene has. Position, `particle_id`, `material`
    /// and `body` are always there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quantities: Option<Vec<String>>,
    /// Format of the files; default `vtkhdf`.
    pub format: FieldsFormat,
}

/// Format of fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FieldsFormat {
    /// `fields.vtkhdf` with all frames, for ParaView and VTK; its data are in the folder `fields`.
    #[default]
    Vtkhdf,
    /// A table for each frame in the folder `fields`, in order of the particles' numbers.
    Csv,
    /// Both `vtkhdf` and `csv`.
    Both,
}

/// Checkpoint schedule. A checkpoint is written at the end of the first step past its time, to
/// `<folder of the results>.checkpoints`. If no key gives a time: every ten minutes of wall time.
/// Checkpoints change no bit of the results.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Checkpoints {
    /// Simulated time between two checkpoints [s]; absent: none at simulated intervals.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub every_seconds: Option<f64>,
    /// Number of steps between two checkpoints; absent: none at intervals of steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub every_steps: Option<u64>,
    /// Simulated times at which checkpoints are written [s], increasing; absent: none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0.0}))]
    pub at_times: Vec<f64>,
    /// Wall time between two checkpoints [s]; 600 if no other key gives a time.
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
    /// Largest number of particles for which a profile has each particle. With more particles it
    /// has means over about as many blocks of cells. Default: 1e6 on a line, 2e5 in a plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub max_particles: Option<u64>,
    /// Time between profiles [s], from time 0, instead of `times`; there is also a profile at the
    /// end of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub every: Option<f64>,
    /// Times [s], increasing; time steps end exactly at them. Empty (default): only the end of the
    /// run.
    #[schemars(extend("items" = {"type": "number", "minimum": 0.0}))]
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
    /// Gauges at points fixed in space; default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stations: Vec<Station>,
    /// Velocities of surfaces as an interferometer records them; default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub velocimeters: Vec<Velocimeter>,
    /// Planes across which mass, momentum and impulse are counted; default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<GaugePlane>,
}

/// A gauge at a point fixed in space. Its velocity, pressure and density are means over the particles
/// within one cell of the point, weighted by their mass and by 1 - |distance| / cell in each direction;
/// empty where there is no particle.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Station {
    /// Name with which its columns in `histories.csv` begin.
    pub name: String,
    /// Coordinates of the point, one number per direction [m].
    pub at: Vec<f64>,
}

/// An interferometer (VISAR) at a surface of a body, free or behind a window.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Velocimeter {
    /// Name with which its columns in `histories.csv` begin.
    pub name: String,
    /// Name of the body whose surface is measured.
    pub body: String,
    /// Initial position on the surface [m]; the nearest particle is followed. On a line, at a face
    /// of the body, the edge of this particle is followed.
    pub at: Vec<f64>,
    /// Velocity per fringe [m/s] (Barker & Hollenbach 1972); adds a column with the number of fringes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub fringe: Option<f64>,
    /// Relative change of the Doppler shift by a window [-] (Wackerle, Stacy & Dallman 1987): the
    /// fringes are those of a velocity 1 + `window_correction` times as large; default 0.
    #[serde(default)]
    pub window_correction: f64,
}

/// A plane normal to an axis, fixed in space. The momentum of the material beyond it changes by the
/// impulse that crosses the plane, as long as no side acts beyond it.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GaugePlane {
    /// Name with which its columns in `histories.csv` begin.
    pub name: String,
    /// Axis to which the plane is normal; default x.
    #[serde(default)]
    pub axis: GaugeAxis,
    /// Position of the plane along its axis [m].
    pub at: f64,
}

/// Axis of a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GaugeAxis {
    /// Along x.
    #[default]
    X,
    /// Along y.
    Y,
}

/// A particle whose history is recorded.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tracer {
    /// Name with which its columns in `histories.csv` begin.
    pub name: String,
    /// Name of the body to which the particle belongs.
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
    /// Name of the body whose profiles are compared with the exact solution.
    pub body: String,
}

/// Noh's problem in a body with an initial `radial` velocity, or with an initial velocity towards
/// the axis of an axisymmetric domain.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NamedNoh {
    /// Name of the body of gas.
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
    /// Name of the body that is struck; its profiles are compared with the exact solution.
    pub target: String,
    /// Direction of the waves in a plane; absent: along x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front: Option<Front>,
}

/// Direction of plane waves in a plane, and the region whose particles are compared with the exact
/// solution.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Front {
    /// Angle from the x axis to the direction of wave propagation [degrees]; default 0.
    #[serde(default)]
    pub angle: f64,
    /// A point on the line along which the waves are followed [m]; at an angle other than 0 the
    /// interface passes through it.
    pub about: Vec<f64>,
    /// Half width of the strip along the line [m]: only particles nearer to the line are compared
    /// with the exact solution; absent: all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub half_width: Option<f64>,
    /// Two positions along the line, measured from `about` [m]; only particles between them are
    /// compared with the exact solution. Absent: everywhere.
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
    /// Name of the body that the piston drives.
    pub body: String,
}

/// The body that runs into the wall.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WallImpact {
    /// Name of the body that runs into the wall, or that the piston drives.
    pub body: String,
}
