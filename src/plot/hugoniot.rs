//! Figures 1, 2 and 3 of the document: pressure against particle velocity, with the states between
//! waves.

use super::color::Color;
use super::figure::{Axis, Figure, Label, Panel, Points, Series, Style};

/// Hugoniot curves with labelled states.
#[derive(Debug, Clone)]
pub struct Hugoniot {
    /// The line at the top.
    pub title: String,
    /// Curves, one a material or wave.
    pub curves: Vec<HugoniotCurve>,
    /// States to mark.
    pub states: Vec<State>,
}

/// The states that a shock into one material can reach.
#[derive(Debug, Clone)]
pub struct HugoniotCurve {
    /// Name in the legend: "copper, left-going shock".
    pub name: String,
    /// Colour; see [`Color::of_material`].
    pub color: Color,
    /// Particle velocity [m/s] and pressure \[Pa\].
    pub points: Points,
}

/// A state between waves, as the document numbers them.
#[derive(Debug, Clone)]
pub struct State {
    /// The number.
    pub label: String,
    /// Particle velocity [m/s].
    pub velocity: f64,
    /// Pressure \[Pa\].
    pub pressure: f64,
}

impl Hugoniot {
    /// The figure. Curves are cut where they rise beyond twice the highest marked pressure, which
    /// is what the picture is about.
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
