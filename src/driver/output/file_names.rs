//! Names of files in a folder of results.

/// Name of the file with the summary of a run.
pub const SUMMARY_FILE: &str = "summary.json";
