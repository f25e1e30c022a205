//! Progress of a run on the terminal: a bar with the time left, or a line at intervals.
//!
//! mpirun forwards the output of its ranks through pipes, so that rank 0 has no terminal itself. Its
//! bar is shown if mpirun writes to a terminal in the foreground. Under other launchers, in batch
//! jobs, and where output is redirected, there are lines instead.

use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle, TermLike};

/// When a run shows its progress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProgressChoice {
    /// A bar on a terminal in the foreground, otherwise a line every ten seconds.
    #[default]
    Auto,
    /// A bar also if the output is not a terminal.
    Always,
    /// Neither bar nor lines.
    Never,
}

/// Form of the progress of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgressForm {
    /// A bar on the terminal of this process.
    Bar,
    /// A bar in the forwarded output: stderr is a pipe, and the width of the terminal is not known.
    ForwardedBar,
    /// A line every ten seconds.
    Lines,
    /// Nothing.
    Nothing,
}

/// Where the messages of a launcher go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LauncherTerminal {
    /// Whether its stderr is a terminal.
    pub is_terminal: bool,
    /// Whether it runs in the foreground of that terminal.
    pub is_foreground: bool,
}

/// The form of the progress, if stderr of this process is a terminal (`own`), and from the launcher
/// on this machine that started the process, if any.
pub fn progress_form(
    choice: ProgressChoice,
    own: bool,
    launcher: Option<LauncherTerminal>,
) -> ProgressForm {
    let shown = launcher.is_some_and(|l| l.is_terminal && l.is_foreground);
    match choice {
        ProgressChoice::Never => ProgressForm::Nothing,
        _ if own => ProgressForm::Bar,
        ProgressChoice::Always => ProgressForm::ForwardedBar,
        ProgressChoice::Auto if shown => ProgressForm::ForwardedBar,
        ProgressChoice::Auto => ProgressForm::Lines,
    }
}

/// Names of launchers that forward the output of their ranks to their own.
const LAUNCHERS: [&str; 5] = ["mpirun", "mpiexec", "orterun", "prterun", "mpiexec.hydra"];

/// Largest number of processes between a rank and its launcher, such as shells and debuggers.
const MOST_BETWEEN: usize = 8;

/// A process, as `/proc/PID/stat` describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
struct ProcessStat {
    name: String,
    parent: u32,
    group: i64,
    /// Process group in the foreground of its terminal; -1 without a terminal.
    foreground: i64,
}

impl ProcessStat {
    /// The process of a text of `/proc/PID/stat`. The name is in parentheses and may contain any
    /// character.
    fn parse(text: &str) -> Option<ProcessStat> {
        let (start, rest) = text.rsplit_once(')')?;
        let name = start.split_once('(')?.1.to_string();
        let fields: Vec<&str> = rest.split_whitespace().collect();
        // state, parent, group, session, terminal, foreground group
        Some(ProcessStat {
            name,
            parent: fields.get(1)?.parse().ok()?,
            group: fields.get(2)?.parse().ok()?,
            foreground: fields.get(5)?.parse().ok()?,
        })
    }

    fn read(process: u32) -> Option<ProcessStat> {
        ProcessStat::parse(&fs::read_to_string(format!("/proc/{process}/stat")).ok()?)
    }
}

/// The launcher on this machine that started this process; `None` if there is none.
fn launcher() -> Option<LauncherTerminal> {
    let mut process = std::os::unix::process::parent_id();
    for _ in 0..MOST_BETWEEN {
        let stat = ProcessStat::read(process)?;
        if LAUNCHERS.contains(&stat.name.as_str()) {
            let stderr = fs::read_link(format!("/proc/{process}/fd/2")).ok()?;
            let is_foreground = stat.group == stat.foreground;
            return Some(LauncherTerminal { is_terminal: is_terminal(&stderr), is_foreground });
        }
        process = stat.parent;
    }
    None
}

/// Whether the target of a link in `/proc/PID/fd` is a terminal, judged by its path.
fn is_terminal(target: &Path) -> bool {
    let name = target.to_string_lossy();
    let console = name.strip_prefix("/dev/tty").is_some_and(|n| !n.is_empty());
    name.starts_with("/dev/pts/") || name == "/dev/console" || console
}

/// A terminal that is reached through a pipe: control sequences are written to stderr.
#[derive(Debug)]
struct ForwardedTerminal;

/// Width that every terminal has [characters].
const FORWARDED_WIDTH: u16 = 79;

impl ForwardedTerminal {
    fn put(&self, text: &str) -> io::Result<()> {
        io::stderr().write_all(text.as_bytes())
    }

    /// Moves the cursor `count` places in the direction of a control sequence.
    fn move_cursor(&self, count: usize, direction: char) -> io::Result<()> {
        if count > 0 { self.put(&format!("\x1b[{count}{direction}")) } else { Ok(()) }
    }
}

impl TermLike for ForwardedTerminal {
    fn width(&self) -> u16 {
        FORWARDED_WIDTH
    }

    fn move_cursor_up(&self, n: usize) -> io::Result<()> {
        self.move_cursor(n, 'A')
    }

