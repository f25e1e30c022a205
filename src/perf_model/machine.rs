//! Measured constants of a machine, and their file.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::network::Network;
use super::schedule::method_name;
use crate::input::input_file;
use crate::scene::CheckedScene;

/// Counts of the computing in a step: own particles, those that do not stay in cache, ghost
/// particles, nodes, patches, and those whose arrays do not stay in a nearer cache.
pub const COMPUTE: [&str; 6] = ["row", "cold row", "ghost row", "node", "patch", "cold patch"];

/// Counts of packing, copying and unpacking in a step: particles examined, ghost particles, halo
/// nodes times fields, patches times exchanges, exchanges, and the step itself.
pub const SERIAL: [&str; 6] =
    ["row", "ghost row", "halo value", "patch and exchange", "exchange", "step"];

/// Seconds per count.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coefficients {
    /// In phases over patches, in the order of [`COMPUTE`] \[s\].
    pub compute: [f64; COMPUTE.len()],
    /// Between these phases, in the order of [`SERIAL`] \[s\].
    pub serial: [f64; SERIAL.len()],
    /// Effective cache sizes of one worker \[B\]: beyond the first its particles are cold, beyond
    /// the second its patches.
    pub cache: [f64; 2],
}

/// Slowdown of a core while others are busy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Busy {
    /// Number of busy cores in the measurement.
    pub cores: usize,
    /// Time of a step over that with one busy core, for particles that stay in cache \[-\].
    pub warm: f64,
    /// The same for particles that do not stay in cache \[-\].
    pub cold: f64,
}

/// The scheme for which the constants were measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SchemeCosts {
    /// Title of the scene.
    pub title: String,
    /// `method` of the scene.
    pub method: Value,
    /// `artificial_viscosity` of the scene.
    pub viscosity: Value,
    /// Equations of state of the materials.
    pub equations: Vec<String>,
}

/// Quality of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quality {
    /// Number of samples.
    pub samples: usize,
    /// Root mean square of the relative residuals \[-\].
    pub rms: f64,
    /// Largest relative residual \[-\].
    pub largest: f64,
}

/// Result of `flyer-mpm perf calibrate`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Version of the file format.
    pub format: u32,
    /// Name of the processor.
    pub processor: String,
    /// Cores that this process may use.
    pub cores: usize,
    /// The calibrated scheme.
    pub scheme: SchemeCosts,
    /// Seconds per count.
    pub coefficients: Coefficients,
    /// Slowdown by other busy cores.
    pub busy: Busy,
    /// Cost of one fork and join of the threads of a rank \[s\].
    pub fork_join: f64,
    /// Additional cost of a fork and join per patch \[s\].
    pub fork_patch: f64,
    /// Whether the costs of fork and join were measured.
    pub fork_measured: bool,
    /// Messages within the machine.
    pub network: Network,
    /// Number of ranks in the measurement of messages; 1: not measured.
    pub ranks: usize,
    /// Fit of whole steps on one thread.
    pub quality: Quality,
    /// Fit of the phases alone.
    pub compute_quality: Quality,
    /// Fit of steps on two threads.
    pub fork_quality: Quality,
}

/// Version of the file format that this program writes.
pub const FORMAT: u32 = 1;

/// A machine file that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum MachineError {
    /// The file is missing or not a machine file.
    #[error("{file}: {reason}")]
    File {
        /// The file.
        file: String,
        /// The error, and how to correct it.
        reason: String,
    },
    /// The file belongs to another method.
    #[error(
        "{file}: calibrated for `{there}`, but the scene has `{here}`{more}; \
         allowed: the file that `flyer-mpm perf calibrate` makes of this scene"
    )]
    Scheme {
        /// The file.
        file: String,
        /// Method of the file.
        there: String,
        /// Method of the scene.
        here: String,
        /// Other differences.
        more: String,
    },
}

impl SchemeCosts {
    /// The properties of a scene that determine the cost per particle.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn of(scene: &CheckedScene) -> Self {
        let json = |value: serde_json::Result<Value>| value.expect("a scene is plain data");
        let mut equations: Vec<String> = (0..scene.bodies.len())
            .filter_map(|b| {
                json(serde_json::to_value(scene.material_of(b))).pointer("/eos/type").cloned()
            })
            .map(|name| name.to_string().replace('"', ""))
            .collect();
        equations.sort();
        equations.dedup();
        SchemeCosts {
            title: scene.scene.title.clone(),
            method: json(serde_json::to_value(&scene.scene.method)),
            viscosity: json(serde_json::to_value(scene.scene.artificial_viscosity)),
            equations,
        }
    }

    fn name(&self) -> String {
        serde_json::from_value(self.method.clone()).map_or("?".into(), |m| method_name(&m))
    }
}

impl Machine {
    /// Reads a machine file.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or is not a valid machine file.
    pub fn read(path: &Path) -> Result<Self, MachineError> {
        let file = path.display().to_string();
        let fail = |reason: String| MachineError::File { file: file.clone(), reason };
        let bytes = input_file::read(path, input_file::LARGEST_JSON)
            .map_err(|e| fail(format!("{e}; `flyer-mpm perf calibrate SCENE.json` makes it")))?;
        let machine: Machine = serde_json::from_slice(&bytes).map_err(|e| {
            fail(format!("no machine file: {e}; `flyer-mpm perf calibrate` makes one"))
        })?;
        match machine.fault() {
            None => Ok(machine),
            Some(fault) => Err(fail(fault)),
        }
    }

