//! The same bits on any layout, rank and thread count.

use crate::runs::Job;
use crate::section::Extent;
use crate::table::Table;

const SHAPES: [&str; 6] =
    ["linear", "gimp", "cpdi", "bspline_quadratic", "bspline_cubic", "cpdi_bspline_quadratic"];
const TRANSFERS: [&str; 6] =
    ["flip", "pic", "apic", r#"{"flip_pic":0.9}"#, r#"{"xpic":3}"#, r#"{"fmpm":4}"#];

/// Every shape function with every transfer, the rest as in `flyer_uintah.json`, and
/// `flyer.json` as shipped; the quick part takes each shape and each transfer but not every pair,
/// and fewer layouts.
pub fn check(table: &mut Table) {
    let quick = table.extent == Extent::Quick;
    // A small target, so that the waves cross patches even where there are few.
    let short = |job: Job| {
        job.set("domain.lower=[-7e-4]")
            .set("domain.upper=[13e-4]")
            .set("bodies.target.box.upper=[8e-4]")
            .set("time.end=1e-7")
            .set("output.profiles.times=[1e-7]")
    };
    compare_layouts(table, "same bits: flyer.json", &short(Job::new("flyer")), quick);
    for (i, shape) in SHAPES.iter().enumerate() {
        for (j, transfer) in TRANSFERS.iter().enumerate() {
            if quick && i != j {
                continue;
            }
            let job = Job::new("flyer_uintah")
                .set(format!("method.shape={shape}"))
                .set(format!("method.transfer={transfer}"));
            let name = format!("same bits: {shape}, {transfer}");
            compare_layouts(table, &name, &short(job), quick);
        }
    }
}

fn compare_layouts(table: &mut Table, name: &str, job: &Job, quick: bool) {
    let ranks: &[usize] = if quick { &[1, 2, 3] } else { &[1, 2, 3, 4] };
    let mut digests: Vec<String> = Vec::new();
    let mut count = 0;
    for &ranks in ranks {
        for patches in [1, 5, 16] {
            for threads in [1, 2] {
                let job = job.clone().set(format!("domain.patches=[{patches}]"));
                let job = job.ranks(ranks).threads(threads);
                let layout = format!("{name}, {ranks} x {patches} x {threads}");
                let Some(run) = table.take(&layout, job.run()) else { return };
                count += 1;
                let digest = run.summary.profiles.last().map(|p| p.state_sha256.clone());
                let digest = digest.unwrap_or_default();
                if !digests.contains(&digest) {
                    digests.push(digest);
                }
            }
        }
    }
    let measured = format!("{} of {count}", digests.len());
    table.holds(name, &measured, "1 digest", digests.len() == 1);
}
