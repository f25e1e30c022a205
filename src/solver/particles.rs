//! Filling of bodies with particles.

use decomp::{Block, IndexBox, Layout};
use nalgebra::SVector;

use super::effect::NewParticle;
use super::stepper::Stepper;
use crate::geometry::{BodyBoundary, CellBox};
use crate::scene::{CheckedBody, CheckedScene};

/// Equal boxes that result from cutting a body into `counts` parts along each direction; the first
/// direction varies fastest.
struct BodyLattice<const D: usize> {
    lower: SVector<f64, D>,
    size: SVector<f64, D>,
    counts: [usize; D],
}

impl<const D: usize> BodyLattice<D> {
    fn of(body: &CheckedBody) -> Self {
        let lower = SVector::from_fn(|a, _| body.lower[a]);
        let upper = SVector::from_fn(|a, _| body.upper[a]);
        BodyLattice { lower, size: upper - lower, counts: std::array::from_fn(|a| body.lattice[a]) }
    }

    /// Centre of the box `k` [m].
    fn centre(&self, k: [i64; D]) -> [f64; D] {
        let share = |a: usize| (2 * k[a] + 1) as f64 / (2 * self.counts[a]) as f64;
        (self.lower + self.size.component_mul(&SVector::from_fn(|a, _| share(a)))).into()
    }

    /// Edges of a box [m].
    fn edges(&self) -> [f64; D] {
        std::array::from_fn(|a| self.size[a] / self.counts[a] as f64)
    }

    /// Number of the box `k`.
    fn number(&self, k: [i64; D]) -> u64 {
        (0..D).rev().fold(0, |number, a| number * self.counts[a] as u64 + k[a] as u64)
    }

    /// The boxes whose centres lie in `cells`: along a direction, cells ascend with boxes.
    fn boxes_in(&self, scene: &CheckedScene, cells: &IndexBox<D>) -> IndexBox<D> {
        let first_from = |a: usize, cell: i64| {
            let (mut from, mut to) = (0, self.counts[a] as i64);
            while from < to {
                let middle = from + (to - from) / 2;
                let mut k = [0; D];
                k[a] = middle;
                let is_below = cell_of(scene, self.centre(k))[a] < cell;
                if is_below { from = middle + 1 } else { to = middle }
            }
            from
        };
        let corner = |corner: &[i64; D]| std::array::from_fn(|a| first_from(a, corner[a]));
        IndexBox::new(corner(&cells.lower), corner(&cells.upper))
    }
}

/// A box of cells with two directions, for any dimension.
pub fn cell_box<const D: usize>(cells: &IndexBox<D>) -> CellBox {
    let corner =
        |corner: &[i64; D], other: i64| [corner[0], if D > 1 { corner[D - 1] } else { other }];
    [corner(&cells.lower, 0), corner(&cells.upper, 1)]
}

/// Fills the patches of `rank` with the particles whose centres lie in their cells: one block per
/// patch of the rank. Particles of other patches are not made. Ids number the particles of all
/// bodies in order, for any layout. Velocities are relative to a grid that moves at `grid_velocity`
/// [m/s].
///
/// The particles of a body tile it: those of a box have equal volume and mass to rounding.
pub fn fill<const D: usize>(
    scene: &CheckedScene,
    stepper: &Stepper<D>,
    layout: &Layout<D>,
    rank: usize,
    grid_velocity: [f64; D],
) -> Vec<Block<D>> {
    let columns = &stepper.columns;
    let mine = layout.patches_of(rank);
    let mut blocks: Vec<Block<D>> = mine.iter().map(|_| Block::new(&columns.specs)).collect();
    let mut values = vec![0.0; columns.specs.len()];
    let mut first_id = 0;
    for (number, checked) in scene.bodies.iter().enumerate() {
        let region = scene.scene.bodies[number].regions().pop().map(|(_, region)| region);
        let boundary = columns.faces.and(region).and_then(|region| BodyBoundary::new(&region));
        for (&patch, block) in mine.iter().zip(&mut blocks) {
            let cells = &layout.patch(patch);
            block.reserve(count_in(scene, checked, cells));
            for strip in strips(cells) {
                let first = block.own();
                each_particle(scene, checked, &strip, &mut |id, centre, size, volume| {
                    let particle = NewParticle { scene, body: number, centre, size };
                    set_initial_values(stepper, &particle, volume, grid_velocity, &mut values);
                    if let (Some(first), Some(boundary)) = (columns.faces, &boundary) {
                        set_faces(boundary, &particle, &mut values[first..first + 4]);
                    }
                    let cell = cell_of(scene, centre).map(|c| c as i32);
                    block.push(first_id + id, cell, &values);
                });
                block.sort_own_from(first);
            }
        }
        first_id += checked.particles;
    }
    for block in &mut blocks {
        block.sort_own();
    }
    blocks
}

