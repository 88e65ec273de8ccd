//! Output: files written completely or not at all, files written line by line, standard output, and the line on standard error.

use super::{InputError, standard};
use same_file::Handle;
use std::fs;
use std::io::{ErrorKind, Seek, SeekFrom, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Argument of the commands that write several files.
#[derive(clap::Args)]
pub(super) struct OutputFolder {
    /// Folder for the tables and charts; created if it is missing.
    #[arg(long, value_name = "D")]
    out_dir: PathBuf,
}

impl OutputFolder {
    /// Creates the folder before any computation.
    pub(super) fn create(&self) -> Result<&Path, InputError> {
        let folder = self.out_dir.as_path();
        if folder.exists() && !folder.is_dir() {
            return Err(input_error(folder, "is a file; allowed: a folder"));
        }
        match fs::create_dir_all(folder) {
            Ok(()) => Ok(folder),
            Err(error) => Err(input_error(folder, format!("cannot be created: {error}"))),
        }
    }
}

/// The name of standard input and output.
pub(super) const STANDARD: &str = "-";

/// A file to be written.
#[derive(Debug)]
pub(super) struct File {
    pub(super) path: PathBuf,
    pub(super) content: Vec<u8>,
}

impl File {
    pub(super) fn new(path: &Path, content: impl Into<Vec<u8>>) -> Self {
        Self { path: path.to_owned(), content: content.into() }
    }
}

/// Prints an error on standard error, in one line.
#[allow(clippy::print_stderr)] // the command line prints to the terminal
pub(super) fn error(line: &str) {
    eprintln!("error: {line}");
}

/// Prints a line on standard error as it is.
#[allow(clippy::print_stderr)] // the command line prints to the terminal
pub(super) fn line(line: &str) {
    eprintln!("{line}");
}

/// Prints a warning on standard error, in one line.
#[allow(clippy::print_stderr)] // the command line prints to the terminal
pub(super) fn warn(line: &str) {
    eprintln!("note: {line}");
}

pub(super) fn input_error(path: &Path, error: impl std::fmt::Display) -> InputError {
    if is_standard(path) {
        return InputError(format!("standard input: {error}"));
    }
    InputError(format!("{}: {error}", path.display()))
}

/// The error of an output that nobody can read; the exit code is 1.
pub(super) const CLOSED: &str = "standard output: is closed";

/// Is standard output, as `-` or by a device name, open?
pub(super) fn check_open(path: &Path) -> Result<(), InputError> {
    let is_output = is_standard(path) || standard::is_output_device(path);
    if is_output && standard::is_output_closed() {
        return Err(InputError(CLOSED.to_owned()));
    }
    Ok(())
}

pub(super) fn is_standard(path: &Path) -> bool {
    path.as_os_str() == STANDARD
}

/// Checks, before any computation, that a file can be written to this path.
pub(super) fn check_path(path: &Path) -> Result<(), InputError> {
    check_open(path)?;
    if is_standard(path) {
        return Ok(());
    }
    if path.is_dir() || path.file_name().is_none() {
        return Err(input_error(path, "is a folder; allowed: a file name"));
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        return Err(input_error(path, format!("the folder {} does not exist", folder.display())));
    }
    Ok(())
}

/// Do two outputs refer to the same file, by links too, or both to standard output?
pub(super) fn is_same_file(a: &Path, b: &Path) -> bool {
    let is_linked = || same_file::is_same_file(a, b).unwrap_or(false);
    let resolved = |path: &Path| match path.canonicalize() {
        Ok(found) => Some(found),
        Err(_) => Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?)),
    };
    a == b || !is_standard(a) && !is_standard(b) && (is_linked() || resolved(a) == resolved(b))
}

/// Is an output the file of an input, by links or as standard input too?
pub(super) fn is_input(out: &Path, input: &Path) -> bool {
    let handle = if is_standard(input) { Handle::stdin() } else { Handle::from_path(input) };
    !is_standard(out)
        && handle.is_ok_and(|input| Handle::from_path(out).is_ok_and(|out| out == input))
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder.as_os_str().is_empty() => Path::new("."),
        Some(folder) => folder,
        None => Path::new("."),
    }
}

