//! Erosion: removal of a particle from the run.
//!
//! ```text
//! ep >= plastic_strain  or  J >= volume_ratio
//! ```
//!
//! Extremely strained material no longer carries load, but it shortens the time step and spreads
//! over cells that it does not fill. Source: Johnson & Stryk (1987), Eroding interface and improved
//! tetrahedral element algorithms for high-velocity impact computations in three dimensions, Int.
//! J. Impact Eng. 5, 411, who limit the equivalent plastic strain. The limit is not a material
//! property: the result depends on it and on the cells.

/// Erosion limits of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErosionCriterion {
    /// Limit of the equivalent plastic strain [-]; infinite: no limit.
    pub plastic_strain: f64,
    /// Limit of J, the volume over the initial volume [-]; infinite: no limit.
    pub volume_ratio: f64,
}

impl ErosionCriterion {
    /// Whether a particle of this plastic strain and volume ratio [-] is removed.
    pub fn takes(&self, plastic_strain: f64, volume_ratio: f64) -> bool {
        plastic_strain >= self.plastic_strain || volume_ratio >= self.volume_ratio
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_limit_takes() {
        let both = ErosionCriterion { plastic_strain: 1.5, volume_ratio: 2.0 };
        assert!(!both.takes(1.49, 1.99) && both.takes(1.5, 1.0) && both.takes(0.0, 2.0));
        let strain = ErosionCriterion { volume_ratio: f64::INFINITY, ..both };
        assert!(!strain.takes(1.49, 1e300) && strain.takes(1.6, 0.5));
    }
}
