//! Figures 1, 2 and 3 of Burghardt (2010): pressure against particle velocity, with the states
//! between waves.

use super::axis::Axis;
use super::color::Color;
use super::figure::{Figure, Label, Panel};
use super::series::{Points, Series, Style};

/// Hugoniot curves with labelled states.
#[derive(Debug, Clone)]
pub struct HugoniotFigure {
    /// Title of the picture.
    pub title: String,
    /// Curves, one per material or wave.
    pub curves: Vec<HugoniotCurve>,
    /// States to mark.
    pub states: Vec<HugoniotPoint>,
}

/// Hugoniot curve: the states that a shock into one material can reach.
#[derive(Debug, Clone)]
pub struct HugoniotCurve {
    /// Name in the legend: "copper, left-going shock".
    pub name: String,
    /// Colour; see [`Color::of_material`].
    pub color: Color,
    /// Particle velocity [m/s] and pressure \[Pa\].
    pub points: Points,
}

/// A state between waves, with its number in Burghardt (2010).
#[derive(Debug, Clone)]
pub struct HugoniotPoint {
    /// Number of the state.
    pub label: String,
    /// Particle velocity [m/s].
    pub velocity: f64,
    /// Pressure \[Pa\].
    pub pressure: f64,
}

impl HugoniotFigure {
    /// The figure. Curves are cut at twice the highest marked pressure, so that the marked states
    /// fill the picture.
    pub fn figure(&self) -> Figure {
        let mut panel = Panel::new(self.pressure_axis());
        for curve in &self.curves {
            let style = Style::line(curve.color).width(3.0);
            panel.series.push(Series::new(&curve.name, curve.points.clone(), style));
        }
        panel.labels.extend(self.states.iter().map(|state| Label {
            text: state.label.clone(),
            x: state.velocity,
            y: state.pressure,
        }));
        Figure::new(&self.title, Axis::linear("Particle velocity", "m/s")).panel(panel)
    }

    fn pressure_axis(&self) -> Axis {
        let axis = Axis::linear("Pressure", "Pa");
        let greatest = |values: &mut dyn Iterator<Item = f64>| {
            values.filter(|p| p.is_finite()).fold(0.0, f64::max)
        };
        let states = greatest(&mut self.states.iter().map(|state| state.pressure));
        let curves = greatest(&mut self.curves.iter().flat_map(|c| c.points.y.iter().copied()));
        if states > 0.0 && curves > 2.0 * states {
            axis.range(-0.1 * states, 2.0 * states)
        } else {
            axis
        }
    }
}
