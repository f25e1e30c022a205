//! A timeline of the ranks and patches in Chrome's trace format, which Perfetto opens.
//!
//! The format: Google, "Trace Event Format"; complete events ("X") with times in microseconds.
//! A process is a rank; its thread 0 is what the rank does between phases, thread k + 1 is its
//! patch k of the whole domain.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::OutputError;

/// What the file of a timeline begins with.
pub const TRACE_START: &str = r#"{"displayTimeUnit":"#;

/// One stretch of one line of the timeline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TraceEvent {
    /// What was done.
    pub name: String,
    /// Rank.
    pub pid: usize,
    /// 0: the rank itself; k + 1: patch k.
    pub tid: usize,
    /// Number of the step.
    pub step: u64,
    /// Start \[us\].
    pub ts: f64,
    /// Length \[us\].
    pub dur: f64,
}

/// Writes the events of all ranks.
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
