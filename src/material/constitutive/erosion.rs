//! When a particle is taken out of the run.
//!
//! ```text
//! ep >= plastic_strain  or  J >= volume_ratio
//! ```
//!
//! What is strained beyond all measure no longer carries load, but shortens the time step and
//! spreads over cells that it does not fill. Source: Johnson & Stryk (1987), Eroding interface and
//! improved tetrahedral element algorithms for high-velocity impact computations in three
//! dimensions, Int. J. Impact Eng. 5, 411, who take an equivalent plastic strain. The limit is no
//! property of the material: what comes out depends on it, and on the cells.

/// The limits of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Erosion {
    /// Equivalent plastic strain [-]; infinite: none.
    pub plastic_strain: f64,
    /// Volume over that at the start, J [-]; infinite: none.
    pub volume_ratio: f64,
}

impl Erosion {
    /// Whether a particle of such plastic strain and volume ratio [-] goes.
    pub fn takes(&self, plastic_strain: f64, volume_ratio: f64) -> bool {
        plastic_strain >= self.plastic_strain || volume_ratio >= self.volume_ratio
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_limit_takes() {
        let both = Erosion { plastic_strain: 1.5, volume_ratio: 2.0 };
        assert!(!both.takes(1.49, 1.99) && both.takes(1.5, 1.0) && both.takes(0.0, 2.0));
        let strain = Erosion { volume_ratio: f64::INFINITY, ..both };
        assert!(!strain.takes(1.49, 1e300) && strain.takes(1.6, 0.5));
    }
}
