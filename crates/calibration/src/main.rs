//! Fits the error models of runs, and the accuracy of the schemes that a plan can choose.
//!
//! `scripts/calibrate_estimates.sh [CASES [THREADS [FOLDER]]]`: runs random impacts, mostly of
//! materials that no library has, with random schemes, fits, and writes
//! `src/accuracy/estimate/laws.json` and `src/accuracy/plan/data.json`. Runs that an earlier call has
//! left in FOLDER (`output/calibration`) are not repeated. `accuracy/estimate` of the acceptance
//! program compares the result with impacts of other materials.

mod fit;
mod picture;
mod scheme_accuracy;

use std::path::{Path, PathBuf};

use calibration::estimates::{CheckedEstimate, Gathered, QUANTITIES, gather, judge};
use calibration::random_impacts::{self, Draw, FITTED, HELD_OUT};
use calibration::random_schemes::Schemes;
use fit::EvidenceSet;
use flyer_mpm::accuracy::estimate::error_model::{FamilyLaws, GuessFactors, Laws, QuantityLaws};
use flyer_mpm::accuracy::estimate::indicators::OTHER_CELLS;
use flyer_mpm::accuracy::estimate::{EstimateBasis, SchemeFamily};

/// Seeds of the impacts of the fit, of those outside of its range, of those of the plan's schemes, and
/// of those of the picture.
const SEEDS: [u64; 4] = [20_261_101, 20_261_102, 20_261_103, 20_261_104];

/// Share of cases left out of a fit that the intervals hold: plateau, arrival, L1. More than the 95 %
/// that are promised, since other materials and schemes differ from those of the fit. The share is
/// greatest for L1, whose intervals are the narrowest.
const SHARES: [f64; 3] = [0.97, 0.98, 0.99];

/// Share of the cases outside of the range of the fit that the wider intervals hold.
const GUESS_SHARE: f64 = 0.9;

/// Least factors on the half-widths of guesses: plateau, arrival, L1. Random scenes with strength need
/// more than the impacts of fluids outside of the range.
const LEAST_GUESS: [f64; 3] = [1.3, 1.6, 1.0];

/// Indicators of the plateau: of the run, of its differences from the coarse runs, of the impact.
const PLATEAU: &[&str] = &[
    "spread",
    "difference_2",
    "difference_4",
    "noise",
    "halves",
    "wide",
    "cells",
    OTHER_CELLS,
    "compression",
    "exp_compression",
    "other_compression",
    "exp_other_compression",
];

/// Indicators of the impact, the length of the plateau, and the sum of all differences.
const FEW: &[&str] = &["spread", "cells", OTHER_CELLS, "compression", "other_compression"];

/// All indicators of [`PLATEAU`] but the exponentials: their products are terms of the larger set.
const MANY: &[&str] = &[
    "spread",
    "difference_2",
    "difference_4",
    "noise",
    "halves",
    "wide",
    "cells",
    OTHER_CELLS,
    "compression",
    "other_compression",
];

/// A set without products.
const fn plain(terms: &'static [&'static str]) -> EvidenceSet {
    EvidenceSet { terms, products: &[] }
}

/// Sets of evidence of each quantity, those with the most evidence first: the others are for runs that
/// lack some. Of several sets a family takes the one with the narrowest intervals.
const EVIDENCE: [&[&[EvidenceSet]]; 3] = [
    &[
        &[
            EvidenceSet { terms: PLATEAU, products: FEW },
            EvidenceSet { terms: PLATEAU, products: MANY },
        ],
        &[plain(&["spread", "noise", "cells"]), plain(&["spread", "cells"])],
        &[plain(&["noise", "halves", "wide", "cells"])],
    ],
    &[&[plain(&["difference_2", "difference_4", "rise"])], &[plain(&["rise"])]],
    &[&[plain(&["difference_2", "difference_4"])], &[plain(&["difference_2"])]],
];

/// Runs impacts, or reads those of an earlier call.
fn gathered(folder: &Path, name: &str, run: impl FnOnce() -> Gathered) -> Gathered {
    let file = folder.join(format!("{name}.json"));
    if let Ok(text) = std::fs::read_to_string(&file) {
        return serde_json::from_str(&text).expect("the file is one of this program");
    }
    let all = run();
    let text = serde_json::to_string(&all).expect("estimates are plain data");
    std::fs::create_dir_all(folder).expect("the folder can be written");
    std::fs::write(&file, text).expect("the file can be written");
    all
}

/// The estimates with the half-widths of these laws.
fn by_laws(all: &[CheckedEstimate], laws: &Laws, quantity: usize) -> Vec<CheckedEstimate> {
    let width = |t: &CheckedEstimate| {
        let laws = laws.of(t.family, t.basis);
        let quantity = [&laws.plateau_pressure, &laws.arrival_time, &laws.l1][quantity];
        quantity.half_width(&t.evidence).map(|w| w * t.unit)
    };
    all.iter().map(|t| CheckedEstimate { half_width: width(t), ..t.clone() }).collect()
}

