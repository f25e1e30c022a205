//! The figure of a field.

use super::axis::Axis;
use super::field::Field;
use super::figure::{Figure, Panel};
use super::profile::readable;

impl Field {
    /// The figure; it takes the data. The field fills the page, so no other panel is possible.
    pub fn figure(mut self) -> Figure {
        let title = format!("{}, t = {}", self.title, readable(self.time));
        let [x, y] = self.axes.each_ref().map(|name| Axis::linear(name, "m"));
        let mut panel = Panel::new(y);
        panel.series = std::mem::take(&mut self.overlays);
        panel.notes = std::mem::take(&mut self.notes);
        panel.field = Some(self);
        Figure::new(title, x).panel(panel)
    }
}
