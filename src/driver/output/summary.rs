//! `summary.json`: settings, costs, conserved quantities and errors of a run.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::decomposition::DecompositionSummary;
use super::error::{OutputError, read_text};
use super::file_names::SUMMARY_FILE;
use super::gauges::GaugeReading;
use super::origin::Origin;
use crate::accuracy::estimate::EstimatedErrors;
use crate::accuracy::plan::Verdict;
use crate::effects::EffectUse;
use crate::input::input_file::LARGEST_NUMBERS;
use crate::scene::MethodChoice;

/// Format of `summary.json`, increased by one whenever a key is renamed.
pub const SUMMARY_FORMAT: u32 = 2;

/// Contents of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Format of this file.
    pub format: u32,
    /// Title of the scene.
    pub title: String,
    /// Version of the program.
    pub version: String,
    /// Commit of its sources; absent if the build did not set it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// Processor of the machine of rank 0, and the cores that rank 0 may use.
    #[serde(default)]
    pub machine: String,
    /// The command and the scene file that made the result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin: Option<Origin>,
    /// The scene as run, with `--set` and defaults applied.
    pub scene: Value,
    /// Choice of the method; absent if the scene gives it in full.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub method_choice: Option<MethodChoice>,
    /// Number of ranks.
    pub ranks: usize,
    /// Threads per rank.
    pub threads: usize,
    /// Number of patches in each direction.
    pub patches: Vec<usize>,
    /// Number of particles at the start.
    pub particles: u64,
    /// Number of cells of the domain.
    pub cells: u64,
    /// Number of steps of the time loop.
    pub steps: u64,
    /// Wall time of the whole process up to the writing of this file \[s\].
    pub wall_seconds: f64,
    /// Wall time of the time loop \[s\].
    pub loop_wall_seconds: f64,
    /// User CPU time of the time loop, sum over all ranks \[s\].
    #[serde(default)]
    pub loop_cpu_seconds: f64,
    /// User CPU time, sum over all ranks \[s\].
    pub cpu_seconds: f64,
    /// Particles times steps, quiescent ones included, over the CPU time of the time loop of all
    /// ranks \[1/s\].
    pub particle_steps_per_cpu_second: f64,
    /// Wall time of the time loop by activity, summed over the ranks \[s\].
    pub phase_seconds: BTreeMap<String, f64>,
    /// Costs of the distribution over ranks.
    pub decomposition: DecompositionSummary,
    /// The ledger of effects: the effects that the scene uses, and the costs of each.
    pub effects: Vec<EffectUse>,
    /// Energy.
    pub energy: Energy,
    /// Momentum.
    pub momentum: Momentum,
    /// Particles that have left the domain; absent if none can leave.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outflow: Option<OutflowSummary>,
    /// Eroded particles; absent without erosion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub erosion: Option<OutflowSummary>,
    /// Failed and damaged particles; absent without failure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<FailureSummary>,
    /// Physical quantities beside their exact values, if these are known.
    #[serde(default)]
    pub measured: Vec<MeasuredQuantity>,
    /// Readings of the gauges and probes of the histories.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gauges: Vec<GaugeReading>,
    /// One entry per profile, in order of time.
    pub profiles: Vec<ProfileSummary>,
    /// The run's own estimate of its errors; absent unless the scene asks for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_estimate: Option<EstimatedErrors>,
    /// Predicted and actual values of a plan; absent without a plan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<Verdict>,
    /// Warnings to the user, one line each.
    pub warnings: Vec<String>,
}

/// Energies of all particles. All fields but the drift are in \[J/m2\] in one dimension (per area),
/// in \[J/m\] in two (per thickness), and in \[J\] per radian with axial symmetry.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Energy {
    /// Kinetic energy at the start, in the unit of [`Energy`].
    pub kinetic_start: f64,
    /// Internal energy at the start, in the unit of [`Energy`].
    pub internal_start: f64,
    /// Sum of kinetic and internal energy at the start, in the unit of [`Energy`].
    pub total_start: f64,
    /// Kinetic energy at the end, in the unit of [`Energy`].
    pub kinetic_end: f64,
    /// Internal energy at the end, in the unit of [`Energy`].
    pub internal_end: f64,
    /// Sum of kinetic and internal energy at the end, in the unit of [`Energy`].
    pub total_end: f64,
    /// Work of the boundaries on the particles, minus the energy of removed particles, in the unit
    /// of [`Energy`].
    pub boundary_work: f64,
    /// Work of a body force, in the unit of [`Energy`]; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body_force_work: Option<f64>,
    /// (total_end - total_start - all work) / total_start \[-\]; if total_start is 0, relative to
    /// total_end; null if both are 0.
    pub drift: Option<f64>,
}

