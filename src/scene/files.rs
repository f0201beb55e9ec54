//! The files that a scene names.

use std::path::{Path, PathBuf};

use super::entry::wrong;
use crate::error::Error;

/// The folder of the files of a scene, and the permission to read them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Files<'a> {
    /// The folder in which relative names start; for a scene given without a folder it is the empty path.
    pub folder: &'a Path,
    /// `true` if files outside the folder may be read.
    pub reads_outside: bool,
}

impl Files<'_> {
    /// The file of this name at a JSON path, which must lie in the folder of the scene after `..` and links are followed, unless the
    /// scene may read outside.
    pub fn named(&self, name: &str, path: String) -> Result<PathBuf, Error> {
        let file = self.folder.join(name);
        if self.reads_outside {
            return Ok(file);
        }
        let real = |path: &Path| {
            path.canonicalize().map_err(|source| Error::File { action: "read", path: path.into(), source })
        };
        let home = real(if self.folder.as_os_str().is_empty() { Path::new(".") } else { self.folder })?;
        if !real(&file)?.starts_with(home) {
            let message = format!(
                "the file {} lies outside the folder of the scene; copy it there, or allow it (--allow-outside)",
                file.display()
            );
            return Err(wrong(path, message));
        }
        Ok(file)
    }

    /// The length of the file of this name, in bytes; zero if it does not exist.
    pub fn length(&self, name: &str) -> f64 {
        std::fs::metadata(self.folder.join(name)).map_or(0.0, |about| about.len() as f64)
    }
}
