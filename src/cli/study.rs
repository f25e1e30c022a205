//! The command `study`.

use std::path::Path;

use flyer_mpm::driver::output::lock::Lock;
use flyer_mpm::driver::output::origin::{Origin, claim};
use flyer_mpm::study::{self, CHOICES_FILE, Study, StudyError, StudyRunner, TABLE_FILE};

use crate::{FAILED, Outcome, bad};

/// Runs a study; returns a text about its results.
pub fn study(file: &Path, output: Option<&Path>, quiet: bool) -> Outcome<String> {
    let study = Study::read(file).map_err(bad)?;
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = output.map_or(Path::new("output/studies").join(name), Path::to_path_buf);
    let _lock = Lock::take(&folder).map_err(bad)?;
    claim(&folder, &Origin::new("study", file)).map_err(bad)?;
    let program = std::env::current_exe().map_err(|e| (FAILED, e.to_string()))?;
    let runner = StudyRunner { program, folder, quiet };
    let rows = study::run(&study, &runner).map_err(|error| match error {
        StudyError::Study { .. } => bad(error),
        error => (FAILED, error.to_string()),
    })?;
    if quiet {
        return Ok(String::new());
    }
    let failed: Vec<_> = rows.iter().filter(|row| row.record.failure.is_some()).collect();
    let mut text = format!("{}: {} cases, {} failed\n", study.title, rows.len(), failed.len());
    for row in &failed {
        let reason = row.record.failure.as_deref().unwrap_or_default();
        text += &format!("  {}: {reason}\n", row.name(&labels(&study)));
    }
    if study.convergence.is_some() && rows.iter().all(|row| row.histories.is_none()) {
        text += "  the reference case has failed: no case has the error `histories`\n";
    }
    if study.choices.is_some() {
        let path = runner.folder.join(CHOICES_FILE);
        text += &std::fs::read_to_string(&path).unwrap_or_default();
    }
    text += &format!("results {}\n", runner.folder.join(TABLE_FILE).display());
    Ok(text)
}

fn labels(study: &Study) -> Vec<String> {
    study.labels().into_iter().map(String::from).collect()
}
