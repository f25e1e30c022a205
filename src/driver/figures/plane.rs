//! Pictures of a run in two dimensions: fields of its particles, and pressure along its waves.

use std::collections::BTreeSet;
use std::path::Path;

use super::bodies;
use crate::accuracy::reference::ReferenceSolution;
use crate::plot::{
    self, Color, Direction, Field, FieldData, FieldQuantity, FieldTile, LineOut, LineOutCurve,
    LineStyle, PictureError, Points, Series, Shading, Style, SymmetryPlane,
};
use crate::scene::{CheckedScene, Domain, SideProperties};
use crate::simulation::ParticleTable;

/// A particle quantity to draw, with the names in its pictures.
struct Drawn {
    stem: &'static str,
    label: &'static str,
    unit: &'static str,
    shading: Shading,
    values: Vec<f64>,
}

/// Draws pressure, density and speed over the plane, and the materials if there are several; crosses
/// mark failed particles. `name` is the profile's file name without its
/// extension.
///
/// # Errors
///
/// If a picture cannot be drawn or written.
///
/// # Panics
///
/// If the table lacks a drawn column, as that of a scene on a line does.
pub fn draw_fields(
    scene: &CheckedScene,
    table: &ParticleTable,
    notes: &[String],
    name: &str,
    folder: &Path,
) -> Result<(), PictureError> {
    let column = |name| table.column(name).expect("the table has its own columns");
    let [x, y] = ["x", "y"].map(column);
    let [vx, vy] = ["velocity_x", "velocity_y"].map(column);
    let speed = vx.iter().zip(vy).map(|(x, y)| x.hypot(*y)).collect();
    let drawn = [
        Drawn {
            stem: "pressure",
            label: "Pressure",
            unit: "Pa",
            shading: Shading::BySign,
            values: column("pressure").to_vec(),
        },
        Drawn {
            stem: "density",
            label: "Density",
            unit: "kg/m3",
            shading: Shading::Sequential,
            values: column("density").to_vec(),
        },
        Drawn {
            stem: "speed",
            label: "Speed",
            unit: "m/s",
            shading: Shading::Sequential,
            values: speed,
        },
    ];
    let domain = &scene.scene.domain;
    let corner = |corner: &[f64]| [corner[0], corner[1]];
    let axes = if scene.axisymmetric() { ["r", "z"] } else { ["x", "y"] };
    let joined = joined_sides(scene);
    let mirrored = scene.axisymmetric() && domain.lower[0] == 0.0;
    let mut notes = notes.to_vec();
    notes.extend(bodies::removed(scene, table));
    let materials = materials(scene);
    let mut drawn = Vec::from(drawn);
    if materials.len() > 1 {
        let (label, unit, shading) = ("Material", "", Shading::Sequential);
        drawn.push(Drawn {
            stem: "materials",
            label,
            unit,
            shading,
            values: vec![0.0; table.len()],
        });
    }
    for Drawn { stem, label, unit, shading, values } in drawn {
        let tile = |(k, value): (usize, f64)| FieldTile {
            centre: [x[k], y[k]],
            half_edges: compact(table.half_edges[k], &scene.cell_size),
            value,
            body: table.body[k],
        };
        let tiles = values.into_iter().enumerate().map(tile);
        let tiles = tiles.flat_map(|tile| in_domain(scene, joined, tile)).collect();
        let quantity = FieldQuantity::new(label, unit, shading);
        let field = Field {
            extent: Some([corner(&domain.lower), corner(&domain.upper)]),
            axes: axes.map(String::from),
            // an axisymmetric domain is mirrored at its axis
            mirror: mirrored.then_some(SymmetryPlane {
                across: Direction::X,
                at: 0.0,
                changes_sign: false,
            }),
            outlines: scene.bodies.len() > 1,
            notes: notes.clone(),
            fills: (stem == "materials").then(|| bodies::colors(scene)),
            overlays: match stem {
                "materials" => materials.clone(),
                _ => Vec::new(),
            }
            .into_iter()
            .chain(failed(table, &scene.scene.domain, mirrored))
            .collect(),
            ..Field::new(
                scene.scene.title.clone(),
                table.time,
                quantity,
                FieldData::Particles(tiles),
            )
        };
        let file = name.replace("profile", stem);
        plot::draw(&field.figure(), &folder.join(file))?;
    }
    Ok(())
}

