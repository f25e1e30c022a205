//! The report that a run prints at its end without `--verbose`: at most ten lines of at most 100
//! characters, and the warnings.

use std::path::Path;

use super::labels;
use super::report::{measured, planned, seconds, significant, significant_to, table};
use super::summary::{ProfileSummary, Summary};
use super::wrap::{WIDTH, warning, wrapped};
use crate::accuracy::estimate::{Bounded, EstimateBasis, EstimatedErrors};

/// Errors in the brief report: key, label, unit.
const ERRORS: [(&str, &str, &str); 9] = [
    ("l1", labels::MEAN_PRESSURE_ERROR, " %"),
    ("rise_cells", labels::SHOCK_WIDTH, " cells"),
    ("overshoot", labels::OVERSHOOT, " %"),
    ("density_l1", labels::MEAN_DENSITY_ERROR, " %"),
    ("mean_density_error", labels::SHOCK_DENSITY_ERROR, " %"),
    ("displacement_l2", labels::DISPLACEMENT_ERROR, " %"),
    ("angular_momentum_loss", labels::LOST_ANGULAR_MOMENTUM, " %"),
    ("velocity_rms", labels::VELOCITY_ERROR, " %"),
    ("pressure_rms", labels::PRESSURE_ERROR, " %"),
];

/// Largest number of lines, warnings aside.
const LINES: usize = 10;

/// Width of the column of labels, and of the spaces beside it.
const LABELS: usize = 16;

/// Title, warnings, physical quantities, errors of the last profile, conservation, size, time and
/// the folder of the files. `--verbose` and `summary.json` have the rest.
pub fn brief(summary: &Summary, folder: &Path) -> String {
    let line = |label: &str, text: &str| format!("  {label:width$}{text}", width = LABELS - 2);
    let folded = |(label, text): &(&str, String)| wrapped(&line(label, text), LABELS) + "\n";
    let lines: String = facts(summary).iter().map(folded).collect();
    // title, heading of the quantities and the last line
    let room = LINES.saturating_sub(3 + lines.lines().count());
    let shown = &summary.measured[..summary.measured.len().min(room)];
    let quantities = if shown.is_empty() { String::new() } else { table(&measured(shown)) };
    // a path stays in one piece, so that it can be copied
    let results = line(labels::RESULTS, &folder.display().to_string()) + "\n";
    title(&summary.title) + &warnings(summary) + &quantities + &lines + &results
}

/// The title, shortened to one line.
fn title(text: &str) -> String {
    match text.chars().count() > WIDTH {
        true => text.chars().take(WIDTH - 3).collect::<String>() + "...\n",
        false => format!("{text}\n"),
    }
}

/// The warnings of the run, and what makes its error estimates uncertain.
fn warnings(summary: &Summary) -> String {
    let mut all = summary.warnings.clone();
    if let Some(estimate) = &summary.error_estimate {
        if estimate.basis == EstimateBasis::Guess && !estimate.outside.is_empty() {
            let outside = estimate.outside.join("; ");
            all.push(format!(
                "the estimated errors are guesses, since the error models were not fitted to such \
                 inputs: {outside}"
            ));
        }
        all.extend(estimate.notes.iter().cloned());
    }
    all.iter().map(|text| warning(text) + "\n").collect()
}

/// Label and text of each line below the quantities, but for the last.
fn facts(summary: &Summary) -> Vec<(&'static str, String)> {
    let mut facts = Vec::new();
    facts.extend(last_errors(&summary.profiles).map(|text| (labels::ERRORS, text)));
    let drifts = [("energy", summary.energy.drift), ("momentum", summary.momentum.drift)];
    let drifts =
        drifts.iter().filter_map(|(of, d)| Some(format!("{of} {:.1e}", d.as_ref()?.abs())));
    let drifts: Vec<String> = drifts.collect();
    if !drifts.is_empty() {
        facts.push((labels::CONSERVATION, format!("relative errors: {}", drifts.join(", "))));
    }
    facts.extend(counted_particles(summary).map(|text| (labels::PARTICLES, text)));
    for text in summary.error_estimate.iter().flat_map(estimates) {
        facts.push((labels::ESTIMATE, text));
    }
    facts.extend(summary.plan.iter().map(|plan| (labels::PLAN, planned(plan))));
    let plural = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    facts.push((
        labels::RUN,
        format!(
            "{} particles, {} steps, {}, {}: {} s",
            summary.particles,
            summary.steps,
            plural(summary.ranks, "rank"),
            plural(summary.threads, "thread"),
            significant(summary.wall_seconds)
        ),
    ));
    facts
}

/// As many of `parts` as one line has room for, at least one.
fn in_one_line(parts: &[String], separator: &str, end: &str) -> String {
    let mut text = String::new();
    for part in parts {
        let longer = if text.is_empty() { part.clone() } else { text.clone() + separator + part };
        if !text.is_empty() && (longer.clone() + end).chars().count() > WIDTH - LABELS {
            break;
        }
        text = longer;
    }
    text + end
}

