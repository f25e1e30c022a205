//! The list of cheapest choices: target errors, the cheapest case that reaches each, and its cost.

use super::StudyRow;
use super::curves::{quantity, swept};
use super::means::{MeanRow, means};
use super::spec::{Choices, Study};

/// The list as a Markdown table. With means it also has the greatest error of a choice.
pub fn markdown(study: &Study, choices: &Choices, rows: &[StudyRow]) -> String {
    let (name, unit, factor) = quantity(&choices.error);
    let is_mean = !choices.over.is_empty();
    let [of, more] = match is_mean {
        true => ["mean ", " greatest |"],
        false => ["", ""],
    };
    let mut text = format!(
        "| {of}{name} wanted | cheapest choice | {of}{name} |{more} CPU seconds of the time loop |\n"
    );
    text += if is_mean { "|---|---|---|---|---|\n" } else { "|---|---|---|---|\n" };
    let means = means(study, rows.iter(), &choices.over);
    let shown = |v: f64| format!("{:.3} {unit}", v * factor);
    for &wanted in &choices.wanted {
        text += &format!("| {:.2} {unit} | ", wanted * factor);
        let Some((row, error, cost)) = cheapest(choices, &means, wanted) else {
            text +=
                if is_mean { "none of these | - | - | - |\n" } else { "none of these | - | - |\n" };
            continue;
        };
        let labels: Vec<String> = study
            .labels()
            .into_iter()
            .filter(|label| !choices.over.iter().any(|over| over == label))
            .filter_map(|label| Some((label, row.first().labels.get(label)?)))
            .map(|(label, value)| match label {
                "scheme" => value.clone(),
                _ => setting(label, value),
            })
            .collect();
        text += &format!("{} | {} | ", labels.join(", "), shown(error));
        if let (true, Some(greatest)) = (is_mean, row.greatest(&choices.error, choices.time)) {
            text += &format!("{} | ", shown(greatest));
        }
        text += &format!("{cost:.3} |\n");
    }
    text
}

/// A swept key and its value, in the unit used for curves.
fn setting(name: &str, value: &str) -> String {
    let number = value.parse::<f64>();
    let (label, unit, factor) = swept(name, number.clone().unwrap_or(0.0));
    let shown = match number {
        Ok(number) => format!("{}", (number * factor * 1e9).round() / 1e9),
        Err(_) => value.to_string(),
    };
    format!("{} {shown} {unit}", label.to_lowercase()).trim_end().to_string()
}

/// The cheapest row whose error is at most `wanted`, its error and its cost \[s\].
fn cheapest<'a, 'r>(
    choices: &Choices,
    rows: &'a [MeanRow<'r>],
    wanted: f64,
) -> Option<(&'a MeanRow<'r>, f64, f64)> {
    rows.iter()
        .filter_map(|row| {
            let error = row.mean(&choices.error, choices.time)?;
            let cost = row.mean("loop_cpu_seconds", None)?;
            Some((row, error, cost)).filter(|_| error <= wanted)
        })
        .min_by(|a, b| a.2.total_cmp(&b.2))
}
