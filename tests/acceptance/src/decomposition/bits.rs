//! The same bits on any layout, by mpirun: digests, files and printed lines.

use std::fs;

use serde_json::Value;

use super::layouts::Layout;
use crate::runs::{Job, Outcome};
use crate::section::Extent;
use crate::table::Table;

/// Scenes, with the keys set: the flyer for a shorter time, and bodies that cross many patches.
fn scenes() -> [(&'static str, Job); 2] {
    let flyer = Job::new("flyer").set("time.end=3e-7").set("output.profiles.times=[1e-7,3e-7]");
    [("flyer.json", flyer), ("crossing.json", Job::new("crossing"))]
}

/// Each scene on layouts in which every pair of choices occurs, or on all layouts.
pub fn check(table: &mut Table) {
    let full = table.extent == Extent::Full;
    for (scene, job) in &scenes() {
        let layouts = if full { Layout::product() } else { Layout::covering() };
        let name = format!("same bits: {scene}");
        let Some(whole) = table.take(&name, left_by(job, &Layout::WHOLE)) else { continue };
        let same = layouts.iter().filter(|layout| {
            let figure = format!("{name}, {layout}");
            match table.take(&figure, left_by(job, layout)) {
                Some(left) => left.differs(&whole).is_none_or(|what| {
                    table.holds(&figure, &format!("other {what}"), "the same", false);
                    false
                }),
                None => false,
            }
        });
        let (same, all) = (same.count(), layouts.len());
        table.holds(&name, &format!("{same} layouts"), &format!("all {all}"), same == all);
    }
}

/// `job` on a layout.
pub fn on(job: &Job, layout: &Layout) -> Job {
    let keys = layout.keys();
    let sets = ["decomposition.balance", "decomposition.skip_quiescent", "decomposition.overlap"];
    let mut job = job.clone().ranks(layout.ranks).threads(layout.threads);
    for path in sets.iter().chain(&["decomposition.filter_halo", "domain.patches"]) {
        let value = path.split('.').fold(&keys, |value, key| &value[key]);
        if *value != Value::Null {
            job = job.set(format!("{path}={value}"));
        }
    }
    job
}

/// What no layout may change.
struct Left {
    digests: Vec<String>,
    /// Profiles and histories as they stand in their files.
    files: Vec<(String, Vec<u8>)>,
    /// Printed lines without those about the layout, and without times.
    lines: Vec<String>,
}

fn left_by(job: &Job, layout: &Layout) -> Result<Left, String> {
    let Outcome { summary, folder, said, .. } = on(job, layout).run()?;
    let run_on = (summary.ranks, summary.threads, summary.patches[0]);
    if run_on != (layout.ranks, layout.threads, layout.patches) {
        return Err(format!("ran on {run_on:?} (ranks, threads, patches)"));
    }
    let names = summary.profiles.iter().map(|p| p.file.clone()).chain(["histories.csv".into()]);
    let files = names.map(|name| match fs::read(folder.join(&name)) {
        Ok(bytes) => Ok((name, bytes)),
        Err(error) => Err(format!("{name}: {error}")),
    });
    let of_layout = ["run", "seconds", "sharing", "results", "ranks", "rank"];
    let independent = |line: &&str| {
        line.split_whitespace().next().is_some_and(|first| !of_layout.contains(&first))
    };
    // an effect's share of the step, last in its line, is measured
    let unmeasured = |line: &str| match line.strip_suffix(" %").and_then(|l| l.rsplit_once(' ')) {
        Some((rest, _)) => rest.trim_end().to_owned(),
        None => line.to_owned(),
    };
    Ok(Left {
        digests: summary.profiles.iter().map(|p| p.state_sha256.clone()).collect(),
        files: files.collect::<Result<_, _>>()?,
        lines: said.lines().filter(independent).map(unmeasured).collect(),
    })
}

impl Left {
    /// What first differs; a run that prints nothing differs from all.
    fn differs(&self, other: &Left) -> Option<String> {
        if self.digests != other.digests {
            return Some("digests".into());
        }
        let files = self.files.iter().zip(&other.files).find(|(a, b)| a != b);
        if let Some(((name, _), _)) = files {
            return Some(name.clone());
        }
        (self.lines != other.lines || self.lines.is_empty()).then(|| "printed lines".into())
    }
}
