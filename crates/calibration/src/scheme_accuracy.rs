//! Errors of the schemes that a plan can choose, from runs of random impacts.

use std::path::Path;

use flyer_mpm::accuracy::plan::data::{CELLS, ErrorLaws, STRENGTH, SchemeAccuracy};
use flyer_mpm::accuracy::plan::{self, Data};

use crate::fit;
use calibration::estimates::{CheckedEstimate, Gathered};

/// Share of the runs whose error is smaller than the one that a plan predicts.
const SHARE: f64 = 0.95;

/// Writes `data.json`.
pub fn write(planned: &Gathered, seed: &str, root: &Path) {
    let mut data = Data::shipped();
    data.schemes.clear();
    data.source = format!("random impacts, seed {seed}, by scripts/calibrate_estimates.sh");
    for scheme in plan::schemes() {
        let of = |k: usize| laws(&planned.estimates[k], &scheme.name);
        if let (Some(plateau), Some(arrival), Some(l1)) = (of(0), of(1), of(2)) {
            let runs = l1.most.cases;
            data.schemes.insert(scheme.name, SchemeAccuracy { l1, plateau, arrival, runs });
        }
    }
    let text = serde_json::to_string_pretty(&data).expect("data are plain") + "\n";
    std::fs::write(root.join("src/accuracy/plan/data.json"), text)
        .expect("the data can be written");
}

/// Laws of a quantity for the scheme of this name.
fn laws(all: &[CheckedEstimate], scheme: &str) -> Option<ErrorLaws> {
    let end = format!(" cells, {scheme}");
    let of_scale = |t: &CheckedEstimate| CheckedEstimate {
        evidence: [(CELLS.to_string(), t.cells), (STRENGTH.to_string(), t.strength)].into(),
        error: t.relative,
        unit: 1.0,
        ..t.clone()
    };
    let own: Vec<CheckedEstimate> =
        all.iter().filter(|t| t.name.ends_with(&end)).map(of_scale).collect();
    let own: Vec<&CheckedEstimate> = own.iter().collect();
    let law = |share: f64| fit::law(&own, &[CELLS, STRENGTH], share).map(|(law, _)| law);
    Some(ErrorLaws { median: law(0.5)?, most: law(SHARE)? })
}
