//! A region as a combination of outlines, and its section along a vertical line.

use super::Point;
use super::curve::{Arc, Curve};
use super::ellipse::EllipseCurve;
use super::line::Line;

/// A region: a single outline, or regions combined by an operation.
#[derive(Clone, Debug)]
pub(super) enum Solid {
    Outline(Outline),
    Joined(Operation, Vec<Solid>),
}

/// Operation that combines regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operation {
    Union,
    Intersection,
    /// The first without the others.
    Difference,
}

/// A region with one border.
#[derive(Clone, Debug)]
pub(super) enum Outline {
    /// Edges in order; the even-odd rule defines the inside.
    Polygon(Vec<Edge>),
    Ellipse(EllipseCurve),
    HalfPlane {
        point: Point,
        normal: [f64; 2],
        /// Border line, if it is not vertical.
        line: Option<Line>,
    },
}

/// An edge of a polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// Start [m].
    pub from: Point,
    /// End [m].
    pub to: Point,
    /// Line through the edge; `None` if it is vertical.
    pub line: Option<Line>,
}

/// Point at which a vertical line enters or leaves a region.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    /// Position [m], possibly infinite.
    pub y: f64,
    /// Curve that it crosses; `None` at infinity.
    pub curve: Option<Curve>,
}

impl Operation {
    fn inside(self, a: bool, b: bool) -> bool {
        match self {
            Operation::Union => a || b,
            Operation::Intersection => a && b,
            Operation::Difference => a && !b,
        }
    }
}

impl Outline {
    /// The polygon with these vertices.
    pub fn polygon(vertices: &[Point]) -> Self {
        let next = vertices.iter().cycle().skip(1);
        let edge = |(&from, &to)| Edge { from, to, line: Line::through(from, to) };
        Outline::Polygon(vertices.iter().zip(next).map(edge).collect())
    }

    /// The side of the line through `point` [m] that `normal` points away from; `normal` has any
    /// length but zero [-].
    pub fn half_plane(point: Point, normal: [f64; 2]) -> Self {
        let slope = -normal[0] / normal[1];
        let range = [f64::NEG_INFINITY, f64::INFINITY];
        let line = slope.is_finite().then_some(Line { at: point, slope, range });
        Outline::HalfPlane { point, normal, line }
    }

    /// Passages of the vertical line at `x` [m], in order of y.
    fn section(&self, x: f64) -> Vec<Passage> {
        let through = |curve: Curve| Passage { y: curve.y(x), curve: Some(curve) };
        let infinite = |y: f64| Passage { y, curve: None };
        match self {
            Outline::Polygon(edges) => {
                let at = |e: &&Edge| (e.from[0] <= x) != (e.to[0] <= x);
                let lines = edges.iter().filter(at).filter_map(|e| e.line);
                let mut passages: Vec<_> = lines.map(|l| through(Curve::Line(l))).collect();
                passages.sort_by(|a, b| a.y.total_cmp(&b.y));
                passages
            }
            Outline::Ellipse(ellipse) => {
                if (x - ellipse.centre[0]).abs() >= ellipse.half_width {
                    return Vec::new();
                }
                let half = |side| through(Curve::Arc(Arc { ellipse: *ellipse, side }));
                vec![half(-1.0), half(1.0)]
            }
            Outline::HalfPlane { point, normal, line } => {
                let [below, above] = [infinite(f64::NEG_INFINITY), infinite(f64::INFINITY)];
                match line {
                    Some(line) if normal[1] > 0.0 => vec![below, through(Curve::Line(*line))],
                    Some(line) => vec![through(Curve::Line(*line)), above],
                    None if (x - point[0]) * normal[0] <= 0.0 => vec![below, above],
                    None => Vec::new(),
                }
            }
        }
    }
}

impl Solid {
    /// Passages of the vertical line at `x` [m], in order of y; entries and exits alternate.
    pub fn section(&self, x: f64) -> Vec<Passage> {
        match self {
            Solid::Outline(outline) => outline.section(x),
            Solid::Joined(operation, parts) => {
                let mut parts = parts.iter().map(|part| part.section(x));
                let first = parts.next().unwrap_or_default();
                parts.fold(first, |a, b| join(*operation, &a, &b))
            }
        }
    }

    /// Appends all outlines to `list`.
    pub fn outlines<'a>(&'a self, list: &mut Vec<&'a Outline>) {
        match self {
            Solid::Outline(outline) => list.push(outline),
            Solid::Joined(_, parts) => parts.iter().for_each(|part| part.outlines(list)),
        }
    }
}

/// Passages of the combination of two sections. Passages at the same position count together, so
/// that coincident borders leave nothing between them.
fn join(operation: Operation, a: &[Passage], b: &[Passage]) -> Vec<Passage> {
    let mut out = Vec::with_capacity(a.len() + b.len());
    let (mut i, mut j, mut inside) = (0, 0, false);
    while let Some(&next) = match (a.get(i), b.get(j)) {
        (Some(p), Some(q)) => Some(if p.y <= q.y { p } else { q }),
        (p, q) => p.or(q),
    } {
        while a.get(i).is_some_and(|p| p.y == next.y) {
            i += 1;
        }
        while b.get(j).is_some_and(|p| p.y == next.y) {
            j += 1;
        }
        let now = operation.inside(i % 2 == 1, j % 2 == 1);
        if now != inside {
            inside = now;
            out.push(next);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passages(list: &[f64]) -> Vec<Passage> {
        list.iter().map(|&y| Passage { y, curve: None }).collect()
    }

    #[test]
    fn sections_join_like_sets() {
        let (a, b) = (passages(&[0.0, 2.0, 5.0, 6.0]), passages(&[1.0, 5.0]));
        let join = |op, a: &[Passage], b: &[Passage]| -> Vec<f64> {
            super::join(op, a, b).iter().map(|p| p.y).collect()
        };
        assert_eq!(join(Operation::Union, &a, &b), [0.0, 6.0]);
        assert_eq!(join(Operation::Intersection, &a, &b), [1.0, 2.0]);
        assert_eq!(join(Operation::Difference, &a, &b), [0.0, 1.0, 5.0, 6.0]);
        assert_eq!(join(Operation::Difference, &b, &a), [2.0, 5.0]);
        assert!(join(Operation::Difference, &a, &a).is_empty());
    }

    #[test]
    fn infinite_sections_join_too() {
        let all = passages(&[f64::NEG_INFINITY, f64::INFINITY]);
        let some = passages(&[0.0, 1.0]);
        assert_eq!(join(Operation::Intersection, &all, &some).len(), 2);
        assert_eq!(join(Operation::Difference, &all, &some).len(), 4);
        assert!(join(Operation::Difference, &some, &all).is_empty());
    }
}
