//! A timeline of the ranks and patches in Chrome's trace format, which Perfetto opens.
//!
//! The format: Google, "Trace Event Format"; complete events ("X") with times in microseconds. A
//! process is a rank. Its thread 0 shows the work of the rank between phases; thread k + 1 shows
//! patch k of the whole domain.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::OutputError;

/// Start of the text of a timeline file.
pub const TRACE_START: &str = r#"{"displayTimeUnit":"#;

/// One interval on one line of the timeline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TraceEvent {
    /// Name of the activity.
    pub name: String,
    /// Rank.
    pub pid: usize,
    /// 0: the rank itself; k + 1: patch k.
    pub tid: usize,
    /// Number of the step.
    pub step: u64,
    /// Start time \[us\].
    pub ts: f64,
    /// Duration \[us\].
    pub dur: f64,
}

/// Writes the events of all ranks.
///
/// # Errors
///
/// If the file cannot be written.
pub fn write_trace(path: &Path, events: &[TraceEvent]) -> Result<(), OutputError> {
    let mut lines: Vec<(usize, usize)> = events.iter().map(|e| (e.pid, e.tid)).collect();
    lines.sort_unstable();
    lines.dedup();
    let mut all = Vec::new();
    for (pid, tid) in lines {
        let name = |what: &str, name: String| {
            serde_json::json!({
                "name": what, "ph": "M", "pid": pid, "tid": tid, "args": {"name": name},
            })
        };
        match tid {
            0 => {
                all.push(name("process_name", format!("rank {pid}")));
                all.push(name("thread_name", "exchanges".into()));
            }
            _ => all.push(name("thread_name", format!("patch {}", tid - 1))),
        }
    }
    all.extend(events.iter().map(|e| {
        serde_json::json!({
            "name": e.name, "ph": "X", "pid": e.pid, "tid": e.tid, "ts": e.ts, "dur": e.dur,
            "args": {"step": e.step},
        })
    }));
    let trace = serde_json::json!({"displayTimeUnit": "ns", "traceEvents": all});
    std::fs::write(path, trace.to_string()).map_err(OutputError::io("write the file", path))
}
