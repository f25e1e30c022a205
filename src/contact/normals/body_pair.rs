//! Two bodies at a node: their particles, and the gap between them along a direction.

use smallvec::SmallVec;

/// Two bodies at a node.
pub struct BodyPair<'a, const D: usize> {
    /// Filled volumes V = sum V_p N [cells].
    pub volume: [f64; 2],
    /// Gradients of the filled volumes g = sum V_p G [cells/m]; they point out of the bodies.
    pub gradient: [&'a [f64; D]; 2],
    /// Particles that touch the node, in canonical order.
    pub particles: [&'a [ContactParticle<D>]; 2],
    /// Edges of a cell [m].
    pub cell: &'a [f64; D],
}

/// Particle that touches a contact node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactParticle<const D: usize> {
    /// Index of the particle.
    pub index: u32,
    /// Position relative to the node [m].
    pub place: [f64; D],
    /// Half edges of its parallelogram [m]; on a line the second is zero.
    pub half_edges: [[f64; D]; 2],
    /// Filled volume V N at the node [cells].
    pub volume: f64,
    /// Faces of its body [-]: with the coordinates s, t along the half edges, a face is the line s
    /// k1 + t k2 = 1; zeros: none.
    pub faces: [[f64; 2]; 2],
}

/// Contact plane of two bodies at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPlane<const D: usize> {
    /// Unit normal from the first body to the second [-].
    pub normal: [f64; D],
    /// Gap between the bodies, negative if they overlap [cells].
    pub gap: f64,
}

/// Contact planes of two bodies at a node.
pub type ContactPlanes<const D: usize> = SmallVec<[ContactPlane<D>; 2]>;

/// A particle corner: its position relative to the node [cells], and whether it belongs to the
/// second body.
pub type BoundaryPoint<const D: usize> = ([f64; D], bool);

/// Scalar product a.b.
#[inline(always)]
pub(super) fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (1..D).fold(a[0] * b[0], |sum, k| sum + a[k] * b[k])
}

/// Greatest extent of `particles` along the unit vector `normal`, relative to the node [m], and the
/// first particle that reaches as far.
pub fn reach<const D: usize>(
    particles: &[ContactParticle<D>],
    normal: &[f64; D],
) -> Option<(f64, u32)> {
    let mut most: Option<(f64, u32)> = None;
    for particle in particles {
        let [first, second] = &particle.half_edges;
        let half = dot(first, normal).abs() + dot(second, normal).abs();
        let reach = dot(&particle.place, normal) + half;
        if most.is_none_or(|(most, _)| reach > most) {
            most = Some((reach, particle.index));
        }
    }
    most
}

impl<const D: usize> BodyPair<'_, D> {
    /// Gap between the particles of the bodies along the unit vector `normal` [cells].
    pub(super) fn gap(&self, normal: &[f64; D]) -> Option<f64> {
        let (first, _) = reach(self.particles[0], normal)?;
        let (second, _) = reach(self.particles[1], &normal.map(|n| -n))?;
        Some(-(first + second) / self.shortest_edge())
    }

    /// Contact plane with the given `normal`. Near a corner the normal lies between the normals of
    /// two faces, and along it the bodies seem to overlap; a gap along the normal of each body and
    /// along each axis counts too.
    pub(super) fn plane(&self, normal: [f64; D]) -> Option<ContactPlane<D>> {
        let mut gap = self.gap(&normal)?;
        if D > 1 {
            let faces = [*self.gradient[0], self.gradient[1].map(|g| -g)];
            let faces = faces.into_iter().filter_map(direction);
            for along in faces.chain(axes(&normal)) {
                gap = gap.max(self.gap(&along)?);
            }
        }
        Some(ContactPlane { normal, gap })
    }

    /// Shortest edge of a cell [m].
    pub(super) fn shortest_edge(&self) -> f64 {
        self.cell.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Directions of the axes, each on the side of `normal`.
pub(super) fn axes<const D: usize>(normal: &[f64; D]) -> impl Iterator<Item = [f64; D]> {
    (0..D).map(|k| std::array::from_fn(|a| if a == k { normal[k].signum() } else { 0.0 }))
}

/// Relative size below which a component is only rounding.
const AXIS: f64 = 1e-10;

/// Length of a vector; exact along an axis.
fn length<const D: usize>(v: &[f64; D]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Unit vector along `v`; exactly along an axis if it is so to rounding.
pub(super) fn unit<const D: usize>(v: [f64; D]) -> [f64; D] {
    let first = length(&v);
    let v = v.map(|x| if x.abs() < AXIS * first { 0.0 } else { x });
    let length = length(&v);
    v.map(|x| x / length)
}

/// Unit vector along `v`, if it has a direction.
pub(super) fn direction<const D: usize>(v: [f64; D]) -> Option<[f64; D]> {
    (length(&v) > 0.0).then(|| unit(v))
}
