//! Errors of the schemes that a plan can choose, from runs of random impacts.

use std::collections::BTreeMap;
use std::path::Path;

use calibration::estimates::{CheckedEstimate, Gathered};
use flyer_mpm::accuracy::estimate::QuantityLaws;
use flyer_mpm::accuracy::estimate::error_model::Law;
use flyer_mpm::accuracy::estimate::indicators::OTHER_CELLS;
use flyer_mpm::accuracy::plan::data::{
    CELLS, ErrorLaws, ImpactIndicators, STRENGTH, SchemeAccuracy,
};
use flyer_mpm::accuracy::plan::{self, Data};

use crate::fit::{self, EvidenceSet};

/// Share of the runs whose error is smaller than the one that a plan predicts: more than the 95 % that
/// are promised, since a plan chooses the scheme of the smallest prediction.
const SHARE: f64 = 0.96;

/// Indicators of an impact whose waves are known, of others with two bodies, and of any scene.
const INDICATORS: [&[&str]; 3] = [
    &[CELLS, OTHER_CELLS, STRENGTH, "compression", "other_compression"],
    &[CELLS, OTHER_CELLS, STRENGTH],
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
    let text = serde_json::to_string(&data).expect("data are plain") + "\n";
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

/// Laws of a quantity for all schemes. The schemes share the weights of products, and each scheme adds
/// to the weights of single indicators, so that all runs contribute to the tail of the errors.
fn laws(all: &[CheckedEstimate], schemes: &[String]) -> BTreeMap<String, ErrorLaws> {
    let of_scale = |t: &CheckedEstimate| {
        let CheckedEstimate { strength, compressions, other_thickness, .. } = *t;
        let impact = ImpactIndicators { strength, compressions, other_thickness };
        let mut evidence = impact.evidence(t.cells);
        evidence.extend(schemes.iter().map(|scheme| {
            let is_own = if is_of(t, scheme) { std::f64::consts::E } else { 1.0 };
            (indicator(scheme), is_own)
        }));
        CheckedEstimate { evidence, error: t.relative, unit: 1.0, ..t.clone() }
    };
    let all: Vec<CheckedEstimate> = all.iter().map(of_scale).collect();
    let all: Vec<&CheckedEstimate> = all.iter().collect();
    let of_share = |share: f64, regressed: f64| -> Vec<Law> {
        let law = |indicators: &&'static [&'static str]| {
            fit::law(&all, &terms(indicators, schemes), share, regressed)
        };
        INDICATORS.iter().filter_map(law).map(|(law, _)| law).collect()
    };
    let (median, most) = (of_share(0.5, 0.5), of_share(SHARE, fit::REGRESSED));
    let laws_of = |scheme: &String| {
        let own =
            |laws: &[Law]| QuantityLaws(laws.iter().map(|law| of_scheme(law, scheme)).collect());
        (scheme.clone(), ErrorLaws { median: own(&median), most: own(&most) })
    };
    schemes.iter().map(laws_of).collect()
}

/// Terms of the law of all schemes: the indicators and their products, whose weights all schemes share,
/// and for each scheme what it adds to the weights of the indicators.
fn terms(indicators: &'static [&'static str], schemes: &[String]) -> Vec<String> {
    let shared = EvidenceSet { terms: indicators, products: indicators }.names();
    let own = schemes.iter().flat_map(|scheme| {
        let is = indicator(scheme);
        let weights = indicators.iter().map(|term| format!("{is}*{term}")).collect::<Vec<_>>();
        weights.into_iter().chain([is])
    });
    shared.into_iter().chain(own).collect()
}

/// The law of one scheme from that of all schemes: the weights of the terms with its indicator are added
/// to those of the terms without, and terms with other indicators are left out.
fn of_scheme(law: &Law, scheme: &str) -> Law {
    let own = indicator(scheme);
    let mut new = Law { evidence: Vec::new(), weights: vec![law.weights[0]], ..law.clone() };
    for (name, &weight) in law.evidence.iter().zip(&law.weights[1..]) {
        match name.strip_prefix(&own) {
            Some("") => new.weights[0] += weight,
            Some(rest) if rest.starts_with('*') => {
                let at = new.evidence.iter().position(|term| *term == rest[1..]);
                new.weights[1 + at.expect("the shared term comes first")] += weight;
            }
            _ if name.starts_with("is ") => {}
            _ => {
                new.evidence.push(name.clone());
                new.weights.push(weight);
            }
        }
    }
    new.ranges.retain(|name, _| !name.starts_with("is "));
    new
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_law_of_a_scheme_has_the_weights_of_the_scheme() {
        let law = Law {
            evidence: ["cells", "is a*cells", "is a", "is b*cells", "is b"]
                .map(String::from)
                .to_vec(),
            weights: vec![1.0, -0.5, 0.25, 2.0, 0.125, 3.0],
            factor: 1.5,
            cases: 7,
            ranges: ["cells", "is a", "is b"].map(|name| (name.to_string(), [1.0, 2.0])).into(),
        };
        let b = of_scheme(&law, "b");
        assert_eq!((b.evidence, b.weights), (vec!["cells".to_string()], vec![4.0, -0.375]));
        assert_eq!((b.factor, b.cases), (1.5, 7));
        assert_eq!(b.ranges.into_keys().collect::<Vec<_>>(), ["cells"]);
    }
}
