//! Plans of random impacts: whether the wanted error came, and the price.

use std::time::Instant;

use calibration::random::Random;
use calibration::random_impacts::{Draw, HELD_OUT, impact};
use calibration::random_schemes::Schemes;
use decomp::Serial;
use flyer_mpm::accuracy::plan::{Data, ErrorTarget, PlanError, Verdict, plan};
use flyer_mpm::driver::output::summary::Summary;
use flyer_mpm::driver::progress::ProgressChoice;
use flyer_mpm::driver::{Beginning, Options, run};
use flyer_mpm::input;
use flyer_mpm::scene::PlannedQuantity;

use crate::bounds::{Unit, accuracy as bounds};
use crate::table::Table;

/// Impacts that are planned and run.
const IMPACTS: usize = bounds::plan::RUNS.number() as usize;
/// Their seed.
const SEED: u64 = 20_260_404;
/// What the impacts are drawn from.
const DRAW: Draw<'static> =
    Draw { library: &HELD_OUT, invented: 0.5, schemes: Schemes::Default, beyond: false };
/// A price may be wrong by this factor.
const FACTOR: f64 = bounds::plan::PRICE_FACTOR.number();
/// Runs may take so long \[s\].
const BUDGET: f64 = 20.0;

/// Wanted errors are drawn between these.
fn range(quantity: PlannedQuantity) -> [f64; 2] {
    match quantity {
        PlannedQuantity::L1 => [0.01, 0.06],
        PlannedQuantity::PlateauPressure => [0.002, 0.02],
        PlannedQuantity::ArrivalTime => [0.001, 0.01],
    }
}

/// Plans and runs impacts.
pub fn check(table: &mut Table) {
    let (mut random, data) = (Random::new(SEED), Data::shipped());
    let quantities =
        [PlannedQuantity::L1, PlannedQuantity::PlateauPressure, PlannedQuantity::ArrivalTime];
    let mut verdicts: Vec<Verdict> = Vec::new();
    let mut refused = 0;
    while verdicts.len() < IMPACTS && refused < IMPACTS {
        let impact = impact(&mut random, &DRAW);
        let quantity = *random.one(&quantities);
        let [low, high] = range(quantity);
        let error = random.between(low.ln(), high.ln()).exp();
        let target = ErrorTarget { quantity, error, budget: BUDGET, ranks: 1, place: None };
        match once(&impact.scene, &impact.name, &target, &data) {
            Ok(verdict) => {
                println!(
                    "  {}, {quantity:?} {:.3} %: actual {:.3} %, CPU {:.3} s predicted {:.3} s",
                    impact.name,
                    100.0 * error,
                    100.0 * verdict.actual.unwrap_or(f64::NAN),
                    verdict.cpu_seconds,
                    verdict.predicted_cpu_seconds
                );
                verdicts.push(verdict);
            }
            Err(reason) => {
                println!("  {}, {quantity:?} {:.3} %: {reason}", impact.name, 100.0 * error);
                refused += 1;
            }
        }
    }
    let share = |holds: &dyn Fn(&Verdict) -> bool| {
        verdicts.iter().filter(|v| holds(v)).count() as f64 / verdicts.len().max(1) as f64
    };
    let met = share(&|v| v.actual.is_some_and(|error| error <= v.wanted));
    let near = |a: f64, b: f64| a <= FACTOR * b && b <= FACTOR * a;
    let price = share(&|v| near(v.cpu_seconds, v.predicted_cpu_seconds));
    let cases = Some(verdicts.len() as f64);
    table.check("plans run", cases, bounds::plan::RUNS);
    table.check("wanted error met", Some(met), bounds::plan::ERROR_MET);
    table.check(
        &format!("price within a factor {FACTOR}"),
        Some(price),
        bounds::plan::PRICE_WITHIN_FACTOR,
    );
    table.beside("refused with the best that can be had", Some(refused as f64), "", Unit::One);
    impossible(table, &data);
}

/// Plans and runs one impact.
fn once(
    scene: &serde_json::Value,
    name: &str,
    target: &ErrorTarget,
    data: &Data,
) -> Result<Verdict, String> {
    let plan = plan(scene, name, target, data).map_err(|e| e.to_string())?;
    let checked =
        input::parse(plan.scene.to_string().as_bytes(), name, &[]).map_err(|e| e.to_string())?;
    let home = tempfile::tempdir().map_err(|e| e.to_string())?;
    let options = Options {
        output: home.path().join("run"),
        keep: false,
        quiet: true,
        progress: ProgressChoice::Never,
        verbose: false,
        threads: 1,
        trace: None,
        started: Instant::now(),
        signal: Default::default(),
        commit: None,
    };
    run(&Serial, &checked, &options, Beginning::Scene).map_err(|e| e.to_string())?;
    let summary = Summary::read(&options.output).map_err(|e| e.to_string())?;
    summary.plan.ok_or_else(|| "the summary has no plan".into())
}

/// A target that no scheme reaches is refused; the error names the smallest that can be reached.
fn impossible(table: &mut Table, data: &Data) {
    let scene = flyer_mpm::accuracy::plan::standard();
    let (quantity, error) = (PlannedQuantity::L1, 1e-5);
    let target = ErrorTarget { quantity, error, budget: 1.0, ranks: 1, place: None };
    let refused = match plan(&scene, "flyer.json", &target, data) {
        Err(PlanError::Impossible { best, seconds, .. }) => Some((best, seconds)),
        _ => None,
    };
    let best = refused.map_or("no".into(), |(best, _)| format!("{:.2} %", 100.0 * best));
    let sound = refused.is_some_and(|(best, _)| best > error);
    table.holds("L1 of 0.001 % in 1 s is refused; best", &best, "refused", sound);
    let seconds = refused.map(|(_, seconds)| seconds);
    table.check("  seconds of the best", seconds, bounds::plan::SECONDS_OF_BEST);
}