/// Errors of the last profile that has any, in words.
fn last_errors(profiles: &[ProfileSummary]) -> Option<String> {
    let last = profiles.iter().rfind(|profile| profile.errors.is_some())?;
    let words = |(key, before, after): &(&str, &str, &str)| {
        let scale = if after.contains('%') { 100.0 } else { 1.0 };
        Some(format!("{before} {}{after}", significant(scale * last.error(key)?)))
    };
    let all: Vec<String> = ERRORS.iter().filter_map(words).collect();
    let end = format!(", at {}", seconds(last.time));
    (!all.is_empty()).then(|| in_one_line(&all, ", ", &end))
}

/// Numbers of the particles that have failed, were removed, or have left the domain.
fn counted_particles(summary: &Summary) -> Option<String> {
    let mut counts = Vec::new();
    if let Some(failure) = &summary.failure {
        counts.push((failure.particles, "failed"));
        counts.push((failure.damaged, "damaged"));
    }
    counts.extend(summary.erosion.as_ref().map(|out| (out.particles, "eroded")));
    counts.extend(summary.outflow.as_ref().map(|out| (out.particles, "left the domain")));
    let words = counts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}"));
    let words: Vec<String> = words.collect();
    (!words.is_empty()).then(|| words.join(", "))
}

/// The estimated errors of the last profile, and those of as many arrivals and fields as one line has
/// room for.
fn estimates(estimate: &EstimatedErrors) -> Vec<String> {
    let within = |bounded: &Bounded, scale: f64, unit: &str| match bounded.half_width {
        Some(width) => {
            let [value, width] = [bounded.value, width].map(|v| v * scale);
            format!("{} +- {} {unit}", significant_to((value, width)), significant(width))
        }
        None => format!("{} {unit}, error not known", significant(bounded.value * scale)),
    };
    let guess = |basis: EstimateBasis| if basis == EstimateBasis::Guess { " (guess)" } else { "" };
    let last = estimate.profiles.last().map(|profile| {
        let plateau = match &profile.plateau_pressure {
            Some(bounded) => format!("plateau {}", within(bounded, 1e-9, "GPa")),
            None => "no plateau".into(),
        };
        let l1 = match profile.l1.half_width {
            Some(bound) => format!("L1 at most {} %", significant(100.0 * bound)),
            None => "L1 not known".into(),
        };
        format!("{plateau}; {l1}, at {}{}", seconds(profile.time), guess(profile.basis))
    });
    let arrivals = estimate.arrivals.iter().map(|arrival| {
        let time = match &arrival.time {
            Some(bounded) => format!("arrival {}", within(bounded, 1e9, "ns")),
            None => "nothing has arrived".into(),
        };
        format!("at {} mm: {time}{}", significant(1e3 * arrival.at), guess(arrival.basis))
    });
    let last_time = estimate.fields.iter().map(|field| field.time).reduce(f64::max);
    let fields = estimate.fields.iter().filter(|field| Some(field.time) == last_time);
    let fields = fields.filter_map(|field| {
        let bound = significant(100.0 * field.l1.half_width?);
        let at = seconds(field.time);
        Some(format!("{} L1 at most {bound} %, at {at}{}", field.quantity, guess(field.basis)))
    });
    let others: Vec<String> = arrivals.chain(fields).collect();
    let others = (!others.is_empty()).then(|| in_one_line(&others, "; ", ""));
    last.into_iter().chain(others).collect()
}

#[cfg(test)]
mod tests {
    use super::super::summary::tests::example;
    use super::super::summary::{FailureSummary, OutflowSummary};
    use super::*;
    use crate::accuracy::estimate::{ArrivalEstimate, FieldEstimate, ProfileEstimate};
    use crate::accuracy::plan::Verdict;
    use crate::scene::PlannedQuantity;

    #[test]
    fn the_physics_come_first_and_the_last_errors_follow() {
        let expected = "\
flyer
warning: linear shape functions ring across cells
               time    computed       exact  difference
  shock speed  1 us  6343.5 m/s  6343.0 m/s   0.00788 %
  errors        mean pressure error 0.890 %, at 0.5 us
  conservation  relative errors: energy 5.0e-2, momentum 0.0e0
  run           1700 particles, 2612 steps, 2 ranks, 1 thread: 1.25 s
  results       output/flyer
";
        let text = brief(&example(), Path::new("output/flyer"));
        assert_eq!(text, expected);
        assert!(text.lines().all(|line| line.len() <= WIDTH));
    }

