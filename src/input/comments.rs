//! Comments and trailing commas in the text of a scene.

/// Text of a scene with spaces in place of its comments (`//` to the end of the line, `/* */`) and of
/// commas before a closing bracket, so that lines and columns of faults stay.
pub(super) fn without_comments(text: &str) -> String {
    let mut out = text.as_bytes().to_vec();
    let mut blank = |from: usize, to: usize| {
        out[from..to].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
    };
    let bytes = text.as_bytes();
    // last significant byte, and the place of a comma that follows a value
    let (mut last, mut comma) = (b'{', None);
    let mut at = 0;
    while at < bytes.len() {
        let end = match (bytes[at], bytes.get(at + 1)) {
            (b'"', _) => end_of_string(bytes, at),
            (b'/', Some(b'/')) => {
                let length = bytes[at..].iter().position(|&byte| byte == b'\n');
                let end = length.map_or(bytes.len(), |length| at + length);
                blank(at, end);
                at = end;
                continue;
            }
            (b'/', Some(b'*')) => {
                let Some(length) = text[at + 2..].find("*/") else { break };
                blank(at, at + length + 4);
                at += length + 4;
                continue;
            }
            (byte, _) if byte.is_ascii_whitespace() => {
                at += 1;
                continue;
            }
            _ => at + 1,
        };
        if matches!(bytes[at], b'}' | b']') {
            comma.into_iter().for_each(|comma| blank(comma, comma + 1));
        }
        comma = (bytes[at] == b',' && !b"{[,:".contains(&last)).then_some(at);
        last = bytes[at];
        at = end;
    }
    String::from_utf8(out).expect("whole characters are replaced")
}

/// End of the string that starts at index `from`.
fn end_of_string(bytes: &[u8], from: usize) -> usize {
    let mut at = from + 1;
    while at < bytes.len() && bytes[at] != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    (at + 1).min(bytes.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_trailing_commas_become_spaces() {
        for (text, expected) in [
            ("{\"a\": 1, // µm, \"x\"\n}", "{\"a\": 1              \n}"),
            ("[1, /* two\n three, */ 4,]", "[1,       \n           4 ]"),
            ("{\"a\": [1, 2,], // x\n \"b\": 3,}", "{\"a\": [1, 2 ],     \n \"b\": 3 }"),
            ("[1,/**/\n]", "[1     \n]"),
        ] {
            let blanked = without_comments(text);
            let lines = |text: &str| text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n");
            assert_eq!(lines(&blanked), lines(expected));
            assert_eq!(blanked.len(), text.len());
        }
    }

    /// Text without comments stays as it is, and faults are left to the JSON parser.
    #[test]
    fn strings_and_faults_stay() {
        for text in [
            r#"{"a": "b // c", "d": "/* \" */", "e": "\\"}"#,
            "[,]",
            "{,}",
            "[1,,]",
            "/* open",
            "\"open \\",
            "{\"a\":,}",
        ] {
            assert_eq!(without_comments(text), text);
        }
    }
}
