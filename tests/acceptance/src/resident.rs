//! Memory of running processes, from `/proc` of Linux.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::Duration;

/// From one look to the next.
const INTERVAL: Duration = Duration::from_millis(20);

/// Looks at a process and those that it has started.
pub struct Watcher {
    ends: Arc<AtomicBool>,
    looks: JoinHandle<Vec<u64>>,
}

impl Watcher {
    /// Starts to look.
    pub fn of(process: u32) -> Watcher {
        let ends = Arc::new(AtomicBool::new(false));
        let until = ends.clone();
        let looks = spawn(move || {
            let mut found = Vec::new();
            while !until.load(Ordering::Relaxed) {
                let bytes = family(process).iter().map(|&p| resident(p)).sum();
                if bytes > 0 {
                    found.push(bytes);
                }
                sleep(INTERVAL);
            }
            found
        });
        Watcher { ends, looks }
    }

    /// What was seen [bytes].
    pub fn end(self) -> Vec<u64> {
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

/// Resident memory of a process [bytes]; 0 once it has ended.
fn resident(process: u32) -> u64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kib = line.and_then(|l| l.trim().strip_suffix("kB")?.trim().parse::<u64>().ok());
    kib.unwrap_or(0) * 1024
}
