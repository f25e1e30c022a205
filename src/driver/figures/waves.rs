//! The x-t diagrams of a scene on a line.

use std::path::Path;

use super::{DiagramQuantity, WaveRow, bodies};
use crate::accuracy::reference::ReferenceSolution;
use crate::exact::{self, ExactError, PathKind, Plate, Solution};
use crate::plot::{self, PictureError, Points, Stroke, WaveDiagram, WavePath};
use crate::scene::CheckedScene;
use crate::simulation::BodyRow;

/// Draws the x-t diagrams of a run, of the pressure at `stem` and of each of the `others`: computed
/// values, surfaces and failed parts of the bodies, and the exact wave paths if there are any.
///
/// # Errors
///
/// [`PictureError`] if a file cannot be written.
pub fn draw_run_waves(
    scene: &CheckedScene,
    rows: &[WaveRow],
    body_rows: &[BodyRow],
    others: &[DiagramQuantity],
    reference: Option<&ReferenceSolution>,
    stem: &Path,
) -> Result<(), PictureError> {
    let mut diagram = diagram(rows, None, reference);
    let content = match diagram.paths.is_empty() {
        true => "over position and time",
        false => "and exact wave paths",
    };
    let title = |quantity: &str| format!("{}: {quantity} {content}", scene.scene.title);
    diagram.title = title("pressure");
    if let Some(last) = body_rows.last() {
        diagram.bands = bodies::bands(scene, &last.ends);
    }
    // the exact lines show the surfaces of flyer and target already, if they go on to the end
    let shown = match reference {
        Some(ReferenceSolution::Impact(all)) if diagram.exact_until.is_none() => {
            vec![all.flyer, all.target]
        }
        _ => Vec::new(),
    };
    diagram.surfaces = surfaces(body_rows, &shown);
    // every third row: a hatching, through which the pressure is seen
    let hatched = body_rows.iter().step_by(3);
    diagram.failed = hatched
        .flat_map(|row| row.failed.iter().map(|part| (part[0], part[1], row.time)))
        .collect();
    plot::draw(&diagram.figure(), stem)?;
    for (k, quantity) in others.iter().enumerate() {
        let words = quantity.name.replace('_', " ");
        diagram.title = title(&words);
        diagram.quantity = (capitalized(&words), quantity.unit.clone());
        let known = rows.iter().filter_map(|row| row.others.get(k).map(|values| (row, values)));
        let known = known.filter(|(row, values)| values.len() == row.x.len());
        diagram.rows = known.map(|(row, values)| diagram_row(row, values)).collect();
        let stem = stem.with_file_name(format!(
            "{}_{}",
            stem.file_name().unwrap_or_default().to_string_lossy(),
            quantity.name
        ));
        plot::draw(&diagram.figure(), &stem)?;
    }
    Ok(())
}

/// The text with its first letter in upper case.
fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// A row of a picture.
fn diagram_row(row: &WaveRow, values: &[f64]) -> plot::DiagramRow {
    plot::DiagramRow { time: row.time, x: row.x.clone(), values: values.to_vec() }
}

/// Draws the x-t diagram: pressure under the exact wave paths, up to the last row or to `end` [s], if
/// that is later. If the exact lines end earlier, a line and a note in the picture say so.
///
/// # Errors
///
/// [`PictureError`] if a file cannot be written.
pub fn draw_waves(
    title: &str,
    rows: &[WaveRow],
    end: Option<f64>,
    reference: Option<&ReferenceSolution>,
    stem: &Path,
) -> Result<(), PictureError> {
    let diagram = WaveDiagram { title: title.into(), ..diagram(rows, end, reference) };
    plot::draw(&diagram.figure(), stem)?;
    Ok(())
}

/// Pressure and exact paths, without a title.
fn diagram(
    rows: &[WaveRow],
    end: Option<f64>,
    reference: Option<&ReferenceSolution>,
) -> WaveDiagram {
    let end = rows.iter().map(|r| r.time).fold(end.unwrap_or(0.0), f64::max);
    let mut diagram = WaveDiagram { end: Some(end), ..WaveDiagram::default() };
    if let Some(ReferenceSolution::Impact(all)) = reference {
        diagram.paths = {
            let free_rear = all.impact.free_rear;
            all.solution.paths.iter().map(|path| drawn_path(path, end, free_rear)).collect()
        };
        (diagram.exact_until, diagram.notes) = ends(&all.solution, end);
    }
    diagram.rows = rows.iter().map(|row| diagram_row(row, &row.pressure)).collect();
    diagram
}

