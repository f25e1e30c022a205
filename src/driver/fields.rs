//! Fields as the run goes: when a frame is due, and the files that it goes to.

use std::path::Path;

use decomp::Comm;

use super::output::OutputError;
use super::output::csv::write_frame;
use super::output::field_files::{FIELDS_FOLDER, FieldFiles};
use super::output::vtkhdf::RunInfo;
use crate::scene::{CheckedScene, FieldOutput, FieldsFormat};
use crate::simulation::{Simulation, quantity_of};

/// The fields of a run; on all ranks.
pub struct FieldSeries<'a> {
    options: &'a FieldOutput,
    end: f64,
    /// Number of the next frame in the schedule.
    due: u64,
    /// Number of frames written.
    written: u64,
    files: Option<FieldFiles>,
}

impl<'a> FieldSeries<'a> {
    /// The fields of a run at its start; `None` if the scene asks for none.
    pub fn new(scene: &'a CheckedScene) -> Option<FieldSeries<'a>> {
        let options = scene.scene.output.fields.as_ref()?;
        Some(FieldSeries { options, end: scene.scene.time.end, due: 0, written: 0, files: None })
    }

    /// Opens the files in `folder`, which rank 0 names; the first `kept` frames are those of an earlier
    /// part of the run, which has reached `time` [s]. Collective.
    ///
    /// # Errors
    ///
    /// If the folder cannot be written; all ranks return an error.
    pub fn open(
        &mut self,
        comm: &dyn Comm,
        scene: &CheckedScene,
        folder: &Path,
        kept: Option<(u64, f64)>,
    ) -> Result<(), OutputError> {
        if let Some((written, time)) = kept {
            (self.written, self.due) = (written, self.after(time));
        }
        let rows = scene.particles as usize;
        let files = FieldFiles::open(comm, folder, rows, self.written as usize)?;
        self.files = Some(files);
        Ok(())
    }

    /// Number of frames written.
    pub fn written(&self) -> u64 {
        self.written
    }

    /// Time of frame number `k` of the schedule [s].
    fn time_of(&self, k: u64) -> Option<f64> {
        let time = match self.options.every {
            Some(every) => k as f64 * every,
            None => *self.options.times.get(k as usize)?,
        };
        // rounding of the last multiple must not lose it
        (time <= self.end * (1.0 + 1e-12)).then_some(time.min(self.end))
    }

    /// The number of the first frame whose time is after `time` [s].
    fn after(&self, time: f64) -> u64 {
        let mut k = match self.options.every {
            Some(every) => ((time / every) as u64).saturating_sub(1),
            None => 0,
        };
        while self.time_of(k).is_some_and(|due| due <= time) {
            k += 1;
        }
        k
    }

    /// Writes a frame if one is due at the end of a step. Collective.
    ///
    /// # Errors
    ///
    /// If a file cannot be written; all ranks return an error.
    ///
    /// # Panics
    ///
    /// If the files have not been [opened](FieldSeries::open).
    pub fn record<const D: usize>(
        &mut self,
        simulation: &Simulation<'_, D>,
        comm: &dyn Comm,
        scene: &CheckedScene,
        folder: &Path,
    ) -> Result<(), OutputError> {
        let time = simulation.time();
        if self.time_of(self.due).is_none_or(|due| time < due) {
            return Ok(());
        }
        let planned = match self.options.every {
            Some(every) => (self.end / every).floor() as u64 + 1,
            None => self.options.times.len() as u64,
        };
        let left = planned.saturating_sub(self.due) as usize;
        let quantities = self.options.quantities.as_deref();
        let wanted = |name: &str| match quantities {
            Some(quantities) => quantities.iter().any(|q| q == quantity_of(name)),
            None => name != crate::simulation::HALF_EDGES,
        };
        let share = simulation.share(&|name| ["x", "y"].contains(&name) || wanted(name));
        if self.options.format != FieldsFormat::Csv {
            let value = serde_json::to_value(&scene.scene).expect("a scene is plain data");
            let bodies: Vec<String> = scene.scene.bodies.iter().map(|b| b.name.clone()).collect();
            let info = RunInfo {
                title: &scene.scene.title,
                scene: &value,
                materials: &share.materials,
                bodies: &bodies,
                axisymmetric: scene.axisymmetric(),
            };
            self.files.as_mut().expect("opened at the start").add(comm, &share, left, &info)?;
        }
        if self.options.format != FieldsFormat::Vtkhdf {
            let path = folder.join(FIELDS_FOLDER).join(format!("frame_{:06}.csv", self.written));
            write_frame(comm, &path, &share)?;
        }
        self.written += 1;
        self.due = self.after(time);
        Ok(())
    }
}
