//! Tiles around given points: each tile is the part of the shape that is nearer to its point than
//! to any other. Its particle is placed at the centroid instead of the point.
//!
//! Particles that do not tile their body cause noise in its density, from their irregular
//! positions. The areas of these cells, together with the centroids as positions, avoid that noise.

use spade::handles::VertexHandle;
use spade::{DelaunayTriangulation, Point2, Triangulation, mitigate_underflow};

use super::Point;
use super::lattice::Tile;
use super::moments::Moments;
use super::piece::Trapezium;
use super::shape::BoundedRegion;

/// Reason why a point cannot have a tile.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("point {} at {place:?}: {reason}", number + 1)]
pub struct PointFault {
    /// Index of the point, from 0; the message counts from 1.
    pub number: usize,
    /// Position [m].
    pub place: Vec<f64>,
    /// Description of the fault, and the allowed values.
    pub reason: String,
}

impl PointFault {
    fn new(number: usize, place: &[f64], reason: impl Into<String>) -> Self {
        PointFault { number, place: place.to_vec(), reason: reason.into() }
    }

    fn doubled(number: usize, other: usize, place: &[f64]) -> Self {
        let reason = format!("the place of point {}; allowed: a place of its own", other + 1);
        PointFault::new(number, place, reason)
    }
}

/// Distance over the mean distance of points, below which two points count as one.
const SAME: f64 = 1e-6;

/// Greatest allowed difference between the area of all tiles and that of the shape, over the
/// latter.
const MISSING: f64 = 1e-10;

/// The tiles of a shape around `points` [m], in their order; `size` is that of a square. The sum of
/// their areas is the area of the shape, and the sum of area times centre its first moments. A cell
/// that extends across a gap of the shape is still one tile.
///
/// # Errors
///
/// A point is outside the shape, or coincides with another.
pub fn voronoi(shape: &BoundedRegion, points: &[[f64; 2]]) -> Result<Vec<Tile>, PointFault> {
    let outside = |point: &Point| point.iter().any(|x| !x.is_finite()) || !shape.contains(*point);
    if let Some(number) = points.iter().position(outside) {
        let reason = "outside of the region; allowed: points within it";
        return Err(PointFault::new(number, &points[number], reason));
    }
    if points.is_empty() {
        return Ok(Vec::new());
    }
    let [lower, upper] = shape.bounds();
    let extent = (upper[0] - lower[0]).max(upper[1] - lower[1]);
    // scaled by the extent, since the triangulation has a limited range of coordinates
    let [x, y] = [0, 1].map(|d| move |point: &Point| (point[d] - lower[d]) / extent);
    let vertex = |point| mitigate_underflow(Point2::new(x(point), y(point)));
    let vertices: Vec<_> = points.iter().map(vertex).collect();
    check_doubled(points, &vertices)?;
    let neighbours = neighbours(vertices);
    let same = SAME * (shape.area() / points.len() as f64).sqrt();
    let margin = 0.1 * extent;
    let mut tiles = Vec::with_capacity(points.len());
    for (i, own) in neighbours.iter().enumerate() {
        let place = points[i];
        let distance = |j: usize| (points[j][0] - place[0]).hypot(points[j][1] - place[1]);
        if let Some(&j) = own.iter().find(|&&j| distance(j) <= same) {
            return Err(PointFault::doubled(i.max(j), i.min(j), &points[i.max(j)]));
        }
        let from = [0, 1].map(|d| lower[d] - margin);
        let to = [0, 1].map(|d| upper[d] + margin);
        let mut cell = vec![from, [to[0], from[1]], to, [from[0], to[1]]];
        for &j in own {
            cell = nearer(&cell, place, points[j]);
        }
        let mut moments = Moments::default();
        for trapezium in trapezia(&cell) {
            moments += shape.overlap(&trapezium, place);
        }
        let from = moments.centroid();
        let centre = [0, 1].map(|d| place[d] + from[d]);
        tiles.push(Tile { centre, area: moments.area, size: [moments.area.sqrt(); 2] });
    }
    check_cover(shape, points, &tiles)?;
    Ok(tiles)
}

