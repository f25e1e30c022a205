//! The full report that a run prints at its end with `--verbose`; `brief` has the report of other
//! runs.

use std::fmt::Write;
use std::path::Path;

use super::decomposition::{DecompositionSummary, RankSummary};
use super::labels;
use super::summary::{FailureSummary, MeasuredQuantity, OutflowSummary, ProfileSummary, Summary};
use super::wrap::warning;
use crate::accuracy::estimate::{Bounded, EstimateBasis, EstimatedErrors};
use crate::accuracy::plan::Verdict;
use crate::effects::{ledger_lines, ledger_rest};
use crate::solver::clock::Activity;

/// Errors of a profile: key, heading, and whether they are shown in per cent.
const ERRORS: [(&str, &str, bool); 22] = [
    ("l1", "L1 %", true),
    ("l2", "L2 %", true),
    ("e1_cells", "E1 cells", false),
    ("plateau", "plateau %", true),
    ("noise", "noise %", true),
    ("shock_position_cells", "shock position cells", false),
    ("rise_cells", "rise cells", false),
    ("overshoot", "overshoot %", true),
    ("second_plateau", "second plateau %", true),
    ("density_plateau", "plateau density %", true),
    ("energy_plateau", "plateau energy %", true),
    ("density_interface", "interface density %", true),
    ("energy_interface", "interface energy %", true),
    ("displacement_l2", "displacement L2 %", true),
    ("angular_momentum_loss", "angular momentum lost %", true),
    ("energy_loss", "energy lost %", true),
    ("kinetic_energy_loss", "kinetic energy lost %", true),
    ("velocity_rms", "velocity rms %", true),
    ("pressure_rms", "pressure rms %", true),
    ("pressure_form_rms", "form rms %", true),
    ("mean_density", "density", false),
    ("mean_density_error", "density error %", true),
];

/// Title and warnings.
fn heading(summary: &Summary) -> String {
    let warnings = summary.warnings.iter().map(|text| warning(text) + "\n");
    format!("{}\n{}", summary.title, warnings.collect::<String>())
}

fn named(facts: Vec<(&str, String)>) -> Vec<Vec<String>> {
    facts.into_iter().map(|(name, text)| vec![name.to_owned(), text]).collect()
}

/// One line per quantity; the columns of exact values only if one is known.
pub(super) fn measured(all: &[MeasuredQuantity]) -> Vec<Vec<String>> {
    let known = all.iter().any(|quantity| quantity.exact.is_some());
    let mut lines = vec![["", "time", "computed"].map(String::from).to_vec()];
    lines[0].extend(["exact", "difference"].into_iter().filter(|_| known).map(String::from));
    for quantity in all {
        let (unit, scale) = match quantity.unit.as_str() {
            "Pa" if quantity.value.abs() >= 1e8 => ("GPa", 1e-9),
            "Pa" if quantity.value.abs() >= 1e5 => ("MPa", 1e-6),
            "m" if quantity.value.abs() < 0.1 => ("mm", 1e3),
            unit => (unit, 1.0),
        };
        let number = |value: f64| five_digits(value * scale);
        let mut line = vec![quantity.name.clone(), seconds(quantity.time)];
        line.push(format!("{} {unit}", number(quantity.value)));
        if known {
            line.push(
                quantity.exact.map_or("-".into(), |exact| format!("{} {unit}", number(exact))),
            );
            let off = quantity.exact.filter(|exact| *exact != 0.0);
            line.push(off.map_or("-".into(), |exact| {
                format!("{} %", significant(100.0 * (quantity.value / exact - 1.0)))
            }));
        }
        lines.push(line);
    }
    lines
}

/// A number with five significant digits.
fn five_digits(value: f64) -> String {
    let whole = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    format!("{value:.*}", (4 - whole).clamp(0, 12) as usize)
}

/// The full report: errors of each profile, ranks, effects, energy, momentum, steps, times and the
/// folder of the files, as aligned text.
pub fn full(summary: &Summary, folder: &Path) -> String {
    let mut text = heading(summary);
    if !summary.measured.is_empty() {
        text += &table(&measured(&summary.measured));
    }
    if summary.profiles.iter().any(|p| p.errors.is_some()) {
        text += &table(&errors(&summary.profiles));
    }
    if summary.ranks > 1 {
        text += &table(&ranks(&summary.decomposition));
    }
    text += &table(&ledger_lines(&summary.effects));
    text += &format!("  {}\n", ledger_rest(&summary.effects));
    text += &table(&facts(summary, folder));
    text
}

