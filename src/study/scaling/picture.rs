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
    panel = panel.note(format!("median of {}", study.repeats));
    if rows.iter().any(|row| row.oversubscribed) {
        panel = panel.note("over: more workers than cores");
    }
    let x = Axis::log("Workers: ranks × threads", "").ticks(ticks);
    Figure::new(format!("{title}: {}", study.title), x).panel(panel).bars(bars(&rows))
}

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
