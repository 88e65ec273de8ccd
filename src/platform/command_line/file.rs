//! Files and standard input, opened for reading.

use super::InputError;
use super::output::{input_error, is_standard};
use super::standard;
use std::fs::{File, metadata};
use std::io::{self, Read};
use std::path::Path;

/// Reads a file, and at most one byte more than `max_bytes`, so that the parser rejects longer files.
pub(super) fn read(path: &Path, max_bytes: usize) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    let file = open(path).map_err(|error| cannot_be_read(path, &error))?;
    let read = file.take(max_bytes as u64 + 1).read_to_end(&mut bytes);
    read.map_err(|error| cannot_be_read(path, &error))?;
    Ok(bytes)
}

pub(super) fn cannot_be_read(path: &Path, error: &io::Error) -> InputError {
    input_error(path, format!("cannot be read: {error}"))
}

pub(super) type Reader = Box<dyn Read + Send>;

pub(super) fn open(path: &Path) -> io::Result<Reader> {
    if is_standard(path) && standard::is_input_closed() {
        return Err(io::Error::other("it is closed"));
    }
    Ok(if is_standard(path) { Box::new(io::stdin()) } else { Box::new(File::open(path)?) })
}

pub(super) fn is_file(path: &Path) -> bool {
    !is_standard(path) && metadata(path).is_ok_and(|found| found.is_file())
}