/// Legend entries of the materials; they have no points.
fn materials(scene: &CheckedScene) -> Vec<Series> {
    let mut entries: Vec<Series> = Vec::new();
    for (body, color) in scene.scene.bodies.iter().zip(bodies::colors(scene)) {
        if entries.iter().all(|entry| entry.name != body.material) {
            let style = Style::line(color).width(14.0);
            entries.push(Series::new(&body.material, Points::new([], []), style));
        }
    }
    entries
}

/// Squares along the longer side of the domain, each of which has one cross at most.
const CROSSES: f64 = 60.0;

/// Crosses at failed particles, one per square of the domain, and if the picture shows the other side
/// of an axis at x = 0 also there; `None` if no particle has failed.
fn failed(table: &ParticleTable, domain: &Domain, mirrored: bool) -> Option<Series> {
    let [x, y] = ["x", "y"].map(|name| table.column(name).unwrap_or(&[]));
    let sides = domain.lower.iter().zip(&domain.upper).map(|(low, high)| high - low);
    let square = sides.fold(0.0, f64::max) / CROSSES;
    let mut marked = BTreeSet::new();
    let mut points = (Vec::new(), Vec::new());
    for row in bodies::failed(table) {
        let (x, y) = (x[row], y[row]);
        if marked.insert([x, y].map(|at| (at / square).floor() as i64)) {
            let images: &[f64] = if mirrored { &[x, -x] } else { &[x] };
            points.0.extend(images);
            points.1.extend(images.iter().map(|_| y));
        }
    }
    let style = Style { outlined: true, ..Style::crosses(Color::BLACK) };
    let some = !points.0.is_empty();
    some.then(|| Series::new("failed", Points::new(points.0, points.1), style))
}

/// Longest half diagonal up to which a parallelogram is drawn in its own shape [cells].
const LONGEST_DRAWN: f64 = 2.0;

/// Half edges of a parallelogram as drawn [m]. A parallelogram that has been sheared into a needle
/// would hide others and leave gaps, so it is replaced by a square of equal area.
fn compact([a, b]: [[f64; 2]; 2], cell: &[f64]) -> [[f64; 2]; 2] {
    let diagonal = |sign: f64| {
        let along = |d: usize| (a[d] + sign * b[d]) / cell[d];
        along(0).hypot(along(1))
    };
    if diagonal(1.0).max(diagonal(-1.0)) <= LONGEST_DRAWN {
        return [a, b];
    }
    let half = (a[0] * b[1] - a[1] * b[0]).abs().sqrt();
    [[half, 0.0], [0.0, half]]
}

/// Directions in which the domain is periodic.
fn joined_sides(scene: &CheckedScene) -> [bool; 2] {
    scene.side_properties::<2>().map(|ends| ends.iter().any(SideProperties::is_periodic))
}

/// The tile moved into a periodic domain, with a copy at the opposite side if it crosses a side.
fn in_domain(scene: &CheckedScene, joined: [bool; 2], tile: FieldTile) -> Vec<FieldTile> {
    let domain = &scene.scene.domain;
    let mut tiles = vec![tile];
    for d in (0..2).filter(|&d| joined[d]) {
        let (lower, upper) = (domain.lower[d], domain.upper[d]);
        let length = upper - lower;
        for k in 0..tiles.len() {
            let tile = &mut tiles[k];
            tile.centre[d] -= ((tile.centre[d] - lower) / length).floor() * length;
            let (tile, reach) = (*tile, tile.half_edges.iter().map(|edge| edge[d].abs()).sum());
            let at = tile.centre[d];
            for (crosses, image) in
                [(at - lower < reach, at + length), (upper - at < reach, at - length)]
            {
                if crosses {
                    let mut centre = tile.centre;
                    centre[d] = image;
                    tiles.push(FieldTile { centre, ..tile });
                }
            }
        }
    }
    tiles
}

