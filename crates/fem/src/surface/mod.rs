//! Closed surfaces of triangles from files: the closest point, the side on which a point lies, the crossings of a line.
//!
//! The readers are short and give the position of every error; the tree is the contact search itself. Its triangles
//! need two things that libraries of collision detection leave out: edges without leaks, and all closest points at
//! equal distance.

mod closest;
mod facets;
mod tree;

use std::path::Path;

pub use facets::distance_from;
pub use tree::ClosedSurface;
pub use tree::{Crossing, Tree};

use crate::error::Error;
use crate::formulation::positive;
use signorini_linear as linear;
use signorini_linear::file::read_capped;

/// Most bytes of a surface: twenty million triangles.
const MOST_OF_SURFACE: u64 = 1 << 30;

impl ClosedSurface {
    /// Reads a surface from an STL file, binary or ASCII, or from an OBJ file, by the extension of its name; its
    /// coordinates are multiplied by `scale` and moved by `origin` (`[x, y, z]`, in length).
    ///
    /// # Errors
    /// [`linear::Error::File`] for a file that cannot be read, [`linear::Error::Setting`] for a scale that is not
    /// positive and finite; [`linear::Error::FileSyntax`] with a line, or [`linear::Error::FileBytes`] with an offset,
    /// for a file of another form, coordinates that are not finite or too large, and triangles that do not close to the
    /// surface of a solid. No error quotes the file.
    pub fn read(file: &Path, scale: f64, origin: [f64; 3]) -> Result<Self, Error> {
        positive("scale", scale)?;
        let ending = file.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
        let parse = match ending.as_deref() {
            Some("stl") => facets::read_stl,
            Some("obj") => facets::read_obj,
            _ => {
                let message = "its name must end in `.stl` or `.obj`, the form of its content".to_string();
                return Err(linear::Error::FileSyntax { file: file.into(), line: 1, message }.into());
            }
        };
        let facets = parse(file, &read_capped(file, MOST_OF_SURFACE)?)?;
        ClosedSurface::new(facets.placed(scale, origin)?)
    }
}
