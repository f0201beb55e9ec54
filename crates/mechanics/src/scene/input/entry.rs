//! Entries of a scene: their checks, their form in messages, and the files that they name.

use std::cell::RefCell;
use std::collections::HashMap;
use std::hash::Hash;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::error::{Error, nearly};
use crate::fem::GmshFile;
use crate::fem::geometry::{distance, unit};
use crate::fem::mesh::deck::Deck;
use crate::fem::mesh::{Boundary, Mesh};
pub(crate) use crate::fem::number;
use signorini_qp as qp;

/// Tolerance, in units of the body's size, for a point on a node and for a table that reaches a candidate: above the
/// rounding of written decimals, far below the size of any cell.
pub(crate) const PLACE_TOLERANCE: f64 = 1e-9;

/// Lengths below this times the body's size are rounding of coordinates.
pub(crate) const COORDINATE_ROUNDING: f64 = 1e-12;

pub fn wrong(path: impl Into<String>, message: impl Into<String>) -> Error {
    Error::Scene { path: path.into(), message: message.into() }
}

/// The refusal of a scene that poses another problem than was meant.
pub fn refused(code: &'static str, path: impl Into<String>, message: String) -> Error {
    Error::Refused { code, place: "scene, ".to_string(), path: path.into(), message }
}

pub(crate) fn finite(path: impl Into<String>, value: f64) -> Result<(), Error> {
    if value.is_finite() { Ok(()) } else { Err(wrong(path, format!("{value} is not finite"))) }
}

pub(crate) fn positive(path: &str, value: f64) -> Result<f64, Error> {
    finite(path, value)?;
    if value > 0.0 {
        Ok(value)
    } else {
        Err(wrong(path, format!("{} is not allowed: it must be positive", number(value))))
    }
}

/// Checks a table at a JSON path: as many factors as `places`, at least one; the places have this name, and increase.
pub(crate) fn table(path: &str, (name, places): (&str, &[f64]), factors: &[f64]) -> Result<(), Error> {
    if places.len() != factors.len() || places.is_empty() {
        let message = format!("{} {name} and {} factors; give as many, at least one", places.len(), factors.len());
        return Err(wrong(path, message));
    }
    for (index, &place) in places.iter().enumerate() {
        finite(format!("{path}.{name}[{index}]"), place)?;
        if index > 0 && place <= places[index - 1] {
            let message = format!("{place:?} does not lie beyond {:?}; {name} must increase", places[index - 1]);
            return Err(wrong(format!("{path}.{name}[{index}]"), message));
        }
        finite(format!("{path}.factors[{index}]"), factors[index])?;
    }
    Ok(())
}

/// A point as a person writes it, with all of its entries.
pub(crate) fn point(at: &[f64]) -> String {
    let coordinates: Vec<String> = at.iter().map(|&coordinate| number(coordinate)).collect();
    format!("({})", coordinates.join(", "))
}

/// Rounded to six significant digits: computed places are not known to more.
pub(crate) fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// A point or vector of a scene in `dimension` coordinates; those beyond are zero.
pub(crate) fn vector(path: &str, entries: &[f64], dimension: usize) -> Result<[f64; 3], Error> {
    if entries.len() != dimension {
        let entry = if entries.len() == 1 { "entry" } else { "entries" };
        let (room, names) =
            [("a bar", "[x]"), ("a plane or axisymmetric model", "[x, y]"), ("a model in space", "[x, y, z]")]
                [dimension - 1];
        let found = entries.len();
        let message = format!("the array has {found} {entry}, but must have {dimension} in {room}: {names}");
        return Err(wrong(path, message));
    }
    let mut vector = [0.0; 3];
    for (index, (place, &entry)) in vector.iter_mut().zip(entries).enumerate() {
        finite(format!("{path}[{index}]"), entry)?;
        *place = entry;
    }
    Ok(vector)
}

