//! Plans of random impacts: whether the wanted error came, and the price, also against the prices of all
//! schemes that the plan could choose.

use calibration::random::Random;
use calibration::random_impacts::{Draw, HELD_OUT, RandomImpact, impact};
use calibration::random_schemes::Schemes;
use decomp::Serial;
use flyer_mpm::accuracy::plan::{Data, ErrorTarget, Plan, PlanError, Verdict, plan};
use flyer_mpm::driver::output::summary::Summary;
use flyer_mpm::driver::{Beginning, Options, run};
use flyer_mpm::input;
use flyer_mpm::scene::PlannedQuantity;
use flyer_mpm::study::scaling::statistics::median;

use crate::bounds::{Unit, accuracy as bounds};
use crate::table::Table;

/// Impacts that are planned and run.
const IMPACTS: usize = bounds::plan::RUNS.number() as usize;
/// Their seed, drawn after the fit.
const SEED: u64 = 459_013_787;
/// What the impacts are drawn from.
const DRAW: Draw<'static> =
    Draw { library: &HELD_OUT, invented: 0.5, schemes: Schemes::Default, beyond: false };
/// A price may be wrong by this factor.
const FACTOR: f64 = bounds::plan::PRICE_FACTOR.number();
/// Runs may take so long \[s\].
const BUDGET: f64 = 20.0;
/// Impacts of which every scheme is run.
const TRIED: usize = bounds::plan_schemes::TRIED.number() as usize;
/// CPU time for which the runs of a scheme are repeated, so that the system measures their mean well
/// \[s\].
const TIMED: f64 = 0.1;
/// A plan whose predicted error is below this share of the target has the largest cells that the fit
/// allows.
const COARSEST: f64 = 0.9;

/// Wanted errors are drawn between these.
fn range(quantity: PlannedQuantity) -> [f64; 2] {
    match quantity {
        PlannedQuantity::L1 => [0.01, 0.06],
        PlannedQuantity::PlateauPressure => [0.002, 0.02],
        PlannedQuantity::ArrivalTime => [0.001, 0.01],
    }
}

/// The next impact, with the error that is wanted of it.
fn next(random: &mut Random) -> (RandomImpact, ErrorTarget) {
    let impact = impact(random, &DRAW);
    let quantities =
        [PlannedQuantity::L1, PlannedQuantity::PlateauPressure, PlannedQuantity::ArrivalTime];
    let quantity = *random.one(&quantities);
    let [low, high] = range(quantity);
    let error = random.between(low.ln(), high.ln()).exp();
    (impact, ErrorTarget { quantity, error, budget: BUDGET, ranks: 1, place: None })
}

