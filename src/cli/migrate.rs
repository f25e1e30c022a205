//! `flyer-mpm migrate`: rewrites a scene of a former format.

use std::path::Path;

use flyer_mpm::input;
use flyer_mpm::input::input_file;
use flyer_mpm::scene::FORMAT;

/// Rewrites `scene` in place, or into `output`; returns a report of the former names.
///
/// # Errors
/// If the file cannot be read or written, or is not a scene of this or a former format: the exit
/// code, and the reason.
pub fn migrate(scene: &Path, output: Option<&Path>) -> Result<String, (u8, String)> {
    let name = scene.display();
    let bad = |reason: String| (crate::BAD_INPUT, format!("{name}: {reason}"));
    let text = input_file::read_text(scene, input::LARGEST_FILE).map_err(|f| bad(f.to_string()))?;
    let (new, former) = input::migrate(&text).map_err(bad)?;
    let target = output.unwrap_or(scene);
    if new != text || output.is_some() {
        write(target, &new).map_err(|e| {
            (crate::BAD_INPUT, format!("{}: cannot write the file: {e}", target.display()))
        })?;
    }
    let rewritten = match former.as_slice() {
        [] => "no former names".to_string(),
        names => format!("former names rewritten: {}", names.join(", ")),
    };
    Ok(format!("{}: format {FORMAT}, {rewritten}\n", target.display()))
}

/// Writes a file beside the target and renames it, so that a crash leaves the target unchanged.
fn write(target: &Path, text: &str) -> std::io::Result<()> {
    let mut aside = target.as_os_str().to_owned();
    aside.push(".new");
    std::fs::write(&aside, text)?;
    std::fs::rename(&aside, target)
}