/// Draws the pressure along the wave direction for profile time number `k`, with the exact
/// pressure.
///
/// # Errors
///
/// If a picture cannot be drawn or written.
pub fn draw_along(
    scene: &CheckedScene,
    reference: &ReferenceSolution,
    k: usize,
    table: &ParticleTable,
    notes: Vec<String>,
    stem: &Path,
) -> Result<(), PictureError> {
    let Some(exact) = reference.profile(scene, k) else { return Ok(()) };
    let samples = reference.samples_along(scene, table, 0.5);
    let line = |name: &str, look, x: Vec<f64>, p: Vec<f64>| LineOutCurve {
        name: name.into(),
        look,
        points: Points::new(x, p),
    };
    let (xs, ps) = samples.iter().map(|s| (s.x, s.p)).unzip();
    let (ex, ep) = exact.points.iter().map(|p| (p.x, p.p)).unzip();
    let figure = LineOut {
        title: scene.scene.title.clone(),
        time: table.time,
        position: "Position along the waves".into(),
        quantity: "Pressure".into(),
        unit: "Pa".into(),
        curves: vec![
            line("exact", LineStyle::Reference, ex, ep),
            line("mean over half a cell", LineStyle::Dots, xs, ps),
        ],
        notes,
        close_up: None,
    };
    plot::draw(&figure.figure(), stem)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::TableColumn;

    #[test]
    fn a_needle_is_drawn_as_a_square_of_its_area() {
        let tile = [[0.3, 0.1], [-0.1, 0.3]];
        assert_eq!(compact(tile, &[1.0, 1.0]), tile);
        let needle = [[3.0, 0.5], [2.9, 0.5]];
        let [[a, zero], [other, b]] = compact(needle, &[1.0, 1.0]);
        assert!((a * b - 0.05f64).abs() < 1e-15 && a == b && zero == 0.0 && other == 0.0);
        assert_eq!(compact(needle, &[4.0, 4.0]), needle, "cells are larger");
    }

    #[test]
    fn failed_particles_have_one_cross_per_square() {
        let scene = include_bytes!("../../../inputs/shear_layer.json");
        let scene = crate::input::parse(scene, "shear_layer.json", &[]).unwrap();
        let column = |name: &str, values: &[f64]| TableColumn {
            name: name.into(),
            unit: String::new(),
            values: values.into(),
        };
        let table = |damage: &[f64]| ParticleTable {
            time: 0.0,
            dimension: 2,
            ids: vec![0, 1, 2, 3],
            material: vec![0; 4],
            materials: vec!["gas".into()],
            body: vec![0; 4],
            columns: vec![
                column("x", &[0.501, 0.502, 0.6, 0.7]),
                column("y", &[0.501, 0.502, 0.6, 0.7]),
                column("damage", damage),
            ],
            half_edges: vec![[[0.01, 0.0], [0.0, 0.01]]; 4],
        };
        let crosses = |damage: &[f64]| failed(&table(damage), &scene.scene.domain, false);
        let marked = crosses(&[1.0, 1.0, 1.0, 0.99]).unwrap();
        assert_eq!(marked.points, Points::new([0.501, 0.6], [0.501, 0.6]));
        assert!(crosses(&[0.0, 0.5, 0.9, 0.0]).is_none());
        let both = failed(&table(&[0.0, 0.0, 1.0, 0.0]), &scene.scene.domain, true).unwrap();
        assert_eq!(both.points, Points::new([0.6, -0.6], [0.6, 0.6]));
    }

    #[test]
    fn what_has_left_a_joined_side_is_drawn_within() {
        let scene = include_bytes!("../../../inputs/shear_layer.json");
        let scene = crate::input::parse(scene, "shear_layer.json", &[]).unwrap();
        let half_edges = [[0.02, 0.0], [0.0, 0.01]];
        let tile = |x, y| FieldTile { centre: [x, y], half_edges, value: 1.0, body: 0 };
        let centres = |x, y| -> Vec<[f64; 2]> {
            in_domain(&scene, joined_sides(&scene), tile(x, y)).iter().map(|t| t.centre).collect()
        };
        assert_eq!(centres(3.25, 0.5), [[0.25, 0.5]]);
        assert_eq!(centres(-0.25, 0.5), [[0.75, 0.5]]);
        assert_eq!(centres(0.5, 1.0), [[0.5, 0.0], [0.5, 1.0]]);
        assert_eq!(centres(1.0, 1.0).len(), 4);
    }
}
