//! Histories: what interface, free surface and tracers felt over time, beside the exact course.

use super::color::Color;
use super::figure::{Axis, Figure, Panel, Points, Series, Stroke, Style};

/// Series over time in panels, one a quantity.
#[derive(Debug, Clone)]
pub struct Histories {
    /// The line at the top.
    pub title: String,
    /// Panels from top to bottom.
    pub panels: Vec<HistoryPanel>,
}

/// One quantity over time.
#[derive(Debug, Clone)]
pub struct HistoryPanel {
    /// The quantity: "Velocity".
    pub label: String,
    /// Its SI unit: "m/s".
    pub unit: String,
    /// Series; one name has one colour in all panels.
    pub series: Vec<History>,
}

/// What one place felt. Times \[s\] as x, values in the panel's unit as y.
#[derive(Debug, Clone)]
pub struct History {
    /// Name in the legend: "interface".
    pub name: String,
    /// The computed course: an unbroken line.
    pub computed: Points,
    /// The exact course: a thin dashed line.
    pub exact: Option<Points>,
}

impl Histories {
    /// The figure.
    pub fn figure(&self) -> Figure {
        let mut names: Vec<&str> = Vec::new();
        let mut figure = Figure::new(&self.title, Axis::linear("Time", "s").tight());
        for quantity in &self.panels {
            let mut panel = Panel::new(Axis::linear(&quantity.label, &quantity.unit));
            for history in &quantity.series {
                let known = names.iter().position(|name| *name == history.name);
                let index = known.unwrap_or_else(|| {
                    names.push(&history.name);
                    names.len() - 1
                });
                let style = Style::line(Color::palette(index));
                panel.series.push(Series::new(&history.name, history.computed.clone(), style));
            }
            for exact in quantity.series.iter().filter_map(|history| history.exact.as_ref()) {
                let style = Style::line(Color::BLACK).stroke(Stroke::Dashed).width(1.5);
                panel.series.push(Series::new("exact", exact.clone(), style));
            }
            figure.panels.push(panel);
        }
        figure
    }
}
