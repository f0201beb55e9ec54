//! Writing files so that nothing is ever half written.

use std::{
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use super::Drawing;
use crate::error::Error;
use crate::file::Streamed;

/// Bytes that are gathered before they are written.
const PIECE: usize = 1 << 20;

/// Writes `contents` to `path` as a whole or not at all, and makes its folder where that is missing.
///
/// The contents go to a new file beside their place, which is synced and then takes the place of `path` in one step.
///
/// # Errors
/// [`Error::File`] where the system refuses; an older file at `path` is then untouched, and nothing is left beside it.
pub fn write_atomically(path: &Path, contents: &[u8]) -> Result<(), Error> {
    streamed_atomically(path, |out| out.write_all(contents))
}

/// Writes what `contents` writes, which need not stand in memory, as [`write_atomically`].
///
/// # Errors
/// As [`write_atomically`].
fn streamed_atomically(path: &Path, contents: impl Fn(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    make_folder(folder)?;
    write(folder, path, contents).map_err(|source| Error::File { action: "write", path: path.to_owned(), source })
}

/// Makes a folder, and those that it is in, where they are missing.
///
/// # Errors
/// [`Error::File`] where the system refuses.
pub fn make_folder(folder: &Path) -> Result<(), Error> {
    let made = std::fs::create_dir_all(folder).map_err(|error| match error.kind() {
        // The system calls it existing, which is not what is wrong.
        io::ErrorKind::AlreadyExists => io::Error::new(io::ErrorKind::NotADirectory, "there is a file of that name"),
        _ => error,
    });
    made.map_err(|source| Error::File { action: "make the folder", path: folder.to_owned(), source })
}

fn write(folder: &Path, path: &Path, contents: impl Fn(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    // A temporary file is private by default; what takes its place is an ordinary file, as the umask wants it.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.prefix(".signorini-").tempfile_in(folder)?;
    let mut out = BufWriter::with_capacity(PIECE, file.as_file_mut());
    contents(&mut out)?;
    out.flush()?;
    drop(out);
    file.as_file().sync_all()?;
    file.persist(path).map(drop).map_err(|error| error.error)
}

/// Writes a drawing as `stem.svg` and `stem.png` (for paper `stem.svg` and `stem.pdf`) into `folder`, and tells both paths.
///
/// # Errors
/// [`Error::File`] where the system refuses, [`Error::Numerical`] where the rasteriser fails (then neither file is
/// written).
pub fn write_picture(folder: &Path, stem: &str, drawing: &Drawing) -> Result<[PathBuf; 2], Error> {
    let (other, bytes) = match drawing.is_for_paper() {
        true => ("pdf", drawing.pdf()),
        false => ("png", drawing.png(1.0)?),
    };
    let paths = ["svg", other].map(|extension| folder.join(format!("{stem}.{extension}")));
    write_atomically(&paths[0], drawing.svg().as_bytes())?;
    write_atomically(&paths[1], &bytes)?;
    Ok(paths)
}

/// Writes named texts into `folder`.
///
/// # Errors
/// [`Error::File`] where the system refuses; the files before the one that failed are complete.
pub fn write_files(folder: &Path, files: &[(&str, impl AsRef<str>)]) -> Result<(), Error> {
    files.iter().try_for_each(|(name, text)| write_atomically(&folder.join(name), text.as_ref().as_bytes()))
}

/// Writes files into `folder`, piece by piece.
///
/// # Errors
/// As [`write_files`].
pub fn write_streamed(folder: &Path, files: &[Streamed]) -> Result<(), Error> {
    files.iter().try_for_each(|file| streamed_atomically(&folder.join(file.name), |out| file.write(out)))
}
