//! Area and first moments of a region.

use std::ops::{Add, AddAssign, Sub};

/// Area of a region, and its first moments about a reference point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Area [m2].
    pub area: f64,
    /// Integrals over the area of x and y, measured from the reference point [m3].
    pub first: [f64; 2],
}

impl Moments {
    /// The moments about another reference point; `shift` is the position of the current one
    /// relative to it [m].
    pub fn shifted(self, shift: [f64; 2]) -> Self {
        let first = [0, 1].map(|d| self.first[d] + self.area * shift[d]);
        Moments { area: self.area, first }
    }

    /// Centroid [m], relative to the reference point.
    pub fn centroid(self) -> [f64; 2] {
        self.first.map(|m| m / self.area)
    }
}

impl Add for Moments {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let first = [0, 1].map(|d| self.first[d] + other.first[d]);
        Moments { area: self.area + other.area, first }
    }
}

impl Sub for Moments {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        let first = [0, 1].map(|d| self.first[d] - other.first[d]);
        Moments { area: self.area - other.area, first }
    }
}

impl AddAssign for Moments {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
