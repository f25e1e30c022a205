//! Memory of running processes, from `/proc` of Linux.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::Duration;

/// From one look to the next.
const INTERVAL: Duration = Duration::from_millis(20);

/// Memory that was seen.
#[derive(Default)]
pub struct Resident {
    /// Of all processes together, look after look [bytes].
    pub together: Vec<u64>,
    /// The most that one process has taken until it was last looked at [bytes].
    pub fullest: u64,
}

/// Looks at a process and those that it has started.
pub struct Watcher {
    ends: Arc<AtomicBool>,
    looks: JoinHandle<Resident>,
}

impl Watcher {
    /// Starts to look.
    pub fn of(process: u32) -> Watcher {
        let ends = Arc::new(AtomicBool::new(false));
        let until = ends.clone();
        let looks = spawn(move || {
            let mut found = Resident::default();
            while !until.load(Ordering::Relaxed) {
                let family = family(process);
                let bytes = family.iter().map(|&p| memory(p, "VmRSS:")).sum();
                if bytes > 0 {
                    found.together.push(bytes);
                }
                let most = family.iter().map(|&p| memory(p, "VmHWM:")).max();
                found.fullest = found.fullest.max(most.unwrap_or(0));
                sleep(INTERVAL);
            }
            found
        });
        Watcher { ends, looks }
    }

    /// What was seen.
    pub fn end(self) -> Resident {
        self.ends.store(true, Ordering::Relaxed);
        self.looks.join().unwrap_or_default()
    }
}

/// The processes of the program among `process` and those that it has started.
fn family(process: u32) -> Vec<u32> {
    let Ok(entries) = fs::read_dir("/proc") else { return Vec::new() };
    let ids = entries.flatten().filter_map(|e| e.file_name().to_str()?.parse::<u32>().ok());
    ids.filter(|id| {
        let stat = fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
        let Some((before, after)) = stat.rsplit_once(") ") else { return false };
        let parent = after.split(' ').nth(1).and_then(|p| p.parse::<u32>().ok());
        before.contains("(flyer-mpm") && (*id == process || parent == Some(process))
    })
    .collect()
}

/// Memory of a process on a `line` of its status [bytes]; 0 once it has ended.
fn memory(process: u32, line: &str) -> u64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix(line));
    let kib = line.and_then(|l| l.trim().strip_suffix("kB")?.trim().parse::<u64>().ok());
    kib.unwrap_or(0) * 1024
}
