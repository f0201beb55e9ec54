//! The files that a scene names.

use std::cell::RefCell;
use std::collections::HashMap;
use std::hash::Hash;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::entry::wrong;
use crate::error::Error;
use crate::fem::GmshFile;
use crate::fem::mesh::deck::Deck;
use signorini_qp as qp;

/// The folder of the files of a scene, and the permission to read them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Files<'a> {
    /// The folder in which relative names start; for a scene given without a folder it is the empty path.
    pub folder: &'a Path,
    /// `true` if files outside the folder may be read.
    pub reads_outside: bool,
}

impl Files<'_> {
    /// The file of this name at a JSON path, which must lie in the folder of the scene after `..` and links are
    /// followed, unless the scene may read outside.
    pub fn named(&self, name: &str, path: String) -> Result<PathBuf, Error> {
        let file = self.folder.join(name);
        let real = match file.canonicalize() {
            Ok(real) if real.is_dir() => Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder, not a file")),
            found => found,
        };
        let real = real.map_err(|source| {
            let named = Named { reason: source.to_string(), scene: "the scene".into(), path: path.clone() };
            let full = std::path::absolute(&file).unwrap_or_else(|_| file.clone());
            qp::LinearError::File { action: "read", path: full, source: io::Error::new(source.kind(), named) }
        })?;
        if self.reads_outside {
            return Ok(file);
        }
        let home = if self.folder.as_os_str().is_empty() { Path::new(".") } else { self.folder };
        let home = home.canonicalize().map_err(|source| qp::LinearError::File {
            action: "read",
            path: home.into(),
            source,
        })?;
        if !real.starts_with(home) {
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

/// What was read, by its key.
type Kept<K, T> = RefCell<HashMap<K, Rc<T>>>;

/// The files of meshes that the bodies of a scene share, each read once: decks up to a step, and those of Gmsh.
#[derive(Default)]
pub(crate) struct MeshFiles {
    decks: Kept<(PathBuf, Option<usize>), Deck>,
    meshes: Kept<PathBuf, GmshFile>,
}

impl MeshFiles {
    /// The deck in a file, whose includes lie in `folder` if it is given.
    pub fn deck(&self, file: PathBuf, folder: Option<&Path>, step: Option<usize>) -> Result<Rc<Deck>, Error> {
        once(&self.decks, (file.clone(), step), || Deck::read(&file, folder, step))
    }

    pub fn gmsh(&self, file: PathBuf) -> Result<Rc<GmshFile>, Error> {
        once(&self.meshes, file.clone(), || GmshFile::read(file))
    }
}

/// What is kept for a key, or what is read for it.
fn once<K: Eq + Hash, T>(kept: &Kept<K, T>, key: K, read: impl FnOnce() -> Result<T, Error>) -> Result<Rc<T>, Error> {
    if let Some(found) = kept.borrow().get(&key) {
        return Ok(found.clone());
    }
    let found = Rc::new(read()?);
    kept.borrow_mut().insert(key, found.clone());
    Ok(found)
}

/// The reason why a file that a scene names cannot be read, with the place of its name.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{reason}; {scene} names it at `{path}`")]
pub(crate) struct Named {
    /// The reason of the system.
    pub reason: String,
    /// The scene, with line and column of the name if they are known.
    pub scene: String,
    /// JSON path of the name.
    pub path: String,
}