/// The estimates of both.
fn together(mut all: Gathered, more: &Gathered) -> Gathered {
    for (all, more) in all.estimates.iter_mut().zip(&more.estimates) {
        all.extend(more.iter().cloned());
    }
    all
}

fn fit_families(fitted: &Gathered, laws: &mut Laws) {
    for family in SchemeFamily::ALL {
        let quantity = |k: usize| {
            let own = fitted.estimates[k].iter().filter(|t| t.family == family);
            let own: Vec<&CheckedEstimate> = own.collect();
            let sets = EVIDENCE[k].iter();
            let laws = sets.filter_map(|sets| fit::narrowest(&own, sets, SHARES[k]));
            QuantityLaws(laws.collect())
        };
        let [plateau_pressure, arrival_time, l1] = [0, 1, 2].map(quantity);
        laws.families.insert(family, FamilyLaws { plateau_pressure, arrival_time, l1 });
    }
}

/// The factors at which the intervals hold [`GUESS_SHARE`] of the cases outside of the range, at least
/// [`LEAST_GUESS`].
fn fit_guess(outside: &Gathered, laws: &mut Laws) {
    let [plateau_pressure, arrival_time, l1] = [0, 1, 2].map(|k| {
        let guesses = by_laws(&outside.estimates[k], laws, k);
        let guesses = guesses.iter().filter(|t| t.basis == EstimateBasis::Guess);
        fit::quantile(guesses.filter_map(|t| Some(t.error / t.half_width?)), GUESS_SHARE)
            .max(LEAST_GUESS[k])
    });
    laws.guess = GuessFactors { plateau_pressure, arrival_time, l1 };
}

fn print(what: &str, all: &Gathered, laws: &Laws) {
    println!(
        "{what}: {} plateaus, {} not reported, {} that are not there, {} impacts failed",
        all.plateaus, all.abstained, all.false_plateaus, all.failed
    );
    for (k, name) in QUANTITIES.iter().enumerate() {
        let judged = by_laws(&all.estimates[k], laws, k);
        for family in SchemeFamily::ALL {
            let of = judge(judged.iter().filter(|t| t.family == family));
            println!(
                "  {name}, {family:?}: {} cases, {:.1} % held, median ratio {:.2}",
                of.cases,
                100.0 * of.held,
                of.ratio
            );
        }
    }
}

fn main() {
    let argument = |k: usize| std::env::args().nth(k);
    let number =
        |k: usize, otherwise: usize| argument(k).and_then(|a| a.parse().ok()).unwrap_or(otherwise);
    let (count, threads) = (number(1, 16_000), number(2, 2));
    let root = &Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = argument(3).map_or(root.join("output/calibration"), PathBuf::from);
    let of = |schemes, beyond| Draw { library: &FITTED, invented: 0.7, schemes, beyond };
    let runs = |name: &str, seed: u64, draw: Draw<'_>, count: usize| {
        gathered(&folder, name, || gather(seed, &draw, count, threads))
    };
    let fitted = runs("fitted", SEEDS[0], of(Schemes::Random, false), count);
    let beyond = runs("beyond", SEEDS[1], of(Schemes::Random, true), count / 10);
    let unusual = runs("unusual", SEEDS[1], of(Schemes::Unusual, true), count / 10);
    let planned = runs("planned", SEEDS[2], of(Schemes::Planned, false), 2 * count / 3);
    let mut laws = Laws {
        source: format!(
            "{count} impacts with random schemes and {} with the schemes of a plan, of {} and of \
             random materials, seeds {} and {}, by scripts/calibrate_estimates.sh; the intervals \
             hold {SHARES:?} of the cases left out of the fit, and {GUESS_SHARE} of {} impacts \
             outside of the range",
            2 * count / 3,
            FITTED.join(", "),
            SEEDS[0],
            SEEDS[2],
            2 * (count / 10)
        ),
        fitted: random_impacts::range(),
        ..Laws::default()
    };
    let fitted = together(fitted, &planned);
    fit_families(&fitted, &mut laws);
    let outside = together(beyond, &unusual);
    fit_guess(&outside, &mut laws);
    let text = serde_json::to_string_pretty(&laws).expect("laws are plain data") + "\n";
    std::fs::write(root.join("src/accuracy/estimate/laws.json"), text)
        .expect("the laws can be written");
    scheme_accuracy::write(&planned, &SEEDS[2].to_string(), root);
    print("fitted", &fitted, &laws);
    print("planned schemes", &planned, &laws);
    print("outside", &outside, &laws);
    let draw = Draw { library: &HELD_OUT, invented: 0.0, schemes: Schemes::Default, beyond: false };
    let held_out = runs("held_out", SEEDS[3], draw, count / 10);
    print("held out", &held_out, &laws);
    let judged: Vec<_> = (0..3).map(|k| by_laws(&held_out.estimates[k], &laws, k)).collect();
    picture::draw(&judged, &root.join("docs/error_estimate")).expect("the picture can be drawn");
}
