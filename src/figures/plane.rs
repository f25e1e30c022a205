//! Pictures of a run in a plane: fields of its particles, and pressure along its waves.

use std::path::Path;

use crate::output::ParticleTable;
use crate::output::pictures::{
    self, Direction, Field, FieldData, LineOut, LineOutCurve, Look, Mirror, PictureError, Points,
    Quantity, Shading, Tile,
};
use crate::reference::Reference;
use crate::scene::CheckedScene;

/// A quantity of particles that is drawn, with what its pictures are named.
struct Drawn {
    stem: &'static str,
    label: &'static str,
    unit: &'static str,
    shading: Shading,
    values: Vec<f64>,
}

/// Pressure, density and speed over the plane; `name` is the profile's file without its ending.
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
    for Drawn { stem, label, unit, shading, values } in drawn {
        let tile = |(k, value): (usize, f64)| Tile {
            centre: [x[k], y[k]],
            half_edges: table.half_edges[k],
            value,
            body: table.body[k],
        };
        let tiles = values.into_iter().enumerate().map(tile).collect();
        let quantity = Quantity::new(label, unit, shading);
        let field = Field {
            extent: Some([corner(&domain.lower), corner(&domain.upper)]),
            axes: axes.map(String::from),
            // what lies about an axis is shown whole
            mirror: (scene.axisymmetric() && domain.lower[0] == 0.0).then_some(Mirror {
                across: Direction::X,
                at: 0.0,
                changes_sign: false,
            }),
            outlines: scene.bodies.len() > 1,
            notes: notes.to_vec(),
            ..Field::new(
                scene.scene.title.clone(),
                table.time,
                quantity,
                FieldData::Particles(tiles),
            )
        };
        let file = name.replace("profile", stem);
        pictures::draw(&field.figure(), &folder.join(file))?;
    }
    Ok(())
}

/// Pressure along the line of the waves of profile time number `k`, against the exact one.
pub fn draw_along(
    scene: &CheckedScene,
    reference: &Reference,
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
            line("exact", Look::Reference, ex, ep),
            line("mean over half a cell", Look::Dots, xs, ps),
        ],
        notes,
        close_up: None,
    };
    pictures::draw(&figure.figure(), stem)?;
    Ok(())
}
