//! The command `plan`.

use std::path::{Path, PathBuf};

use flyer_mpm::accuracy::estimate::EstimateBasis;
use flyer_mpm::accuracy::plan::{self, Data, ErrorTarget, PlanError};
use flyer_mpm::driver::output::origin::{absolute, check_target};
use flyer_mpm::input::input_file;

use serde_json::Value;

use crate::cli::PlanArgs;
use crate::{BAD_INPUT, FAILED, Outcome, bad, read_scene};

/// Plans a scene and writes the scene to run; returns a text about the plan.
pub fn plan(args: &PlanArgs) -> Outcome<String> {
    let (_, checked) = read_scene(&args.scene, true)?;
    let stem = args.scene.scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let file: PathBuf = args
        .output
        .clone()
        .unwrap_or_else(|| Path::new("output/plans").join(format!("{stem}.plan.json")));
    // check the output path first, because pilot runs take time
    input_file::check_place(&file).map_err(|fault| bad(format!("{}: {fault}", file.display())))?;
    let scene = serde_json::to_value(&checked.scene).expect("a scene is plain data");
    let target = ErrorTarget {
        quantity: args.quantity,
        error: args.error,
        budget: args.budget,
        ranks: args.ranks,
        place: args.at,
    };
    let of = absolute(&args.scene.scene);
    check_target(&file, &format!("a plan of {}", checked.file), |text| {
        let there: Option<Value> = serde_json::from_str(text).ok();
        let there = there.and_then(|plan| plan.pointer("/output/plan/of").cloned());
        there.is_some_and(|there| Some(there) == of.clone().map(Value::String))
    })
    .map_err(bad)?;
    let mut plan =
        plan::plan(&scene, &checked.file, &target, &Data::shipped()).map_err(|error| {
            let code =
                if matches!(error, PlanError::Impossible { .. }) { FAILED } else { BAD_INPUT };
            (code, error.to_string())
        })?;
    plan.scene["output"]["plan"]["of"] = serde_json::json!(of);
    let text = serde_json::to_string_pretty(&plan.scene).expect("a scene is plain data") + "\n";
    let written = file.parent().map_or(Ok(()), std::fs::create_dir_all);
    written
        .and_then(|()| std::fs::write(&file, text))
        .map_err(|e| bad(format!("{}: cannot be written: {e}", file.display())))?;
    let percent = plan::choose::percent;
    let guess = match plan.basis {
        EstimateBasis::Calibrated => String::new(),
        EstimateBasis::Guess => {
            let outside = plan.outside.join("; ");
            format!("guess      the schemes were not measured on such inputs: {outside}\n")
        }
    };
    Ok(format!(
        "scheme     {}\ncells      {:.4e} m, {} particles a cell, Courant number {}\nerror      \
         {} at most in 19 of 20 runs, {} in half of them; wanted {}\n{guess}seconds    {:.3} of CPU, {:.3} of \
         wall in the time loop on {} ranks (pilots took {:.2} s)\nscene      {}\n",
        plan.scheme,
        plan.cell_size,
        plan.particles_per_cell,
        plan.courant,
        percent(plan.error),
        percent(plan.error_median),
        percent(args.error),
        plan.cpu_seconds,
        plan.wall_seconds,
        args.ranks,
        plan.pilot_seconds,
        file.display()
    ))
}
