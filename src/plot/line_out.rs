//! A quantity along a line, such as the centre line or a radius, at one time.

use super::color::Color;
use super::figure::{Axis, Figure, Panel, Points, Series, Stroke, Style};
use super::profile::readable;

/// Curves and points of a quantity over a position.
#[derive(Debug, Clone)]
pub struct LineOut {
    /// The line at the top, to which the time is added.
    pub title: String,
    /// Time \[s\].
    pub time: f64,
    /// The position: "Radius".
    pub position: String,
    /// The quantity: "Pressure".
    pub quantity: String,
    /// Its SI unit: "Pa".
    pub unit: String,
    /// Curves and points, drawn in this order.
    pub curves: Vec<LineOutCurve>,
    /// Lines of text, such as errors.
    pub notes: Vec<String>,
    /// Positions \[m\] between which the curves are shown once more, enlarged, if there is room.
    pub close_up: Option<(f64, f64)>,
}

/// One curve: positions \[m\] as x, values in the quantity's unit as y.
#[derive(Debug, Clone)]
pub struct LineOutCurve {
    /// Name in the legend: "particles within 5° of the axis".
    pub name: String,
    /// How it is drawn.
    pub look: Look,
    /// The data; dots may come in any order.
    pub points: Points,
}

/// How a curve of a [`LineOut`] is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// Dots: single particles.
    Dots,
    /// A line: means over bins or cells.
    Line,
    /// A dashed black line: what should come out.
    Reference,
}

impl LineOut {
    /// The figure. Curves that are no reference take the colours of the palette in turn.
    pub fn figure(&self) -> Figure {
        let mut panel = Panel::new(Axis::linear(&self.quantity, &self.unit));
        let mut computed = 0;
        for curve in &self.curves {
            let (style, points) = match curve.look {
                Look::Reference => {
                    let line = Style::line(Color::BLACK).stroke(Stroke::Dashed).width(2.0);
                    (line, curve.points.clone())
                }
                look => {
                    let color = Color::palette(computed);
                    computed += 1;
                    match look {
                        // Of very many dots a few are drawn: the extremes of each part of the line.
                        Look::Dots => (Style::marks(color), sorted(&curve.points)),
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

/// Points by ascending abscissa; as they are if the columns differ in length, which is an error for
/// the drawing to find.
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
            curve("particles", Look::Dots),
            curve("mean", Look::Line),
            curve("exact", Look::Reference),
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
