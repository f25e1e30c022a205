//! The description of a figure: panels of series over one x axis. SI units throughout.

use super::bars::Bars;
use super::color::Color;
use super::color_map::ColorMap;
use super::field::Field;

/// A picture: a title and panels, one above the other, over a common x axis.
#[derive(Debug, Clone)]
pub struct Figure {
    /// The line at the top.
    pub title: String,
    /// The axis all panels share.
    pub x: Axis,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
    /// Bars that take the right half of the page; not beside a colour map.
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
}

/// One pair of axes with what is drawn in it.
#[derive(Debug, Clone)]
pub struct Panel {
    /// The upright axis.
    pub y: Axis,
    /// Series, drawn in this order.
    pub series: Vec<Series>,
    /// Labelled points.
    pub labels: Vec<Label>,
    /// Lines of text, put where they cover least.
    pub notes: Vec<String>,
    /// Part of the x axis to be shown once more, enlarged, if there is room.
    pub close_up: Option<(f64, f64)>,
    /// A colour map under the series.
    pub(super) map: Option<ColorMap>,
    /// A field under the series, which then is all that the figure shows.
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

/// Spacing of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Even.
    Linear,
    /// Logarithmic; values of zero and below are left out.
    Log,
}

/// An axis. Its data are in `unit`; the layout may show them with a prefix (mm, GPa) or a power of
/// ten.
#[derive(Debug, Clone)]
pub struct Axis {
    /// What is measured: "Pressure".
    pub label: String,
    /// SI unit: "Pa"; empty for a plain number.
    pub unit: String,
    /// Spacing.
    pub scale: Scale,
    /// Ends, in `unit`; taken from the data when absent.
    pub range: Option<(f64, f64)>,
    /// Room left beyond the data at each end, as a fraction of their range.
    pub margin: f64,
    /// Values that are numbered, in `unit`; round ones where it is empty.
    pub ticks: Vec<f64>,
}

impl Axis {
    /// An evenly spaced axis from the data's least to their greatest value and a little more.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        let (label, unit) = (label.into(), unit.into());
        let ticks = Vec::new();
        Self { label, unit, scale: Scale::Linear, range: None, margin: 0.05, ticks }
    }

    /// A logarithmic axis.
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label, unit) }
    }

    /// The axis from `low` to `high` whatever the data are; ignored if these are not finite and
    /// ascending.
    pub fn range(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }

    /// The axis with numbers at these values alone, as far as they lie on it.
    pub fn ticks(self, ticks: impl Into<Vec<f64>>) -> Self {
        Self { ticks: ticks.into(), ..self }
    }

    /// The axis without room beyond the data.
    pub fn tight(self) -> Self {
        Self { margin: 0.0, ..self }
    }
}

/// Points of a curve; what is not finite breaks the line.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Points {
    /// Abscissae, in the x axis' unit.
    pub x: Vec<f64>,
    /// Ordinates, in the y axis' unit; as many.
    pub y: Vec<f64>,
}

impl Points {
    /// Points from two columns.
    pub fn new(x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Self {
        Self { x: x.into(), y: y.into() }
    }
}

/// A named curve.
#[derive(Debug, Clone)]
pub struct Series {
    /// Name in the legend, which lists a name once; empty: not listed.
    pub name: String,
    /// The data.
    pub points: Points,
    /// The look.
    pub style: Style,
}

impl Series {
    /// A series with a look of its own.
    pub fn new(name: impl Into<String>, points: Points, style: Style) -> Self {
        Self { name: name.into(), points, style }
    }
}

/// Pattern of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// Unbroken.
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// The look of a series: a line, marks, or both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Colour of line and marks.
    pub color: Color,
    /// Pattern of the line; absent: marks only.
    pub stroke: Option<Stroke>,
    /// Width of the line \[pixel of a page 1200 wide\].
    pub width: f64,
    /// Radius of round marks \[pixel\]; absent: line only.
    pub mark: Option<f64>,
    /// Whether marks are rings.
    pub hollow: bool,
    /// Whether the line gets a dark border, to be seen on a colour map.
    pub outlined: bool,
}

impl Style {
    /// An unbroken line.
    pub fn line(color: Color) -> Self {
        let stroke = Some(Stroke::Solid);
        Self { color, stroke, width: 2.5, mark: None, hollow: false, outlined: false }
    }

    /// Marks without a line.
    pub fn marks(color: Color) -> Self {
        Self { stroke: None, mark: Some(3.0), ..Self::line(color) }
    }

    /// Marks joined by a line.
    pub fn line_and_marks(color: Color) -> Self {
        Self { mark: Some(5.0), ..Self::line(color) }
    }

    /// The same with another pattern.
    pub fn stroke(self, stroke: Stroke) -> Self {
        Self { stroke: Some(stroke), ..self }
    }

    /// The same with rings for marks.
    pub fn hollow(self) -> Self {
        Self { hollow: true, ..self }
    }

    /// The same with another width of line.
    pub fn width(self, width: f64) -> Self {
        Self { width, ..self }
    }
}

/// A dot with a short text beside it.
#[derive(Debug, Clone)]
pub struct Label {
    /// The text.
    pub text: String,
    /// Abscissa, in the x axis' unit.
    pub x: f64,
    /// Ordinate, in the y axis' unit.
    pub y: f64,
}
