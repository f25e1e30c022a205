//! What checkpoints cost: time and bytes.

use std::fs;

use flyer_mpm::driver::checkpoint::folder::list;
use flyer_mpm::driver::checkpoint::schedule::WALL_SECONDS;
use serde_json::Value;

use super::runs::{folder, good, scene, with};
use crate::bounds::{Unit, reliability as bounds};
use crate::table::Table;

/// Seconds that all ranks have spent on output, and the number of ranks.
fn output_seconds(folder: &std::path::Path) -> Option<(f64, f64)> {
    let text = fs::read_to_string(folder.join("summary.json")).ok()?;
    let summary: Value = serde_json::from_str(&text).ok()?;
    let seconds = |key: &str| summary["phase_seconds"][key].as_f64();
    Some((seconds("output")? + seconds("wait")?, summary["particles"].as_f64()?))
}

/// Many checkpoints of a line and of a plane, one rank.
pub fn check(table: &mut Table) {
    let line = ["domain.cell_size=1.6e-7", "time.end=1e-9", "output.profiles.times=[1e-9]"];
    let plane = ["time.end=6e-9", "output.profiles.times=[6e-9]"];
    for (name, sets) in [("flyer", &line[..]), ("flyer_2d", &plane[..])] {
        let home = folder("cost");
        let args = scene(name, &[sets, &["output.histories=null"]].concat());
        let (plain, kept) = (home.join("plain"), home.join("kept"));
        let [to_plain, to_kept] = [&plain, &kept].map(|p| p.display().to_string());
        let every = "output.checkpoint={\"every_steps\":4,\"keep\":999}";
        let runs = good(1, &with(&args, &["--output", &to_plain]))
            .and_then(|()| good(1, &with(&args, &["--output", &to_kept, "--set", every])));
        if table.take(&format!("{name}: cost"), runs).is_none() {
            continue;
        }
        let files = list(&home.join("kept.checkpoints"));
        let found = output_seconds(&plain).zip(output_seconds(&kept));
        let Some(((before, particles), (after, _))) = found else { continue };
        let each = (after - before) / files.len() as f64;
        let title = format!("{name}, {particles} particles: a checkpoint");
        table.beside(&title, Some(each), "", Unit::Seconds);
        let share = each / WALL_SECONDS;
        table.check(
            "  of the run time, at the default interval",
            Some(share),
            bounds::cost::SHARE_OF_RUN_TIME,
        );
        let size = files.last().and_then(|f| fs::metadata(&f.1).ok()).map(|m| m.len() as f64);
        table.beside("  bytes per particle", size.map(|s| s / particles), "", Unit::One);
    }
}
