//! Meshes written by Gmsh: `.msh` files of version 4.1 and 2.2, in ASCII and in binary form of either byte order.
//!
//! Physical groups give the names: the elements of the highest dimension are the body, and every group one dimension
//! below becomes a boundary. The name of a group without a name is its number.
//!
//! ```
//! use signorini_fem::GmshFile;
//!
//! let text = r#"$MeshFormat
//! 2.2 0 8
//! $EndMeshFormat
//! $PhysicalNames
//! 1
//! 1 7 "floor"
//! $EndPhysicalNames
//! $Nodes
//! 3
//! 10 0 0 0
//! 30 0 1 0
//! 20 2 0 0
//! $EndNodes
//! $Elements
//! 2
//! 1 1 2 7 1 10 20
//! 2 2 2 0 1 10 20 30
//! $EndElements
//! "#;
//! let mesh = GmshFile::parse(text, "triangle.msh")?.mesh(&[], 0.5)?;
//! assert_eq!(mesh.nodes()[2], [1.0, 0.0, 0.0]);
//! assert_eq!(mesh.boundary("floor").map(|floor| floor.nodes()), Some(vec![0, 2]));
//! # Ok::<(), signorini_fem::Error>(())
//! ```
//!
//! # Source
//! C. Geuzaine, J.-F. Remacle, *Gmsh Reference Manual*, chapter "Gmsh file formats", MSH file format and its version 2.

mod body;
mod content;
mod record;
mod sections;

use std::path::Path;

pub use body::Glued;
pub use content::{GmshFile, PhysicalGroup};

use super::Mesh;
use crate::error::Error;
use crate::formulation::positive;
use signorini_linear::file::read_capped;

/// Most bytes of a mesh: more than any body that can be solved needs.
const MOST_OF_MESH: u64 = 4 << 30;

impl GmshFile {
    /// Reads a mesh file of Gmsh of format 4.1 or 2.2, as text or binary.
    ///
    /// # Errors
    /// [`linear::Error::File`](signorini_linear::Error::File) for a file that cannot be read, and as
    /// [`GmshFile::parse`].
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        let path = file.as_ref();
        Self::parse(read_capped(path, MOST_OF_MESH)?, path)
    }

    /// Reads the content of a file, a text or bytes; `file` is named in errors.
    ///
    /// # Errors
    /// [`linear::Error::FileSyntax`](signorini_linear::Error::FileSyntax) with the line; in a binary file with the line
    /// in which the section begins, and with the byte, from 0, at which the node, element or other record begins: for a
    /// version other than 4.1 and 2.2, an unknown byte order or data size, a section that is missing or ends early or
    /// announces another number of lines than it has, a number of the wrong kind, coordinates that are not finite, an
    /// unknown element type, an element whose node does not exist, a group without elements.
    pub fn parse(content: impl AsRef<[u8]>, file: impl AsRef<Path>) -> Result<Self, Error> {
        sections::read(file.as_ref(), content.as_ref())
    }

    /// The physical groups, in the order of the file, without those that have no name.
    pub fn groups(&self) -> &[PhysicalGroup] {
        &self.groups
    }

    /// Names of the physical groups that have elements of the highest dimension: each may be a body.
    pub fn bodies(&self) -> Vec<String> {
        let names = self.names_in_use();
        names.into_iter().filter(|(dimension, _)| Some(*dimension) == self.highest()).map(|(_, name)| name).collect()
    }

    /// The mesh of the body: of the elements in the physical groups of these names, or, without a name, of all elements
    /// of the highest dimension. Groups that share nodes are glued. Coordinates are multiplied by `scale`.
    ///
    /// Nodes that no element of the body uses are left out; the others keep the order of the file. A plane mesh lies in
    /// any plane z = const, a bar along x. Elements that run clockwise are turned, if all elements do. Facets of a
    /// boundary have one orientation: the body is on the left of edges; in space facets are counterclockwise seen from
    /// outside. With names, facets of boundaries that are not on the body are left out.
    ///
    /// # Errors
    /// [`linear::Error::FileSyntax`](signorini_linear::Error::FileSyntax) with the line: for elements of more than one
    /// kind, or of a kind without contact, a node outside the plane, an element that is inverted or has no volume, a
    /// group with facets that are not faces of the body. [`Error::Mesh`] for a group that does not exist, and for
    /// groups of different dimensions, [`linear::Error::Setting`](signorini_linear::Error::Setting) for a scale that is
    /// not positive and finite.
    pub fn mesh(&self, groups: &[&str], scale: f64) -> Result<Mesh, Error> {
        positive("scale", scale)?;
        let (mut mesh, numbers) = body::mesh(self, groups, scale)?;
        mesh.boundaries = body::of(self, &mesh, &numbers, !groups.is_empty())?;
        Ok(mesh)
    }
}
