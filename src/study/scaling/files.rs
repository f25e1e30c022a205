//! The files of a scaling study: a CSV, the same numbers as JSON, a picture.

use std::fs;
use std::path::Path;

use super::error::ScalingError;
use super::kind::ScalingKind;
use super::picture;
use super::study::ScalingStudy;
use crate::plot;

/// Meaning of the columns of the CSV.
const COLUMNS: &str = "\
# One row per configuration: medians over the repeats, which were run in turn.
# ranks, threads, workers = ranks * threads; skip_quiescent: patches at rest were skipped.
# oversubscribed: more workers than cores; binding: core, none, oversubscribed.
# patches, particles, steps of the run.
# wall_seconds, _min, _max: wall time of the time loop [s]; cpu_seconds: user CPU time of all
#   ranks, set-up and files included [s].
# worker_seconds_per_particle_step = wall_seconds * workers / (particles * steps) [s].
# efficiency: that number of 1 x 1, with the same skip_quiescent, over the row's; speed_up: efficiency
#   times workers.
# compute, exchange, migrate, balance, wait, output, rest: shares of the wall time of all ranks.
# predicted_seconds: the wall time by the performance model, empty without constants of a machine;
#   predicted_bytes_per_step, predicted_messages_per_step: without outputs.
# bytes_per_step, messages_per_step: sent by all ranks; imbalance: work of the busiest rank over
#   the mean; skipped: share of particle-steps. Empty if the program does not count it.
";

/// Writes the CSV, `scaling.json` and the picture of a study into `folder`.
///
/// # Errors
///
/// If a file cannot be written, or if the picture cannot be drawn.
pub fn write(study: &ScalingStudy, folder: &Path) -> Result<(), ScalingError> {
    let save = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        fs::write(&path, bytes).map_err(ScalingError::io(&path))
    };
    let name = format!("{}.csv", study.kind.name());
    let csv = table(study).map_err(ScalingError::format(&folder.join(&name)))?;
    save(&name, &csv)?;
    let json = serde_json::to_string_pretty(study);
    let json = json.map_err(ScalingError::format(&folder.join("scaling.json")))? + "\n";
    save("scaling.json", json.as_bytes())?;
    plot::draw(&picture::figure(study), &folder.join("scaling"))?;
    Ok(())
}

/// The CSV; comments at its head explain it.
fn table(study: &ScalingStudy) -> Result<Vec<u8>, csv::Error> {
    let fixed = match study.kind {
        ScalingKind::Strong => "the same scene on every row",
        ScalingKind::Weak => {
            "cell size and end divided by workers: particles per worker and steps are kept"
        }
    };
    let head = format!(
        "# {}: {fixed}\n# scene: {} ({}), --set {:?}\n# machine: {} cores, {}\n# repeats: {}\n",
        study.kind.name(),
        study.title,
        study.scene.display(),
        study.sets,
        study.cores,
        study.processor,
        study.repeats,
    );
    let mut writer = csv::Writer::from_writer((head + COLUMNS).into_bytes());
    for row in &study.rows {
        writer.serialize(row)?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}

#[cfg(test)]
mod tests {
    use super::super::row::ScalingRow;
    use super::super::row::tests::measured;
    use super::super::row_prediction::RowPrediction;
    use super::*;

    #[test]
    fn all_files_hold_the_rows() {
        let (job, runs) = measured(1, &[1.0], false);
        let rows = vec![ScalingRow::new(&job, &runs, &RowPrediction::default(), None)];
        let study = ScalingStudy {
            kind: ScalingKind::Weak,
            title: "Flyer".into(),
            scene: "flyer.json".into(),
            sets: vec!["time.end=1e-7".into()],
            repeats: 1,
            cores: 2,
            processor: "unknown".into(),
            rows,
        };
        let folder = tempfile::tempdir().unwrap();
        write(&study, folder.path()).unwrap();
        let path = folder.path().join("weak_scaling.csv");
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
        let names = reader.headers().unwrap().clone();
        // Every column is explained.
        for name in &names {
            let stem = name.trim_start_matches("wall_seconds");
            assert!(COLUMNS.contains(stem), "{name}");
        }
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let compute = names.iter().position(|name| name == "compute").unwrap();
        assert_eq!((rows.len(), &rows[0][0], &rows[0][compute]), (1, "1", ""));
        let text = fs::read_to_string(folder.path().join("scaling.json")).unwrap();
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!((&json["kind"], &json["rows"][0]["ranks"]), (&"weak".into(), &1.into()));
        assert!(folder.path().join("scaling.png").exists());
        assert!(folder.path().join("scaling.svg").exists());
    }
}
