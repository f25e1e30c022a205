//! Histories: values at interface, free surface and tracers over time, with the exact solution.

use super::axis::Axis;
use super::color::Color;
use super::figure::{Figure, Panel};
use super::series::{Points, Series, Stroke, Style};

/// Series over time, one panel per quantity.
#[derive(Debug, Clone)]
pub struct HistoriesFigure {
    /// Title of the picture.
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
    /// Series; a name has the same colour in all panels.
    pub series: Vec<HistoryCurve>,
}

/// History at one location: times \[s\] as x, values in the unit of the panel as y.
#[derive(Debug, Clone)]
pub struct HistoryCurve {
    /// Name in the legend: "interface".
    pub name: String,
    /// Computed history: a solid line.
    pub computed: Points,
    /// Exact history: a thin dashed line.
    pub exact: Option<Points>,
}

impl HistoriesFigure {
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
