//! Curves of a study: errors over a cost or a key.

use super::StudyRow;
use super::cases::fits;
use super::front::front;
use super::means::{MeanRow, means};
use super::spec::{CurvesPicture, Study};
use crate::plot::{Axis, Color, Figure, Panel, Points, Series, Stroke, Style};

/// Label of a quantity: name, unit, and conversion factor from SI.
pub fn quantity(name: &str) -> (String, &'static str, f64) {
    let (text, percent) = match name {
        "l1" => ("L1", true),
        "l2" => ("L2", true),
        "e1_cells" => return ("E1".into(), "cells", 1.0),
        "plateau" => ("Plateau", true),
        "noise" => ("Noise", true),
        "rise_cells" => return ("Rise".into(), "cells", 1.0),
        "shock_position_cells" => return ("Shock position".into(), "cells", 1.0),
        "overshoot" => ("Overshoot", true),
        "second_plateau" => ("Second plateau", true),
        "displacement_l2" => ("L2 of displacement", true),
        "velocity_rms" => ("RMS of velocity", true),
        "velocity_l1" => ("L1 of velocity", true),
        "pressure_rms" => ("RMS of pressure", true),
        "density_l1" => ("L1 of density", true),
        "histories" => ("Difference of histories", true),
        "kinetic_energy_loss" => ("Loss of kinetic energy", true),
        "energy_drift" => return ("Energy drift".into(), "", 1.0),
        "waves.shock" => ("L1, shock", true),
        "waves.fan" => ("L1, fan", true),
        "waves.plateau_2" => ("L1, plateau 2", true),
        "waves.second_plateau" => ("L1, second plateau", true),
        "loop_cpu_seconds" => return ("User CPU time of the time loop".into(), "s", 1.0),
        "loop_wall_seconds" => return ("Wall time of the time loop".into(), "s", 1.0),
        "core_seconds" => return ("Wall time of the time loop × cores".into(), "s", 1.0),
        "time.courant" => return ("Courant number".into(), "", 1.0),
        "artificial_viscosity.linear" => return ("Linear viscosity a1".into(), "", 1.0),
        "artificial_viscosity.expansion" => {
            return ("Linear viscosity a3 in expansion".into(), "", 1.0);
        }
        "artificial_viscosity.quadratic" => return ("Quadratic viscosity a2".into(), "", 1.0),
        other => return (other.replace(['_', '.'], " "), "", 1.0),
    };
    if percent { (text.into(), "%", 100.0) } else { (text.into(), "", 1.0) }
}

/// Label of a swept key or of another quantity on an axis, for values up to `largest` in SI units.
pub fn swept(name: &str, largest: f64) -> (String, &'static str, f64) {
    match name {
        "domain.cell_size" if largest < 1e-3 => ("Cell size".into(), "um", 1e6),
        "domain.cell_size" => ("Cell size".into(), "mm", 1e3),
        other => quantity(other),
    }
}

/// Style of curve `index`: the palette with discs, then dashed with rings, then dotted with discs.
fn style_of(index: usize) -> Style {
    let style = Style { mark: Some(5.0), ..Style::line(Color::palette(index)).width(2.0) };
    match index / 7 {
        0 => style,
        1 => style.hollow().stroke(Stroke::Dashed),
        _ => style.stroke(Stroke::Dotted),
    }
}

/// Slope of log y over log x by least squares; `None` for fewer than two distinct x.
pub fn order(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> =
        points.iter().filter(|p| p.0 > 0.0 && p.1 > 0.0).map(|p| (p.0.ln(), p.1.ln())).collect();
    let n = logs.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let xx: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
    let xy: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    (xx > 1e-12).then(|| xy / xx)
}

