//! Check whether a checkpoint fits a scene that may have been changed since.

use std::path::Path;

use super::{Checkpoint, CheckpointError};
use crate::driver::output::histories::HistoryTable;
use crate::driver::probes::Probes;
use crate::effects;
use crate::scene::CheckedScene;
use crate::simulation::saved_sums;

/// Keys that may change at a restart.
pub const CHANGEABLE: [&str; 5] = ["time", "monitor", "output", "domain.patches", "decomposition"];

impl Checkpoint {
    /// Refuses a scene with which a run cannot restart from this checkpoint, whatever its particles
    /// ([`Checkpoint::fit_share`]). Drops records that the scene no longer asks for. Called on rank 0.
    ///
    /// # Errors
    ///
    /// The first difference between the scene and the checkpoint that prevents a restart.
    pub fn fit(&mut self, scene: &CheckedScene, path: &Path) -> Result<(), CheckpointError> {
        let why = self.check_columns(scene).or_else(|| self.check_record(scene));
        why.map_or(Ok(()), |why| Err(CheckpointError::Unfit { path: path.into(), why }))
    }

    /// Refuses particles of this rank's share that cannot be those of the scene; whether all are there
    /// is known when all ranks have theirs.
    ///
    /// # Errors
    ///
    /// If a particle is not one of the scene.
    pub fn fit_share(&self, scene: &CheckedScene) -> Result<(), CheckpointError> {
        match self.check_rows(scene) {
            true => Ok(()),
            false => Err(CheckpointError::Unfit {
                path: "the checkpoint".into(),
                why: "its particles are not those of its scene".into(),
            }),
        }
    }

    /// An error in the columns of the particles or in the scalar values, if any.
    fn check_columns(&self, scene: &CheckedScene) -> Option<String> {
        let columns = effects::columns(scene);
        let state = columns.state();
        let named = |k: &usize| columns.specs[*k].name;
        if !self.columns.iter().map(|c| c.name.as_str()).eq(state.iter().map(named)) {
            let theirs: Vec<&str> = self.columns.iter().map(|c| c.name.as_str()).collect();
            return Some(format!(
                "its particles have the columns {}, not those of the scene; continue with version {}, \
                 which wrote it",
                theirs.join(", "),
                self.version
            ));
        }
        if self.saved.sums.len() != saved_sums(scene) || self.dimension != scene.dimension {
            return Some("its sums are not those of its scene".into());
        }
        let saved = &self.saved;
        let numbers =
            saved.time >= 0.0 && saved.stable > 0.0 && (0.0..1e3).contains(&saved.longest);
        (!numbers).then(|| "its time or its steps are none".into())
    }

    /// Whether each particle may be one of the scene.
    fn check_rows(&self, scene: &CheckedScene) -> bool {
        let (columns, rows) = (effects::columns(scene), &self.saved.particles);
        let state = columns.state();
        let (count, dimension) = (rows.ids.len(), scene.dimension);
        let counts = rows.ids.iter().all(|&id| id < scene.particles)
            && rows.columns.len() == state.len()
            && rows.columns.iter().all(|c| c.len() == count);
        let cells = rows.cells.len() == dimension * count
            && rows.cells.chunks_exact(dimension).all(|cell| {
                cell.iter().zip(&scene.cells).all(|(&c, &n)| c >= 0 && (c as usize) < n)
            });
        let body = state.iter().position(|&k| k == columns.body);
        let bodies = body.is_some_and(|k| {
            let known =
                |b: &f64| *b >= 0.0 && b.fract() == 0.0 && (*b as usize) < scene.bodies.len();
            rows.columns.get(k).is_some_and(|column| column.iter().all(known))
        });
        counts && cells && bodies
    }

    /// An error in the records, if any; drops records that the scene no longer asks for.
    fn check_record(&mut self, scene: &CheckedScene) -> Option<String> {
        let (time, end) = (self.saved.time, scene.scene.time.end);
        if time > end {
            return Some(format!("its time {time:e} s is beyond time.end = {end:e}"));
        }
        self.record.tables.retain(|(table, _)| scene.profile_times.contains(&table.time));
        let past: Vec<f64> = scene.profile_times.iter().copied().filter(|&t| t <= time).collect();
        let recorded = |t: &f64| self.record.tables.iter().any(|(table, _)| table.time == *t);
        if let Some(missed) = past.iter().find(|t| !recorded(t)) {
            return Some(format!(
                "output.profiles.times: {missed:e} is before its time {time:e} s and was not \
                 recorded; allowed: later times"
            ));
        }
        let wanted = Probes::new(scene).map(Probes::into_histories);
        let names =
            |h: &HistoryTable| h.columns().iter().map(|c| c.name.clone()).collect::<Vec<_>>();
        match (&wanted, &self.record.histories) {
            (Some(wanted), Some(have)) if names(wanted) != names(have) => Some(
                "output.histories: other columns than so far; allowed: the same tracers".into(),
            ),
            (None, _) => {
                self.record.histories = None;
                None
            }
            _ => None,
        }
    }
}
