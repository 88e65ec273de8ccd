//! Signals to a running command.

use std::fs;
use std::path::Path;
use std::process::{Child, Command};
use std::thread;

/// Sends a signal.
pub(crate) fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status();
    assert!(sent.unwrap().success());
}

/// Sends a signal once a file that the command writes has so many bytes.
pub(crate) fn signal_after(child: &Child, name: &str, file: &Path, bytes: u64) {
    while fs::metadata(file).map_or(0, |found| found.len()) < bytes {
        thread::yield_now();
    }
    signal(child, name);
}