/// The same, of unit length.
pub(crate) fn direction(path: &str, entries: &[f64], dimension: usize) -> Result<[f64; 3], Error> {
    let direction = unit(vector(path, entries, dimension)?);
    if direction == [0.0; 3] {
        return Err(wrong(path, "the vector is zero and has no direction; it needs a length"));
    }
    Ok(direction)
}

/// A setting that a lower module refused, with its place in the scene.
pub(crate) fn located(error: impl Into<Error>, prefix: &str) -> Error {
    match error.into() {
        Error::Linear(qp::LinearError::Setting { name, value, allowed }) => {
            wrong(format!("{prefix}{name}"), format!("{} is not allowed: it must be {allowed}", number(value)))
        }
        other => other,
    }
}

pub(crate) fn boundary<'a>(mesh: &'a Mesh, name: &str, path: &str) -> Result<&'a Boundary, Error> {
    mesh.boundary(name).ok_or_else(|| {
        let names: Vec<&str> = mesh.boundaries().iter().map(|boundary| boundary.name.as_str()).collect();
        let meant = nearly(name, names.iter().copied());
        let there = match names.is_empty() {
            true => {
                "the mesh has none: name them in Gmsh by physical groups, or in the scene by the `parts` of the mesh"
                    .into()
            }
            false => format!("there are {}", names.join(", ")),
        };
        wrong(path, format!("there is no boundary `{name}`; {there}{meant}"))
    })
}

/// The nodes of the set of this name, or the node of this number, in the file of a mesh.
pub(crate) fn nodes_named(mesh: &Mesh, name: &str, path: &str) -> Result<Vec<usize>, Error> {
    let names = mesh.node_names();
    names.nodes(name).ok_or_else(|| {
        let sets: Vec<&str> = names.sets().collect();
        let there = match (names.has_numbers(), sets.is_empty()) {
            (false, _) => "only nodes of a deck have names".to_string(),
            (true, true) => "the deck has no sets of nodes".to_string(),
            (true, false) => format!("there are the sets {}, and numbers of nodes", sets.join(", ")),
        };
        let meant = nearly(name, sets.iter().copied());
        wrong(path, format!("there is no set of nodes, and no node of the number, `{name}`; {there}{meant}"))
    })
}

/// The nodes of these names, each once.
pub(crate) fn nodes_named_once(mesh: &Mesh, names: &[String], path: &str) -> Result<Vec<usize>, Error> {
    let mut nodes = Vec::new();
    for name in names {
        nodes.extend(nodes_named(mesh, name, path)?);
    }
    nodes.sort_unstable();
    nodes.dedup();
    Ok(nodes)
}

/// The node at a point of a scene.
pub(crate) fn node_at(mesh: &Mesh, at: &[f64], path: &str) -> Result<usize, Error> {
    let dimension = mesh.dimension();
    let place = vector(path, at, dimension)?;
    let tolerance = PLACE_TOLERANCE * mesh.size();
    let is_there = |node: &[f64; 3]| {
        // Most nodes are away along an axis.
        (0..3).all(|axis| (node[axis] - place[axis]).abs() <= tolerance) && distance(*node, place) <= tolerance
    };
    let there: Vec<usize> = (0..mesh.nodes().len()).filter(|&node| is_there(&mesh.nodes()[node])).collect();
    if let [node] = there[..] {
        return Ok(node);
    }
    let message = match (&there[..], mesh.nearest_node(place)) {
        ([one, other, ..], _) => {
            format!("nodes {one} and {other} of two bodies lie at {}; name a boundary instead", point(at))
        }
        (_, Some((node, _))) => {
            let nearest = point(&mesh.nodes()[node][..dimension]);
            format!("there is no node at {}; the nearest is node {node} at {nearest}", point(at))
        }
        (_, None) => "the mesh has no nodes".into(),
    };
    Err(wrong(path, message))
}

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
        once(&self.decks, (file.clone(), step), || Ok(Deck::read(&file, folder, step)?))
    }

    pub fn gmsh(&self, file: PathBuf) -> Result<Rc<GmshFile>, Error> {
        once(&self.meshes, file.clone(), || Ok(GmshFile::read(file)?))
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