    fn move_cursor_down(&self, n: usize) -> io::Result<()> {
        self.move_cursor(n, 'B')
    }

    fn move_cursor_right(&self, n: usize) -> io::Result<()> {
        self.move_cursor(n, 'C')
    }

    fn move_cursor_left(&self, n: usize) -> io::Result<()> {
        self.move_cursor(n, 'D')
    }

    fn write_line(&self, text: &str) -> io::Result<()> {
        self.put(&format!("{text}\n"))
    }

    fn write_str(&self, text: &str) -> io::Result<()> {
        self.put(text)
    }

    fn clear_line(&self) -> io::Result<()> {
        self.put("\r\x1b[2K")
    }

    fn flush(&self) -> io::Result<()> {
        io::stderr().flush()
    }
}

/// Time between two lines.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// Time between two changes of a bar.
const BAR_INTERVAL: Duration = Duration::from_millis(100);

/// Progress of a run. One rank shows it.
pub struct Progress {
    form: ProgressForm,
    bar: Option<ProgressBar>,
    /// Start and end time [s].
    span: [f64; 2],
    last_shown: Instant,
    started: Instant,
}

impl Progress {
    /// Progress of a run over `span`, its start and end time [s].
    pub fn new(span: [f64; 2], choice: ProgressChoice) -> Self {
        let form = match choice {
            ProgressChoice::Never => ProgressForm::Nothing,
            _ => progress_form(choice, io::stderr().is_terminal(), launcher()),
        };
        let bar = match form {
            ProgressForm::Bar => Some(ProgressBar::new(1000)),
            ProgressForm::ForwardedBar => {
                let target = ProgressDrawTarget::term_like(Box::new(ForwardedTerminal));
                Some(ProgressBar::with_draw_target(Some(1000), target))
            }
            ProgressForm::Lines | ProgressForm::Nothing => None,
        };
        let style = ProgressStyle::with_template("{bar:24} {percent:>3} %  {msg}  left {eta}");
        if let (Some(bar), Ok(style)) = (&bar, style) {
            bar.set_style(style);
        }
        Progress { form, bar, span, last_shown: Instant::now(), started: Instant::now() }
    }

    /// Shows the `time` [s] and number of steps that the run has reached, if it is due.
    pub fn show(&mut self, time: f64, step: u64) {
        let every = if self.bar.is_some() { BAR_INTERVAL } else { LINE_INTERVAL };
        if self.form == ProgressForm::Nothing || self.last_shown.elapsed() < every {
            return;
        }
        self.last_shown = Instant::now();
        let share = (time - self.span[0]) / (self.span[1] - self.span[0]);
        match &self.bar {
            Some(bar) => {
                bar.set_position((1000.0 * share) as u64);
                bar.set_message(format!("{time:.4e} s, step {step}"));
            }
            None => {
                let left = self.started.elapsed().as_secs_f64() * (1.0 / share.max(1e-9) - 1.0);
                eprintln!(
                    "{:5.1} %  time {time:.4e} s, step {step}, {left:.0} s left",
                    100.0 * share
                );
            }
        }
    }
}

/// Removes the bar.
impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_is_shown_only_on_a_terminal_in_the_foreground() {
        use ProgressChoice::{Always, Auto, Never};
        use ProgressForm::{Bar, ForwardedBar, Lines, Nothing};
        let launcher =
            |is_terminal, is_foreground| Some(LauncherTerminal { is_terminal, is_foreground });
        for (choice, own, launcher, expected) in [
            (Auto, true, None, Bar),
            (Auto, false, None, Lines),
            (Auto, false, launcher(true, true), ForwardedBar),
            (Auto, false, launcher(true, false), Lines),
            (Auto, false, launcher(false, true), Lines),
            (Auto, false, launcher(false, false), Lines),
            (Always, true, None, Bar),
            (Always, false, None, ForwardedBar),
            (Always, false, launcher(false, false), ForwardedBar),
            (Never, true, None, Nothing),
            (Never, false, launcher(true, true), Nothing),
        ] {
            let form = progress_form(choice, own, launcher);
            assert_eq!(form, expected, "{choice:?} {own} {launcher:?}");
        }
    }

    #[test]
    fn a_process_is_read_whatever_its_name() {
        let stat = ProcessStat::parse("71 (a) (b) S 70 69 68 34816 67 4194304 1").unwrap();
        let name = "a) (b".to_string();
        assert_eq!(stat, ProcessStat { name, parent: 70, group: 69, foreground: 67 });
        assert_eq!(ProcessStat::parse("71 (a) S 70"), None);
        let own = ProcessStat::read(std::process::id()).unwrap();
        assert_eq!(own.parent, std::os::unix::process::parent_id());
    }

    #[test]
    fn terminals_are_known_by_their_paths() {
        for (path, expected) in [
            ("/dev/pts/3", true),
            ("/dev/tty1", true),
            ("/dev/console", true),
            ("/dev/null", false),
            ("/dev/tty", false),
            ("pipe:[4711]", false),
            ("/home/me/log.txt", false),
        ] {
            assert_eq!(is_terminal(Path::new(path)), expected, "{path}");
        }
    }
}
