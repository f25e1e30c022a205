//! Pressure against position at one time, as in figure 4 of Burghardt (2010).

use super::axis::Axis;
use super::color::Color;
use super::figure::{Figure, MaterialBand, Panel};
use super::series::{Points, Series, Style};

/// A pressure profile with its reference solutions: positions \[m\], pressures \[Pa\].
#[derive(Debug, Clone)]
pub struct ProfileFigure {
    /// Title of the picture; the time is appended.
    pub title: String,
    /// Time \[s\].
    pub time: f64,
    /// Solution of Burghardt (2010), with release waves as shocks: a black line.
    pub approximation: Option<Points>,
    /// Exact solution, with release fans: a red line.
    pub exact: Option<Points>,
    /// Computed points, one part per material.
    pub computed: Vec<ProfilePart>,
    /// Computed points of failed material: black crosses.
    pub failed: Points,
    /// Bodies at this time, as coloured bands above the profile.
    pub bands: Vec<MaterialBand>,
    /// Positions of the surfaces where bodies touch \[m\]: thin lines.
    pub interfaces: Vec<f64>,
    /// Lines of text, such as errors.
    pub notes: Vec<String>,
    /// Positions \[m\] between which the profile is shown again, enlarged, if there is space: the
    /// shock front.
    pub close_up: Option<(f64, f64)>,
}

/// The computed points of one material.
#[derive(Debug, Clone)]
pub struct ProfilePart {
    /// Name in the legend.
    pub name: String,
    /// Colour of the marks.
    pub color: Color,
    /// Positions \[m\] and pressures \[Pa\].
    pub points: Points,
}

impl ProfileFigure {
    /// The figure.
    pub fn figure(&self) -> Figure {
        let mut panel = Panel::new(Axis::linear("Pressure", "Pa"));
        panel.bands.clone_from(&self.bands);
        panel.lines.clone_from(&self.interfaces);
        for part in &self.computed {
            let style = Style::marks(part.color);
            panel.series.push(Series::new(&part.name, part.points.clone(), style));
        }
        if !self.failed.x.is_empty() {
            let style = Style::crosses(Color::BLACK);
            panel.series.push(Series::new("failed", self.failed.clone(), style));
        }
        if let Some(points) = &self.approximation {
            let style = Style::line(Color::BLACK).width(2.0);
            panel.series.push(Series::new("shock approximation", points.clone(), style));
        }
        if let Some(points) = &self.exact {
            let style = Style::line(Color::RED).width(2.2);
            panel.series.push(Series::new("exact solution", points.clone(), style));
        }
        panel.notes.clone_from(&self.notes);
        panel.close_up = self.close_up;
        let title = format!("{}, t = {}", self.title, readable(self.time));
        Figure::new(title, Axis::linear("Position", "m").tight()).panel(panel)
    }
}

/// A time [s] as text, in microseconds below 0.01 s, else in seconds, without trailing zeros.
pub(super) fn readable(time: f64) -> String {
    let (scale, unit) = if time < 1e-2 { (1e6, "µs") } else { (1.0, "s") };
    let text = format!("{:.4}", time * scale);
    format!("{} {unit}", text.trim_end_matches('0').trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_in_a_unit_that_suits_them() {
        assert_eq!(readable(5e-7), "0.5 µs");
        assert_eq!(readable(0.2), "0.2 s");
    }
}
