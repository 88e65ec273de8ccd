//! The encoding of a text, and the name of a file that is none.

use std::borrow::Cow;
use std::fmt;

/// How the letters of a text are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// UTF-8, with or without a byte order mark.
    Utf8,
    /// UTF-16 behind a byte order mark, the low byte first (a spreadsheet's "Unicode text").
    Utf16Le,
    /// UTF-16 behind a byte order mark, the high byte first.
    Utf16Be,
}

/// A file that is no text in a known encoding. The message goes on behind a noun: "the table is a gzip file; …".
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotText {
    /// Another kind of file: what it is, and what to do.
    Other(&'static str, &'static str),
    /// A byte that is not UTF-8.
    NotUtf8 {
        /// The line, from 1.
        line: usize,
    },
    /// Half of a letter of UTF-16.
    NotUtf16 {
        /// The line, from 1.
        line: usize,
    },
}

impl fmt::Display for NotText {
    fn fmt(&self, text: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Other(what, todo) => write!(text, "is {what}; {todo}"),
            Self::NotUtf8 { line } => {
                write!(text, "is not UTF-8 (saved as Windows-1252?), line {line}; save it as UTF-8")
            }
            Self::NotUtf16 { line } => {
                write!(text, "is damaged UTF-16, line {line}; save it as UTF-8")
            }
        }
    }
}

impl std::error::Error for NotText {}

const UNPACK: &str = "unpack it";
const AS_CSV: &str = "save it as CSV";
const AS_UTF8: &str = "save it as UTF-8";
const UTF16: &str = "UTF-16 without a byte order mark";
const UTF32: &str = "UTF-32";

/// How files of other kinds begin.
const OTHERS: [(&[u8], &str, &str); 11] = [
    (&[0x1f, 0x8b], "a gzip file", UNPACK),
    (b"BZh", "a bzip2 file", UNPACK),
    (&[0xfd, b'7', b'z', b'X', b'Z', 0], "an xz file", UNPACK),
    (&[0x28, 0xb5, 0x2f, 0xfd], "a Zstandard file", UNPACK),
    (&[0xd0, 0xcf, 0x11, 0xe0], "an Excel workbook", AS_CSV),
    (b"PAR1", "a Parquet file", "name it .parquet"),
    (b"%PDF", "a PDF file", AS_CSV),
    (b"\xff\xfe\0\0", UTF32, AS_UTF8),
    (b"\0\0\xfe\xff", UTF32, AS_UTF8),
    (b"7z\xbc\xaf", "a 7z file", UNPACK),
    (b"\x89PNG", "a picture", "give a text"),
];

/// Parts of the first entries of an Excel workbook, which is a zip file.
const WORKBOOK: [&[u8]; 3] = [b"[Content_Types].xml", b"_rels/", b"xl/"];

/// The encoding by the beginning of a file, 4 bytes or more where it has them.
///
/// # Errors
/// The beginning is that of another kind of file.
pub fn encoding(beginning: &[u8]) -> Result<Encoding, NotText> {
    if let Some((_, what, todo)) = OTHERS.iter().find(|(start, ..)| beginning.starts_with(start)) {
        return Err(NotText::Other(what, todo));
    }
    if beginning.starts_with(b"PK\x03\x04") {
        let start = &beginning[..beginning.len().min(256)];
        let has = |part: &[u8]| start.windows(part.len()).any(|window| window == part);
        return Err(if WORKBOOK.iter().any(|part| has(part)) {
            NotText::Other("an Excel workbook (zip)", AS_CSV)
        } else if has(b"opendocument") {
            NotText::Other("an OpenDocument file (zip)", AS_CSV)
        } else {
            NotText::Other("a zip file", UNPACK)
        });
    }
    match beginning {
        [0xff, 0xfe, ..] => Ok(Encoding::Utf16Le),
        [0xfe, 0xff, ..] => Ok(Encoding::Utf16Be),
        // Where the zeros stand among the first four bytes.
        [a, b, c, d, ..] => match [a, b, c, d].map(|byte| *byte == 0) {
            [true, true, true, false] | [false, true, true, true] => {
                Err(NotText::Other(UTF32, AS_UTF8))
            }
            [true, false, true, false] | [false, true, false, true] => {
                Err(NotText::Other(UTF16, AS_UTF8))
            }
            _ => Ok(Encoding::Utf8),
        },
        _ => Ok(Encoding::Utf8),
    }
}

