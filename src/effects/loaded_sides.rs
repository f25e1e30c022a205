//! Sides that apply a pressure to the surface of the bodies that touched them at the start.
//!
//! ```text
//! A_i = sum V G_i.n,  f_i = -n p(t) A_i      at nodes that particles of the surface reach
//! ```
//!
//! sum V G_i is the surface of the volume of the particles, in the quadrature of the internal
//! force: a body under the same pressure stays at rest to rounding. Particles next to the side at
//! the start are marked, and the load moves with them.

use crate::scene::{CheckedScene, Course};
use crate::shape::with_width;
use crate::solver::Scheme;
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Effect, NewParticle, Package, Phase, Setup, StepContext};
use crate::solver::patch::Patch;
use crate::solver::sides::sides_of;

/// Sides under a prescribed pressure.
pub struct LoadedSides {
    /// Direction, end and pressure of each side.
    loads: Vec<(usize, usize, Course)>,
    /// Volume at the time of the forces [m3].
    volume: usize,
    /// Sides that load a particle of the surface, as a sum of powers of two: see [`load_bit`].
    mark: usize,
    /// Index of the first of the nodal sums.
    sums: usize,
}

/// Bit of the mark for the side at the lower or upper `end` of direction `axis`.
fn load_bit(axis: usize, end: usize) -> u8 {
    1 << (2 * axis + end)
}

/// Mark of a particle: the bits of all sides that load it.
fn load_mark<const D: usize>(scene: &CheckedScene, centre: [f64; D], size: [f64; D]) -> u8 {
    let (domain, sides) = (&scene.scene.domain, scene.side_properties::<D>());
    let pressing = (0..D).flat_map(|a| [(a, 0), (a, 1)]).filter(|&(a, end)| {
        let at = if end == 0 { domain.lower[a] } else { domain.upper[a] };
        // up to the side, only the outermost particles of a body
        sides[a][end].pressure.is_some() && (centre[a] - at).abs() < 0.75 * size[a]
    });
    pressing.map(|(a, end)| load_bit(a, end)).sum()
}

impl Package for LoadedSides {
    const NAME: &'static str = "loaded sides";

    fn is_active(scene: &CheckedScene) -> bool {
        scene.is_loaded()
    }

    fn declare(_: &CheckedScene, d: &mut Declare<'_>) {
        d.scalar("load_volume", "m3", Role::GhostScratch);
        d.scalar("load_mark", "", Role::GhostState);
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        Box::new(LoadedSides {
            loads: sides_of::<D, _>(setup.scene, |side| side.pressure.clone()),
            volume: setup.columns.get("load_volume"),
            mark: setup.columns.get("load_mark"),
            sums: setup.fields.add(2),
        })
    }
}

impl<const D: usize> Effect<D> for LoadedSides {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::ParticleForce, Phase::NodalForce]
    }

    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        match phase {
            Phase::ParticleForce => self.find_volume(step, patch),
            _ => {
                for (axis, end, load) in &self.loads {
                    self.apply(step.scheme, patch, *axis, *end, load.at(step.time));
                }
            }
        }
    }

    fn initialize(&self, particle: &NewParticle<'_, D>, values: &mut [f64]) {
        let NewParticle { scene, centre, size, .. } = *particle;
        values[self.mark] = f64::from(load_mark(scene, centre, size));
    }
}

impl LoadedSides {
    /// Volumes of the own particles at the time of the forces.
    fn find_volume<const D: usize>(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let c = &step.scheme.columns;
        let n = patch.block.own();
        let mut volume = std::mem::take(&mut patch.block.columns[self.volume]);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (volume0, j) = (column(c.volume0), column(step.jacobian));
        volume.clear();
        volume.extend((0..n).map(|r| volume0[r] * j[r]));
        patch.block.columns[self.volume] = volume;
    }

