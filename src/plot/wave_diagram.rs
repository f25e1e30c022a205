//! The x-t diagram: computed pressure as colour, with the exact wave paths.

use super::axis::Axis;
use super::color::Color;
use super::color_map::{ColorMap, DiagramRow};
use super::figure::{Figure, Panel};
use super::series::{Points, Series, Stroke, Style};

/// Computed pressure over position and time, and wave paths.
#[derive(Debug, Clone)]
pub struct WaveDiagram {
    /// Title of the picture.
    pub title: String,
    /// Computed pressure, one row per time; rows may differ in length.
    pub rows: Vec<DiagramRow>,
    /// Wave paths; paths with the same name share a colour and a legend entry.
    pub paths: Vec<WavePath>,
    /// Upper end of the time axis \[s\]; `None`: the last time of the data.
    pub end: Option<f64>,
    /// Lines of text inside the panel.
    pub notes: Vec<String>,
}

/// The path of a wave, of an interface or of a free surface.
#[derive(Debug, Clone)]
pub struct WavePath {
    /// Name in the legend: "shock".
    pub name: String,
    /// Positions \[m\] as x and times \[s\] as y.
    pub points: Points,
    /// Pattern of the line.
    pub stroke: Stroke,
}

impl WaveDiagram {
    /// Colours that are visible on every colour of the map.
    const COLORS: [Color; 4] =
        [Color::WHITE, Color(0xff, 0x6e, 0x6e), Color(0xff, 0xb0, 0xe8), Color(0xff, 0xc8, 0x5a)];

    /// The figure.
    pub fn figure(&self) -> Figure {
        let axis = Axis { range: self.end.map(|end| (0.0, end)), ..Axis::linear("Time", "s") };
        let mut panel = Panel::new(axis.tight());
        panel.notes = self.notes.clone();
        let mut names: Vec<&str> = Vec::new();
        for path in &self.paths {
            let known = names.iter().position(|name| *name == path.name);
            let index = known.unwrap_or_else(|| {
                names.push(&path.name);
                names.len() - 1
            });
            let color = Self::COLORS[index % Self::COLORS.len()];
            let line = Style::line(color).stroke(path.stroke).width(2.0);
            let style = Style { outlined: true, ..line };
            panel.series.push(Series::new(&path.name, path.points.clone(), style));
        }
        panel.map =
            Some(ColorMap { label: "Pressure".into(), unit: "Pa".into(), rows: self.rows.clone() });
        Figure::new(&self.title, Axis::linear("Position", "m").tight()).panel(panel)
    }
}