/// Intervals around `points` [m] between `lower` and `upper` [m], each the part that is nearer to
/// its point than to any other: midpoint and length [m], in the order of the points.
///
/// # Errors
///
/// A point is outside the range, or coincides with another.
pub fn voronoi_line(lower: f64, upper: f64, points: &[f64]) -> Result<Vec<(f64, f64)>, PointFault> {
    let inside = |x: &f64| (lower..=upper).contains(x);
    if let Some(number) = points.iter().position(|x| !inside(x)) {
        let reason = format!("outside of the body; allowed: {lower:?} to {upper:?}");
        return Err(PointFault::new(number, &points[number..=number], reason));
    }
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].total_cmp(&points[b]).then(a.cmp(&b)));
    let same = SAME * (upper - lower) / points.len() as f64;
    for pair in order.windows(2) {
        if points[pair[1]] - points[pair[0]] <= same {
            let (first, second) = (pair[0].min(pair[1]), pair[0].max(pair[1]));
            return Err(PointFault::doubled(second, first, &points[second..=second]));
        }
    }
    let mut cells = vec![(0.0, 0.0); points.len()];
    let middle = |a: usize, b: usize| points[a] + 0.5 * (points[b] - points[a]);
    for (k, &i) in order.iter().enumerate() {
        let from = if k == 0 { lower } else { middle(order[k - 1], i) };
        let to = order.get(k + 1).map_or(upper, |&next| middle(i, next));
        cells[i] = (from + 0.5 * (to - from), to - from);
    }
    Ok(cells)
}

/// Refuses points with exactly the same vertex, which the triangulation would merge.
fn check_doubled(points: &[Point], vertices: &[Point2<f64>]) -> Result<(), PointFault> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    // 0 is added because -0 and 0 are the same position
    let key = |i: usize| [vertices[i].x + 0.0, vertices[i].y + 0.0];
    order.sort_by(|&a, &b| {
        let ([x, y], [u, v]) = (key(a), key(b));
        x.total_cmp(&u).then(y.total_cmp(&v)).then(a.cmp(&b))
    });
    match order.windows(2).filter(|pair| key(pair[0]) == key(pair[1])).min_by_key(|p| p[1]) {
        Some(pair) => Err(PointFault::doubled(pair[1], pair[0], &points[pair[1]])),
        None => Ok(()),
    }
}

/// For each point, the points whose cells share an edge with its cell, from the Delaunay
/// triangulation.
fn neighbours(vertices: Vec<Point2<f64>>) -> Vec<Vec<usize>> {
    let net: DelaunayTriangulation<_> =
        DelaunayTriangulation::bulk_load_stable(vertices).expect("positions are within the extent");
    let of = |vertex: VertexHandle<'_, _>| {
        let mut all: Vec<usize> = vertex.out_edges().map(|edge| edge.to().index()).collect();
        // the order in which the cell is cut, which changes its rounding
        all.sort_unstable();
        all
    };
    net.vertices().map(of).collect()
}

/// The part of a convex polygon that is nearer to `own` than to `other`.
fn nearer(polygon: &[Point], own: Point, other: Point) -> Vec<Point> {
    let normal = [0, 1].map(|d| other[d] - own[d]);
    let half = 0.5 * (normal[0] * normal[0] + normal[1] * normal[1]);
    let beyond = |p: &Point| (0..2).map(|d| (p[d] - own[d]) * normal[d]).sum::<f64>() - half;
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, from) in polygon.iter().enumerate() {
        let to = &polygon[(i + 1) % polygon.len()];
        let (a, b) = (beyond(from), beyond(to));
        if a <= 0.0 {
            kept.push(*from);
        }
        if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
            kept.push([0, 1].map(|d| from[d] + (to[d] - from[d]) * (a / (a - b))));
        }
    }
    kept
}

/// Trapezia of a convex, counter-clockwise polygon, cut by vertical lines through its vertices.
fn trapezia(polygon: &[Point]) -> Vec<Trapezium> {
    let mut places: Vec<f64> = polygon.iter().map(|p| p[0]).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let outline = super::solid::Outline::polygon(polygon);
    let super::solid::Outline::Polygon(edges) = outline else { return Vec::new() };
    let strip = |x: &[f64]| {
        let over = |p: Point, q: Point| p[0] <= x[0] && q[0] >= x[1];
        let lower = edges.iter().find(|e| over(e.from, e.to))?.line?;
        let upper = edges.iter().find(|e| over(e.to, e.from))?.line?;
        Some(Trapezium { x: [x[0], x[1]], lower, upper })
    };
    places.windows(2).filter_map(strip).collect()
}

/// Checks that the tiles cover the shape and that each has an area, which rounding can prevent if
/// points almost coincide.
fn check_cover(shape: &BoundedRegion, points: &[Point], tiles: &[Tile]) -> Result<(), PointFault> {
    let reason =
        "its cell cannot be distinguished from others; allowed: points that lie further apart";
    if let Some(i) = tiles.iter().position(|tile| tile.area.is_nan() || tile.area <= 0.0) {
        return Err(PointFault::new(i, &points[i], reason));
    }
    let (sum, area) = (tiles.iter().map(|tile| tile.area).sum::<f64>(), shape.area());
    if (sum - area).abs() <= MISSING * area {
        return Ok(());
    }
    let greatest = (0..tiles.len()).max_by(|&a, &b| tiles[a].area.total_cmp(&tiles[b].area));
    let i = greatest.unwrap_or(0);
    Err(PointFault::new(i, &points[i], reason))
}
