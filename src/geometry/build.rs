//! Conversion of a region of the scene to a checked solid; a fault names the key inside the region.

use robust::{Coord, orient2d};
use serde::Serialize;
use serde_json::Value;

use super::Point;
use super::ellipse::EllipseCurve;
use super::region::{Annulus, BoxShape, Disk, HalfPlane, Polygon, Region, Rotation};
use super::solid::{Operation, Outline, Solid};

/// A fault in a region.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path} = {value}: {reason}")]
pub struct RegionFault {
    /// Path of the key inside the region, such as `union[1].disk.radius`.
    pub path: String,
    /// Value of that key.
    pub value: Value,
    /// Description of the fault, and the allowed values.
    pub reason: String,
}

impl RegionFault {
    pub(super) fn new(path: &str, value: impl Serialize, reason: impl Into<String>) -> Self {
        let value = serde_json::to_value(value).unwrap_or(Value::Null);
        RegionFault { path: path.to_string(), value, reason: reason.into() }
    }
}

/// Greatest length or coordinate [m]: its fourth power is still finite.
const GREATEST: f64 = 1e60;

/// Smallest length [m]: its fourth power is still above 0.
const LEAST: f64 = 1e-60;

/// Greatest thickness over length of a polygon whose area is only rounding.
const THIN: f64 = 1e-12;

/// A rotation about the origin, followed by a translation.
#[derive(Clone, Copy)]
struct Placement {
    cos: f64,
    sin: f64,
    shift: [f64; 2],
}

impl Placement {
    const NONE: Placement = Placement { cos: 1.0, sin: 0.0, shift: [0.0; 2] };

    /// A rotation about the point `about`; quarter turns are exact.
    fn turn(degrees: f64, about: Point) -> Self {
        let (sin, cos) = match degrees.rem_euclid(360.0) {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            angle => angle.to_radians().sin_cos(),
        };
        let turn = Placement { cos, sin, shift: [0.0; 2] };
        let moved = turn.vector(about);
        Placement { shift: [about[0] - moved[0], about[1] - moved[1]], ..turn }
    }

    fn vector(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }

    fn point(&self, point: Point) -> Point {
        let [x, y] = self.vector(point);
        [x + self.shift[0], y + self.shift[1]]
    }

    /// The placement that applies `inner` first, then this one.
    fn after(&self, inner: &Placement) -> Self {
        let cos = self.cos * inner.cos - self.sin * inner.sin;
        let sin = self.sin * inner.cos + self.cos * inner.sin;
        Placement { cos, sin, shift: self.point(inner.shift) }
    }
}

/// The solid of a region.
pub(super) fn solid(region: &Region) -> Result<Solid, RegionFault> {
    build(region, "", &Placement::NONE)
}

/// The key of a region's only entry.
pub(super) fn key(region: &Region) -> &'static str {
    match region {
        Region::Box(_) => "box",
        Region::Disk(_) => "disk",
        Region::Ellipse(_) => "ellipse",
        Region::Polygon(_) => "polygon",
        Region::Annulus(_) => "annulus",
        Region::HalfPlane(_) => "half_plane",
        Region::Union(_) => "union",
        Region::Difference(_) => "difference",
        Region::Intersection(_) => "intersection",
        Region::Rotation(_) => "rotation",
    }
}

