//! The list of cheapest choices: target errors, the cheapest case that reaches each, and its cost.

use super::StudyRow;
use super::curves::quantity;
use super::spec::Choices;

/// The list as a Markdown table.
pub fn markdown(choices: &Choices, rows: &[StudyRow]) -> String {
    let (name, unit, factor) = quantity(&choices.error);
    let mut text = format!(
        "| {name} wanted | cheapest choice | {name} | CPU seconds of the time loop |\n|---|---|---|---|\n"
    );
    for &wanted in &choices.wanted {
        let shown = |v: f64| format!("{:.3} {unit}", v * factor);
        let (choice, error, cost) = match cheapest(choices, rows, wanted) {
            Some((row, error, cost)) => {
                let labels: Vec<String> = row
                    .labels
                    .iter()
                    .map(|(name, value)| match name.as_str() {
                        "scheme" => value.clone(),
                        _ => setting(name, value),
                    })
                    .collect();
                (labels.join(", "), shown(error), format!("{cost:.3}"))
            }
            None => ("none of these".into(), "-".into(), "-".into()),
        };
        text += &format!("| {:.2} {unit} | {choice} | {error} | {cost} |\n", wanted * factor);
    }
    text
}

/// A swept key and its value, in the unit used for curves.
fn setting(name: &str, value: &str) -> String {
    let (label, unit, factor) = quantity(name);
    let shown = match value.parse::<f64>() {
        Ok(number) => format!("{}", (number * factor * 1e9).round() / 1e9),
        Err(_) => value.to_string(),
    };
    format!("{} {shown} {unit}", label.to_lowercase()).trim_end().to_string()
}

/// The cheapest row whose error is at most `wanted`, its error and its cost \[s\].
pub fn cheapest<'a>(
    choices: &Choices,
    rows: &'a [StudyRow],
    wanted: f64,
) -> Option<(&'a StudyRow, f64, f64)> {
    rows.iter()
        .filter_map(|row| {
            let error = row.number(&choices.error, choices.time)?.abs();
            Some((row, error, row.seconds(|s| s.loop_cpu)?)).filter(|_| error <= wanted)
        })
        .min_by(|a, b| a.2.total_cmp(&b.2))
}
