//! JSON values one after the other, each over any number of lines.

use std::io::{self, BufRead};

/// The texts of values in a stream. A text ends with the bracket that closes the first one; other text, with its line.
pub struct Values<R> {
    input: R,
    most_bytes: usize,
    /// Number of line feeds before the next byte.
    feeds: usize,
    /// Was a value read? A byte order mark may stand before the first one.
    is_begun: bool,
}

impl<R: BufRead> Values<R> {
    /// Reads at most so many bytes of a value, and leaves the others out.
    pub fn new(input: R, most_bytes: usize) -> Self {
        Self { input, most_bytes, feeds: 0, is_begun: false }
    }

    /// The next text and the line on which it begins, from 1; `None` at the end.
    ///
    /// # Errors
    /// Of the reader.
    pub fn next_value(&mut self) -> io::Result<Option<(usize, Vec<u8>)>> {
        if self.peek()?.is_none() {
            return Ok(None);
        }
        self.is_begun = true;
        let line = self.feeds + 1;
        let (mut bytes, mut depth) = (Vec::new(), 0_usize);
        let (mut is_text, mut is_escaped) = (false, false);
        loop {
            let piece = self.input.fill_buf()?;
            if piece.is_empty() {
                return Ok(Some((line, bytes)));
            }
            let (mut used, mut is_end) = (0, false);
            for byte in piece {
                let is_first = bytes.is_empty();
                used += 1;
                self.feeds += usize::from(*byte == b'\n');
                if bytes.len() < self.most_bytes {
                    bytes.push(*byte);
                }
                match byte {
                    _ if std::mem::take(&mut is_escaped) => {}
                    b'\\' if is_text => is_escaped = true,
                    b'"' if depth > 0 => is_text = !is_text,
                    _ if is_text => {}
                    b'{' | b'[' if depth > 0 || is_first => depth += 1,
                    b'}' | b']' if depth > 0 => {
                        depth -= 1;
                        is_end = depth == 0;
                    }
                    b'\n' => is_end = depth == 0,
                    _ => {}
                }
                if is_end {
                    break;
                }
            }
            self.input.consume(used);
            if is_end {
                return Ok(Some((line, bytes)));
            }
        }
    }

    /// The next byte that is no white space, which stays.
    fn peek(&mut self) -> io::Result<Option<u8>> {
        loop {
            let piece = self.input.fill_buf()?;
            if piece.is_empty() {
                return Ok(None);
            }
            let is_mark = |byte: &u8| !self.is_begun && b"\xef\xbb\xbf".contains(byte);
            let is_blank = |byte: &&u8| byte.is_ascii_whitespace() || is_mark(byte);
            let blank = piece.iter().take_while(is_blank).count();
            self.feeds += piece[..blank].iter().filter(|byte| **byte == b'\n').count();
            let next = piece.get(blank).copied();
            self.input.consume(blank);
            if next.is_some() {
                return Ok(next);
            }
        }
    }
}

/// Does an object follow the first one?
///
/// # Errors
/// Of the reader; memory is always read.
pub fn has_several(beginning: &[u8]) -> io::Result<bool> {
    let mut values = Values::new(beginning, 0);
    Ok(values.peek()? == Some(b'{')
        && values.next_value()?.is_some()
        && values.peek()? == Some(b'{'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    fn values(text: &str) -> Vec<(usize, String)> {
        let read = |piece| {
            let reader = BufReader::with_capacity(piece, text.as_bytes());
            let mut values = Values::new(reader, 40);
            let mut found = Vec::new();
            while let Some((line, bytes)) = values.next_value().unwrap() {
                found.push((line, String::from_utf8(bytes).unwrap()));
            }
            found
        };
        assert_eq!(read(1), read(1000));
        read(7)
    }

    fn expected(texts: &[(usize, &str)]) -> Vec<(usize, String)> {
        texts.iter().map(|(line, text)| (*line, (*text).to_owned())).collect()
    }

    #[test]
    fn values_end_with_their_brackets() {
        let (a, b) = ("{\n \"a\": \"}\\\"{\", \"b\": [{}]\n}", "{\"c\": \"\\\\\"}");
        for (text, found) in [
            (format!("{a}\n\n{b}\n"), vec![(1, a), (5, b)]),
            (format!("\u{feff}{a}{b}"), vec![(1, a), (3, b)]),
            (format!("\n{b} \r{b}"), vec![(2, b), (2, b)]),
            (format!("{b}\nnull {{\n}}\n{b}"), vec![(1, b), (2, "null {\n"), (3, "}\n"), (4, b)]),
            ("{\"a\": [\n".to_owned(), vec![(1, "{\"a\": [\n")]),
            (" \n".to_owned(), vec![]),
        ] {
            assert_eq!(values(&text), expected(&found), "{text:?}");
        }
        let long = format!("{{{}}}{b}", " ".repeat(100));
        assert_eq!(values(&long), expected(&[(1, &long[..40]), (1, b)]));
    }
}
