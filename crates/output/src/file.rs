//! Atomic writing of files: each is written as a whole or not at all.

use std::{
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use super::Drawing;
use signorini_mechanics::Error;
use signorini_qp as qp;
use signorini_qp::file::Streamed;

/// Size of the write buffer in bytes.
const PIECE: usize = 1 << 20;

/// Writes `contents` to `path` as a whole or not at all, and makes its folder if that is missing.
///
/// The contents go to a new file in the same folder, which is synced and then replaces `path` in one step.
///
/// # Errors
/// [`qp::LinearError::File`] if the system refuses; an older file at `path` is then untouched, and nothing is left
/// beside it.
pub fn write_atomically(path: &Path, contents: &[u8]) -> Result<(), Error> {
    streamed_atomically(path, |out| out.write_all(contents))
}

/// Writes the output of `contents`, which need not be in memory, as [`write_atomically`] does.
pub(crate) fn streamed_atomically(
    path: &Path,
    contents: impl Fn(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Error> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    make_folder(folder)?;
    Ok(write(folder, path, contents).map_err(|source| qp::LinearError::File {
        action: "write",
        path: path.to_owned(),
        source,
    })?)
}

/// Makes a folder and its parent folders if they are missing.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Error> {
    let made = std::fs::create_dir_all(folder).map_err(|error| match error.kind() {
        // The system reports that it exists, which is not the fault.
        io::ErrorKind::AlreadyExists => io::Error::new(io::ErrorKind::NotADirectory, "there is a file of that name"),
        _ => error,
    });
    Ok(made.map_err(|source| qp::LinearError::File { action: "make the folder", path: folder.to_owned(), source })?)
}

fn write(folder: &Path, path: &Path, contents: impl Fn(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    // A temporary file is private by default; the final file has ordinary permissions under the umask.
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

impl Drawing {
    /// Writes the drawing as `stem.svg` and `stem.png` (for paper `stem.svg` and `stem.pdf`) into `folder`; returns
    /// both paths.
    ///
    /// # Errors
    /// [`qp::LinearError::File`] if the system refuses, [`qp::LinearError::Numerical`] if the rasteriser fails (then
    /// neither file is written).
    pub fn write(&self, folder: &Path, stem: &str) -> Result<[PathBuf; 2], Error> {
        let (other, bytes) = match self.is_for_paper() {
            true => ("pdf", self.pdf()),
            false => ("png", self.png(1.0)?),
        };
        let paths = ["svg", other].map(|extension| folder.join(format!("{stem}.{extension}")));
        write_atomically(&paths[0], self.svg().as_bytes())?;
        write_atomically(&paths[1], &bytes)?;
        Ok(paths)
    }
}

/// Writes named texts into `folder`, one file each, from the first to the last.
///
/// # Errors
/// [`qp::LinearError::File`] if the system refuses; the files before the one that failed are complete.
pub fn write_files(folder: &Path, files: &[(&str, impl AsRef<str>)]) -> Result<(), Error> {
    files.iter().try_for_each(|(name, text)| write_atomically(&folder.join(name), text.as_ref().as_bytes()))
}

/// Writes files into `folder`, piece by piece.
///
/// # Errors
/// As [`write_files`].
pub fn write_streamed(folder: &Path, files: &[Streamed]) -> Result<(), Error> {
    make_folder(folder)?;
    files.iter().try_for_each(|file| streamed_atomically(&folder.join(file.name), |out| file.write(out)))
}

/// The names of pictures that runs leave in a folder; a number may follow.
const PICTURES: [&str; 12] = [
    "contact",
    "force",
    "force-width",
    "gap",
    "history",
    "iteration",
    "meshes",
    "motion",
    "pressure",
    "rung",
    "total-error",
    "tradeoff",
];

/// Removes the page and the pictures that an earlier run left in a folder: they would show another answer.
///
/// # Errors
/// As [`remove_files`].
pub fn remove_shown(folder: &Path) -> Result<(), Error> {
    let is_shown = |name: &&str| {
        let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
        let without_number = stem.trim_end_matches(|digit: char| digit.is_ascii_digit()).trim_end_matches('-');
        *name == "report.html" || (["svg", "png", "pdf"].contains(&ending) && PICTURES.contains(&without_number))
    };
    // Without a report of an earlier run the files belong to somebody else, or there is no folder.
    let is_ours = folder.join("report.json").exists();
    let entries = std::fs::read_dir(folder).into_iter().filter(|_| is_ours).flatten().flatten();
    let names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    remove_files(folder, &names.iter().map(String::as_str).filter(is_shown).collect::<Vec<_>>())
}

/// Removes files that an earlier run left in a folder, and that would not belong to this one.
///
/// # Errors
/// [`qp::LinearError::File`] if a file stays.
pub fn remove_files(folder: &Path, names: &[&str]) -> Result<(), Error> {
    for name in names {
        match std::fs::remove_file(folder.join(name)) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound && folder.exists() => {
                return Err(qp::LinearError::File { action: "remove", path: folder.join(name), source }.into());
            }
            _ => {}
        }
    }
    Ok(())
}
