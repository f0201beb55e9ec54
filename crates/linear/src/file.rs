//! Files read up to a cap: an endless device or an absurdly large file is refused before it fills the memory. Files of
//! numbers that take more room than the numbers in memory are read, and written, piece by piece.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use crate::error::Error;

/// Most bytes of an input of unknown length, not a regular file: a pipe, a device.
const MOST_OF_STREAM: u64 = 64 << 20;

/// The content of a file of at most `most` bytes: an endless device does not fill the memory. For the crates of this
/// workspace.
///
/// # Errors
/// [`Error::File`] for a file that cannot be read, and for one that is longer.
pub fn read_capped(path: &Path, most: u64) -> Result<Vec<u8>, Error> {
    let (mut file, mut bytes) = (open_capped(path, most)?, Vec::new());
    let read = bytes.try_reserve_exact(file.length as usize).map_err(io::Error::from);
    read.and_then(|()| file.read_to_end(&mut bytes)).map_err(unread(path))?;
    Ok(bytes)
}

/// The error of a file that cannot be read.
pub fn unread(path: &Path) -> impl Fn(io::Error) -> Error + '_ {
    move |source| Error::File { action: "read", path: path.into(), source }
}

/// A file that is read up to a cap; beyond it, reading fails.
pub(crate) struct Capped {
    file: File,
    /// Bytes of a regular file; 0 for other files, of unknown length.
    pub(crate) length: u64,
    most: u64,
    left: u64,
}

impl Capped {
    fn too_long(&self) -> io::Error {
        io::Error::new(io::ErrorKind::FileTooLarge, format!("it is longer than {} MB", self.most >> 20))
    }
}

impl Read for Capped {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(into)?;
        self.left = self.left.checked_sub(count as u64).ok_or_else(|| self.too_long())?;
        Ok(count)
    }
}

/// A file to be read piece by piece, at most `most` bytes.
pub(crate) fn open_capped(path: &Path, most: u64) -> Result<Capped, Error> {
    let opened = open(path).and_then(|file| {
        let about = file.metadata()?;
        let (length, most) = if about.is_file() { (about.len(), most) } else { (0, most.min(MOST_OF_STREAM)) };
        let file = Capped { file, length, most, left: most };
        if length > most { Err(file.too_long()) } else { Ok(file) }
    });
    opened.map_err(unread(path))
}

fn open(path: &Path) -> io::Result<File> {
    if is_named_pipe(path) {
        let reason = "it is a named pipe, which may never be written to; name a file, or pipe into /dev/stdin";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    }
    File::open(path)
}

/// A file whose length is known before it is read, opened, with that length in bytes. For the crates of this workspace.
///
/// # Errors
/// [`Error::File`] for a file that cannot be read, and for a pipe, a device or a folder.
pub fn open_regular(path: &Path) -> Result<(File, u64), Error> {
    let opened = open(path).and_then(|file| {
        let about = file.metadata()?;
        if about.is_file() {
            return Ok((file, about.len()));
        }
        Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file, whose length is known"))
    });
    opened.map_err(unread(path))
}

/// Returns `true` for a named pipe, which would wait for a writer when it is opened. A pipe that a shell has already
/// connected, as /dev/stdin, has no name.
#[cfg(unix)]
fn is_named_pipe(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;

    std::fs::metadata(path).is_ok_and(|about| about.file_type().is_fifo()) && path.canonicalize().is_ok()
}

#[cfg(not(unix))]
fn is_named_pipe(_: &Path) -> bool {
    false
}

/// The content of a file as text, at most `most` bytes of UTF-8. For the crates of this workspace.
///
/// # Errors
/// As [`read_capped`], and for bytes that are not UTF-8.
pub fn read_text_capped(path: &Path, most: u64) -> Result<String, Error> {
    let invalid = |_| io::Error::new(io::ErrorKind::InvalidData, "its text is not valid UTF-8");
    String::from_utf8(read_capped(path, most)?).map_err(invalid).map_err(unread(path))
}

/// A file to be written piece by piece: it is never in memory as a whole.
pub struct Streamed<'a> {
    /// Its name without the folder that holds it.
    pub name: &'static str,
    contents: Box<Contents<'a>>,
}

/// Writes the contents of a file, the same each time.
type Contents<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

impl<'a> Streamed<'a> {
    /// The file of this name; a function writes its contents, the same at each call.
    pub fn new(name: &'static str, contents: impl Fn(&mut dyn Write) -> io::Result<()> + 'a) -> Self {
        Streamed { name, contents: Box::new(contents) }
    }

    /// Writes the whole contents to `out`, piece by piece.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        (self.contents)(out)
    }

    /// The contents in memory, if they are text.
    pub fn text(&self) -> String {
        let mut text = Vec::new();
        // Writing into memory cannot fail.
        let _ = self.write(&mut text);
        String::from_utf8_lossy(&text).into_owned()
    }

    /// The number of bytes of the contents, counted without writing them anywhere.
    pub fn bytes(&self) -> u64 {
        let mut counter = Counter(0);
        // Writing to a counter cannot fail.
        let _ = self.write(&mut counter);
        counter.0
    }
}

struct Counter(u64);

impl Write for Counter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