/// Largest number of ranks with a line each; `summary.json` has all.
const LISTED: usize = 16;

/// One line per rank: its times by activity, and its messages. Of many ranks the least, the median and
/// the greatest value of each column.
fn ranks(sharing: &DecompositionSummary) -> Vec<Vec<String>> {
    let activities = || Activity::ALL.iter().map(|a| a.name());
    let mut heading: Vec<String> = vec!["ranks".into(), "patches".into(), "particles".into()];
    heading.extend(activities().map(|name| format!("{name} s")));
    heading.extend(["messages", "bytes", "migrated"].map(String::from));
    let values = |rank: &RankSummary| {
        let seconds = |name| rank.seconds.get(name).copied().unwrap_or(0.0);
        let mut values = vec![rank.patches as f64, rank.particles as f64];
        values.extend(activities().map(seconds));
        values.extend([rank.messages, rank.bytes, rank.particles_migrated].map(|n| n as f64));
        values
    };
    let times = 3..3 + Activity::ALL.len();
    let line = |name: String, values: Vec<f64>| {
        let digits = |column: usize| if times.contains(&column) { 3 } else { 0 };
        let cells = values.iter().enumerate().map(|(k, v)| format!("{v:.*}", digits(k + 1)));
        [name].into_iter().chain(cells).collect()
    };
    let all: Vec<Vec<f64>> = sharing.ranks.iter().map(values).collect();
    let mut lines = vec![heading];
    if all.len() <= LISTED {
        let numbers = sharing.ranks.iter().map(|rank| format!("rank {}", rank.rank));
        lines.extend(numbers.zip(all).map(|(name, values)| line(name, values)));
        return lines;
    }
    let sorted = |column: usize| {
        let mut values: Vec<f64> = all.iter().map(|rank| rank[column]).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let columns: Vec<Vec<f64>> = (0..all[0].len()).map(sorted).collect();
    for (name, place) in [("least", 0), ("median", all.len() / 2), ("greatest", all.len() - 1)] {
        lines.push(line(name.into(), columns.iter().map(|values| values[place]).collect()));
    }
    lines
}

/// One line per profile; errors that no profile has are omitted.
fn errors(profiles: &[ProfileSummary]) -> Vec<Vec<String>> {
    let mut shown: Vec<(String, String, bool)> =
        ERRORS.iter().map(|(key, head, p)| ((*key).into(), (*head).into(), *p)).collect();
    // error keys of other references
    for (key, _) in profiles.iter().filter_map(|p| p.errors.as_ref()?.as_object()).flatten() {
        if !shown.iter().any(|(name, ..)| name == key) {
            shown.push((key.clone(), key.replace('_', " "), false));
        }
    }
    shown.retain(|(key, ..)| profiles.iter().any(|p| p.error(key).is_some()));
    let heading = ["time".to_owned()].into_iter().chain(shown.iter().map(|(_, h, _)| h.clone()));
    let mut lines = vec![heading.collect::<Vec<_>>()];
    for profile in profiles {
        let value = |key: &str, percent: bool| match profile.error(key) {
            None => "-".to_owned(),
            Some(value) => significant(value * if percent { 100.0 } else { 1.0 }),
        };
        let values = shown.iter().map(|(key, _, percent)| value(key, *percent));
        lines.push([seconds(profile.time)].into_iter().chain(values).collect());
    }
    lines
}

fn facts(summary: &Summary, folder: &Path) -> Vec<Vec<String>> {
    let Summary { energy, momentum, .. } = summary;
    let per = per_extent(momentum.start.len());
    let drift = |d: Option<f64>| d.map_or("-".into(), |d| format!("{d:.1e}"));
    let vector = |v: &[f64]| v.iter().map(|v| format!("{v:.6e}")).collect::<Vec<_>>().join(" ");
    let joined = |n: &[usize]| n.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ");
    let mut facts = vec![
        (
            "energy",
            format!(
                "start {:.6e}  end {:.6e} J{per}  boundaries {:.2e}  drift {}",
                energy.total_start,
                energy.total_end,
                energy.boundary_work,
                drift(energy.drift)
            ),
        ),
        (
            "momentum",
            format!(
                "start {}  end {} kg m/s{per}  boundaries {}  drift {}",
                vector(&momentum.start),
                vector(&momentum.end),
                vector(&momentum.boundary_impulse),
                drift(momentum.drift)
            ),
        ),
    ];
    facts.extend(events(summary));
    facts.push((
        "run",
        format!(
            "{} particles, {} cells, {} steps, {} ranks x {} threads, {} patches",
            summary.particles,
            summary.cells,
            summary.steps,
            summary.ranks,
            summary.threads,
            joined(&summary.patches)
        ),
    ));
    facts.push((
        "seconds",
        format!(
            "{:.3} in all, {:.3} in the time loop, {:.3} of CPU, {:.2} M particle-steps per CPU second",
            summary.wall_seconds,
            summary.loop_wall_seconds,
            summary.cpu_seconds,
            summary.particle_steps_per_cpu_second * 1e-6
        ),
    ));
    let sharing = &summary.decomposition;
    let all = sharing.particle_steps_computed + sharing.particle_steps_skipped;
    let left_out = 100.0 * sharing.particle_steps_skipped as f64 / all.max(1) as f64;
    let mut shared = format!("{left_out:.1} % of particle-steps left out at rest");
    if summary.ranks > 1 {
        shared += &format!(
            ", imbalance {:.3}, {} patches moved, {} particles migrated, {:.1} messages and {:.0} bytes a step",
            sharing.imbalance,
            sharing.patches_moved,
            sharing.particles_migrated,
            sharing.messages_per_step,
            sharing.bytes_per_step
        );
    }
    facts.push(("sharing", shared));
    facts.push(("results", folder.display().to_string()));
    named(facts)
}

/// Unit of an integral over a body, without that of its density.
fn per_extent(dimension: usize) -> &'static str {
    ["/m2", "/m", ""][dimension.clamp(1, 3) - 1]
}

