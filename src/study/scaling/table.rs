//! The table on standard output.

use super::row::ScalingRow;
use super::statistics::PARTS;

const HEAD: [&str; 7] =
    ["ranks x threads", "at rest", "wall s", "spread", "CPU s", "speed-up", "efficiency"];
const TAIL: [&str; 5] = ["bytes/step", "msgs/step", "imbalance", "skipped", "note"];

/// The rows as aligned text; a dash for values that were not counted.
pub fn text(rows: &[ScalingRow]) -> String {
    let head = HEAD.iter().chain(&PARTS).chain(&TAIL).map(|name| name.to_string()).collect();
    let lines: Vec<Vec<String>> = std::iter::once(head).chain(rows.iter().map(cells)).collect();
    let width = |column: usize| lines.iter().map(|line| line[column].len()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..lines[0].len()).map(width).collect();
    let mut text = String::new();
    for (number, line) in lines.iter().enumerate() {
        let cells = line.iter().zip(&widths).map(|(cell, &width)| format!(" {cell:>width$} "));
        text += &format!("|{}|\n", cells.collect::<Vec<_>>().join("|"));
        if number == 0 {
            let rules = widths.iter().map(|width| "-".repeat(width + 1) + ":");
            text += &format!("|{}|\n", rules.collect::<Vec<_>>().join("|"));
        }
    }
    text
}

fn cells(row: &ScalingRow) -> Vec<String> {
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or("-".into(), |value| format!("{value:.decimals$}"))
    };
    let percent = |value: Option<f64>| value.map_or("-".into(), |v| format!("{:.1} %", 100.0 * v));
    let mut cells = vec![
        format!("{} x {}", row.ranks, row.threads),
        if row.skip_quiescent { "skipped" } else { "computed" }.into(),
        format!("{:.4}", row.wall_seconds),
        percent(Some(row.spread())),
        format!("{:.3}", row.cpu_seconds),
        format!("{:.2}", row.speed_up),
        percent(Some(row.efficiency)),
    ];
    cells.extend(row.shares().map(percent));
    cells.extend([
        number(row.bytes_per_step, 0),
        number(row.messages_per_step, 1),
        number(row.imbalance, 3),
        percent(row.skipped),
        match row.binding {
            "core" => String::new(),
            "none" => "not bound".into(),
            other => other.into(),
        },
    ]);
    cells
}

#[cfg(test)]
mod tests {
    use super::super::row::tests::measured;
    use super::super::row_prediction::RowPrediction;
    use super::*;

    #[test]
    fn what_is_not_counted_is_a_dash() {
        let rows = [false, true].map(|sections| {
            let (job, runs) = measured(2, &[1.0, 2.0], sections);
            ScalingRow::new(&job, &runs, &RowPrediction::default(), None)
        });
        let text = text(&rows);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 4);
        assert!(lines.iter().all(|line| line.len() == lines[0].len()), "{text}");
        assert!(lines[2].contains(" - ") && !lines[3].contains(" - "), "{text}");
        assert!(lines[3].contains("1.5000") && lines[3].contains("75.0 %"), "{text}");
    }
}