fn build(region: &Region, parent: &str, motion: &Placement) -> Result<Solid, RegionFault> {
    let dot = if parent.is_empty() { "" } else { "." };
    let path = format!("{parent}{dot}{}", key(region));
    let join = |operation, parts: &[Region]| {
        if parts.is_empty() {
            let reason = "an empty list; allowed: one region or more";
            return Err(RegionFault::new(&path, parts, reason));
        }
        let part = |(i, part)| build(part, &format!("{path}[{i}]"), motion);
        let parts = parts.iter().enumerate().map(part).collect::<Result<_, _>>()?;
        Ok(Solid::Joined(operation, parts))
    };
    let ellipse = |centre, radii| {
        let ellipse = EllipseCurve::tilted(motion.point(centre), radii, motion.cos, motion.sin);
        Solid::Outline(Outline::Ellipse(ellipse))
    };
    let polygon = |vertices: Vec<Point>| {
        let vertices: Vec<_> = vertices.into_iter().map(|p| motion.point(p)).collect();
        Solid::Outline(Outline::polygon(&vertices))
    };
    Ok(match region {
        Region::Box(extent) => {
            let [[x0, y0], [x1, y1]] = corners(extent, &path)?;
            polygon(vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
        }
        Region::Disk(Disk { centre, radius }) => {
            let centre = point(centre, &format!("{path}.centre"))?;
            let radius = length(*radius, &format!("{path}.radius"))?;
            ellipse(centre, [radius, radius])
        }
        Region::Ellipse(super::region::Ellipse { centre, radii }) => {
            let centre = point(centre, &format!("{path}.centre"))?;
            let path = format!("{path}.radii");
            let [a, b] = point(radii, &path)?;
            ellipse(centre, [length(a, &format!("{path}[0]"))?, length(b, &format!("{path}[1]"))?])
        }
        Region::Polygon(Polygon { vertices }) => {
            polygon(check_polygon(vertices, &format!("{path}.vertices"))?)
        }
        Region::Annulus(Annulus { centre, inner, outer }) => {
            let centre = point(centre, &format!("{path}.centre"))?;
            let hole = length(*inner, &format!("{path}.inner"))?;
            let disk = length(*outer, &format!("{path}.outer"))?;
            if inner >= outer {
                let reason =
                    format!("not within the outer circle; allowed: below {path}.outer = {outer:?}");
                return Err(RegionFault::new(&format!("{path}.inner"), inner, reason));
            }
            let disks = vec![ellipse(centre, [disk, disk]), ellipse(centre, [hole, hole])];
            Solid::Joined(Operation::Difference, disks)
        }
        Region::HalfPlane(HalfPlane { point: at, normal }) => {
            let at = point(at, &format!("{path}.point"))?;
            let path = format!("{path}.normal");
            let [x, y] = point(normal, &path)?;
            let norm = x.hypot(y);
            if norm == 0.0 {
                let reason = "no direction; allowed: two numbers that are not both 0";
                return Err(RegionFault::new(&path, normal, reason));
            }
            let normal = motion.vector([x / norm, y / norm]);
            Solid::Outline(Outline::half_plane(motion.point(at), normal))
        }
        Region::Union(parts) => join(Operation::Union, parts)?,
        Region::Difference(parts) => join(Operation::Difference, parts)?,
        Region::Intersection(parts) => join(Operation::Intersection, parts)?,
        Region::Rotation(Rotation { angle, about, of }) => {
            let about = point(about, &format!("{path}.about"))?;
            let angle = number(*angle, &format!("{path}.angle"))?;
            let turned = motion.after(&Placement::turn(angle, about));
            build(of, &format!("{path}.of"), &turned)?
        }
    })
}

fn number(value: f64, path: &str) -> Result<f64, RegionFault> {
    if value.abs() <= GREATEST {
        return Ok(value);
    }
    let reason = format!("out of range; allowed: finite numbers, {GREATEST:e} at most");
    Err(RegionFault::new(path, value.to_string(), reason))
}

fn length(value: f64, path: &str) -> Result<f64, RegionFault> {
    if value >= LEAST || value.is_nan() {
        return number(value, path);
    }
    let reason = format!("no length; allowed: above 0, at least {LEAST:e}");
    Err(RegionFault::new(path, value, reason))
}

fn point(values: &[f64], path: &str) -> Result<Point, RegionFault> {
    let &[x, y] = values else {
        let reason = format!("{} numbers; allowed: two, x and y", values.len());
        return Err(RegionFault::new(path, values, reason));
    };
    Ok([number(x, &format!("{path}[0]"))?, number(y, &format!("{path}[1]"))?])
}

/// Lower and upper corner of a box.
pub(super) fn corners(extent: &BoxShape, path: &str) -> Result<[Point; 2], RegionFault> {
    let lower = point(&extent.lower, &format!("{path}.lower"))?;
    let path = format!("{path}.upper");
    let upper = point(&extent.upper, &path)?;
    for d in 0..2 {
        if upper[d] <= lower[d] {
            let reason = format!("not above the lower corner; allowed: above {:?}", lower[d]);
            return Err(RegionFault::new(&format!("{path}[{d}]"), upper[d], reason));
        }
    }
    Ok([lower, upper])
}

/// Checks that a polygon has an area and does not touch itself; returns its vertices.
fn check_polygon(vertices: &[Vec<f64>], path: &str) -> Result<Vec<Point>, RegionFault> {
    let fault = |reason: String| Err(RegionFault::new(path, vertices, reason));
    if vertices.len() < 3 {
        return fault(format!("{} vertices; allowed: three or more", vertices.len()));
    }
    let at = |(i, v): (usize, &Vec<f64>)| point(v, &format!("{path}[{i}]"));
    let points = vertices.iter().enumerate().map(at).collect::<Result<Vec<Point>, _>>()?;
    let n = points.len();
    if let Some(i) = (0..n).find(|&i| points[i] == points[(i + 1) % n]) {
        return fault(format!(
            "vertices [{i}] and [{}] are one point; allowed: each unlike the next, the last being \
             joined to the first",
            (i + 1) % n
        ));
    }
    let distance = |p: &Point| (p[0] - points[0][0]).hypot(p[1] - points[0][1]);
    let far =
        points.iter().max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(&points[0]);
    let long = distance(far);
    let side = |p: &Point| {
        (far[0] - points[0][0]) * (p[1] - points[0][1])
            - (far[1] - points[0][1]) * (p[0] - points[0][0])
    };
    if points.iter().all(|p| side(p).abs() <= THIN * long * long) {
        return fault(
            "no area, all vertices lie on a line; allowed: a polygon with an area".into(),
        );
    }
    for i in 0..n {
        for j in i + 1..n {
            if touch(&points, i, j) {
                return fault(format!(
                    "crosses or touches itself, the edges from vertex [{i}] and from vertex [{j}] \
                     meet; allowed: edges that meet at their common vertex alone"
                ));
            }
        }
    }
    Ok(points)
}

/// Whether the edges from the vertices `i` < `j` meet anywhere except at a shared vertex.
fn touch(points: &[Point], i: usize, j: usize) -> bool {
    let n = points.len();
    let [a, b, c, d] = [points[i], points[(i + 1) % n], points[j], points[(j + 1) % n]];
    let range = |p: f64, q: f64| [p.min(q), p.max(q)];
    for k in 0..2 {
        let (own, other) = (range(a[k], b[k]), range(c[k], d[k]));
        if own[1] < other[0] || other[1] < own[0] {
            return false;
        }
    }
    let coord = |p: Point| Coord { x: p[0], y: p[1] };
    let side = |p, q, r| {
        let side = orient2d(coord(p), coord(q), coord(r));
        if side == 0.0 { 0.0 } else { side.signum() }
    };
    // neighbours meet elsewhere only if one folds back onto the other
    let folds = |p: Point, q: Point, r: Point| {
        let along = (p[0] - q[0]) * (r[0] - q[0]) + (p[1] - q[1]) * (r[1] - q[1]);
        side(p, q, r) == 0.0 && along > 0.0
    };
    if j == i + 1 {
        return folds(a, b, d);
    }
    if (j + 1) % n == i {
        return folds(c, a, b);
    }
    side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
}
