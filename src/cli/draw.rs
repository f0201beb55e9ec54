//! `signorini draw`: the set-up of a scene, before it is solved.

use super::input::{build, read_scene, warnings};
use super::options::{Draw, Picture};
use super::outcome::{Outcome, warn};
use crate::Error;
use crate::output::{Drawing, write_atomically};

pub(super) fn run(options: &Draw) -> Result<Outcome, Error> {
    let scene = read_scene(&options.scene, &options.limits)?;
    let model = build(&scene, &options.scene, &options.limits)?;
    warn(&warnings(&model));
    let drawing = Drawing::of_set_up(&model)?;
    let (file, bytes) = match &options.out {
        Picture::Png(file) => (file, drawing.png(1.0)?),
        Picture::Svg(file) => (file, drawing.svg().into_bytes()),
    };
    write_atomically(file, &bytes)?;
    Ok(Outcome::done(format!("{}: a picture of the scene before it is solved\n", file.display())))
}
