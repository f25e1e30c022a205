//! Half-widths against true errors of impacts that are not in the fit.

use std::path::Path;

use calibration::estimates::{CheckedEstimate, QUANTITIES, judge};
use plot::{
    Axis, Color, Figure, Panel, PictureError, Points, Series, Stroke, Style, draw as draw_figure,
};

/// Draws a panel per quantity; cases whose interval does not contain the exact value are red.
pub fn draw(all: &[Vec<CheckedEstimate>], stem: &Path) -> Result<(), PictureError> {
    let x = Axis::log(
        "True error relative to the plateau pressure, the transit time of a cell, L1",
        "",
    );
    let mut figure = Figure::new("Estimated errors of impacts that are not in the fit", x);
    for (name, estimates) in QUANTITIES.iter().zip(all) {
        let points = |held: bool| {
            let of = estimates.iter().filter_map(|t| {
                let (error, width) = (t.error / t.unit, t.half_width? / t.unit);
                ((error <= width) == held && error > 0.0).then_some((error, width))
            });
            let (x, y): (Vec<f64>, Vec<f64>) = of.unzip();
            Points::new(x, y)
        };
        let of = judge(estimates);
        let all: Vec<f64> = [points(true), points(false)].into_iter().flat_map(|p| p.x).collect();
        let low = all.iter().copied().fold(f64::INFINITY, f64::min);
        let high = all.iter().copied().fold(0.0, f64::max);
        let mark = |color| Style { mark: Some(4.0), ..Style::marks(color) };
        let equal = Style::line(Color::BLACK).stroke(Stroke::Dashed).width(1.5);
        let panel = Panel::new(Axis::log(format!("± {name}"), ""))
            .series(Series::new("contains the exact value", points(true), mark(Color::palette(0))))
            .series(Series::new("does not", points(false), mark(Color::RED)))
            .series(Series::new("half-width = error", Points::new([low, high], [low, high]), equal))
            .note(format!(
                "{} cases, {:.1} % inside, median ratio {:.1}",
                of.cases,
                100.0 * of.held,
                of.ratio
            ));
        figure = figure.panel(panel);
    }
    draw_figure(&figure, stem)?;
    Ok(())
}
