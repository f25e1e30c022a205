//! A quantity along a line, such as the centre line or a radius, at one time.

use super::axis::Axis;
use super::color::Color;
use super::figure::{Figure, Panel};
use super::profile::readable;
use super::series::{Points, Series, Stroke, Style};

/// Curves and points of a quantity over position.
#[derive(Debug, Clone)]
pub struct LineOut {
    /// Title of the picture; the time is appended.
    pub title: String,
    /// Time \[s\].
    pub time: f64,
    /// Name of the position: "Radius".
    pub position: String,
    /// Name of the quantity: "Pressure".
    pub quantity: String,
    /// SI unit of the quantity: "Pa".
    pub unit: String,
    /// Curves and points, in drawing order.
    pub curves: Vec<LineOutCurve>,
    /// Lines of text, such as errors.
    pub notes: Vec<String>,
    /// Positions \[m\] between which the curves are shown again, enlarged, if there is space.
    pub close_up: Option<(f64, f64)>,
}

/// One curve: positions \[m\] as x, values in the unit of the quantity as y.
#[derive(Debug, Clone)]
pub struct LineOutCurve {
    /// Name in the legend: "particles within 5° of the axis".
    pub name: String,
    /// Line style.
    pub look: LineStyle,
    /// The data; dots may be in any order.
    pub points: Points,
}

/// Line style of a curve of a [`LineOut`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineStyle {
    /// Dots: individual particles.
    Dots,
    /// A line: means over bins or cells.
    Line,
    /// A dashed black line: the reference solution.
    Reference,
}

impl LineOut {
    /// The figure. Curves other than references take the palette colours in turn.
    pub fn figure(&self) -> Figure {
        let mut panel = Panel::new(Axis::linear(&self.quantity, &self.unit));
        let mut computed = 0;
        for curve in &self.curves {
            let (style, points) = match curve.look {
                LineStyle::Reference => {
                    let line = Style::line(Color::BLACK).stroke(Stroke::Dashed).width(2.0);
                    (line, curve.points.clone())
                }
                look => {
                    let color = Color::palette(computed);
                    computed += 1;
                    match look {
                        // Thinning keeps the extremes of each part of the line, so the dots must be
                        // sorted along it.
                        LineStyle::Dots => (Style::marks(color), sorted(&curve.points)),
                        _ => (Style::line(color), curve.points.clone()),
                    }
                }
            };
            panel.series.push(Series::new(&curve.name, points, style));
        }
        panel.notes.clone_from(&self.notes);
        panel.close_up = self.close_up;
        let title = format!("{}, t = {}", self.title, readable(self.time));
        Figure::new(title, Axis::linear(&self.position, "m").tight()).panel(panel)
    }
}

/// Points sorted by abscissa. Unchanged if the columns differ in length: the drawing reports it.
fn sorted(points: &Points) -> Points {
    if points.x.len() != points.y.len() {
        return points.clone();
    }
    let mut pairs: Vec<(f64, f64)> =
        std::iter::zip(points.x.iter().copied(), points.y.iter().copied()).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
    Points { x, y }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_have_their_looks_and_dots_are_sorted() {
        let curve = |name: &str, look| LineOutCurve {
            name: name.into(),
            look,
            points: Points::new([2e-3, 1e-3], [5.0, 4.0]),
        };
        let curves = vec![
            curve("particles", LineStyle::Dots),
            curve("mean", LineStyle::Line),
            curve("exact", LineStyle::Reference),
        ];
        let figure = LineOut {
            title: "Ring".into(),
            time: 2e-6,
            position: "Radius".into(),
            quantity: "Pressure".into(),
            unit: "Pa".into(),
            curves,
            notes: vec![],
            close_up: None,
        }
        .figure();
        let series = &figure.panels[0].series;
        assert_eq!(series[0].points, Points::new([1e-3, 2e-3], [4.0, 5.0]));
        assert!(series[0].style.stroke.is_none() && series[1].style.stroke.is_some());
        assert_ne!(series[0].style.color, series[1].style.color);
        assert_eq!(series[2].style.stroke, Some(Stroke::Dashed));
        assert_eq!((figure.title.as_str(), figure.x.label.as_str()), ("Ring, t = 2 µs", "Radius"));
    }
}
