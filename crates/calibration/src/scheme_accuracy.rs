//! Errors of the schemes that a plan can choose, from runs of random impacts.

use std::collections::BTreeMap;
use std::path::Path;

use calibration::estimates::{CheckedEstimate, Gathered};
use flyer_mpm::accuracy::estimate::QuantityLaws;
use flyer_mpm::accuracy::estimate::error_model::Law;
use flyer_mpm::accuracy::plan::data::{CELLS, ErrorLaws, STRENGTH, SchemeAccuracy, ShockStrength};
use flyer_mpm::accuracy::plan::{self, Data};

use crate::fit;

/// Share of the runs whose error is smaller than the one that a plan predicts: more than the 95 % that
/// are promised, since a plan chooses the scheme of the smallest prediction.
const SHARE: f64 = 0.97;

/// Sets of evidence, the one with the most evidence first: the other is for scenes whose waves are not
/// known.
const EVIDENCE: [&[&str]; 2] = [
    &[CELLS, "compression", "exp_compression", "other_compression", "exp_other_compression"],
    &[CELLS, STRENGTH],
];

/// Writes `data.json`.
pub fn write(planned: &Gathered, seed: &str, root: &Path) {
    let mut data = Data::shipped();
    data.schemes.clear();
    data.source = format!("random impacts, seed {seed}, by scripts/calibrate_estimates.sh");
    let names: Vec<String> = plan::schemes().into_iter().map(|scheme| scheme.name).collect();
    let [plateau, arrival, l1] = [0, 1, 2].map(|k| laws(&planned.estimates[k], &names));
    for name in names {
        let of = |laws: &BTreeMap<String, ErrorLaws>| laws.get(&name).cloned();
        if let (Some(plateau), Some(arrival), Some(l1)) = (of(&plateau), of(&arrival), of(&l1)) {
            let runs = planned.estimates[2].iter().filter(|t| is_of(t, &name)).count();
            data.schemes.insert(name, SchemeAccuracy { l1, plateau, arrival, runs });
        }
    }
    let text = serde_json::to_string_pretty(&data).expect("data are plain") + "\n";
    std::fs::write(root.join("src/accuracy/plan/data.json"), text)
        .expect("the data can be written");
}

/// Whether an estimate is of the scheme of this name.
fn is_of(t: &CheckedEstimate, scheme: &str) -> bool {
    t.name.ends_with(&format!(" cells, {scheme}"))
}

/// Name of the indicator of a scheme: its logarithm is 1 for the scheme and 0 for all others.
fn indicator(scheme: &str) -> String {
    format!("is {scheme}")
}

/// Laws of a quantity for all schemes. The schemes share the weights of the evidence and differ by a
/// factor, so that all runs contribute to the tail of the errors.
fn laws(all: &[CheckedEstimate], schemes: &[String]) -> BTreeMap<String, ErrorLaws> {
    let of_scale = |t: &CheckedEstimate| {
        let shock = ShockStrength { strength: t.strength, compressions: t.compressions };
        let mut evidence = shock.evidence(t.cells);
        evidence.extend(schemes.iter().map(|scheme| {
            let is_own = if is_of(t, scheme) { std::f64::consts::E } else { 1.0 };
            (indicator(scheme), is_own)
        }));
        CheckedEstimate { evidence, error: t.relative, unit: 1.0, ..t.clone() }
    };
    let all: Vec<CheckedEstimate> = all.iter().map(of_scale).collect();
    let all: Vec<&CheckedEstimate> = all.iter().collect();
    let indicators: Vec<String> = schemes.iter().map(|scheme| indicator(scheme)).collect();
    let of_share = |share: f64| -> Vec<Law> {
        let with_schemes = |evidence: &[&str]| {
            let names: Vec<&str> =
                evidence.iter().copied().chain(indicators.iter().map(String::as_str)).collect();
            fit::law(&all, &names, share, share).map(|(law, _)| law)
        };
        EVIDENCE.iter().filter_map(|evidence| with_schemes(evidence)).collect()
    };
    let (median, most) = (of_share(0.5), of_share(SHARE));
    let laws_of = |scheme: &String| {
        let own =
            |laws: &[Law]| QuantityLaws(laws.iter().map(|law| of_scheme(law, scheme)).collect());
        (scheme.clone(), ErrorLaws { median: own(&median), most: own(&most) })
    };
    schemes.iter().map(laws_of).collect()
}

/// The law of one scheme from that of all schemes.
fn of_scheme(law: &Law, scheme: &str) -> Law {
    let own = indicator(scheme);
    let mut new = Law { evidence: Vec::new(), weights: vec![law.weights[0]], ..law.clone() };
    for (name, weight) in law.evidence.iter().zip(&law.weights[1..]) {
        if *name == own {
            new.weights[0] += weight;
        } else if !name.starts_with("is ") {
            new.evidence.push(name.clone());
            new.weights.push(*weight);
        }
    }
    new
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_law_of_a_scheme_has_the_factor_of_the_scheme() {
        let law = Law {
            evidence: ["cells", "is a", "is b"].map(String::from).to_vec(),
            weights: vec![1.0, -0.5, 2.0, 3.0],
            factor: 1.5,
            cases: 7,
        };
        let b = of_scheme(&law, "b");
        assert_eq!((b.evidence, b.weights), (vec!["cells".to_string()], vec![4.0, -0.5]));
        assert_eq!((b.factor, b.cases), (1.5, 7));
    }
}
