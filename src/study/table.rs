//! The table of a study as CSV: one row per case; failed cases have the reason of the failure.

use super::StudyRow;
use super::convergence::HISTORIES;
use super::row::ERRORS;
use super::spec::Study;

/// The table as CSV. Column heads contain the profile time \[us\].
pub fn csv(study: &Study, rows: &[StudyRow]) -> String {
    let mut times: Vec<f64> = rows
        .iter()
        .filter_map(|row| row.record.measured.as_ref())
        .flat_map(|m| m.profiles.iter().map(|p| p.time))
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let has = |name: &str, time: f64| rows.iter().any(|row| row.error(name, Some(time)).is_some());
    let columns: Vec<(&str, f64)> = times
        .iter()
        .flat_map(|&time| ERRORS.iter().map(move |&name| (name, time)))
        .filter(|&(name, time)| has(name, time))
        .collect();
    let mut head: Vec<String> = study.labels().iter().map(|l| field(l)).collect();
    head.extend(
        [
            "status",
            "ranks",
            "threads",
            "repeats",
            "particles",
            "cells",
            "steps",
            "loop_cpu_seconds",
            "loop_cpu_seconds_least",
            "loop_cpu_seconds_greatest",
            "loop_wall_seconds",
            "cpu_seconds",
            "wall_seconds",
            "energy_drift",
            "momentum_drift",
            HISTORIES,
        ]
        .map(String::from),
    );
    head.extend(columns.iter().map(|(name, t)| format!("{name}@{}us", t * 1e12 / 1e6)));
    let mut text = head.join(",") + "\n";
    for row in rows {
        let status = row.record.failure.as_deref().unwrap_or("done");
        let mut line: Vec<String> = study
            .labels()
            .iter()
            .map(|l| field(row.labels.get(*l).map_or("", String::as_str)))
            .collect();
        line.extend([
            field(status),
            row.ranks.to_string(),
            row.threads.to_string(),
            row.record.seconds.len().to_string(),
        ]);
        let measured = row.record.measured.as_ref();
        let count = |n: Option<u64>| n.map_or(String::new(), |n| n.to_string());
        line.push(count(measured.map(|m| m.particles)));
        line.push(count(measured.map(|m| m.cells)));
        line.push(count(measured.map(|m| m.steps)));
        let spread = row.spread(|s| s.loop_cpu);
        let numbers = [
            row.seconds(|s| s.loop_cpu),
            spread.map(|s| s.0),
            spread.map(|s| s.1),
            row.seconds(|s| s.loop_wall),
            row.seconds(|s| s.cpu),
            row.seconds(|s| s.wall),
            measured.and_then(|m| m.energy_drift),
            measured.and_then(|m| m.momentum_drift),
            row.histories,
        ];
        line.extend(numbers.map(number));
        line.extend(columns.iter().map(|&(name, time)| number(row.error(name, Some(time)))));
        text += &(line.join(",") + "\n");
    }
    text
}

fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |v| format!("{v:e}"))
}

/// A field, quoted if CSV requires it.
fn field(text: &str) -> String {
    match text.contains([',', '"', '\n']) {
        true => format!("\"{}\"", text.replace('"', "\"\"").replace('\n', " ")),
        false => text.to_string(),
    }
}