impl Energy {
    /// Totals and drift from kinetic and internal energy, each at \[start, end\], and the work of
    /// the boundaries. There is no drift if the energy does not exceed the rounding error
    /// `rounding`. All arguments are in the unit of [`Energy`].
    pub fn new(kinetic: [f64; 2], internal: [f64; 2], boundary_work: f64, rounding: f64) -> Energy {
        let [total_start, total_end] = [kinetic[0] + internal[0], kinetic[1] + internal[1]];
        let scale = if total_start == 0.0 { total_end } else { total_start }.abs();
        Energy {
            kinetic_start: kinetic[0],
            internal_start: internal[0],
            total_start,
            kinetic_end: kinetic[1],
            internal_end: internal[1],
            total_end,
            boundary_work,
            body_force_work: None,
            drift: ratio(
                total_end - total_start - boundary_work,
                if scale > rounding { scale } else { 0.0 },
            ),
        }
    }

    /// The same with the work of a body force; both arguments are in the unit of [`Energy`].
    pub fn with_body_force(self, work: f64, rounding: f64) -> Energy {
        let kinetic = [self.kinetic_start, self.kinetic_end];
        let internal = [self.internal_start, self.internal_end];
        let drift = Energy::new(kinetic, internal, self.boundary_work + work, rounding).drift;
        Energy { body_force_work: Some(work), drift, ..self }
    }
}

/// Momentum of all particles. All fields but the drift are in \[kg/(m s)\] in one dimension (per
/// area), in \[kg/s\] in two (per thickness), and in \[kg m/s\] per radian with axial symmetry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Momentum {
    /// Momentum at the start, D components, in the unit of [`Momentum`].
    pub start: Vec<f64>,
    /// Momentum at the end, D components, in the unit of [`Momentum`].
    pub end: Vec<f64>,
    /// Impulse of the boundaries on the particles, minus the momentum of removed particles, D
    /// components, in the unit of [`Momentum`].
    pub boundary_impulse: Vec<f64>,
    /// Impulse of a body force, D components, in the unit of [`Momentum`]; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body_force_impulse: Option<Vec<f64>>,
    /// |end - start - all impulses| over the sum of m|v| at the start \[-\]; signed in one
    /// dimension; null if that sum is 0.
    pub drift: Option<f64>,
}

impl Momentum {
    /// Drift from the momentum at start and end, the impulse of the boundaries and the sum `scale`
    /// of m|v| at the start. All arguments are in the unit of [`Momentum`]; the first three have D
    /// components.
    pub fn new(start: &[f64], end: &[f64], boundary_impulse: &[f64], scale: f64) -> Momentum {
        let left = |i: usize| end[i] - start[i] - boundary_impulse[i];
        let left = match start.len() {
            1 => left(0),
            d => (0..d).map(|i| left(i) * left(i)).sum::<f64>().sqrt(),
        };
        Momentum {
            start: start.into(),
            end: end.into(),
            boundary_impulse: boundary_impulse.into(),
            body_force_impulse: None,
            drift: ratio(left, scale),
        }
    }

    /// The same with the impulse of a body force, D components; `scale` is the sum of m|v| at the
    /// start. Both are in the unit of [`Momentum`].
    pub fn with_body_force(self, impulse: &[f64], scale: f64) -> Momentum {
        let all: Vec<f64> = self.boundary_impulse.iter().zip(impulse).map(|(a, b)| a + b).collect();
        let drift = Momentum::new(&self.start, &self.end, &all, scale).drift;
        Momentum { body_force_impulse: Some(impulse.into()), drift, ..self }
    }
}

/// Particles that have left the domain through open sides, or were eroded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutflowSummary {
    /// Number of particles.
    pub particles: u64,
    /// Mass of these particles \[kg/m2\] in one dimension, \[kg/m\] in two, \[kg\] per radian with
    /// axial symmetry.
    pub mass: f64,
    /// Momentum of these particles, D components, in the unit of [`Momentum`].
    pub momentum: Vec<f64>,
    /// Kinetic and internal energy of these particles, in the unit of [`Energy`].
    pub energy: f64,
}

