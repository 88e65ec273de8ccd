//! Text in UTF-16 as UTF-8, in pieces.

use std::io::{self, Read};

/// A byte that is no part of UTF-8, in place of half a letter.
const UNREADABLE: u8 = 0xff;

/// A reader of UTF-16 without its byte order mark, as UTF-8.
pub(super) struct Utf16<R> {
    input: R,
    unit: fn([u8; 2]) -> u16,
    /// The first byte of a pair.
    odd: Option<u8>,
    /// The first half of a letter.
    half: Option<u16>,
    /// Bytes that are ready, from the index on.
    ready: (Vec<u8>, usize),
}

impl<R: Read> Utf16<R> {
    pub(super) fn new(input: R, unit: fn([u8; 2]) -> u16) -> Self {
        Self { input, unit, odd: None, half: None, ready: (Vec::new(), 0) }
    }

    fn fill(&mut self) -> io::Result<()> {
        let (ready, at) = &mut self.ready;
        ready.clear();
        *at = 0;
        let mut piece = [0; 4096];
        let count = self.input.read(&mut piece)?;
        if count == 0 && (self.odd.take().is_some() | self.half.take().is_some()) {
            ready.push(UNREADABLE);
        }
        for byte in &piece[..count] {
            let Some(first) = self.odd.take() else {
                self.odd = Some(*byte);
                continue;
            };
            let unit = (self.unit)([first, *byte]);
            let is_half = (0xd800..0xdc00).contains(&unit);
            if is_half && self.half.is_none() {
                self.half = Some(unit);
                continue;
            }
            let next = is_half.then_some(unit);
            let units = self.half.take().into_iter().chain((!is_half).then_some(unit));
            self.half = next;
            for letter in char::decode_utf16(units) {
                match letter {
                    Ok(letter) => {
                        ready.extend_from_slice(letter.encode_utf8(&mut [0; 4]).as_bytes());
                    }
                    Err(_) => ready.push(UNREADABLE),
                }
            }
        }
        Ok(())
    }
}

impl<R: Read> Read for Utf16<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        while self.ready.1 == self.ready.0.len() {
            let was_open = self.odd.is_some() || self.half.is_some();
            self.fill()?;
            let is_open = self.odd.is_some() || self.half.is_some();
            if self.ready.0.is_empty() && !was_open && !is_open {
                return Ok(0);
            }
        }
        let (ready, at) = &mut self.ready;
        let count = to.len().min(ready.len() - *at);
        to[..count].copy_from_slice(&ready[*at..*at + count]);
        *at += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives one byte at a time.
    struct Slow<'a>(&'a [u8]);

    impl Read for Slow<'_> {
        fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
            let count = to.len().min(self.0.len()).min(1);
            to[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    fn read(units: &[u16], end: &[u8]) -> Vec<u8> {
        let read = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
            let (mut all, mut slow) = (Vec::new(), Vec::new());
            Utf16::new(bytes, unit).read_to_end(&mut all).unwrap();
            Utf16::new(Slow(bytes), unit).read_to_end(&mut slow).unwrap();
            assert_eq!(all, slow);
            all
        };
        let bytes = |of: fn(u16) -> [u8; 2]| {
            units.iter().flat_map(|unit| of(*unit)).chain(end.iter().copied()).collect::<Vec<_>>()
        };
        let found = read(&bytes(u16::to_le_bytes), u16::from_le_bytes);
        assert_eq!(read(&bytes(u16::to_be_bytes), u16::from_be_bytes), found);
        found
    }

    #[test]
    fn letters_are_those_of_the_text_and_halves_are_unreadable() {
        let text = "Größe;𝄞\r\n".repeat(2000);
        assert_eq!(read(&text.encode_utf16().collect::<Vec<_>>(), &[]), text.as_bytes());
        for (units, end, expected) in [
            (&[][..], &[][..], &b""[..]),
            (&[0x61, 0xd834, 0x62], &[], b"a\xffb"),
            (&[0xd834, 0xd834, 0xdd1e], &[], b"\xff\xf0\x9d\x84\x9e"),
            (&[0xdd1e, 0x61], &[], b"\xffa"),
            (&[0x61, 0xd834], &[], b"a\xff"),
            (&[0x61], &[0x62], b"a\xff"),
        ] {
            assert_eq!(read(units, end), expected, "{units:x?}");
        }
    }
}