/// Plans and runs impacts.
pub fn check(table: &mut Table) {
    let (mut random, data) = (Random::new(SEED), Data::shipped());
    let mut verdicts: Vec<Verdict> = Vec::new();
    let mut refused = 0;
    while verdicts.len() < IMPACTS && refused < IMPACTS {
        let (impact, target) = next(&mut random);
        let wanted =
            format!("{}, {:?} {:.3} %", impact.name, target.quantity, 100.0 * target.error);
        let planned = plan(&impact.scene, &impact.name, &target, &data).map_err(|e| e.to_string());
        match planned.and_then(|plan| once(&plan, &impact.name)) {
            Ok(verdict) => {
                println!(
                    "  {wanted}: actual {:.3} %, CPU {:.3} s predicted {:.3} s",
                    100.0 * verdict.actual.unwrap_or(f64::NAN),
                    verdict.cpu_seconds,
                    verdict.predicted_cpu_seconds
                );
                verdicts.push(verdict);
            }
            Err(reason) => {
                println!("  {wanted}: {reason}");
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
    overkill(table, &verdicts);
    table.beside("refused with the best that can be had", Some(refused as f64), "", Unit::One);
    impossible(table, &data);
}

/// Price of the plan's scheme against that of the cheapest found by trying all schemes.
pub fn schemes(table: &mut Table) {
    let (mut random, data) = (Random::new(SEED), Data::shipped());
    let mut prices = Vec::new();
    for _ in 0..10 * TRIED {
        if prices.len() == TRIED {
            break;
        }
        let (impact, target) = next(&mut random);
        let Ok(chosen) = plan(&impact.scene, &impact.name, &target, &data) else { continue };
        let Some(price) = over_cheapest(&impact, &target, &data, &chosen) else { continue };
        println!("  {}, {:?}: {} at {price:.3}", impact.name, target.quantity, chosen.scheme);
        prices.push(price);
    }
    prices.sort_by(f64::total_cmp);
    let tried = Some(prices.len() as f64);
    table.check("impacts of which every scheme is run", tried, bounds::plan_schemes::TRIED);
    let bound = bounds::plan_schemes::OVER_CHEAPEST;
    table.check("price over that of the cheapest, greatest", prices.last().copied(), bound);
    let within = prices.iter().filter(|&&price| bound.holds(Some(price))).count();
    table.beside("the same, number within the bound", Some(within as f64), "", Unit::One);
    table.beside("the same, median", median(prices), "", Unit::One);
}

/// Median of target over actual error: of all plans, and of those whose cells are not the largest of
/// the fit.
fn overkill(table: &mut Table, verdicts: &[Verdict]) {
    let quantities = [
        (PlannedQuantity::L1, "L1", None),
        (PlannedQuantity::PlateauPressure, "plateau", Some(bounds::plan::OVERKILL)),
        (PlannedQuantity::ArrivalTime, "arrival", Some(bounds::plan::OVERKILL)),
    ];
    for (quantity, name, bound) in quantities {
        let own = || verdicts.iter().filter(move |v| v.quantity == quantity);
        let free = || own().filter(|v| v.predicted >= COARSEST * v.wanted);
        let ratio = |v: &Verdict| Some(v.wanted / v.actual?);
        let figure = format!("{name}: target over actual error, median");
        let all = median(own().filter_map(ratio));
        match bound {
            Some(bound) => table.check(&figure, all, bound),
            None => table.beside(&figure, all, "", Unit::One),
        }
        let note = format!("{} of {} plans", free().count(), own().count());
        let figure = format!("{name}: the same, unless on the coarsest cells");
        table.beside(&figure, median(free().filter_map(ratio)), &note, Unit::One);
    }
}

/// CPU seconds of the plan's scheme over those of the cheapest scheme that reaches the target, each on
/// the cells that a plan chooses for it; `None` if no scheme reaches the target.
fn over_cheapest(
    impact: &RandomImpact,
    target: &ErrorTarget,
    data: &Data,
    chosen: &Plan,
) -> Option<f64> {
    let price = |plan: &Plan| {
        let (mut runs, mut all) = (0.0, 0.0);
        loop {
            let verdict = once(plan, &impact.name).ok()?;
            (runs, all) = (runs + 1.0, all + verdict.cpu_seconds);
            if all >= TIMED || runs >= 100.0 {
                return Some(Verdict { cpu_seconds: all / runs, ..verdict });
            }
        }
    };
    let others = data.schemes.iter().filter(|(name, _)| **name != chosen.scheme);
    let others = others.filter_map(|(name, measured)| {
        let schemes = [(name.clone(), measured.clone())].into();
        let alone = Data { schemes, ..data.clone() };
        price(&plan(&impact.scene, &impact.name, target, &alone).ok()?)
    });
    let own = price(chosen)?;
    let all: Vec<Verdict> = others.chain([own.clone()]).collect();
    let met = all.iter().filter(|v| v.actual.is_some_and(|error| error <= v.wanted));
    Some(own.cpu_seconds / met.map(|v| v.cpu_seconds).reduce(f64::min)?)
}

/// Runs a planned scene.
fn once(plan: &Plan, name: &str) -> Result<Verdict, String> {
    let checked =
        input::parse(plan.scene.to_string().as_bytes(), name, &[]).map_err(|e| e.to_string())?;
    let home = tempfile::tempdir().map_err(|e| e.to_string())?;
    let options = Options::quiet(home.path().join("run"));
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