/// What happened in the run: outflow, erosion, failure, estimated errors, plan.
fn events(summary: &Summary) -> Vec<(&'static str, String)> {
    let per = per_extent(summary.momentum.start.len());
    let mut facts = Vec::new();
    if let Some(out) = &summary.outflow {
        facts.push(("outflow", format!("{} particles, {:.6e} kg{per}", out.particles, out.mass)));
    }
    if let Some(out) = &summary.erosion {
        let OutflowSummary { particles, mass, energy, .. } = out;
        let what = format!("{particles} particles, {mass:.6e} kg{per}, {energy:.6e} J{per}");
        facts.push(("erosion", format!("{what} taken out")));
    }
    if let Some(failure) = &summary.failure {
        let FailureSummary { particles, damaged, released_energy } = failure;
        let text = format!(
            "{particles} particles have failed, {damaged} are damaged; {released_energy:.6e} J{per} \
             of elastic energy is heat"
        );
        facts.push(("failure", text));
    }
    if let Some(estimate) = &summary.error_estimate {
        facts.extend(estimate_facts(estimate));
    }
    facts.extend(summary.plan.iter().map(|plan| (labels::PLAN, plan_fact(plan))));
    facts
}

/// Predicted and actual error of a plan.
pub(super) fn planned(plan: &Verdict) -> String {
    let percent = |v: f64| format!("{} %", significant(100.0 * v));
    let actual = match (plan.actual, plan.is_true) {
        (Some(error), true) => percent(error),
        (Some(bound), false) => format!("at most {} by its own bound", percent(bound)),
        (None, _) => "not known".into(),
    };
    format!(
        "target {}, predicted {}{}, actual {actual}",
        percent(plan.wanted),
        percent(plan.predicted),
        if plan.guess { " (guess)" } else { "" },
    )
}

/// Predicted and actual values of a plan.
fn plan_fact(plan: &Verdict) -> String {
    format!(
        "{}; CPU seconds of the time loop predicted {:.3}, actual {:.3}; wall {:.3}, {:.3}",
        planned(plan),
        plan.predicted_cpu_seconds,
        plan.cpu_seconds,
        plan.predicted_wall_seconds,
        plan.wall_seconds
    )
}

