//! Transfers and shape functions, each with what keeps the most of its energy.

use crate::runs::Job;

/// Shape functions, by their names in a scene.
pub const SHAPES: [&str; 6] =
    ["linear", "gimp", "cpdi", "bspline_quadratic", "bspline_cubic", "cpdi_bspline_quadratic"];

/// Transfers, by what stands in a scene.
pub const TRANSFERS: [&str; 7] = [
    "\"flip\"",
    "\"apic\"",
    "\"pic\"",
    "{\"xpic\": 3}",
    "{\"fmpm\": 2}",
    "{\"fmpm\": 4}",
    "{\"fmpm\": 8}",
];

/// `job` with mid-point steps of this shape function and transfer, energy as exact as it has it.
pub fn scheme(job: Job, shape: &str, transfer: &str) -> Job {
    let affine = transfer.contains("apic");
    let filters = !affine && !transfer.contains("flip");
    let deforms = shape.starts_with("cpdi");
    let job = job
        .set(format!("method.shape={shape}"))
        .set(format!("method.transfer={transfer}"))
        .set("method.stepping=midpoint")
        .set(format!("method.energy={}", if affine { "textbook" } else { "compatible" }))
        .set(format!("method.filter_heat={filters}"));
    let job = if transfer.contains("fmpm") { job } else { job.set("method.edge_mask=null") };
    if deforms { job } else { job.set("method.domain_limit=null") }
}

/// A scheme in words.
pub fn name(shape: &str, transfer: &str) -> String {
    let transfer: String = transfer.chars().filter(|c| !"{}\" ".contains(*c)).collect();
    format!("{shape}, {transfer}")
}
