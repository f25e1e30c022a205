//! The x-t diagram: a computed quantity as colour, with the exact wave paths.

use super::axis::Axis;
use super::color::Color;
use super::color_map::{ColorMap, DiagramRow};
use super::figure::{Figure, MaterialBand, Panel};
use super::series::{Points, Series, Stroke, Style};

/// Colour of failed parts; the dark border makes them visible on bright parts of the map.
const FAILED: Color = Color(0xff, 0xe0, 0x66);

/// Colour of the computed surfaces of bodies.
const SURFACE: Color = Color(0xd9, 0xf2, 0xff);

/// A computed quantity over position and time, and wave paths.
#[derive(Debug, Clone)]
pub struct WaveDiagram {
    /// Title of the picture.
    pub title: String,
    /// Name and unit of the quantity.
    pub quantity: (String, String),
    /// Computed values, one row per time; rows may differ in length.
    pub rows: Vec<DiagramRow>,
    /// Wave paths; paths with the same name share a colour and a legend entry.
    pub paths: Vec<WavePath>,
    /// Upper end of the time axis \[s\]; `None`: the last time of the data.
    pub end: Option<f64>,
    /// Bodies at the end, as coloured bands above the diagram.
    pub bands: Vec<MaterialBand>,
    /// Computed surfaces of the bodies, positions \[m\] as x and times \[s\] as y.
    pub surfaces: Vec<Points>,
    /// Parts of the rows that have failed: lower and upper position \[m\] and time \[s\].
    pub failed: Vec<(f64, f64, f64)>,
    /// Time \[s\] from which the exact paths are not known: a line across the diagram.
    pub exact_until: Option<f64>,
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

impl Default for WaveDiagram {
    /// A diagram of the pressure without rows.
    fn default() -> Self {
        WaveDiagram {
            title: String::new(),
            quantity: ("Pressure".into(), "Pa".into()),
            rows: Vec::new(),
            paths: Vec::new(),
            end: None,
            bands: Vec::new(),
            surfaces: Vec::new(),
            failed: Vec::new(),
            exact_until: None,
            notes: Vec::new(),
        }
    }
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
        panel.bands.clone_from(&self.bands);
        panel.series.extend(self.computed());
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
        panel.map = Some(ColorMap {
            label: self.quantity.0.clone(),
            unit: self.quantity.1.clone(),
            rows: self.rows.clone(),
            limits: None,
        });
        if let Some(until) = self.exact_until {
            let ends = self.rows.iter().flat_map(|row| row.x.iter().copied());
            let ends = ends.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
            let line = Points::new([ends.0, ends.1], [until, until]);
            let style = Style::line(Color::WHITE).stroke(Stroke::Dashed).width(1.5);
            let style = Style { outlined: true, ..style };
            panel.series.push(Series::new("end of the exact paths", line, style));
        }
        Figure::new(&self.title, Axis::linear("Position", "m").tight()).panel(panel)
    }

    /// Failed parts and surfaces of bodies, under the exact paths.
    fn computed(&self) -> Vec<Series> {
        let mut series = Vec::new();
        if !self.failed.is_empty() {
            // A value that is not finite ends each stroke.
            let strokes = self.failed.iter();
            let x: Vec<f64> = strokes.clone().flat_map(|f| [f.0, f.1, f64::NAN]).collect();
            let t: Vec<f64> = strokes.flat_map(|f| [f.2, f.2, f64::NAN]).collect();
            let style = Style::line(FAILED).width(2.5);
            let style = Style { outlined: true, ..style };
            series.push(Series::new("failed", Points::new(x, t), style));
        }
        for surface in &self.surfaces {
            let style = Style { outlined: true, ..Style::line(SURFACE).width(1.0) };
            series.push(Series::new("surface of a body", surface.clone(), style));
        }
        series
    }
}
