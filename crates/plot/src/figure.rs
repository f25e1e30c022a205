//! Description of a figure: panels of series over one x axis. All values are in SI units.

use super::axis::Axis;
use super::bars::Bars;
use super::color::Color;
use super::color_map::ColorMap;
use super::field::Field;
use super::series::{Series, Style};

/// A picture: a title and panels, stacked over a common x axis.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Title of the picture.
    pub title: String,
    /// The axis common to all panels.
    pub x: Axis,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
    /// Bars in the right half of the page; cannot be combined with a colour map.
    pub bars: Option<Bars>,
}

impl Figure {
    /// A figure without panels.
    pub fn new(title: impl Into<String>, x: Axis) -> Self {
        Self { title: title.into(), x, panels: Vec::new(), bars: None }
    }

    /// Puts bars beside the panels.
    pub fn bars(self, bars: Bars) -> Self {
        Self { bars: Some(bars), ..self }
    }

    /// Adds a panel below the others.
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// Names of the bands and the series with the first style of each, in drawing order.
    pub(super) fn legend(&self) -> Vec<(&str, &Style)> {
        let mut entries: Vec<(&str, &Style)> = Vec::new();
        let bands = self.panels.iter().flat_map(|panel| &panel.bands);
        let bands = bands.map(|band| (band.name.as_str(), &band.style));
        let series = self.panels.iter().flat_map(|panel| &panel.series);
        let series = series.map(|series| (series.name.as_str(), &series.style));
        for (name, style) in bands.chain(series) {
            if !name.is_empty() && entries.iter().all(|(known, _)| *known != name) {
                entries.push((name, style));
            }
        }
        entries
    }
}

/// One pair of axes and its contents.
#[derive(Debug, Clone)]
pub struct Panel {
    /// The y axis.
    pub y: Axis,
    /// Series, in drawing order.
    pub series: Vec<Series>,
    /// Labelled points.
    pub labels: Vec<Label>,
    /// Lines of text, placed where they cover the least data.
    pub notes: Vec<String>,
    /// Part of the x axis, in its unit, that is shown again, enlarged, if there is space.
    pub close_up: Option<(f64, f64)>,
    /// Coloured bands above the panel, which name parts of the x axis.
    pub bands: Vec<MaterialBand>,
    /// Abscissae of thin vertical lines under the series, such as interfaces, in the unit of the x
    /// axis.
    pub lines: Vec<f64>,
    /// A colour map under the series.
    pub(super) map: Option<ColorMap>,
    /// A field under the series; it is then the only panel of the figure.
    pub(super) field: Option<Field>,
}

impl Panel {
    /// An empty panel.
    pub fn new(y: Axis) -> Self {
        let (series, labels, notes, bands) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self {
            y,
            series,
            labels,
            notes,
            close_up: None,
            bands,
            lines: vec![],
            map: None,
            field: None,
        }
    }

    /// Adds a series on top of the others.
    pub fn series(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Adds a line of text.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }
}

/// A part of the x axis, such as a body of one material, drawn as a coloured band above the panel.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialBand {
    /// Name in the legend: "copper".
    pub name: String,
    /// Lower end, in the unit of the x axis.
    pub low: f64,
    /// Upper end, in the unit of the x axis.
    pub high: f64,
    /// Colour, and the look of the legend entry.
    pub(super) style: Style,
}

impl MaterialBand {
    /// A band of this colour.
    pub fn new(name: impl Into<String>, (low, high): (f64, f64), color: Color) -> Self {
        Self { name: name.into(), low, high, style: Style::line(color).width(14.0) }
    }
}

/// A dot with a short text beside it.
#[derive(Debug, Clone)]
pub struct Label {
    /// The text.
    pub text: String,
    /// Abscissa, in the unit of the x axis.
    pub x: f64,
    /// Ordinate, in the unit of the y axis.
    pub y: f64,
}