    /// Describes the first invalid number, if there is one.
    fn fault(&self) -> Option<String> {
        if self.format != FORMAT {
            return Some(format!("format = {}; allowed: {FORMAT}, calibrate again", self.format));
        }
        if self.cores == 0 || self.busy.cores == 0 || self.ranks == 0 {
            return Some("cores, busy.cores or ranks = 0; allowed: at least 1".into());
        }
        let c = &self.coefficients;
        let numbers = c.compute.iter().chain(&c.serial).chain([
            &c.cache[0],
            &c.cache[1],
            &self.busy.warm,
            &self.busy.cold,
            &self.fork_join,
            &self.fork_patch,
            &self.network.latency,
            &self.network.seconds_per_byte,
            &self.network.overhead,
            &self.network.call,
            &self.network.reduction_level,
        ]);
        let mut bad = numbers.filter(|v| !(v.is_finite() && **v >= 0.0));
        bad.next().map(|v| format!("a constant is {v}; allowed: finite numbers from 0 on"))
    }

    /// Writes the file.
    ///
    /// # Errors
    ///
    /// If the file or its folder cannot be written.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn write(&self, path: &Path) -> std::io::Result<()> {
        if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder)?;
        }
        let text = serde_json::to_string_pretty(self).expect("constants are plain data");
        std::fs::write(path, text + "\n")
    }

    /// Checks that the constants are valid for `scene`; `file` is named in messages.
    ///
    /// # Errors
    ///
    /// If the constants are of another method, viscosity or equation of state.
    pub fn fits(&self, scene: &CheckedScene, file: &Path) -> Result<(), MachineError> {
        let (there, here) = (&self.scheme, SchemeCosts::of(scene));
        if (&there.method, &there.viscosity, &there.equations)
            == (&here.method, &here.viscosity, &here.equations)
        {
            return Ok(());
        }
        let more = match there.method == here.method {
            true => " with another viscosity or other materials".to_string(),
            false => String::new(),
        };
        let file = file.display().to_string();
        Err(MachineError::Scheme { file, there: there.name(), here: here.name(), more })
    }

    /// Slowdown of a core with `workers` busy cores in total on a node of this kind \[-\], for the
    /// fraction `cold` of cold particles \[-\].
    pub fn slowing(&self, workers: usize, cold: f64) -> f64 {
        let others = (self.busy.cores - 1).max(1) as f64;
        let share = ((workers.max(1) - 1) as f64 / others).min(1.0);
        let all = self.busy.warm + cold * (self.busy.cold - self.busy.warm);
        1.0 + share * (all - 1.0)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::input;

    fn flyer(sets: &[&str]) -> CheckedScene {
        let text = include_bytes!("../../inputs/flyer.json");
        let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
        input::parse(text, "flyer.json", &sets).unwrap()
    }

    /// Machine with round constants for the method of the flyer plate.
    pub fn machine() -> Machine {
        let quality = Quality { samples: 1, rms: 0.0, largest: 0.0 };
        Machine {
            format: FORMAT,
            processor: "a processor".into(),
            cores: 2,
            scheme: SchemeCosts::of(&flyer(&[])),
            coefficients: Coefficients {
                compute: [70e-9, 30e-9, 35e-9, 60e-9, 700e-9, 1e-6],
                serial: [2e-9, 40e-9, 2e-9, 10e-9, 150e-9, 1e-6],
                cache: [16e6, 4e6],
            },
            busy: Busy { cores: 2, warm: 1.1, cold: 1.5 },
            fork_join: 3e-6,
            fork_patch: 0.0,
            fork_measured: true,
            network: Network::assumed(),
            ranks: 1,
            quality,
            compute_quality: quality,
            fork_quality: quality,
        }
    }

    #[test]
    fn a_file_is_read_as_it_was_written_and_bad_ones_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/machine.json");
        machine().write(&path).unwrap();
        assert_eq!(Machine::read(&path).unwrap(), machine());
        let text = std::fs::read_to_string(&path).unwrap();
        for (from, to, said) in [
            ("\"format\": 1", "\"format\": 7", "format = 7; allowed: 1"),
            ("\"cores\": 2", "\"cores\": 0", "allowed: at least 1"),
            ("\"fork_join\": ", "\"fork_join\": -", "allowed: finite numbers from 0 on"),
            ("\"fork_join\"", "\"forks\"", "no machine file"),
            ("{", "", "no machine file"),
        ] {
            assert!(text.contains(from), "{from}");
            std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
            let error = Machine::read(&path).unwrap_err().to_string();
            assert!(error.contains(said) && !error.contains('\n'), "{error}");
        }
    }

    #[test]
    fn constants_belong_to_a_method() {
        let (machine, file) = (machine(), Path::new("m.json"));
        machine.fits(&flyer(&["domain.cell_size=5e-6", "time.end=2e-6"]), file).unwrap();
        for set in ["method.shape=cpdi", "artificial_viscosity.limiter=null"] {
            let error = machine.fits(&flyer(&[set]), file).unwrap_err().to_string();
            assert!(error.contains("m.json: calibrated for `cpdi_bspline_quadratic, fmpm 8"));
        }
    }

    #[test]
    fn busy_cores_slow_down_up_to_all_of_them() {
        let machine = Machine { busy: Busy { cores: 3, warm: 1.2, cold: 2.0 }, ..machine() };
        let at = |workers, cold| (machine.slowing(workers, cold) * 1e6).round() / 1e6;
        assert_eq!([at(1, 0.0), at(2, 0.0), at(3, 0.0), at(9, 0.0)], [1.0, 1.1, 1.2, 1.2]);
        assert_eq!([at(1, 1.0), at(3, 0.5), at(3, 1.0)], [1.0, 1.6, 2.0]);
    }
}
