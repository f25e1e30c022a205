//! Bodies that reach across a plane of symmetry or the axis: the part inside of the domain.
//!
//! What lies beyond is the mirror image of what lies inside. The axis of an axisymmetric domain is
//! r = 0, the lower end of x.

use super::TOUCHING;
use super::model::{Body, CellSize, Geometry, Region, Scene, Side};
use crate::geometry::BoundedRegion;
use crate::geometry::region::{BoxShape, HalfPlane};

impl Scene {
    /// The regions of a body, as [`Body::regions`], in two dimensions clipped at the sides of kind
    /// `symmetry` and at the axis. What crosses none of them stays as it is.
    pub fn regions_of(&self, body: &Body) -> Vec<(&'static str, Region)> {
        let mut regions = body.regions();
        if self.domain.lower.len() == 2 && self.domain.upper.len() == 2 {
            for (_, region) in &mut regions {
                if let Some(clipped) = self.clipped(region, body.velocity.as_deref()) {
                    *region = clipped;
                }
            }
        }
        regions
    }

    /// The part of `region` inside of the planes of symmetry that it crosses; `None` if it crosses
    /// none, or has no part inside. A body that moves across a plane is not its own mirror image, and
    /// is not clipped there. Faults of a region are found where it is filled.
    fn clipped(&self, region: &Region, velocity: Option<&[f64]>) -> Option<Region> {
        let mirrors = self.mirrors();
        if mirrors.iter().flatten().all(|is_mirror| !is_mirror) {
            return None;
        }
        let bounds = BoundedRegion::new(region).ok()?.bounds();
        let domain = [&self.domain.lower, &self.domain.upper];
        let crosses = |a: usize, end: usize| {
            let outwards = [-1.0, 1.0][end];
            let beyond = |corner: usize| outwards * (bounds[corner][a] - domain[end][a]);
            let rests = velocity.and_then(|v| v.get(a)).is_none_or(|v| *v == 0.0);
            mirrors[a][end] && rests && beyond(end) > self.touching(a) && beyond(1 - end) < 0.0
        };
        let crossed: Vec<(usize, usize)> = [(0, 0), (0, 1), (1, 0), (1, 1)]
            .into_iter()
            .filter(|&(a, end)| crosses(a, end))
            .collect();
        if crossed.is_empty() {
            return None;
        }
        if let Region::Box(BoxShape { lower, upper }) = region {
            let mut corners = [lower.clone(), upper.clone()];
            crossed.iter().for_each(|&(a, end)| corners[end][a] = domain[end][a]);
            let [lower, upper] = corners;
            return Some(Region::Box(BoxShape { lower, upper }));
        }
        let half_plane = |&(a, end): &(usize, usize)| {
            let along_a = |value: f64| [0, 1].map(|d| if d == a { value } else { 0.0 }).to_vec();
            let (point, normal) = (along_a(domain[end][a]), along_a([-1.0, 1.0][end]));
            Region::HalfPlane(HalfPlane { point, normal })
        };
        let parts = [region.clone()].into_iter().chain(crossed.iter().map(half_plane));
        let clipped = Region::Intersection(parts.collect());
        BoundedRegion::new(&clipped).is_ok().then_some(clipped)
    }

    /// Whether each side, by direction and end, mirrors what is inside.
    fn mirrors(&self) -> [[bool; 2]; 2] {
        let sides = self.boundary.clone().unwrap_or_default();
        let mirrors = |side: &Side| side.properties().symmetric;
        let of = |side: &Option<Side>| side.as_ref().is_some_and(mirrors);
        let along_x = match self.domain.geometry {
            Geometry::Axisymmetric => [self.domain.lower[0] == 0.0, false],
            Geometry::PlaneStrain => [&sides.x_lower, &sides.x_upper].map(mirrors),
        };
        [along_x, [of(&sides.y_lower), of(&sides.y_upper)]]
    }

    /// Distance up to which two places touch along direction `a` [m].
    fn touching(&self, a: usize) -> f64 {
        TOUCHING
            * match &self.domain.cell_size {
                CellSize::Uniform(size) => *size,
                CellSize::PerDirection(sizes) => sizes.get(a).copied().unwrap_or(0.0),
            }
    }
}
