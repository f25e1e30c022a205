//! The command `report`, and the report of a run that has ended.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use flyer_mpm::accuracy::reference::ReferenceSolution;
use flyer_mpm::driver::output::histories::HISTORIES_FILE;
use flyer_mpm::driver::output::origin::check_target;
use flyer_mpm::driver::output::summary::Summary;
use flyer_mpm::input;
use flyer_mpm::plot::Color;
use flyer_mpm::scene::CheckedScene;
use report::page::{Columns, FIRST_LINE};
use report::payload::Payload;
use report::{Body, Curve, FrameFile, Page};

use crate::{FAILED, Outcome, bad};

/// Name of the page in the folder of results.
const REPORT_FILE: &str = "report.html";

/// Writes the page about the result in `folder`, to `output` or into the folder; returns its path.
pub fn report(folder: &Path, output: Option<&Path>) -> Outcome<PathBuf> {
    let summary = Summary::read(folder).map_err(bad)?;
    let target = output.map_or_else(|| folder.join(REPORT_FILE), Path::to_path_buf);
    if output.is_some() {
        check_target(&target, "a report", |text| text.starts_with(FIRST_LINE)).map_err(bad)?;
    }
    let page = page(folder, &summary)?;
    std::fs::write(&target, page.html())
        .map_err(|e| (FAILED, format!("{}: cannot write the file: {e}", target.display())))?;
    Ok(target)
}

/// The data of the page.
fn page(folder: &Path, summary: &Summary) -> Outcome<Page> {
    let scene_text = summary.scene.to_string();
    let scene =
        input::parse(scene_text.as_bytes(), "the scene of summary.json", &[]).map_err(bad)?;
    let names: Vec<&str> = scene.scene.bodies.iter().map(|body| body.material.as_str()).collect();
    let colors = Color::of_materials(&names);
    let bodies = scene.scene.bodies.iter().zip(colors).map(|(body, Color(r, g, b))| Body {
        name: body.name.clone(),
        material: body.material.clone(),
        color: format!("#{r:02x}{g:02x}{b:02x}"),
    });
    let frames = match FrameFile::open(folder, scene.dimension).map_err(bad)? {
        Some(file) => Payload::new(&file, &scene.cell_size[..scene.dimension]).map_err(bad)?,
        None => Payload::default(),
    };
    let mut page = Page {
        summary: serde_json::to_value(summary).map_err(bad)?,
        bodies: bodies.collect(),
        frames,
        exact: exact_curves(&scene),
        histories: histories(&folder.join(HISTORIES_FILE))?,
        pictures: Vec::new(),
    };
    page.add_pictures(folder).map_err(bad)?;
    Ok(page)
}

/// The exact profiles of a scene on a line; none if there is no exact solution.
fn exact_curves(scene: &CheckedScene) -> Vec<Curve> {
    let Ok(Some(reference)) = ReferenceSolution::new(scene) else { return Vec::new() };
    let profile = |k: usize| match &reference {
        ReferenceSolution::Impact(all) => {
            let snapshot = &all.solution.snapshots[k];
            snapshot.whole.clone().or_else(|| snapshot.target.clone())
        }
        other => other.profile(scene, k),
    };
    let curve = |(k, time): (usize, &f64)| {
        let points = profile(k)?.points;
        let of =
            |value: fn(&flyer_mpm::exact::ProfilePoint) -> f64| points.iter().map(value).collect();
        let values: BTreeMap<String, Vec<f64>> = [
            ("pressure", of(|p| p.p)),
            ("velocity", of(|p| p.u)),
            ("density", of(|p| p.rho)),
            ("specific_internal_energy", of(|p| p.e)),
        ]
        .map(|(name, values)| (name.to_owned(), values))
        .into();
        Some(Curve { time: *time, x: of(|p| p.x), values })
    };
    scene.profile_times.iter().enumerate().filter_map(curve).collect()
}

/// The columns of the histories; empty if there are none.
fn histories(path: &Path) -> Outcome<Columns> {
    if !path.exists() {
        return Ok(Columns::new());
    }
    let mut reader = csv::Reader::from_path(path).map_err(bad)?;
    let names: Vec<String> = reader.headers().map_err(bad)?.iter().map(str::to_owned).collect();
    let mut columns = vec![Vec::new(); names.len()];
    for record in reader.records() {
        for (column, text) in columns.iter_mut().zip(&record.map_err(bad)?) {
            column.push(text.parse().ok());
        }
    }
    Ok(names.into_iter().zip(columns).collect())
}
