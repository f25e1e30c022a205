//! Instructions per particle and step, counted by callgrind: the same number on a busy machine.

use crate::bounds::Bound;
use crate::bounds::resources::instructions as bounds;
use crate::counts;
use crate::runs::Job;
use crate::table::Table;

/// Each scene against its number.
pub fn check(table: &mut Table) {
    if let Err(reason) = counts::can_count() {
        return table.not_measured("instructions", reason);
    }
    let coarse = |scene, cell: f64| Job::new(scene).set(format!("domain.cell_size={cell:e}"));
    let windows = [
        ("flyer", Job::new("flyer"), [1.25e-8, 5e-8], bounds::FLYER),
        ("flyer_uintah", Job::new("flyer_uintah"), [1.25e-8, 5e-8], bounds::FLYER_UINTAH),
        ("flyer_2d", coarse("flyer_2d", 4e-5), [5e-9, 1.5e-8], bounds::FLYER_2D),
        ("taylor_bar", coarse("taylor_bar", 4e-4), [1e-6, 3e-6], bounds::TAYLOR_BAR),
    ];
    for (scene, job, ends, before) in windows {
        let figure = format!("{scene}.json: instructions per particle and step");
        let job = job.set("domain.patches=null").set("reference=null");
        let Some(count) = table.take(&figure, counts::instructions(&job, ends)) else { continue };
        let most = before.number() * (1.0 + bounds::EXCESS.number());
        table.check(&figure, Some(count), Bound { at_most: Some(most), ..before });
    }
}