/// Failed and damaged particles at the end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailureSummary {
    /// Number of particles that are present and carry neither tension nor shear any more.
    pub particles: u64,
    /// Number of particles that are present with a damage between 0 and 1.
    #[serde(default)]
    pub damaged: u64,
    /// Elastic energy that was converted to heat in these particles, in the unit of [`Energy`].
    pub released_energy: f64,
}

/// A physical quantity of a run beside its exact value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredQuantity {
    /// Name in words.
    pub name: String,
    /// SI unit of the values.
    pub unit: String,
    /// Time at which it was measured \[s\].
    pub time: f64,
    /// Computed value, in the unit of the field `unit`.
    pub value: f64,
    /// Exact value, in the unit of the field `unit`; absent if it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exact: Option<f64>,
}

/// Entry of one profile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProfileSummary {
    /// Time \[s\].
    pub time: f64,
    /// File of the profile, relative to the folder of results.
    pub file: String,
    /// SHA-256 of the whole state of the particles in order of their ids, in hexadecimal.
    pub state_sha256: String,
    /// Errors of the raw profile, as fractions; absent without a reference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub errors: Option<Value>,
    /// Errors after averaging over cells, as fractions; absent without a reference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub errors_cell_averaged: Option<Value>,
}

impl ProfileSummary {
    /// The error `name` of the raw profile, in the unit of [`crate::exact::Errors`]; `None` if
    /// undefined.
    pub fn error(&self, name: &str) -> Option<f64> {
        self.errors.as_ref()?.get(name)?.as_f64()
    }
}

impl Summary {
    /// Writes `summary.json` into `folder`.
    ///
    /// # Errors
    ///
    /// If the file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let path = folder.join(SUMMARY_FILE);
        let mut text = serde_json::to_string_pretty(self)
            .map_err(|source| OutputError::Json { path: path.clone(), source })?;
        text.push('\n');
        fs::write(&path, text).map_err(OutputError::io("write the file", &path))
    }

    /// Reads `summary.json` of `folder`.
    ///
    /// # Errors
    /// If the file cannot be read, is not a summary, or has another format than [`SUMMARY_FORMAT`].
    pub fn read(folder: &Path) -> Result<Summary, OutputError> {
        let path = folder.join(SUMMARY_FILE);
        // the file contains the scene with the positions and tables that were read for it
        let text = read_text(&path, LARGEST_NUMBERS)?;
        let json = |source| OutputError::Json { path: path.clone(), source };
        let value: Value = serde_json::from_str(&text).map_err(json)?;
        let format = value.get("format").and_then(Value::as_u64).unwrap_or(1);
        if format != u64::from(SUMMARY_FORMAT) {
            return Err(OutputError::Format { path, format, read: SUMMARY_FORMAT });
        }
        serde_json::from_value(value).map_err(json)
    }
}

/// a/b; `None` if b is 0.
fn ratio(a: f64, b: f64) -> Option<f64> {
    (b != 0.0).then(|| a / b)
}

#[cfg(test)]
pub(super) mod tests {
    use serde_json::json;

    use super::*;
    use crate::driver::output::decomposition::RankSummary;
    use crate::scene::FilterHalo;

    /// A decomposition of two ranks.
    fn decomposition() -> DecompositionSummary {
        let rank = |rank, particle_steps| RankSummary {
            rank,
            patches: 2,
            particles: 850,
            particle_steps,
            particle_steps_skipped: 500,
            seconds: [("compute", 0.6), ("wait", 0.1)].map(|(n, s)| (n.to_owned(), s)).into(),
            cpu_seconds: 0.7,
            bytes: 26_120_000,
            messages: 5224,
            output_bytes_received: 4000,
            particles_migrated: 7,
            patches_moved: rank as u64,
        };
        let options = crate::scene::Decomposition::default();
        let ranks = vec![rank(0, 2000), rank(1, 1000)];
        DecompositionSummary::new(FilterHalo::Redundant, &options, 2612, 1800, 1, ranks)
    }

    #[test]
    fn ranks_add_up() {
        let all = decomposition();
        assert_eq!((all.particle_steps_computed, all.particle_steps_skipped), (3000, 1000));
        assert_eq!((all.imbalance, all.patches_moved, all.particles_migrated), (1.2, 1, 14));
        assert_eq!((all.bytes_per_step, all.messages_per_step), (20_000.0, 4.0));
        assert_eq!(all.seconds()["compute"], 1.2);
    }