/// Cells along the last direction of a strip.
const STRIP: i64 = 16;

/// Cuts a box of cells along its last direction, so that the memory for sorting is that of a strip.
fn strips<const D: usize>(cells: &IndexBox<D>) -> impl Iterator<Item = IndexBox<D>> {
    let cells = *cells;
    (cells.lower[D - 1]..cells.upper[D - 1]).step_by(STRIP as usize).map(move |first| {
        let mut strip = cells;
        strip.lower[D - 1] = first;
        strip.upper[D - 1] = cells.upper[D - 1].min(first + STRIP);
        strip
    })
}

/// Number of particles of `body` whose centres lie in `cells`.
fn count_in<const D: usize>(
    scene: &CheckedScene,
    body: &CheckedBody,
    cells: &IndexBox<D>,
) -> usize {
    match &body.tiling {
        Some(tiling) => tiling.count_in(cell_box(cells)) as usize,
        None => BodyLattice::<D>::of(body).boxes_in(scene, cells).count(),
    }
}

/// Calls `take` with the number, centre [m], edges [m] and volume [m3] of each particle of `body`
/// whose centre lies in `cells`.
fn each_particle<const D: usize>(
    scene: &CheckedScene,
    body: &CheckedBody,
    cells: &IndexBox<D>,
    take: &mut dyn FnMut(u64, [f64; D], [f64; D], f64),
) {
    if let Some(tiling) = &body.tiling {
        let along = |v: [f64; 2]| std::array::from_fn(|a| v[a]);
        return tiling.each_in(cell_box(cells), &mut |number, tile| {
            take(number, along(tile.centre), along(tile.size), tile.area);
        });
    }
    let lattice = BodyLattice::<D>::of(body);
    let size = lattice.edges();
    for k in lattice.boxes_in(scene, cells).iter() {
        take(lattice.number(k), lattice.centre(k), size, size.iter().product());
    }
}

/// Writes the initial values of a particle with `volume` [m3], per radian with axial symmetry over its
/// radius, to all columns.
fn set_initial_values<const D: usize>(
    stepper: &Stepper<D>,
    particle: &NewParticle<'_, D>,
    volume: f64,
    grid_velocity: [f64; D],
    values: &mut [f64],
) {
    let &NewParticle { scene, body: number, centre, size } = particle;
    let (columns, checked) = (&stepper.columns, &scene.bodies[number]);
    let body = &scene.scene.bodies[number];
    let volume = if scene.axisymmetric() { volume * centre[0] } else { volume };
    values.fill(0.0);
    for a in 0..D {
        values[columns.position + a] = centre[a];
        values[columns.velocity + a] = checked.velocity[a] - grid_velocity[a];
    }
    if D == 1 {
        values[columns.velocity] = scene.graded_velocity(number, centre[0]) - grid_velocity[0];
    }
    let mut pressure = body.pressure;
    if let Some(motion) = &checked.motion {
        let place = std::array::from_fn(|a| if a < D { centre[a] } else { 0.0 });
        let velocity = motion.velocity(place);
        for a in 0..D {
            values[columns.velocity + a] = velocity[a] - grid_velocity[a];
        }
        if let Some(affine) = columns.affine {
            let gradient = motion.gradient(place, size[0]);
            (0..D * D).for_each(|k| values[affine + k] = gradient[k / D][k % D]);
        }
        pressure = motion.pressure(place).unwrap_or(pressure);
    }
    if let Some(initial) = columns.initial_position {
        (0..D).for_each(|a| values[initial + a] = centre[a]);
    }
    values[columns.mass] = scene.material_of(number).density * volume;
    values[columns.volume0] = volume;
    values[columns.jacobian] = 1.0;
    values[columns.energy] = stepper.starting_energy(number, pressure, body.temperature);
    for effect in stepper.effects.iter() {
        effect.initialize(particle, values);
    }
    values[columns.body] = number as f64;
    if let Some(column) = columns.contact_impulse {
        values[column] = stepper.starting_impulse(number, pressure);
    }
    if let Some(half_lengths) = columns.half_lengths {
        (0..D).for_each(|a| values[half_lengths + a] = 0.5 * size[a]);
    }
    if let Some(deformation) = columns.deformation {
        (0..D).for_each(|a| values[deformation + (D + 1) * a] = 1.0);
    }
}

