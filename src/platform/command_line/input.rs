//! Reading: whole files up to a length, or standard input.

use super::Refused;
use super::output::{is_standard, refuse};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The bytes of a file; a little more than `most` of one that is longer, which its reader will refuse.
pub(super) fn read(path: &Path, most: usize) -> Result<Vec<u8>, Refused> {
    let mut bytes = Vec::new();
    let most = most as u64 + 1;
    let read = if is_standard(path) {
        std::io::stdin().lock().take(most).read_to_end(&mut bytes)
    } else {
        File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes))
    };
    read.map_err(|error| refuse(path, format!("cannot be read: {error}")))?;
    Ok(bytes)
}
