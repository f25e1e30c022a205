//! Fits the error models of runs, and compares them with other impacts.
//!
//! `scripts/calibrate_estimates.sh [CASES [THREADS]]`: runs random impacts of some materials, fits,
//! writes `src/accuracy/estimate/laws.json`, runs impacts of other materials, draws
//! `docs/error_estimate.png` and prints how often the intervals contained the true error.

#[path = "../common/estimates.rs"]
mod estimates;
mod fit;
mod picture;
#[path = "../common/random_impacts.rs"]
mod random_impacts;

use std::path::Path;

use estimates::{CheckedEstimate, QUANTITIES, gather, judge};
use flyer_mpm::accuracy::estimate::Laws;
use flyer_mpm::accuracy::estimate::error_model::QuantityLaws;
use flyer_mpm::accuracy::plan::data::{SchemeAccuracy, Size};
use flyer_mpm::accuracy::plan::{self, Data};
use random_impacts::{FITTED, HELD_OUT};

/// Seeds of the impacts to which the error models are fitted, and of those with which they are compared.
const SEEDS: [u64; 2] = [20_260_101, 20_260_202];

/// The shares of the fitted cases that the intervals are to hold, before their margin.
const SHARES: [f64; 3] = [0.945, 0.96, 0.96];

/// What half-widths are multiplied by: room for materials that were not fitted on. The plateau's is the
/// most that leaves the median ratio of the held-out impacts a tenth below the 5 that is allowed.
const MARGINS: [f64; 3] = [1.07, 1.3, 1.05];

/// Evidence of each quantity, the most first: the others are for runs that lack some.
const EVIDENCE: [&[&[&str]]; 3] = [
    &[
        &["difference_2", "difference_4", "noise", "halves", "wide", "cells"],
        &["noise", "halves", "wide", "cells"],
    ],
    &[&["difference_2", "difference_4", "rise"], &["rise"]],
    &[&["difference_2", "difference_4"], &["difference_2"]],
];

/// What the planner knows of the schemes, by the same runs.
fn write_data(estimates: &[Vec<CheckedEstimate>; 3], root: &Path) {
    let sizes = |all: &[CheckedEstimate], scheme: &str| {
        let of = all.iter().filter(|t| t.name.split_once(" m/s, ").is_some_and(|n| n.1 == scheme));
        let mut of: Vec<f64> = of.map(|t| t.in_cells).filter(|v| v.is_finite()).collect();
        of.sort_by(f64::total_cmp);
        let at = |share: f64| of.get((share * of.len() as f64) as usize).copied();
        at(0.5).zip(at(0.95)).map(|(median, most)| (Size { median, most }, of.len()))
    };
    let mut data = Data::shipped();
    data.schemes.clear();
    data.source = format!(
        "random impacts of {}, seed {}, by scripts/calibrate_estimates.sh",
        FITTED.join(", "),
        SEEDS[0]
    );
    for scheme in plan::schemes() {
        let [plateau, arrival, e1] = [0, 1, 2].map(|k| sizes(&estimates[k], &scheme.name));
        if let (Some((plateau, _)), Some((arrival_cells, _)), Some((e1_cells, runs))) =
            (plateau, arrival, e1)
        {
            let measured =
                SchemeAccuracy { e1_cells, plateau, plateau_order: 1.0, arrival_cells, runs };
            data.schemes.insert(scheme.name, measured);
        }
    }
    let text = serde_json::to_string_pretty(&data).expect("data are plain") + "\n";
    std::fs::write(root.join("src/accuracy/plan/data.json"), text)
        .expect("the data can be written");
}

fn main() {
    let number = |k: usize, otherwise: usize| {
        std::env::args().nth(k).and_then(|a| a.parse().ok()).unwrap_or(otherwise)
    };
    let (count, threads) = (number(1, 1250), number(2, 2));
    let fitted = gather(SEEDS[0], &FITTED, count, threads);
    let quantity = |k: usize| {
        QuantityLaws(
            EVIDENCE[k]
                .iter()
                .filter_map(|e| fit::law(&fitted[k], e, SHARES[k], MARGINS[k]))
                .collect(),
        )
    };
    let laws = Laws {
        source: format!(
            "{count} random impacts of {}, seed {}, by scripts/calibrate_estimates.sh; weights \
             of the quantiles {SHARES:?}, factors {MARGINS:?}",
            FITTED.join(", "),
            SEEDS[0]
        ),
        fitted: random_impacts::range(),
        plateau_pressure: quantity(0),
        arrival_time: quantity(1),
        l1: quantity(2),
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = serde_json::to_string_pretty(&laws).expect("laws are plain data") + "\n";
    std::fs::write(root.join("src/accuracy/estimate/laws.json"), text)
        .expect("the laws can be written");
    write_data(&fitted, root);
    let held_out = gather(SEEDS[1], &HELD_OUT, count.min(280), threads);
    let by_law = |all: &[CheckedEstimate], quantity: &QuantityLaws| -> Vec<CheckedEstimate> {
        let estimates = all.iter().cloned();
        estimates
            .map(|t| CheckedEstimate {
                half_width: quantity.half_width(&t.evidence).map(|w| w * t.unit),
                ..t
            })
            .collect()
    };
    let of = [&laws.plateau_pressure, &laws.arrival_time, &laws.l1];
    let judged: Vec<[Vec<CheckedEstimate>; 2]> =
        (0..3).map(|k| [by_law(&fitted[k], of[k]), by_law(&held_out[k], of[k])]).collect();
    for (name, [own, others]) in QUANTITIES.iter().zip(&judged) {
        for (what, all) in [("fitted", own), ("held out", others)] {
            let (cases, held, median) = judge(all);
            let held = 100.0 * held;
            println!("{name}, {what}: {cases} cases, {held:.1} % held, median ratio {median:.2}");
        }
        for one in others.iter().filter(|t| t.half_width.is_some_and(|w| t.error > w)) {
            let ratio = one.error / one.half_width.unwrap_or(f64::NAN);
            println!("  not held: {}, {ratio:.2} times the half-width", one.name);
        }
    }
    let others: Vec<Vec<CheckedEstimate>> = judged.into_iter().map(|[_, others]| others).collect();
    picture::draw(&others, &root.join("docs/error_estimate")).expect("the picture can be drawn");
}
