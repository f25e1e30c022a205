//! Particle density of a scene over its cells, computed without creating particles.

use decomp::SideKind;

use crate::scene::CheckedScene;

/// A body: the cells from `lower` to `upper`, with a uniform particle density.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    lower: f64,
    upper: f64,
    particles_per_cell: f64,
}

/// Particle density over the cells of a domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Terrain {
    /// Number of cells of the domain.
    pub cells: usize,
    /// Number of particles of all bodies \[-\].
    pub particles: f64,
    /// Longest particle \[cells\].
    pub longest: f64,
    spans: Vec<Span>,
    sides: [SideKind; 2],
}

impl Terrain {
    /// Particle density of a scene at its start.
    pub fn new(scene: &CheckedScene) -> Self {
        let (origin, size) = (scene.scene.domain.lower[0], scene.cell_size[0]);
        let spans: Vec<Span> = (scene.bodies.iter())
            .map(|checked| {
                let lower = (checked.lower[0] - origin) / size;
                let upper = (checked.upper[0] - origin) / size;
                let particles_per_cell = checked.particles as f64 / (upper - lower);
                Span { lower, upper, particles_per_cell }
            })
            .collect();
        let longest =
            scene.bodies.iter().zip(&spans).map(|(checked, span)| match &checked.tiling {
                Some(tiling) => tiling.samples().map(|(_, t)| t.size[0] / size).fold(0.0, f64::max),
                None => 1.0 / span.particles_per_cell,
            });
        Terrain {
            cells: scene.cells[0],
            particles: scene.particles as f64,
            longest: longest.fold(0.0, f64::max),
            spans,
            sides: scene.side_properties::<1>()[0].clone().map(|side| side.ghosts),
        }
    }

    /// Sums over the cells from `lower` to `upper`, with images beyond the sides.
    fn sum(&self, lower: f64, upper: f64, of: &dyn Fn(&Span) -> f64) -> f64 {
        let end = self.cells as f64;
        let within = |lower: f64, upper: f64| -> f64 {
            let length = |s: &Span| (upper.min(s.upper) - lower.max(s.lower)).max(0.0);
            self.spans.iter().map(|s| length(s) * of(s)).sum()
        };
        let mut sum = within(lower.max(0.0), upper.min(end));
        if lower < 0.0 {
            sum += match self.sides[0] {
                SideKind::Open => 0.0,
                SideKind::Mirror => within((-upper).max(0.0), -lower),
                SideKind::Wrap => within(lower + end, (upper + end).min(end)),
            };
        }
        if upper > end {
            sum += match self.sides[1] {
                SideKind::Open => 0.0,
                SideKind::Mirror => within(2.0 * end - upper, (2.0 * end - lower).min(end)),
                SideKind::Wrap => within((lower - end).max(0.0), upper - end),
            };
        }
        sum
    }

    /// Number of particles \[-\] in the cells from `lower` to `upper` \[cells\].
    pub fn particles_in(&self, lower: f64, upper: f64) -> f64 {
        self.sum(lower, upper, &|s| s.particles_per_cell)
    }

    /// Number of cells with material \[-\] from `lower` to `upper` \[cells\].
    pub fn filled_in(&self, lower: f64, upper: f64) -> f64 {
        self.sum(lower, upper, &|_| 1.0)
    }

    /// Whether the sides are periodic, so that the first and the last patch are neighbours.
    pub fn is_joined(&self) -> bool {
        self.sides[0] == SideKind::Wrap
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terrain(sides: [SideKind; 2]) -> Terrain {
        let span = |lower, upper, particles_per_cell| Span { lower, upper, particles_per_cell };
        let spans = vec![span(2.0, 6.0, 2.0), span(6.0, 18.0, 1.0)];
        Terrain { cells: 20, particles: 20.0, longest: 1.0, spans, sides }
    }

    #[test]
    fn particles_are_those_of_the_bodies_in_reach() {
        let t = terrain([SideKind::Open; 2]);
        assert_eq!((t.particles_in(0.0, 20.0), t.filled_in(0.0, 20.0)), (20.0, 16.0));
        assert_eq!((t.particles_in(5.0, 8.0), t.particles_in(-9.0, 3.0)), (4.0, 2.0));
    }

    #[test]
    fn images_count_beyond_mirrors_and_joints() {
        let t = terrain([SideKind::Mirror; 2]);
        assert_eq!((t.particles_in(-3.0, 0.0), t.particles_in(20.0, 25.0)), (2.0, 3.0));
        let t = terrain([SideKind::Wrap; 2]);
        assert_eq!((t.particles_in(-3.0, 0.0), t.particles_in(20.0, 25.0)), (1.0, 6.0));
    }
}
