//! Search for the contact of a body with itself: faces of one body that approach each other over a
//! narrow gap.
//!
//! A body has one velocity field, in which its surfaces stick together as soon as they share nodes.
//! The search changes no result: a run reports the first such place. It looks at pairs of particles
//! so few cells apart that every patch with one of them has the other.

use super::self_contact::SelfContact;
use crate::contact::{BoundaryParticle, ContactParticle};
use crate::solver::patch::Patch;
use crate::solver::scheme::Scheme;

/// Gap below which surfaces of a body touch [cells]: surfaces that meet stop at a gap of 0.7 to 0.9
/// cells, where the shared nodes have given them a common velocity.
const NARROW: f64 = 1.0;

/// Greatest distance between the cells of two particles. Ghosts extend as far, except those of
/// particles without an extent.
const DISTANCE: i32 = 2;

/// Closing speed of rounding errors, as a fraction of the speeds of both particles [-].
const ROUNDING: f64 = 1e-6;

/// Particle that carries faces.
struct Surface<const D: usize> {
    /// Its cell, the last axis first.
    key: [i32; D],
    /// Its index.
    particle: usize,
    faces: BoundaryParticle<D>,
}

impl<const D: usize> Scheme<D> {
    /// Narrowest gap across which faces of a body approach each other, if an own particle has one of
    /// them; `None` unless particles carry faces.
    pub(super) fn find_self_contact(&self, patch: &Patch<D>) -> Option<SelfContact<D>> {
        let surfaces = self.surfaces(patch, self.columns.faces?);
        let distance = if self.shape.has_jumps() { 1 } else { DISTANCE };
        let mut found: Option<SelfContact<D>> = None;
        for first in surfaces.iter().filter(|s| s.particle < patch.block.own()) {
            // faces exist only in a plane
            for row in -distance..=distance {
                let (mut from, mut to) = (first.key, first.key);
                (from[0], to[0]) = (from[0] + row, to[0] + row);
                (from[D - 1], to[D - 1]) = (from[D - 1] - distance, to[D - 1] + distance);
                let start = surfaces.partition_point(|s| s.key < from);
                for second in surfaces[start..].iter().take_while(|s| s.key <= to) {
                    let pair = self.meets_itself(patch, [first, second]);
                    let Some(pair) = pair else { continue };
                    if found.is_none_or(|found| pair.compare(&found).is_lt()) {
                        found = Some(pair);
                    }
                }
            }
        }
        found
    }

    /// Particles with faces in canonical order, without images beyond mirrors.
    fn surfaces(&self, patch: &Patch<D>, faces: usize) -> Vec<Surface<D>> {
        let columns = &patch.block.columns;
        let half_edges = self.columns.half_edges.expect("faces need them");
        let has_face = |r: usize| (0..4).any(|k| columns[faces + k][r] != 0.0);
        let is_surface = |r: &usize| has_face(*r) && !self.is_image(patch, *r);
        let surface = |r: usize| {
            let edge = |k: usize| {
                decomp::array::from_fn(|a| columns[half_edges + 2 * k + a][r] * self.cell[a])
            };
            let particle = ContactParticle {
                index: r as u32,
                place: [0.0; D],
                half_edges: [edge(0), edge(1)],
                volume: 0.0,
                faces: [0, 1].map(|k| [0, 1].map(|a| columns[faces + 2 * k + a][r])),
            };
            let key = std::array::from_fn(|a| patch.block.cells[r][D - 1 - a]);
            Surface { key, particle: r, faces: BoundaryParticle::new(&particle) }
        };
        patch.runs.iter().cloned().flatten().filter(is_surface).map(surface).collect()
    }

    /// Whether a particle is an image beyond a mirror.
    fn is_image(&self, patch: &Patch<D>, particle: usize) -> bool {
        let cell = patch.block.cells[particle];
        (0..D).any(|a| {
            let [lower, upper] = [0, 1].map(|end| !self.sides[a][end].is_periodic());
            (lower && cell[a] < 0) || (upper && i64::from(cell[a]) >= self.cells[a])
        })
    }

    /// Contact of two particles of one body, each pair once.
    fn meets_itself(&self, patch: &Patch<D>, surfaces: [&Surface<D>; 2]) -> Option<SelfContact<D>> {
        let c = &self.columns;
        let [first, second] = surfaces.map(|s| s.particle);
        let column = |k: usize, r: usize| patch.block.columns[k][r];
        let ids = [first, second].map(|r| patch.block.ids[r]);
        let body = self.layer_of(patch, first);
        if ids[0] >= ids[1] || self.layer_of(patch, second) != body {
            return None;
        }
        let node = patch.block.cells[first].map(i64::from);
        let places = [first, second].map(|r| self.place(patch, r, node));
        let away: [f64; D] =
            decomp::array::from_fn(|a| (places[1][a] - places[0][a]) * self.cell[a]);
        let (normal, width) = surfaces[0].faces.gap_to(&surfaces[1].faces, &away)?;
        let gap = width / self.cell.iter().copied().fold(f64::INFINITY, f64::min);
        let velocity = |r: usize| (0..D).map(move |a| column(c.velocity + a, r));
        let closing: f64 = velocity(first)
            .zip(velocity(second))
            .zip(normal)
            .map(|((first, second), normal)| (first - second) * normal)
            .sum();
        let speeds: f64 = velocity(first).chain(velocity(second)).map(f64::abs).sum();
        let place = decomp::array::from_fn(|a| {
            self.lower[a] + (node[a] as f64 + places[0][a]) * self.cell[a]
        });
        let approaches = gap < NARROW && closing > ROUNDING * speeds;
        approaches.then_some(SelfContact { gap, ids, body, place })
    }
}
