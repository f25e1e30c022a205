//! Description of a figure: panels of series over one x axis. All values are in SI units.

use super::axis::Axis;
use super::bars::Bars;
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

    /// Names of the series with the first style of each, in drawing order.
    pub(super) fn legend(&self) -> Vec<(&str, &Style)> {
        let mut entries: Vec<(&str, &Style)> = Vec::new();
        for series in self.panels.iter().flat_map(|panel| &panel.series) {
            if !series.name.is_empty() && entries.iter().all(|(name, _)| *name != series.name) {
                entries.push((&series.name, &series.style));
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
    /// Part of the x axis that is shown again, enlarged, if there is space.
    pub close_up: Option<(f64, f64)>,
    /// A colour map under the series.
    pub(super) map: Option<ColorMap>,
    /// A field under the series; it is then the only panel of the figure.
    pub(super) field: Option<Field>,
}

impl Panel {
    /// An empty panel.
    pub fn new(y: Axis) -> Self {
        let (series, labels, notes) = (Vec::new(), Vec::new(), Vec::new());
        Self { y, series, labels, notes, close_up: None, map: None, field: None }
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