/// Estimated errors of a run, one line per profile and per arrival.
fn estimate_facts(estimate: &EstimatedErrors) -> Vec<(&'static str, String)> {
    let within = |b: &Bounded, scale: f64, unit: &str| match b.half_width {
        Some(width) => {
            let exact = b.exact.map_or(String::new(), |e| {
                format!(", exact {}", significant_to((e * scale, width * scale)))
            });
            let value = significant_to((b.value * scale, width * scale));
            format!("{value} +- {} {unit}{exact}", significant(width * scale))
        }
        None => format!("{} {unit}, too little evidence of its error", b.value * scale),
    };
    let guess = |basis: EstimateBasis| if basis == EstimateBasis::Guess { " (guess)" } else { "" };
    let mut facts = Vec::new();
    for profile in &estimate.profiles {
        let guess = guess(profile.basis);
        let plateau = match &profile.plateau_pressure {
            Some(bounded) => format!("plateau {}", within(bounded, 1e-9, "GPa")),
            None => "no plateau".into(),
        };
        let l1 = match profile.l1.half_width {
            Some(bound) => format!("L1 <= {} %", significant(100.0 * bound)),
            None => "L1 not known".into(),
        };
        let exact = profile.l1.exact;
        let exact = exact.map_or(String::new(), |e| format!(", exact {}", significant(100.0 * e)));
        facts.push((
            labels::ESTIMATE,
            format!("{}: {plateau}; {l1}{exact}{guess}", seconds(profile.time)),
        ));
    }
    for arrival in &estimate.arrivals {
        let time = match &arrival.time {
            Some(bounded) => format!("arrival {}", within(bounded, 1e9, "ns")),
            None => "nothing has arrived".into(),
        };
        let guess = guess(arrival.basis);
        facts.push((
            labels::ESTIMATE,
            format!("at {} mm: {time}{guess}", significant(1e3 * arrival.at)),
        ));
    }
    let bound = |l1: &Bounded| match l1.half_width {
        Some(bound) => format!("L1 <= {} % (guess)", significant(100.0 * bound)),
        None => "L1 not known".into(),
    };
    for field in &estimate.fields {
        let text = format!("{}: {} {}", seconds(field.time), field.quantity, bound(&field.l1));
        facts.push((labels::ESTIMATE, text));
    }
    for history in &estimate.histories {
        let text = format!("{}: {} {}", history.gauge, history.quantity, bound(&history.l1));
        facts.push((labels::ESTIMATE, text));
    }
    if estimate.basis == EstimateBasis::Guess && !estimate.outside.is_empty() {
        let outside = estimate.outside.join("; ");
        let text = format!("guess: the laws of errors were not fitted on such inputs: {outside}");
        facts.push((labels::ESTIMATE, text));
    }
    facts.extend(estimate.notes.iter().map(|note| (labels::ESTIMATE, note.clone())));
    facts
}

/// A value with as many digits as its half width justifies.
pub(super) fn significant_to((value, width): (f64, f64)) -> String {
    let digits = (1 - width.abs().max(1e-12).log10().floor() as i32).clamp(0, 12) as usize;
    format!("{value:.digits$}")
}

/// Cells as aligned columns: the first column left-aligned, the others right-aligned.
pub(super) fn table(lines: &[Vec<String>]) -> String {
    let columns = lines.iter().map(Vec::len).max().unwrap_or(0);
    let length = |s: &String| s.chars().count();
    let width = |i: usize| lines.iter().filter_map(|l| l.get(i)).map(length).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for line in lines {
        let mut row = String::new();
        for (i, (cell, &width)) in line.iter().zip(&widths).enumerate() {
            // a table of two columns holds names and sentences, a wider one numbers
            let _ = match i {
                0 => write!(row, "  {cell:width$}"),
                _ if columns == 2 => write!(row, "  {cell}"),
                _ => write!(row, "  {cell:>width$}"),
            };
        }
        text += row.trim_end();
        text.push('\n');
    }
    text
}

/// A number with three significant digits.
pub(super) fn significant(value: f64) -> String {
    let size = value.abs();
    match size {
        _ if value == 0.0 => "0".into(),
        _ if !(1e-3..1e4).contains(&size) => format!("{value:.1e}"),
        _ => format!("{value:.*}", (2 - size.log10().floor() as i32).max(0) as usize),
    }
}

