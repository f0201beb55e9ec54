//! A first scene for a mesh: the content of the file, and a scene that runs and can be changed.

mod bodies;
mod comments;
mod text;

use std::path::Path;

use crate::error::Error;
use crate::fem::GmshFile;
use crate::scene::input::absent::absent;
use crate::scene::input::roles::roles;
use crate::scene::input::schema::Scene;
use bodies::Bodies;

impl Scene {
    /// The sentence that a scene with this unknown name is answered with, if other programs give the name to a thing
    /// that is not modelled here.
    pub fn not_modelled(name: &str) -> Option<&'static str> {
        absent(name)
    }

    /// The text of a scene for the mesh `file`, with comment lines; `named` is the name of the file in the scene. The
    /// scene is built before it is returned, so that it is not refused later.
    ///
    /// Groups of elements that share nodes are one body, and the others are further bodies. One is held, one is
    /// pressed, and weak springs keep those that no support holds.
    ///
    /// # Errors
    /// As [`GmshFile::read`] and [`GmshFile::mesh`]; [`Error::Mesh`] for a mesh of which no boundary can be held while
    /// another is pressed.
    pub fn start(file: &Path, named: &str) -> Result<String, Error> {
        let bodies = Bodies::of(&GmshFile::read(file)?)?;
        let comments = comments::head(named, &bodies);
        let mut reason = String::from("no side faces up while another, which holds all pieces of the mesh, faces down");
        for roles in roles(&bodies.joined) {
            let text = comments.clone() + &text::scene(named, &bodies, &roles);
            match Scene::from_json(&text, named)?.build_of(bodies.separate.clone(), &[]) {
                Ok(_) => return Ok(text),
                Err(error) => reason = error.to_string(),
            }
        }
        let message = format!("no first scene holds one boundary of this mesh and presses another: {reason}");
        Err(Error::Mesh { message })
    }
}