/// Writes all files or none: first under temporary names, then renamed. Special files (devices, pipes)
/// cannot be replaced and are written directly, after the regular files; `-` is written last.
pub(super) fn write_all(files: &[File]) -> Result<(), InputError> {
    let mut pending: Vec<(PathBuf, PathBuf)> = Vec::new();
    let mut failure = None;
    let is_special = |file: &File| {
        !is_standard(&file.path) && fs::metadata(&file.path).is_ok_and(|found| !found.is_file())
    };
    let is_regular = |file: &File| !is_standard(&file.path) && !is_special(file);
    for (index, file) in files.iter().enumerate().filter(|(_, file)| is_regular(file)) {
        // The target of a link, not the link.
        let path = file.path.canonicalize().unwrap_or_else(|_| file.path.clone());
        let name = format!(".implant-preview-{}-{index}.part", std::process::id());
        let temporary = folder_of(&path).join(name);
        pending.push((temporary.clone(), path));
        if let Err(error) = write_durably(&temporary, &file.content) {
            failure = Some(cannot_be_written(&file.path, &error));
            break;
        }
    }
    for (temporary, path) in &pending {
        if failure.is_none() {
            failure =
                fs::rename(temporary, path).err().map(|error| cannot_be_written(path, &error));
        }
        if failure.is_some() {
            // Removal is best effort: the first failure is the one to report.
            let _ = fs::remove_file(temporary);
        }
    }
    if let Some(failure) = failure {
        return Err(failure);
    }
    for file in files.iter().filter(|file| is_special(file)) {
        let written = fs::OpenOptions::new().write(true).open(&file.path);
        written
            .and_then(|mut special| special.write_all(&file.content))
            .map_err(|error| cannot_be_written(&file.path, &error))?;
    }
    files.iter().filter(|file| is_standard(&file.path)).try_for_each(|file| print(&file.content))
}

fn write_durably(path: &Path, content: &[u8]) -> std::io::Result<()> {
    let mut file = fs::File::create(path)?;
    file.write_all(content)?;
    file.sync_all()
}

fn print(content: &[u8]) -> Result<(), InputError> {
    LineFile::open(Path::new(STANDARD), None)?.write(content).map(drop)
}

/// A file whose lines are written one by one, each at once.
pub(super) struct LineFile {
    path: PathBuf,
    to: Box<dyn Write + Send>,
}

impl LineFile {
    /// Opens a file at its place; what it holds stays up to the byte `keep`, without one nothing stays.
    pub(super) fn open(path: &Path, keep: Option<u64>) -> Result<Self, InputError> {
        check_open(path)?;
        let open = || -> std::io::Result<Box<dyn Write + Send>> {
            if is_standard(path) {
                return Ok(Box::new(std::io::stdout()));
            }
            let Some(keep) = keep else { return Ok(Box::new(fs::File::create(path)?)) };
            let mut file = fs::OpenOptions::new().write(true).open(path)?;
            file.set_len(keep)?;
            file.seek(SeekFrom::End(0))?;
            Ok(Box::new(file))
        };
        let to = open().map_err(|error| cannot_be_written(path, &error))?;
        Ok(Self { path: path.to_owned(), to })
    }

    /// Writes whole lines; breaks where the reader has closed the pipe early (`| head`), which is no error.
    pub(super) fn write(&mut self, lines: &[u8]) -> Result<ControlFlow<()>, InputError> {
        match self.to.write_all(lines).and_then(|()| self.to.flush()) {
            Ok(()) => Ok(ControlFlow::Continue(())),
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(ControlFlow::Break(())),
            Err(error) => Err(cannot_be_written(&self.path, &error)),
        }
    }

    /// The writer of the file, for content that is no text.
    pub(super) fn into_writer(self) -> Box<dyn Write + Send> {
        self.to
    }
}

fn cannot_be_written(path: &Path, error: &std::io::Error) -> InputError {
    if is_standard(path) {
        return InputError(format!("standard output: cannot be written: {error}"));
    }
    input_error(path, format!("cannot be written: {error}"))
}
