//! The picture: speed-up against workers, and where the time went.

use crate::plot::{Axis, Bar, BarPart, Bars, Color, Figure, Panel, Points, Series, Stroke, Style};

use super::kind::ScalingKind;
use super::row::ScalingRow;
use super::statistics::PARTS;
use super::study::ScalingStudy;

/// The figure of the rows that skip nothing.
pub fn figure(study: &ScalingStudy) -> Figure {
    let rows: Vec<&ScalingRow> = study.rows.iter().filter(|row| !row.skip_quiescent).collect();
    let (title, upright) = match study.kind {
        ScalingKind::Strong => ("Strong scaling", "Speed-up"),
        ScalingKind::Weak => ("Weak scaling", "Scaled speed-up"),
    };
    let most = rows.iter().map(|row| row.workers).max().unwrap_or(1);
    let ticks = ticks(most);
    let mut panel = Panel::new(Axis::log(upright, "").ticks(&ticks[..]));
    let ends = [1.0, most as f64];
    let ideal = Style::line(Color::GRAY).stroke(Stroke::Dashed).width(2.0);
    panel = panel.series(Series::new("ideal", Points::new(ends, ends), ideal));
    if study.cores < most {
        // Up to the ideal line.
        let cores = study.cores as f64;
        let look = Style::line(Color::BLACK).stroke(Stroke::Dotted).width(1.5);
        let name = format!("{} cores", study.cores);
        panel = panel.series(Series::new(name, Points::new([cores; 2], [1.0, cores]), look));
    }
    for (index, threads) in threads(&rows).into_iter().enumerate() {
        let of = rows.iter().filter(|row| row.threads == threads);
        let (x, y): (Vec<f64>, Vec<f64>) = of.map(|row| (row.workers as f64, row.speed_up)).unzip();
        let look = Style { mark: Some(7.0), ..Style::line_and_marks(Color::palette(index)) };
        let (name, look) = match threads {
            1 => ("ranks × 1".into(), look),
            n => (format!("ranks × {n}"), look.hollow()),
        };
        panel = panel.series(Series::new(name, Points::new(x, y), look));
    }
    for (index, threads) in threads(&rows).into_iter().enumerate() {
        let (x, y) = predicted(&rows, threads);
        if !x.is_empty() {
            let look = Style::line(Color::palette(index)).stroke(Stroke::Dotted).width(2.0);
            let name = format!("model, ranks × {threads}");
            panel = panel.series(Series::new(name, Points::new(x, y), look));
        }
    }
    panel = panel.note(format!("median of {}", study.repeats));
    if rows.iter().any(|row| row.oversubscribed) {
        panel = panel.note("over: more workers than cores");
    }
    let x = Axis::log("Workers: ranks × threads", "").ticks(ticks);
    let figure = Figure::new(format!("{title}: {}", study.title), x).panel(panel);
    let figure = match study.kind {
        ScalingKind::Strong => figure,
        ScalingKind::Weak => messages(figure, &rows),
    };
    figure.bars(bars(&rows))
}

/// Workers with `threads` threads a rank, and the predicted speed-up; without a prediction none.
fn predicted(rows: &[&ScalingRow], threads: usize) -> (Vec<f64>, Vec<f64>) {
    let per_step = |row: &ScalingRow| {
        let particle_steps = row.particles as f64 * row.steps as f64;
        row.predicted_seconds.map(|seconds| seconds / particle_steps)
    };
    let base = rows.iter().find(|row| row.workers == 1).and_then(|row| per_step(row));
    let of = rows.iter().filter(|row| row.threads == threads);
    let all = of.filter_map(|row| Some((row.workers as f64, base? / per_step(row)?)));
    all.unzip()
}

/// `figure` with panels of the bytes and messages of a rank in a step, counted and predicted, of the
/// rows with one thread a rank.
fn messages(figure: Figure, rows: &[&ScalingRow]) -> Figure {
    let of = || rows.iter().filter(|row| row.threads == 1 && row.ranks > 1);
    let ranks: Vec<f64> = of().map(|row| row.ranks as f64).collect();
    let panel = |label: &str, unit: &str, scale: f64, counted: Value, predicted: Value| {
        let each = |value: Value| -> Vec<f64> {
            of().map(|row| scale * value(row) / row.ranks as f64).collect()
        };
        let points = |value| Points::new(&ranks[..], each(value));
        let line = Style::line(Color::palette(0)).stroke(Stroke::Dotted).width(2.0);
        let marks = Style { mark: Some(7.0), ..Style::marks(Color::palette(0)) };
        let panel = Panel::new(Axis::linear(label, unit));
        panel
            .series(Series::new("counted, outputs included", points(counted), marks))
            .series(Series::new("model", points(predicted), line))
    };
    if ranks.is_empty() {
        return figure;
    }
    let bytes = panel(
        "Sent by a rank in a step",
        "kB",
        1e-3,
        |row| row.bytes_per_step.unwrap_or(f64::NAN),
        |row| row.predicted_bytes_per_step,
    );
    let messages = panel(
        "Messages of a rank in a step",
        "",
        1.0,
        |row| row.messages_per_step.unwrap_or(f64::NAN),
        |row| row.predicted_messages_per_step,
    );
    figure.panel(bytes).panel(messages)
}

/// A value of a row.
type Value = fn(&ScalingRow) -> f64;

/// Shares of time, a bar a configuration.
fn bars(rows: &[&ScalingRow]) -> Bars {
    let color = |index: usize| match PARTS[index] {
        "rest" => Color::GRAY,
        _ => Color::palette(index),
    };
    let parts = PARTS.iter().enumerate();
    let parts = parts.map(|(index, &name)| BarPart { name: name.into(), color: color(index) });
    let bar = |row: &&ScalingRow| Bar {
        label: format!(
            "{} × {}{}",
            row.ranks,
            row.threads,
            if row.oversubscribed { ", over" } else { "" }
        ),
        values: row.shares().iter().flatten().map(|share| 100.0 * share).collect(),
    };
    Bars {
        label: "Share of the ranks' time".into(),
        unit: "%".into(),
        parts: parts.collect(),
        bars: rows.iter().map(bar).collect(),
    }
}

/// The numbers of threads, in ascending order.
fn threads(rows: &[&ScalingRow]) -> Vec<usize> {
    let mut threads: Vec<usize> = rows.iter().map(|row| row.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    threads
}

/// Numbers on both axes: powers of two, and where these are few the middles between them.
fn ticks(most: usize) -> Vec<f64> {
    let powers = (-6..=20).map(|power| 2f64.powi(power));
    match most {
        0..=8 => powers.flat_map(|power| [power, 1.5 * power]).collect(),
        _ => powers.collect(),
    }
}
