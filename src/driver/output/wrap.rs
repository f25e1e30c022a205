//! Text of the terminal: lines of at most [`WIDTH`] characters, broken between words.

use textwrap::Options;

/// Largest number of characters of a line.
pub const WIDTH: usize = 100;

/// A text with the lines broken between words; lines after the first start with `indent` spaces. A
/// longer word, such as a path, has a line of its own.
pub fn wrapped(text: &str, indent: usize) -> String {
    let spaces = " ".repeat(indent);
    let options = Options::new(WIDTH)
        .subsequent_indent(&spaces)
        .break_words(false)
        .word_splitter(textwrap::WordSplitter::NoHyphenation);
    textwrap::fill(text, options)
}

/// The lines of a warning.
pub fn warning(text: &str) -> String {
    const START: &str = "warning: ";
    wrapped(&format!("{START}{text}"), START.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_between_words_and_keep_all_of_them() {
        let text = "no steps to a word-with-hyphens, 12.5 GPa and ".repeat(9);
        let lines = warning(text.trim());
        assert!(lines.lines().count() > 4);
        assert!(lines.lines().all(|line| line.chars().count() <= WIDTH), "{lines}");
        assert!(lines.lines().skip(1).all(|line| line.starts_with("         ")), "{lines}");
        let words: Vec<&str> = lines.split_whitespace().skip(1).collect();
        assert_eq!(words, text.split_whitespace().collect::<Vec<_>>());
        assert_eq!(warning("short"), "warning: short");
        let path = "/a".repeat(80);
        assert_eq!(warning(&format!("in {path}")), format!("warning: in\n         {path}"));
    }
}
