//! Input: whole files up to a size, or standard input.

use super::InputError;
use super::output::{input_error, is_standard};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Reads a file, and at most one byte more than `max_bytes`, so that the parser rejects longer files.
pub(super) fn read(path: &Path, max_bytes: usize) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    let max_bytes = max_bytes as u64 + 1;
    let read = if is_standard(path) {
        std::io::stdin().lock().take(max_bytes).read_to_end(&mut bytes)
    } else {
        File::open(path).and_then(|file| file.take(max_bytes).read_to_end(&mut bytes))
    };
    read.map_err(|error| input_error(path, format!("cannot be read: {error}")))?;
    Ok(bytes)
}