/// The time at which all exact lines end before `end` [s], and notes about lines that end.
fn ends(solution: &Solution, end: f64) -> (Option<f64>, Vec<String>) {
    let (mut until, mut notes) = (None, Vec::new());
    if let Some((stopped, why)) = &solution.stopped
        && *stopped < end
    {
        until = Some(*stopped);
        notes.push(format!("exact lines end at {:.4} µs:", stopped * 1e6));
        let why = match why {
            ExactError::RearNotFree => "a wave reaches the target's rear, which is not free",
            ExactError::TooManyWaves { .. } => "too many waves meet",
            _ => "more tension than the equation of state has",
        };
        notes.push(why.into());
    }
    let inside = |p: &exact::Path| p.steepened && p.points.last().is_some_and(|q| q[0] < end);
    if solution.paths.iter().any(inside) {
        notes.push("a fan's line ends where the fan steepens".into());
    }
    (until, notes)
}

/// The lower and the upper surface of each body over time, but for the bodies that are `shown`
/// already; interrupted while the body has no particles.
fn surfaces(rows: &[BodyRow], shown: &[usize]) -> Vec<Points> {
    let bodies = rows.iter().map(|row| row.ends.len()).max().unwrap_or(0);
    let surface = |body: usize, side: usize| {
        let place = |row: &BodyRow| row.ends.get(body).map_or(f64::NAN, |ends| ends[side]);
        let x: Vec<f64> = rows.iter().map(place).collect();
        Points::new(x, rows.iter().map(|row| row.time).collect::<Vec<f64>>())
    };
    let bodies = (0..bodies).filter(|body| !shown.contains(body));
    bodies.flat_map(|body| [surface(body, 0), surface(body, 1)]).collect()
}

/// The part of a path up to `end` [s]. `free_rear`: whether the target's rear is a free surface.
fn drawn_path(path: &exact::Path, end: f64, free_rear: bool) -> WavePath {
    let held = path.kind == PathKind::FreeSurface && path.plate == Plate::Target && !free_rear;
    let (name, stroke) = path_style(if held { PathKind::Interface } else { path.kind });
    let points = until(&path.points, end);
    let points = Points::new(
        points.iter().map(|q| q[1]).collect::<Vec<f64>>(),
        points.iter().map(|q| q[0]).collect::<Vec<f64>>(),
    );
    WavePath { name: name.into(), points, stroke }
}

/// The part of a line of the x-t diagram up to the time `end` [s]; the last segment is cut at
/// `end`.
fn until(points: &[[f64; 2]], end: f64) -> Vec<[f64; 2]> {
    let inside = points.partition_point(|q| q[0] <= end);
    let mut part = points[..inside].to_vec();
    if let (Some(&[t, x]), Some(&[later, x_later])) = (part.last(), points.get(inside)) {
        part.push([end, x + (x_later - x) * (end - t) / (later - t)]);
    }
    part
}

fn path_style(kind: PathKind) -> (&'static str, Stroke) {
    match kind {
        PathKind::Shock => ("shock", Stroke::Solid),
        PathKind::FanHead => ("head of a fan", Stroke::Dashed),
        PathKind::FanTail => ("tail of a fan", Stroke::Dotted),
        PathKind::Interface => ("interface", Stroke::Solid),
        PathKind::FreeSurface => ("free surface", Stroke::Solid),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::reference::impact_of;
    use crate::exact::Accuracy;
    use crate::scene::Reference;

    #[test]
    fn surfaces_are_those_of_bodies_without_exact_lines() {
        let ends = vec![[0.0, 1.0], [1.0, 2.0], [f64::INFINITY, f64::NEG_INFINITY]];
        let rows = [BodyRow { time: 0.5, ends, failed: Vec::new() }];
        let all = surfaces(&rows, &[]);
        assert_eq!((all.len(), all[1].x[0], all[2].y[0]), (6, 1.0, 0.5));
        assert_eq!(
            surfaces(&rows, &[0, 2]),
            [Points::new([1.0], [0.5]), Points::new([2.0], [0.5])]
        );
        assert!(surfaces(&[], &[]).is_empty());
    }

    #[test]
    fn the_end_of_the_exact_lines_is_reported() {
        let text = include_bytes!("../../../inputs/flyer.json");
        let scene = crate::input::parse(text, "flyer.json", &[]).unwrap();
        let Some(Reference::FlyerImpact(named)) = &scene.scene.reference else { panic!() };
        let (mut impact, _) = impact_of(&scene, named).unwrap();
        // the shock needs 1.27 us to the rear, which is held here
        impact.free_rear = false;
        let solution = impact.solve(&[3e-6], &[], Accuracy::default()).unwrap();
        let (until, notes) = ends(&solution, 3e-6);
        assert!(until.is_some_and(|t| (1.1e-6..1.4e-6).contains(&t)), "{until:?}");
        assert!(notes[0].starts_with("exact lines end at 1.") && notes[1].contains("not free"));
        assert_eq!(ends(&solution, 1e-6).0, None);
        let free = solution.paths.iter().map(|path| drawn_path(path, 3e-6, impact.free_rear));
        let free = free.filter(|path| path.name == "free surface").count();
        assert_eq!(free, 1, "the flyer's rear alone");
    }
}