    /// A summary with everything that a run can report.
    fn full_summary() -> Summary {
        let mut summary = example();
        summary.warnings.clear();
        summary.title = "A long title. ".repeat(20);
        let quantity = summary.measured[0].clone();
        summary.measured = vec![quantity; 9];
        let failure = FailureSummary { particles: 7, damaged: 11, released_energy: 1.5 };
        summary.failure = Some(failure);
        let outflow = OutflowSummary { particles: 2, mass: 0.5, momentum: vec![0.25], energy: 2.0 };
        summary.erosion = Some(OutflowSummary { particles: 3, ..outflow.clone() });
        summary.outflow = Some(outflow);
        let all = ERRORS.iter().map(|(key, ..)| ((*key).to_string(), 0.0123.into()));
        let errors = serde_json::Value::Object(all.collect());
        summary.profiles.iter_mut().for_each(|profile| profile.errors = Some(errors.clone()));
        let bounded = |value: f64| Bounded {
            value,
            half_width: Some(1e-3 * value),
            evidence: Default::default(),
            exact: Some(value),
        };
        let basis = EstimateBasis::Guess;
        let plateau_pressure = Some(bounded(12.3e9));
        let l1 = Bounded { value: 0.0, half_width: Some(0.01), ..bounded(0.0) };
        let field =
            FieldEstimate { time: 1e-6, quantity: "velocity".into(), basis, l1: l1.clone() };
        let profile = ProfileEstimate { time: 1e-6, basis, plateau_pressure, l1 };
        let arrival = ArrivalEstimate { at: 5e-3, basis, time: Some(bounded(1e-6)) };
        summary.error_estimate = Some(EstimatedErrors {
            body: Some("target".into()),
            basis,
            outside: vec!["bodies: 3".into()],
            companions: vec![2e-5, 4e-5],
            cpu_seconds: 0.1,
            profiles: vec![profile; 5],
            arrivals: vec![arrival; 5],
            fields: vec![field; 2],
            notes: vec!["no estimate at 2 us".into()],
            ..EstimatedErrors::default()
        });
        summary.plan = Some(Verdict {
            quantity: PlannedQuantity::L1,
            wanted: 8.91e-5,
            predicted: 8.92e-5,
            guess: true,
            actual: Some(8.93e-5),
            is_true: false,
            predicted_cpu_seconds: 1.0,
            cpu_seconds: 1.0,
            predicted_wall_seconds: 1.0,
            wall_seconds: 1.0,
        });
        summary
    }

    #[test]
    fn every_report_has_ten_short_lines_and_its_warnings() {
        let folder = format!("output/{}", "a long name ".repeat(10));
        let text = brief(&full_summary(), Path::new(folder.trim()));
        let starts_warning = |line: &&str| line.starts_with("warning: ");
        // a warning goes on in lines with the indent of its text
        let indent = " ".repeat("warning: ".len());
        let goes_on = |line: &str| line.strip_prefix(&indent).is_some_and(|l| !l.starts_with(' '));
        let is_warning = |line: &&str| starts_warning(line) || goes_on(line);
        let lines: Vec<&str> = text.lines().filter(|line| !is_warning(line)).collect();
        assert_eq!(text.lines().filter(starts_warning).count(), 2, "{text}");
        assert_eq!(lines.len(), LINES, "{text}");
        let (last, others) = lines.split_last().unwrap();
        assert!(others.iter().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert_eq!(*last, format!("  results       {}", folder.trim()));
        for line in [
            "  particles     7 failed, 11 damaged, 3 eroded, 2 left the domain",
            "  estimate      plateau 12.300 +- 0.0123 GPa; L1 at most 1.00 %, at 1 us (guess)",
            "  plan          target 0.00891 %, predicted 0.00892 % (guess), actual at most 0.00893 % by its own",
        ] {
            assert!(lines.contains(&line), "{text}");
        }
        let words: Vec<&str> = text.split_whitespace().collect();
        assert!(words.join(" ").contains("not fitted to such inputs: bodies: 3"), "{text}");
    }

    #[test]
    fn without_a_body_the_errors_of_fields_are_reported() {
        let mut summary = full_summary();
        let estimate = summary.error_estimate.as_mut().unwrap();
        estimate.profiles.clear();
        estimate.arrivals.clear();
        estimate.fields[0].time = 5e-7;
        let line = "  estimate      velocity L1 at most 1.00 %, at 1 us (guess)";
        let text = brief(&summary, Path::new("out"));
        let estimates: Vec<&str> =
            text.lines().filter(|line| line.trim_start().starts_with(labels::ESTIMATE)).collect();
        assert_eq!(estimates, [line], "{text}");
    }

    #[test]
    fn numbers_of_particles_that_are_zero_are_left_out() {
        let mut summary = example();
        let none = OutflowSummary { particles: 0, mass: 0.0, momentum: vec![0.0], energy: 0.0 };
        summary.outflow = Some(none);
        let text = brief(&summary, Path::new("out"));
        assert!(
            text.lines().all(|line| !line.trim_start().starts_with(labels::PARTICLES)),
            "{text}"
        );
    }
}
