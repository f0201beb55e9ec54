//! Tables of a motion in its folder, which grow line by line and are continued after a stop.

use std::fs::OpenOptions;
use std::io::{Error as IoError, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use crate::file::write_atomically;
use signorini_mechanics::Error;
use signorini_qp as qp;

/// Lines are written at every frame, and between frames if they exceed this number of bytes.
const MOST_BYTES: usize = 1 << 16;

/// A file of comma-separated values under a heading.
#[derive(Debug)]
pub(crate) struct MotionTable {
    path: PathBuf,
    /// Lines that are not written yet.
    lines: String,
    /// Number of bytes of the file that belong to this run.
    written: u64,
}

impl MotionTable {
    /// A new file with its heading, which ends with a line feed.
    pub fn new(path: PathBuf, heading: &str) -> Result<Self, Error> {
        write_atomically(&path, heading.as_bytes())?;
        Ok(MotionTable { path, lines: String::new(), written: heading.len() as u64 })
    }

    /// The file of an earlier run, cut off after its first `bytes`.
    pub fn resume(path: PathBuf, heading: &str, bytes: u64) -> Result<Self, Error> {
        match cut(&path, heading, bytes) {
            Ok(()) => Ok(MotionTable { path, lines: String::new(), written: bytes }),
            Err(source) => Err(qp::LinearError::File { action: "resume", path, source }.into()),
        }
    }

    /// Number of written bytes.
    pub fn bytes(&self) -> u64 {
        self.written
    }

    /// Adds a line.
    pub fn add(&mut self, line: &str) -> Result<(), Error> {
        self.lines.push_str(line);
        self.lines.push('\n');
        if self.lines.len() > MOST_BYTES { self.write() } else { Ok(()) }
    }

    /// Appends the lines that are not written yet.
    pub fn write(&mut self) -> Result<(), Error> {
        let appended = OpenOptions::new().append(true).open(&self.path).and_then(|mut file| {
            file.write_all(self.lines.as_bytes())?;
            file.sync_data()
        });
        appended.map_err(|source| qp::LinearError::File { action: "write", path: self.path.clone(), source })?;
        self.written += self.lines.len() as u64;
        self.lines.clear();
        Ok(())
    }
}

/// Cuts a table off after its first `bytes`; a file that is not a table of a run in its own folder is left unchanged.
fn cut(path: &Path, expected: &str, bytes: u64) -> std::io::Result<()> {
    let wrong = |message: &str| Err(IoError::new(ErrorKind::InvalidData, message));
    // Opening a named pipe waits for a reader, and the target of a link is outside this folder.
    if !path.symlink_metadata()?.is_file() {
        return wrong("it is not a regular file");
    }
    let mut file = OpenOptions::new().read(true).write(true).open(path)?;
    let mut heading = Vec::new();
    (&mut file).take(expected.len() as u64).read_to_end(&mut heading)?;
    if heading != expected.as_bytes() {
        return wrong("it is not a history of a motion");
    }
    if file.metadata()?.len() < bytes {
        return wrong("it is shorter than its checkpoint says");
    }
    file.set_len(bytes.max(expected.len() as u64))
}
