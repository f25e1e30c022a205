//! Decomposition of a region into pieces, by vertical lines at all positions where its section
//! changes: at vertices, at the extremes of ellipses, and at crossings of borders.
//!
//! Between two such positions the section has the same passages in the same order, so that its
//! middle represents all of it. Additional positions do no harm.

use super::ellipse::EllipseCurve;
use super::line::Line;
use super::piece::Piece;
use super::solid::{Edge, Outline, Solid};

/// A part of a border that can cross others: an edge, an infinite line or a whole ellipse.
struct Border {
    kind: PieceKind,
    x: [f64; 2],
    y: [f64; 2],
}

enum PieceKind {
    Line(Line),
    Ellipse(EllipseCurve),
}

/// Reasons why a region has no pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoPieces {
    /// The region is not bounded.
    Unbounded,
    /// The region is empty.
    Empty,
}

/// Area over the square of the width, below which a region is empty except for rounding.
const NOTHING: f64 = 1e-13;

/// The pieces of a region, from left to right, and from bottom to top within each strip.
pub(super) fn pieces(solid: &Solid) -> Result<Vec<Piece>, NoPieces> {
    let places = places(solid);
    let (Some(&first), Some(&last)) = (places.first(), places.last()) else {
        let bare = solid.section(0.0).is_empty();
        return Err(if bare { NoPieces::Empty } else { NoPieces::Unbounded });
    };
    let beyond = (last - first).max(last.abs()).max(first.abs()).max(f64::MIN_POSITIVE);
    if [first - beyond, last + beyond].iter().any(|&x| !solid.section(x).is_empty()) {
        return Err(NoPieces::Unbounded);
    }
    let mut pieces = Vec::new();
    for strip in places.windows(2) {
        let passages = solid.section(0.5 * (strip[0] + strip[1]));
        for pair in passages.chunks_exact(2) {
            let (Some(lower), Some(upper)) = (pair[0].curve, pair[1].curve) else {
                return Err(NoPieces::Unbounded);
            };
            pieces.push(Piece { x: [strip[0], strip[1]], lower, upper });
        }
    }
    let area: f64 = pieces.iter().map(|p| p.moments([p.x[0], p.lower.y(p.x[0])]).area).sum();
    // not "<=": the area may be NaN
    let something = area > NOTHING * (last - first) * (last - first);
    if something { Ok(pieces) } else { Err(NoPieces::Empty) }
}

/// Sorted positions x [m] between which the structure of the section does not change.
fn places(solid: &Solid) -> Vec<f64> {
    let mut outlines = Vec::new();
    solid.outlines(&mut outlines);
    let mut places = Vec::new();
    let mut borders = Vec::with_capacity(outlines.len());
    for outline in outlines {
        borders.push(borders_of(outline, &mut places));
    }
    for (i, list) in borders.iter().enumerate() {
        for a in list {
            for b in borders[i + 1..].iter().flatten() {
                crossings(a, b, &mut places);
            }
        }
    }
    places.retain(|x| x.is_finite());
    places.sort_by(f64::total_cmp);
    let scale = places.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
    // the same position computed twice differs by rounding
    places.dedup_by(|next, kept| *next - *kept <= 4.0 * f64::EPSILON * scale);
    places
}

/// The borders of an outline; adds the positions of their ends and extremes to `places`.
fn borders_of(outline: &Outline, places: &mut Vec<f64>) -> Vec<Border> {
    match outline {
        Outline::Polygon(edges) => {
            places.extend(edges.iter().map(|e| e.from[0]));
            let border = |Edge { from, to, line }: &Edge| {
                let x = [from[0].min(to[0]), from[0].max(to[0])];
                line.map(|line| Border { kind: PieceKind::Line(line), x, y: line.range })
            };
            edges.iter().filter_map(border).collect()
        }
        Outline::Ellipse(ellipse) => {
            places.extend(ellipse.extremes());
            let around = |middle: f64, half: f64| [middle - half, middle + half];
            let x = around(ellipse.centre[0], ellipse.half_width);
            let y = around(ellipse.centre[1], ellipse.half_extent_y());
            vec![Border { kind: PieceKind::Ellipse(*ellipse), x, y }]
        }
        Outline::HalfPlane { point, line: None, .. } => {
            places.push(point[0]);
            Vec::new()
        }
        Outline::HalfPlane { line: Some(line), .. } => {
            let all = [f64::NEG_INFINITY, f64::INFINITY];
            vec![Border { kind: PieceKind::Line(*line), x: all, y: all }]
        }
    }
}

/// Adds the positions at which two borders cross to `places`.
fn crossings(a: &Border, b: &Border, places: &mut Vec<f64>) {
    let apart = |p: [f64; 2], q: [f64; 2]| p[1] < q[0] || q[1] < p[0];
    if apart(a.x, b.x) || apart(a.y, b.y) {
        return;
    }
    match (&a.kind, &b.kind) {
        (PieceKind::Line(line), PieceKind::Line(other)) => {
            let meet = line.meet(other);
            let within = |x: &f64| [a.x, b.x].iter().all(|r| r[0] <= *x && *x <= r[1]);
            places.extend(meet.filter(within));
        }
        (PieceKind::Ellipse(ellipse), PieceKind::Ellipse(other)) => {
            places.extend(ellipse.meet(other))
        }
        (PieceKind::Line(line), PieceKind::Ellipse(ellipse))
        | (PieceKind::Ellipse(ellipse), PieceKind::Line(line)) => {
            places.extend(ellipse.meet_line(line));
        }
    }
}
