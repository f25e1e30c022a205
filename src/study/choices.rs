//! The error wanted, the cheapest choice that reaches it, and its cost.

use super::Row;
use super::curves::quantity;
use super::spec::Choices;

/// The list as a table in Markdown.
pub fn markdown(choices: &Choices, rows: &[Row]) -> String {
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

/// A swept key and its value, in the unit that curves show it in.
fn setting(name: &str, value: &str) -> String {
    let (label, unit, factor) = quantity(name);
    let shown = match value.parse::<f64>() {
        Ok(number) => format!("{}", (number * factor * 1e9).round() / 1e9),
        Err(_) => value.to_string(),
    };
    format!("{} {shown} {unit}", label.to_lowercase()).trim_end().to_string()
}

/// The cheapest row whose error is at most the one wanted, its error and its cost \[s\].
pub fn cheapest<'a>(
    choices: &Choices,
    rows: &'a [Row],
    wanted: f64,
) -> Option<(&'a Row, f64, f64)> {
    rows.iter()
        .filter_map(|row| {
            let error = row.number(&choices.error, choices.time)?.abs();
            Some((row, error, row.seconds(|s| s.loop_cpu)?)).filter(|_| error <= wanted)
        })
        .min_by(|a, b| a.2.total_cmp(&b.2))
}
