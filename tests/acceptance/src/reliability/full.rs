//! A disk that is full: what was good stays good.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::runs::{end, folder, good, left, scene, with};
use crate::table::Table;

/// A small disk in memory, gone with this value.
struct Disk(PathBuf);

impl Disk {
    fn mount(place: PathBuf, size: &str) -> Option<Disk> {
        fs::create_dir_all(&place).ok()?;
        let option = format!("size={size}");
        let mount = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &option, "tmpfs"])
            .arg(&place)
            .output();
        mount.is_ok_and(|out| out.status.success()).then_some(Disk(place))
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

/// Fills what is left of the disk but for `rest` bytes.
fn fill(disk: &Path, rest: u64) {
    #[allow(clippy::unnecessary_cast, reason = "the types differ between systems")]
    let bytes =
        |s: nix::sys::statvfs::Statvfs| s.blocks_available() as u64 * s.fragment_size() as u64;
    let room = nix::sys::statvfs::statvfs(disk);
    let left = room.map_or(0, bytes);
    let _ = fs::write(disk.join("filler"), vec![1u8; left.saturating_sub(rest) as usize]);
}

/// A run whose disk fills up as it writes, on one rank and on two.
pub fn check(table: &mut Table) {
    let home = folder("full");
    let sets = ["time.end=3e-7", "output.profiles.times=[1e-7,3e-7]"];
    let args = scene("flyer", &sets);
    let whole = home.join("whole").display().to_string();
    let whole =
        good(1, &with(&args, &["--output", &whole])).and_then(|()| left(&home.join("whole")));
    let Some(whole) = table.take("full disk: a whole run", whole) else { return };
    let Some(disk) = Disk::mount(home.join("disk"), "16m") else {
        table.not_measured("full disk", "no right to mount");
        return;
    };
    let output = disk.0.join("run");
    let at = output.display().to_string();
    // an earlier result that must survive
    let first = good(1, &with(&args, &["--output", &at])).and_then(|()| left(&output));
    if table.take("full disk: an earlier result", first).is_none() {
        return;
    }
    let every = ["--output", &at, "--set", "output.checkpoint={\"every_steps\":40}"];
    // room for a checkpoint or two and no more; for none; for nothing at all
    for (ranks, rest) in [(1, 600_000), (2, 600_000), (2, 300_000), (1, 100_000), (2, 0)] {
        let name = format!("{ranks} ranks, {} kB left", rest / 1000);
        let _ = fs::remove_dir_all(disk.0.join("run.checkpoints"));
        let stop = with(&every.map(String::from), &["--set", "time.wall_limit=1e-9"]);
        let (code, said) =
            end(ranks, &with(&args, &[]).into_iter().chain(stop).collect::<Vec<_>>());
        if code != Some(4) {
            table.holds(
                &format!("{name}: the first checkpoint"),
                &format!("{code:?}"),
                "code 4",
                false,
            );
            println!("  {said}");
            continue;
        }
        fill(&disk.0, rest);
        let on = ["--restart", &at, "--set", "time.wall_limit=null"].map(String::from);
        let (code, said) = end(ranks, &on);
        let line = said.lines().find(|l| l.starts_with("error:")).unwrap_or("no message");
        let words = ["the last good checkpoint is", "No space left on device"];
        let is_reported = words.iter().any(|w| line.contains(w)) && !said.contains("panicked");
        let shown = format!("code {}", code.map_or("none".into(), |c| c.to_string()));
        let ok = matches!(code, Some(2 | 3)) && is_reported;
        table.holds(&format!("{name}: ends and says so"), &shown, "code 2 or 3", ok);
        if !is_reported {
            println!("  {line}");
        }
        let intact = left(&output).is_ok_and(|left| left.differs(&whole).is_none());
        let verdict = if intact { "intact" } else { "other" };
        table.holds("  the earlier result", verdict, "intact", intact);
        let elsewhere = home.join("again");
        let to = elsewhere.display().to_string();
        let on = with(&on, &["--output", &to, "--set", "output.checkpoint.keep=0"]);
        let again = good(1, &on).and_then(|()| left(&elsewhere));
        let differs = again.map(|left| left.differs(&whole));
        let same = matches!(differs, Ok(None));
        let verdict = if same { "same bits" } else { "other" };
        table.holds("  gone on with, to another disk", verdict, "same bits", same);
        let _ = fs::remove_file(disk.0.join("filler"));
    }
}
