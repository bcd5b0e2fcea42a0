//! CSV as people write it, made such that the reader of CSV takes it.

/// Gives the text without spaces and tabs in front of quoted fields and on lines of nothing else.
///
/// The reader takes a quote behind a space for a part of the field, and a line of spaces for a
/// field. Lines keep their numbers. Comments and what stands between quotes stay as they are.
pub fn tidied(bytes: &[u8]) -> Vec<u8> {
    let mut tidied = Vec::with_capacity(bytes.len());
    let mut rest = bytes;
    while !rest.is_empty() {
        let blank = blanks(rest);
        if is_line_end(rest.get(blank)) {
            rest = &rest[blank..];
        }
        let line = if rest.starts_with(b"#") { line_bytes(rest) } else { record(rest, &mut tidied) };
        if rest.starts_with(b"#") {
            tidied.extend_from_slice(&rest[..line]);
        }
        let ends = rest[line..].iter().take_while(|byte| is_line_end(Some(byte))).count();
        tidied.extend_from_slice(&rest[line..line + ends]);
        rest = &rest[line + ends..];
    }
    tidied
}

/// Writes a record without the spaces in front of its quotes, up to the end of its line; returns
/// the number of its bytes.
fn record(bytes: &[u8], tidied: &mut Vec<u8>) -> usize {
    let mut at = 0;
    loop {
        let blank = blanks(&bytes[at..]);
        let is_quoted = bytes.get(at + blank) == Some(&b'"');
        let begin = if is_quoted { at + blank } else { at };
        // A quote within quotes is written twice, and so ends one quoted part and begins another.
        let mut is_within = false;
        let is_over = |byte: &u8| {
            is_within ^= is_quoted && *byte == b'"';
            !is_within && (*byte == b',' || is_line_end(Some(byte)))
        };
        let end = bytes[begin..].iter().position(is_over).map_or(bytes.len(), |length| begin + length);
        tidied.extend_from_slice(&bytes[begin..end]);
        if bytes.get(end) != Some(&b',') {
            return end;
        }
        tidied.push(b',');
        at = end + 1;
    }
}

/// Number of spaces and tabs at the beginning.
fn blanks(bytes: &[u8]) -> usize {
    bytes.iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count()
}

/// Number of bytes before the end of the line.
fn line_bytes(bytes: &[u8]) -> usize {
    bytes.iter().position(|byte| is_line_end(Some(byte))).unwrap_or(bytes.len())
}

/// True for the end of the text, too.
fn is_line_end(byte: Option<&u8>) -> bool {
    matches!(byte, None | Some(b'\n' | b'\r'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8]) -> String {
        String::from_utf8(tidied(bytes)).expect("text stays text")
    }

    #[test]
    fn spaces_in_front_of_quotes_and_on_empty_lines_are_left_out() {
        assert_eq!(text(b"a, \"b c\" ,\t\"d, \"\"e\"\"\"\n"), "a,\"b c\" ,\"d, \"\"e\"\"\"\n");
        assert_eq!(text(b"  \"a\",b\r\n \t \r\n1,2\n   "), "\"a\",b\r\n\r\n1,2\n");
    }

    #[test]
    fn text_without_them_and_comments_and_quoted_lines_stay_as_they_are() {
        for same in ["a,b\n1, 2 \n", "# a, \"b\n1,2", "\"a\n  \n, \"\"b\",c\n", "a\"b, c\n", "", "\n\n", ",,\n"] {
            assert_eq!(text(same.as_bytes()), same);
        }
    }
}
