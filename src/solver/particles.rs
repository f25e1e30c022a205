//! Filling of bodies with particles.

use decomp::{Block, IndexBox, Layout};
use nalgebra::SVector;

use super::effect::NewParticle;
use super::stepper::Stepper;
use crate::geometry::BodyBoundary;
use crate::scene::CheckedScene;

/// Centres of the equal boxes that result from cutting a box into `counts` parts along each
/// direction; the first direction varies fastest.
fn lattice<const D: usize>(
    lower: SVector<f64, D>,
    upper: SVector<f64, D>,
    counts: [usize; D],
) -> impl Iterator<Item = SVector<f64, D>> {
    let size = upper - lower;
    IndexBox::new([0; D], counts.map(|n| n as i64)).iter().map(move |k| {
        let share = |a: usize| (2 * k[a] + 1) as f64 / (2 * counts[a]) as f64;
        lower + size.component_mul(&SVector::from_fn(|a, _| share(a)))
    })
}

/// Fills the bodies with particles and keeps those whose patch is on `rank`: one block per patch of
/// the rank. Ids number the particles of all bodies in order, for any layout. Velocities are
/// relative to a grid that moves at `grid_velocity` [m/s].
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
    let mut place = vec![None; layout.patches().len()];
    for (k, &p) in mine.iter().enumerate() {
        place[p] = Some(k);
    }
    let mut values = vec![0.0; columns.specs.len()];
    let mut id = 0u64;
    for (number, checked) in scene.bodies.iter().enumerate() {
        let region = scene.scene.bodies[number].regions().pop().map(|(_, region)| region);
        let boundary = columns.faces.and(region).and_then(|region| BodyBoundary::new(&region));
        let mut add = |centre: [f64; D], size: [f64; D], volume: f64| {
            let cell = cell_of(scene, centre);
            let patch = layout.wrap_cell(cell).map(|c| layout.patch_of(c));
            id += 1;
            let Some(block) = patch.and_then(|p| place[p]) else { return };
            let particle = NewParticle { scene, body: number, centre, size };
            set_initial_values(stepper, &particle, volume, grid_velocity, &mut values);
            if let (Some(first), Some(boundary)) = (columns.faces, &boundary) {
                set_faces(boundary, &particle, &mut values[first..first + 4]);
            }
            blocks[block].push(id - 1, cell.map(|c| c as i32), &values);
        };
        match &checked.tiles {
            Some(tiles) => tiles.iter().for_each(|tile| {
                let first = |v: [f64; 2]| std::array::from_fn(|a| v[a]);
                add(first(tile.centre), first(tile.size), tile.area);
            }),
            None => {
                let lower = SVector::from(std::array::from_fn::<f64, D, _>(|a| checked.lower[a]));
                let upper = SVector::from(std::array::from_fn::<f64, D, _>(|a| checked.upper[a]));
                let counts = std::array::from_fn(|a| checked.lattice[a]);
                let size = std::array::from_fn(|a| (upper - lower)[a] / counts[a] as f64);
                for centre in lattice(lower, upper, counts) {
                    add(centre.into(), size, size.iter().product());
                }
            }
        }
    }
    for block in &mut blocks {
        block.sort_own();
    }
    blocks
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

/// Number of particles in each slice of cells normal to `axis`, counted without creating them.
pub fn slices(scene: &CheckedScene, axis: usize) -> Vec<u64> {
    let (lower, size) = (scene.scene.domain.lower[axis], scene.cell_size[axis]);
    let mut counts = vec![0.0; scene.cells[axis]];
    for body in &scene.bodies {
        if let Some(tiles) = &body.tiles {
            for tile in tiles.iter() {
                let cell = ((tile.centre[axis] - lower) / size) as usize;
                counts[cell.min(scene.cells[axis] - 1)] += 1.0;
            }
            continue;
        }
        let (from, to) = (body.lower[axis], body.upper[axis]);
        let per_length = body.particles as f64 / (to - from);
        for (cell, count) in counts.iter_mut().enumerate() {
            let x = lower + cell as f64 * size;
            *count += ((to.min(x + size) - from.max(x)).max(0.0) * per_length).round();
        }
    }
    counts.into_iter().map(|count| count as u64).collect()
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
        let lower = SVector::from([-1.0, 0.0]);
        let places: Vec<_> = lattice(lower, SVector::from([1.0, 3.0]), [2, 3]).collect();
        assert_eq!(places.len(), 6);
        assert_eq!(places[0], SVector::from([-0.5, 0.5]));
        assert_eq!(places[1], SVector::from([0.5, 0.5]));
        assert_eq!(places[5], SVector::from([0.5, 2.5]));
    }
}
