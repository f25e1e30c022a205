//! Estimated errors of runs, on impacts of materials and schemes to which no law was fitted.

use calibration::estimates::{CheckedEstimate, Gathered, QUANTITIES, gather, judge};
use calibration::random_impacts::{Draw, HELD_OUT};
use calibration::random_schemes::Schemes;
use flyer_mpm::accuracy::estimate::EstimateBasis;

use crate::bounds::{Unit, accuracy as bounds};
use crate::table::Table;

/// Schemes of the impacts, with their number; none is one of the fit.
const GROUPS: [(&str, Schemes, usize); 5] = [
    ("default", Schemes::Default, 600),
    ("sharpest", Schemes::Sharpest, 600),
    ("robust", Schemes::Robust, 600),
    ("total-Lagrangian", Schemes::TotalLagrangian, 600),
    ("random schemes", Schemes::Random, 800),
];
/// Number of the impacts outside of the range of the fit, half of them by their scheme.
const OUTSIDE: usize = 400;
/// Seed, drawn after the fit.
const SEED: u64 = 781_068_566;
/// Runs at once.
const THREADS: usize = 2;
/// Upper ends of the bands of speeds of which figures are printed \[m/s\].
const BANDS: [f64; 5] = [250.0, 750.0, 1500.0, 3000.0, 5000.0];

/// Impacts of materials that are not in the fit: half of them of the library, half invented.
fn draw(schemes: Schemes, beyond: bool) -> Draw<'static> {
    Draw { library: &HELD_OUT, invented: 0.5, schemes, beyond }
}

/// Coverage and tightness of the intervals.
pub fn check(table: &mut Table) {
    let groups = GROUPS.iter().zip(0..).map(|((name, schemes, count), k)| {
        (*name, gather(SEED + k, &draw(*schemes, false), *count, THREADS))
    });
    let groups: Vec<(&str, Gathered)> = groups.collect();
    for (group, all) in &groups {
        for (name, estimates) in QUANTITIES.iter().zip(&all.estimates) {
            calibrated(table, &format!("{group}, {name}"), estimates);
        }
    }
    let plateaus: usize = groups.iter().map(|(_, all)| all.plateaus).sum();
    let abstained: usize = groups.iter().map(|(_, all)| all.abstained).sum();
    let abstained = abstained as f64 / plateaus.max(1) as f64;
    let wrong: usize = groups.iter().map(|(_, all)| all.false_plateaus).sum();
    let failed: usize = groups.iter().map(|(_, all)| all.failed).sum();
    table.check("plateaus not reported", Some(abstained), bounds::estimate::ABSTAINED);
    table.check(
        "plateaus reported that are not there",
        Some(wrong as f64),
        bounds::estimate::FALSE_PLATEAUS,
    );
    table.beside("impacts that could not be run", Some(failed as f64), "", Unit::One);
    by_speed(table, &groups);
    guesses(table);
}

/// Figures of the estimates within the range of the fit.
fn calibrated(table: &mut Table, name: &str, estimates: &[CheckedEstimate]) {
    let of = judge(estimates.iter().filter(|t| t.basis == EstimateBasis::Calibrated));
    table.beside(&format!("{name}: cases"), Some(of.cases as f64), "", Unit::One);
    table.check(&format!("{name}: truth within"), Some(of.held), bounds::estimate::TRUTH_WITHIN);
    let figure = format!("{name}: the same, lower end of 95 %");
    table.check(&figure, Some(of.held_at_least), bounds::estimate::TRUTH_WITHIN_AT_LEAST);
    let figure = format!("{name}: median half-width over error");
    table.check(&figure, Some(of.ratio), bounds::estimate::HALF_WIDTH_OVER_ERROR);
}

/// Coverage and tightness in bands of the speed, for all schemes.
fn by_speed(table: &mut Table, groups: &[(&str, Gathered)]) {
    for (k, name) in QUANTITIES.iter().enumerate() {
        let mut low = 0.0;
        for high in BANDS {
            let all = groups.iter().flat_map(|(_, all)| &all.estimates[k]);
            let of = judge(all.filter(|t| (low..high).contains(&t.speed)));
            let band = format!("{name}, {low} to {high} m/s");
            let cases = format!("{} cases", of.cases);
            let (held, ratio) = (Some(of.held), Some(of.ratio));
            table.beside(&format!("{band}: truth within"), held, &cases, Unit::Fraction);
            table.beside(&format!("{band}: half-width over error"), ratio, &cases, Unit::One);
            low = high;
        }
    }
}

/// Figures of the estimates that are marked as guesses.
fn guesses(table: &mut Table) {
    let seed = SEED + GROUPS.len() as u64;
    let [beyond, unusual] = [Schemes::Random, Schemes::Unusual]
        .map(|schemes| gather(seed, &draw(schemes, true), OUTSIDE / 2, THREADS));
    for (k, name) in QUANTITIES.iter().enumerate() {
        let all = || beyond.estimates[k].iter().chain(&unusual.estimates[k]);
        let marked = all().filter(|t| t.basis == EstimateBasis::Guess);
        let of = judge(marked.clone());
        let share = marked.count() as f64 / all().count().max(1) as f64;
        let name = format!("outside of the fit, {name}");
        table.check(&format!("{name}: marked"), Some(share), bounds::estimate::MARKED);
        let figure = format!("{name}: truth within");
        table.check(&figure, Some(of.held), bounds::estimate::GUESS_WITHIN);
        let figure = format!("{name}: median half-width over error");
        table.check(&figure, Some(of.ratio), bounds::estimate::GUESS_OVER_ERROR);
    }
}
