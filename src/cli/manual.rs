//! The commands `completions` and `man`: shell completions and manual pages, from the definition of
//! the command line.

use std::fs;
use std::path::Path;

use clap::CommandFactory;
use clap_complete::Shell;
use clap_mangen::Man;

use crate::cli::Cli;
use crate::{FAILED, Outcome, bad};

/// Name of the program in completions and pages.
const PROGRAM: &str = "flyer-mpm";

/// The script that completes the commands and options in a shell.
pub fn completions(shell: Shell) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), PROGRAM, &mut script);
    String::from_utf8(script).expect("a script is text")
}

/// Writes the pages of the program and of all commands into `folder`, and returns how to read them.
/// Without a folder, returns the page of the program in roff.
///
/// # Errors
///
/// If the folder cannot be created or a page cannot be written.
pub fn man(folder: Option<&Path>) -> Outcome<String> {
    let failed = |e: std::io::Error| (FAILED, e.to_string());
    let Some(folder) = folder else {
        let mut page = Vec::new();
        Man::new(Cli::command()).render(&mut page).map_err(failed)?;
        return String::from_utf8(page).map_err(|e| (FAILED, e.to_string()));
    };
    let refused = |e: std::io::Error| bad(format!("{}: cannot write: {e}", folder.display()));
    fs::create_dir_all(folder).map_err(refused)?;
    clap_mangen::generate_to(Cli::command(), folder).map_err(refused)?;
    let page = folder.join(format!("{PROGRAM}.1"));
    Ok(format!("pages of all commands are in {}; man {}\n", folder.display(), page.display()))
}