/// The figure of these curves.
pub fn figure(study: &Study, picture: &CurvesPicture, rows: &[StudyRow]) -> Figure {
    let rows = rows.iter().filter(|row| fits(&row.labels, &picture.only));
    let rows = means(study, rows, &picture.over);
    let mut names: Vec<String> = Vec::new();
    for name in rows.iter().map(|row| row.first().name(&picture.series)) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let values = rows.iter().filter_map(|row| row.mean(&picture.x, picture.time));
    let (x_label, x_unit, x_factor) = swept(&picture.x, values.fold(0.0, f64::max));
    let mut axis = Axis::log(x_label, x_unit);
    let swept = study.labels().contains(&picture.x.as_str());
    if swept {
        let mut ticks: Vec<f64> = rows
            .iter()
            .filter_map(|row| row.mean(&picture.x, picture.time))
            .map(|x| (x * x_factor * 1e9).round() / 1e9)
            .collect();
        ticks.sort_by(f64::total_cmp);
        ticks.dedup();
        axis = axis.ticks(ticks);
    }
    let mut figure = Figure::new(&picture.title, axis);
    for error in &picture.y {
        let (label, unit, factor) = quantity(error);
        let mut panel = Panel::new(Axis::log(label, unit));
        let place = |row: &MeanRow<'_>| {
            let x = row.mean(&picture.x, picture.time)? * x_factor;
            Some((x, row.mean(error, picture.time)? * factor))
        };
        if picture.front {
            let all: Vec<(f64, f64)> = rows.iter().filter_map(place).collect();
            let all: Vec<(f64, f64)> = all.into_iter().filter(|p| p.1 > 0.0).collect();
            let (x, y): (Vec<f64>, Vec<f64>) = front(&all).iter().map(|&k| all[k]).unzip();
            let style = Style { color: Color(0xf3, 0xd0, 0x70), ..Style::line(Color::BLACK) };
            let style = style.width(11.0);
            panel = panel.series(Series::new("Pareto front", Points::new(x, y), style));
        }
        for (k, name) in names.iter().enumerate() {
            let of = rows.iter().filter(|row| row.first().name(&picture.series) == *name);
            let mut points: Vec<(f64, f64)> = of.filter_map(place).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            if picture.order
                && let Some(order) = order(&points)
                && points.len() > 2
            {
                panel = panel.note(format!("{name}: order {order:.2}"));
            }
            let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
            panel = panel.series(Series::new(name, Points::new(x, y), style_of(k)));
        }
        if picture.peers {
            panel = with_peers(panel, study, picture, error, factor);
        }
        figure = figure.panel(panel);
    }
    figure
}

/// Adds other codes as bold rings, after a legend line that says that they are other codes.
fn with_peers(
    mut panel: Panel,
    study: &Study,
    picture: &CurvesPicture,
    error: &str,
    factor: f64,
) -> Panel {
    let ring = |color: Color| Style { mark: Some(9.0), ..Style::marks(color) }.hollow();
    let mut shown = false;
    for (k, peer) in study.peers.iter().enumerate() {
        let at = |pair: &&[f64; 2]| {
            picture.time.is_some_and(|time| (pair[0] - time).abs() <= 1e-9 * time)
        };
        let Some(value) = peer.errors.get(error).and_then(|e| e.iter().find(at)) else { continue };
        if !shown {
            let whose = "other codes, measured on a similar machine:";
            panel = panel.series(Series::new(whose, Points::new([], []), ring(Color::BLACK)));
            shown = true;
        }
        let points = Points::new([peer.seconds], [value[1].abs() * factor]);
        let color = Color::BLACK.mix(Color::palette(k), 0.55);
        panel = panel.series(Series::new(&peer.name, points, ring(color)));
    }
    panel
}

#[cfg(test)]
mod tests {
    use super::order;

    #[test]
    fn orders_are_slopes() {
        let of = |p: f64| [1.0, 2.0, 4.0, 8.0].map(|x: f64| (x, 3.0 * x.powf(p)));
        assert!((order(&of(1.5)).unwrap() - 1.5).abs() < 1e-12);
        assert_eq!(order(&[(1.0, 1.0)]), None);
    }
}