    /// Adds the force of `pressure` [Pa] at the lower or upper `end` of direction `axis`.
    fn apply<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        axis: usize,
        end: usize,
        pressure: f64,
    ) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            (s, e): (&Scheme<D>, &LoadedSides),
            axis: usize,
            end: usize,
            pressure: f64,
        ) {
            let Some([low, high]) = e.loaded_cells(patch, axis, end) else { return };
            let outward = if end == 0 { -1.0 } else { 1.0 };
            // nodes within reach of a marked particle, and particles within reach of those nodes
            let reach = K as i64 + 1;
            let Some(boxes) =
                s.start_side(patch, axis, low - reach, high + reach + 1, e.sums..e.sums + 2)
            else {
                return;
            };
            let near = low - 2 * reach..=high + 2 * reach;
            e.sum_surface::<K, D>(s, patch, axis, end, outward, |cell| near.contains(&cell));
            for (layer, part) in boxes.into_iter().enumerate().filter(|(_, p)| !p.is_empty()) {
                for index in part.iter() {
                    let at = layer * patch.nodes.nodes.count() + patch.nodes.nodes.flat(index);
                    let value = |k: usize| patch.nodes.fields[k][at];
                    let (area, touched) = (value(e.sums), value(e.sums + 1));
                    // a surface that faces inward is the opposite end of the body
                    if area <= 0.0 || touched <= 0.0 || value(s.fields.mass) <= s.empty_mass {
                        continue;
                    }
                    let along = -outward * pressure * area;
                    let force = std::array::from_fn(|a| if a == axis { along } else { 0.0 });
                    s.push(patch, at, index, force);
                }
            }
        }
        with_width!(patch.stencils.width, go(patch, (s, self), axis, end, pressure));
    }

    /// Whether a side loads a particle.
    fn is_loaded<const D: usize>(
        &self,
        patch: &Patch<D>,
        particle: usize,
        axis: usize,
        end: usize,
    ) -> bool {
        patch.block.columns[self.mark][particle] as u8 & load_bit(axis, end) != 0
    }

    /// Lowest and highest cell along `axis` of the particles that a side loads.
    fn loaded_cells<const D: usize>(
        &self,
        patch: &Patch<D>,
        axis: usize,
        end: usize,
    ) -> Option<[i64; 2]> {
        let particles = patch.runs.iter().cloned().flatten();
        let cells = particles
            .filter(|&r| self.is_loaded(patch, r, axis, end))
            .map(|r| i64::from(patch.block.cells[r][axis]));
        cells.fold(None, |range: Option<[i64; 2]>, cell| {
            let [low, high] = range.unwrap_or([cell, cell]);
            Some([low.min(cell), high.max(cell)])
        })
    }

    /// Sums over the particles near a side: the surface sum V G.n, and sum m N of the marked
    /// particles.
    fn sum_surface<const K: usize, const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        axis: usize,
        end: usize,
        outward: f64,
        near: impl Fn(i64) -> bool,
    ) {
        let first = self.sums;
        let [mut area, mut touched] =
            [0, 1].map(|k| std::mem::take(&mut patch.nodes.fields[first + k]));
        for r in patch.runs.iter().cloned().flatten() {
            if !near(i64::from(patch.block.cells[r][axis])) {
                continue;
            }
            let weights = patch.stencils.particle::<K, D>(r);
            let volume = outward * patch.block.columns[self.volume][r];
            weights.add(&mut area, weights.gradient(axis), |g| g * volume);
            if s.axisymmetric && axis == 0 {
                let hoop = volume / s.radius(patch, r);
                weights.add(&mut area, weights.values, |n| n * hoop);
            }
            if self.is_loaded(patch, r, axis, end) {
                let m = patch.block.columns[s.columns.mass][r];
                weights.add(&mut touched, weights.values, |n| n * m);
            }
        }
        patch.nodes.fields[first] = area;
        patch.nodes.fields[first + 1] = touched;
    }
}

#[cfg(test)]
#[path = "tests/loaded_sides.rs"]
mod tests;