    /// A summary with two profiles; only the first has errors.
    pub(in super::super) fn example() -> Summary {
        let profile = |time: f64, errors: Option<Value>| ProfileSummary {
            time,
            file: format!("profile_{:.3}us.csv", time * 1e6),
            state_sha256: "00ff".into(),
            errors: errors.clone(),
            errors_cell_averaged: errors,
        };
        Summary {
            title: "flyer".into(),
            format: SUMMARY_FORMAT,
            version: "0.1.0".into(),
            commit: None,
            machine: "processor, 2 cores".into(),
            origin: None,
            scene: json!({"domain": {"lower": [0.0]}}),
            method_choice: None,
            ranks: 2,
            threads: 1,
            patches: vec![4],
            particles: 1700,
            cells: 1000,
            steps: 2612,
            wall_seconds: 1.25,
            loop_wall_seconds: 0.75,
            loop_cpu_seconds: 1.0,
            cpu_seconds: 2.0,
            particle_steps_per_cpu_second: 5.9e6,
            phase_seconds: [("compute".to_owned(), 0.5)].into(),
            decomposition: decomposition(),
            effects: vec![
                EffectUse {
                    effect: "strength".into(),
                    active: true,
                    columns: vec!["plastic_strain".into()],
                    bytes_per_particle: 8,
                    bytes_per_ghost: 0,
                    step_share: Some(0.125),
                },
                EffectUse {
                    effect: "contact".into(),
                    active: false,
                    columns: Vec::new(),
                    bytes_per_particle: 0,
                    bytes_per_ghost: 0,
                    step_share: Some(0.0),
                },
            ],
            energy: Energy::new([10.0, 4.0], [0.0, 7.0], 0.5, 0.0),
            momentum: Momentum::new(&[8.0], &[8.0], &[0.0], 8.0),
            outflow: None,
            erosion: None,
            failure: None,
            measured: vec![MeasuredQuantity {
                name: "shock speed".into(),
                unit: "m/s".into(),
                time: 1e-6,
                value: 6343.5,
                exact: Some(6343.0),
            }],
            gauges: vec![GaugeReading {
                gauge: "rear".into(),
                quantity: "arrival".into(),
                unit: "s".into(),
                value: 3e-7,
                time: None,
            }],
            profiles: vec![
                profile(5e-7, Some(json!({"l1": 0.0089, "plateau": -1e-5, "noise": null}))),
                profile(1e-6, None),
            ],
            error_estimate: None,
            plan: None,
            warnings: vec!["linear shape functions ring across cells".into()],
        }
    }

    #[test]
    fn drifts_are_what_is_left_when_boundaries_are_booked() {
        let summary = example();
        assert_eq!(summary.energy.drift, Some(0.05));
        let momentum = Momentum::new(&[1.0, 0.0], &[4.5, 4.0], &[0.5, 0.0], 10.0);
        assert_eq!(momentum.drift, Some(0.5));
        assert_eq!(Momentum::new(&[0.0], &[0.0], &[0.0], 0.0).drift, None);
        assert_eq!(Energy::new([0.0, 3.0], [0.0, 1.0], 3.0, 0.0).drift, Some(0.25));
        assert_eq!(Energy::new([0.0; 2], [0.0; 2], 0.0, 0.0).drift, None);
        // a body colder than its reference has a negative energy
        assert_eq!(Energy::new([1.0; 2], [-5.0, -4.0], 0.0, 0.0).drift, Some(0.25));
        assert_eq!(Energy::new([0.0; 2], [0.0, 1e-11], 0.0, 1e-9).drift, None);
    }

    #[test]
    fn comes_back_from_its_file() {
        let home = tempfile::tempdir().unwrap();
        let summary = example();
        summary.write(home.path()).unwrap();
        assert_eq!(Summary::read(home.path()).unwrap(), summary);
        let text = fs::read_to_string(home.path().join(SUMMARY_FILE)).unwrap();
        let value: Value = serde_json::from_str(&text).unwrap();
        assert!(value["profiles"][1].get("errors").is_none());
        assert_eq!(summary.profiles[0].error("l1"), Some(0.0089));
        assert_eq!(summary.profiles[0].error("noise"), None);
        let missing = Summary::read(&home.path().join("none")).unwrap_err().to_string();
        assert!(missing.contains("none/summary.json: cannot read the file"), "{missing}");
    }
}
