//! Values of a coarse run at the particles of a run.
//!
//! The particles of the two runs are at different positions. The values are interpolated linearly,
//! body by body: between neighbours on a line, in the triangles between the particles in a plane
//! (Delaunay 1934). Outside of them, at the surface of a body, the nearest particle of the coarse run
//! counts. In a hollow of a body the triangles join its two sides.

use spade::{
    DelaunayTriangulation, FloatTriangulation, HasPosition, Point2, Triangulation,
    mitigate_underflow,
};

use crate::simulation::ParticleTable;

/// Rows of each body, in order of the table.
pub(super) fn by_body(table: &ParticleTable) -> Vec<(u32, Vec<usize>)> {
    let mut all: Vec<(u32, Vec<usize>)> = Vec::new();
    for (row, &body) in table.body.iter().enumerate() {
        match all.iter_mut().find(|(of, _)| *of == body) {
            Some((_, rows)) => rows.push(row),
            None => all.push((body, vec![row])),
        }
    }
    all
}

/// Values of the columns `names` of `table` at the particles of `places`, one list per name; NaN for
/// bodies that are not in `table`, and for columns that it does not have.
pub(super) fn at_particles(
    table: &ParticleTable,
    names: &[&str],
    places: &ParticleTable,
) -> Vec<Vec<f64>> {
    let columns: Vec<Option<&[f64]>> = names.iter().map(|name| table.column(name)).collect();
    let mut values = vec![vec![f64::NAN; places.len()]; names.len()];
    let sources = by_body(table);
    for (body, wanted) in by_body(places) {
        let Some((_, rows)) = sources.iter().find(|(of, _)| *of == body) else { continue };
        let mut between = Interpolation::new(table, rows);
        for row in wanted {
            let place = |axis: usize| places.columns[axis].values[row];
            let neighbours = match places.dimension {
                1 => between.on_line(place(0)),
                _ => between.in_plane([place(0), place(1)]),
            };
            for (values, column) in values.iter_mut().zip(&columns) {
                if let Some(column) = column {
                    values[row] = neighbours.iter().map(|&(r, weight)| weight * column[r]).sum();
                }
            }
        }
    }
    values
}

/// A particle of a coarse run in a plane: position \[m\] and row in the table.
struct Vertex {
    position: Point2<f64>,
    row: usize,
}

impl HasPosition for Vertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// A position \[m\], with zero for coordinates that are too small for the triangulation.
fn point([x, y]: [f64; 2]) -> Point2<f64> {
    mitigate_underflow(Point2::new(x, y))
}

/// Linear interpolation between the particles of one body.
struct Interpolation<'a> {
    /// Positions along x \[m\].
    x: &'a [f64],
    /// Rows of the body; on a line in order of x.
    rows: &'a [usize],
    /// Triangles between the particles in a plane.
    triangles: DelaunayTriangulation<Vertex>,
    /// Rows and weights \[-\] of the last position.
    neighbours: Vec<(usize, f64)>,
}

impl<'a> Interpolation<'a> {
    fn new(table: &'a ParticleTable, rows: &'a [usize]) -> Self {
        let x = &table.columns[0].values;
        let vertex =
            |&row: &usize| Vertex { position: point([x[row], table.columns[1].values[row]]), row };
        let vertices = match table.dimension {
            1 => Vec::new(),
            _ => rows.iter().map(vertex).collect(),
        };
        let triangles =
            DelaunayTriangulation::bulk_load(vertices).expect("positions are finite numbers");
        Interpolation { x, rows, triangles, neighbours: Vec::new() }
    }

    /// Rows and weights for a position on a line \[m\].
    fn on_line(&mut self, at: f64) -> &[(usize, f64)] {
        let (rows, x) = (self.rows, |k: usize| self.x[self.rows[k]]);
        let after = rows.partition_point(|&row| self.x[row] < at).min(rows.len() - 1);
        let before = after.saturating_sub(1);
        let gap = x(after) - x(before);
        let share = if gap > 0.0 { ((at - x(before)) / gap).clamp(0.0, 1.0) } else { 1.0 };
        self.neighbours = vec![(rows[before], 1.0 - share), (rows[after], share)];
        &self.neighbours
    }

    /// Rows and weights for a position in a plane \[m\].
    fn in_plane(&mut self, [x, y]: [f64; 2]) -> &[(usize, f64)] {
        let at = point([x, y]);
        let mut found = Vec::new();
        self.triangles.barycentric().get_weights(at, &mut found);
        let row = |vertex| self.triangles.vertex(vertex).data().row;
        self.neighbours.clear();
        self.neighbours.extend(found.into_iter().map(|(vertex, weight)| (row(vertex), weight)));
        if self.neighbours.is_empty() {
            let nearest = self.triangles.nearest_neighbor(at);
            self.neighbours.extend(nearest.map(|vertex| (vertex.data().row, 1.0)));
        }
        &self.neighbours
    }
}
