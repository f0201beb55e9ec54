//! `signorini new`: a first scene for a mesh.

use super::options::New;
use super::outcome::Outcome;
use crate::Error;
use crate::output::write_atomically;
use crate::scene::Scene;

pub(super) fn run(options: &New) -> Result<Outcome, Error> {
    // A scene beside its mesh names the file alone.
    let beside = options.out.as_ref().is_some_and(|out| out.parent() == options.mesh.parent());
    let named = match options.mesh.file_name().filter(|_| beside) {
        Some(name) => name.to_string_lossy().into_owned(),
        None => options.mesh.to_string_lossy().into_owned(),
    };
    let text = Scene::start(&options.mesh, &named)?;
    match &options.out {
        Some(file) => {
            write_atomically(file, text.as_bytes())?;
            Ok(Outcome::done(format!("{}: written as a first scene; solve it, then change it\n", file.display())))
        }
        None => Ok(Outcome::done(text)),
    }
}