/// The text of a file in UTF-8 or UTF-16, without its byte order mark.
///
/// # Errors
/// What the file is instead, and the line of the first unreadable letter.
pub fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, NotText> {
    let unit = match encoding(bytes)? {
        Encoding::Utf8 => {
            let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            return std::str::from_utf8(bytes).map(Cow::Borrowed).map_err(|error| {
                NotText::NotUtf8 { line: line_at(&bytes[..error.valid_up_to()]) }
            });
        }
        Encoding::Utf16Le => u16::from_le_bytes,
        Encoding::Utf16Be => u16::from_be_bytes,
    };
    let (pairs, rest) = bytes[2..].as_chunks();
    let read: Result<String, _> =
        char::decode_utf16(pairs.iter().map(|pair| unit(*pair))).collect();
    let damaged = || {
        let units = pairs.iter().map(|pair| unit(*pair));
        let before = char::decode_utf16(units).map_while(Result::ok).collect::<String>();
        NotText::NotUtf16 { line: line_at(before.as_bytes()) }
    };
    read.ok().filter(|_| rest.is_empty()).map(Cow::Owned).ok_or_else(damaged)
}

/// The number of the line behind a text. A carriage return, a line feed, or both end a line.
#[must_use]
pub fn line_at(before: &[u8]) -> usize {
    let is_end =
        |k: &usize| before[*k] == b'\n' || before[*k] == b'\r' && before.get(k + 1) != Some(&b'\n');
    1 + (0..before.len()).filter(is_end).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
        "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(bytes).collect()
    }

    #[test]
    fn texts_of_all_encodings_are_the_same() {
        let text = "Größe;1,5\r\n𝄞;2";
        for bytes in [
            text.as_bytes().to_vec(),
            [b"\xef\xbb\xbf", text.as_bytes()].concat(),
            utf16(text, u16::to_le_bytes),
            utf16(text, u16::to_be_bytes),
        ] {
            assert_eq!(decode(&bytes).as_deref(), Ok(text));
        }
        assert_eq!(decode(b"").as_deref(), Ok(""));
        assert_eq!(decode(b"\xff\xfe").as_deref(), Ok(""));
    }

    #[test]
    fn what_is_no_text_is_named() {
        let unmarked = |text: &str| utf16(text, u16::to_le_bytes)[2..].to_vec();
        let utf32: Vec<u8> = "ab".chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        let half = utf16("a\nb", u16::to_le_bytes);
        for (bytes, expected) in [
            (b"\x1f\x8b\x08\0".to_vec(), "is a gzip file; unpack it"),
            (
                b"PK\x03\x04\x14\0\0\0[Content_Types].xml".to_vec(),
                "is an Excel workbook (zip); save it as CSV",
            ),
            (b"PK\x03\x04\x14\0\0\0a.csv".to_vec(), "is a zip file; unpack it"),
            (b"\xd0\xcf\x11\xe0\xa1\xb1".to_vec(), "is an Excel workbook; save it as CSV"),
            (unmarked("id"), "is UTF-16 without a byte order mark; save it as UTF-8"),
            (b"\0i\0d".to_vec(), "is UTF-16 without a byte order mark; save it as UTF-8"),
            (utf32.clone(), "is UTF-32; save it as UTF-8"),
            ([b"\xff\xfe\0\0".to_vec(), utf32].concat(), "is UTF-32; save it as UTF-8"),
            (
                b"id\r\nb\rM\xfcller".to_vec(),
                "is not UTF-8 (saved as Windows-1252?), line 3; save it as UTF-8",
            ),
            (half[..half.len() - 1].to_vec(), "is damaged UTF-16, line 2; save it as UTF-8"),
            (b"\xff\xfea\0\n\0\x34\xd8".to_vec(), "is damaged UTF-16, line 2; save it as UTF-8"),
        ] {
            assert_eq!(decode(&bytes).unwrap_err().to_string(), expected);
        }
    }
}