/// A time [s] as text with a suitable unit.
pub(super) fn seconds(time: f64) -> String {
    let (unit, scale) = match time {
        t if t >= 0.1 => ("s", 1.0),
        t if t >= 1e-3 => ("ms", 1e3),
        t if t >= 1e-8 => ("us", 1e6),
        _ => ("ns", 1e9),
    };
    format!("{} {unit}", (time * scale * 1e6).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::super::summary::tests::example;
    use super::*;

    #[test]
    fn five_digits_are_kept() {
        let texts = [0.0, 29.80695, 6343.512, 0.012345678, 123456.7].map(five_digits);
        assert_eq!(texts, ["0.0000", "29.807", "6343.5", "0.012346", "123457"]);
    }

    #[test]
    fn the_full_report_has_every_figure() {
        let mut summary = example();
        summary.profiles[1].errors = Some(serde_json::json!({"l1": 0.01, "density_l1": 0.5}));
        let text = full(&summary, Path::new("output/flyer"));
        let expected = "\
flyer
warning: linear shape functions ring across cells
               time    computed       exact  difference
  shock speed  1 us  6343.5 m/s  6343.0 m/s   0.00788 %
  time     L1 %  plateau %  density l1
  0.5 us  0.890   -0.00100           -
  1 us     1.00          -       0.500
  ranks   patches  particles  compute s  exchange s  wait s  migrate s  balance s  output s  messages     bytes  migrated
  rank 0        2        850      0.600       0.000   0.100      0.000      0.000     0.000      5224  26120000         7
  rank 1        2        850      0.600       0.000   0.100      0.000      0.000     0.000      5224  26120000         7
  effect    bytes per particle  bytes per ghost  share of step
  strength                   8                0         12.5 %
  off, 0 bytes and 0 % of the step: contact
  energy    start 1.000000e1  end 1.100000e1 J/m2  boundaries 5.00e-1  drift 5.0e-2
  momentum  start 8.000000e0  end 8.000000e0 kg m/s/m2  boundaries 0.000000e0  drift 0.0e0
  run       1700 particles, 1000 cells, 2612 steps, 2 ranks x 1 threads, 4 patches
  seconds   1.250 in all, 0.750 in the time loop, 2.000 of CPU, 5.90 M particle-steps per CPU second
  sharing   25.0 % of particle-steps left out at rest, imbalance 1.200, 1 patches moved, 14 particles migrated, 4.0 messages and 20000 bytes a step
  results   output/flyer
";
        assert_eq!(text, expected);
    }

    #[test]
    fn many_ranks_have_a_distribution() {
        let mut sharing = example().decomposition;
        let rank = sharing.ranks[0].clone();
        sharing.ranks = (0..100)
            .map(|k| RankSummary { rank: k, particles: 1000 - k as u64, ..rank.clone() })
            .collect();
        let lines = ranks(&sharing);
        let particles: Vec<&str> = lines.iter().map(|line| line[2].as_str()).collect();
        assert_eq!(particles, ["particles", "901", "951", "1000"]);
        assert_eq!(lines[2][..4], ["median", "2", "951", "0.600"]);
    }

    #[test]
    fn without_a_reference_there_are_no_errors() {
        let mut summary = example();
        summary.profiles[0].errors = None;
        assert!(!full(&summary, Path::new("out")).contains("L1"));
    }

    #[test]
    fn eroded_particles_are_counted() {
        let mut summary = example();
        let momentum = vec![0.25];
        summary.erosion = Some(OutflowSummary { particles: 7, mass: 0.5, momentum, energy: 2.0 });
        let line = "  erosion   7 particles, 5.000000e-1 kg/m2, 2.000000e0 J/m2 taken out\n";
        assert!(full(&summary, Path::new("out")).contains(line));
    }

    #[test]
    fn numbers_and_times_are_short() {
        assert_eq!(
            ["123.456", "12345.6", "0.0456", "1e-9"].map(|s| significant(s.parse().unwrap())),
            ["123", "1.2e4", "0.0456", "1.0e-9"]
        );
        assert_eq!([0.2, 0.05, 2e-7, 0.0].map(seconds), ["0.2 s", "50 ms", "0.2 us", "0 ns"]);
    }
}