/// Greatest distance of the face of a particle from its centre [edges of its box]: a face beyond the
/// particle next to a boundary belongs to that particle.
const NEAR: f64 = 1.1;

/// Tolerance within which a face lies on a side of the domain [cells].
const ON_SIDE: f64 = 1e-6;

/// Writes the faces of a particle, in the coordinates of its half edges. Faces on the sides of the
/// domain meet no body.
fn set_faces<const D: usize>(
    boundary: &BodyBoundary,
    particle: &NewParticle<'_, D>,
    values: &mut [f64],
) {
    let NewParticle { scene, centre, size, .. } = particle;
    let (centre, size) = ([centre[0], centre[D - 1]], [size[0], size[D - 1]]);
    let near = NEAR * size[0].max(size[1]);
    let domain = &scene.scene.domain;
    let is_inner = |foot: [f64; 2]| {
        (0..2).all(|a| {
            let side = ON_SIDE * scene.cell_size[a];
            let [lower, upper] =
                [domain.lower[a], domain.lower[a] + scene.cells[a] as f64 * scene.cell_size[a]];
            foot[a] > lower + side && foot[a] < upper - side
        })
    };
    for (k, face) in boundary.faces(centre, near, is_inner).into_iter().enumerate() {
        for a in 0..2 {
            values[2 * k + a] = face.normal[a] * 0.5 * size[a] / face.distance;
        }
    }
}

/// Number of particles in each slice of cells normal to `axis`, each particle counted `weight` times,
/// without creating them.
pub fn slices(scene: &CheckedScene, axis: usize, weight: impl Fn(&CheckedBody) -> u64) -> Vec<u64> {
    let (lower, size) = (scene.scene.domain.lower[axis], scene.cell_size[axis]);
    let mut counts = vec![0; scene.cells[axis]];
    for body in &scene.bodies {
        let weight = weight(body);
        if let Some(tiling) = &body.tiling {
            let slices = tiling.slices(axis, counts.len());
            counts.iter_mut().zip(slices).for_each(|(count, more)| *count += weight * more);
            continue;
        }
        let (from, to) = (body.lower[axis], body.upper[axis]);
        let per_length = body.particles as f64 / (to - from);
        for (cell, count) in counts.iter_mut().enumerate() {
            let x = lower + cell as f64 * size;
            let inside = (to.min(x + size) - from.max(x)).max(0.0);
            *count += weight * (inside * per_length).round() as u64;
        }
    }
    counts
}

/// Cell that contains the position `x` [m].
pub fn cell_of<const D: usize>(scene: &CheckedScene, x: [f64; D]) -> [i64; D] {
    let lower = &scene.scene.domain.lower;
    std::array::from_fn(|a| ((x[a] - lower[a]) * (1.0 / scene.cell_size[a])).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_has_the_centres_of_its_boxes() {
        let (lower, size) = (SVector::from([-1.0, 0.0]), SVector::from([2.0, 3.0]));
        let lattice = BodyLattice { lower, size, counts: [2, 3] };
        let boxes = IndexBox::new([0, 0], [2, 3]);
        let places: Vec<_> = boxes.iter().map(|k| lattice.centre(k)).collect();
        assert_eq!(places.len(), 6);
        assert_eq!(places[0], [-0.5, 0.5]);
        assert_eq!(places[1], [0.5, 0.5]);
        assert_eq!(places[5], [0.5, 2.5]);
        let numbers: Vec<_> = boxes.iter().map(|k| lattice.number(k)).collect();
        assert_eq!(numbers, [0, 1, 2, 3, 4, 5]);
        assert_eq!(lattice.edges(), [1.0, 1.0]);
    }
}
