//! Natural vibrations: the body at both ends of each mode.

use serde::Serialize;

use super::body::Shape;
use super::packed::Packer;
use super::state::State;
use super::sweep::MOST_BYTES;
use signorini_mechanics::Error;
use signorini_mechanics::scene::ModalAnalysis;
use signorini_qp::largest;

/// The largest displacement of a mode if the equilibrium has none, relative to the size of the body.
const OF_SIZE: f64 = 1e-3;

#[derive(Debug, Serialize)]
pub(super) struct ModeShown {
    /// Largest displacement of the mode in its states, in length.
    amplitude: f64,
    /// The body at both ends of the vibration.
    ends: [State; 2],
}

/// The first modes, as many as a page holds.
pub(super) fn modes_shown(found: &ModalAnalysis, shape: &Shape, packer: &mut Packer) -> Result<Vec<ModeShown>, Error> {
    let (answer, model) = (&found.answer, found.answer.model());
    let dimension = model.mesh().dimension();
    let of_equilibrium = largest(answer.displacement());
    let amplitude = if of_equilibrium > 0.0 { of_equilibrium } else { OF_SIZE * model.mesh().size() };
    let most = MOST_BYTES / (2 * State::bytes(shape, dimension)).max(1);
    let mut shown = Vec::new();
    for mode in found.modes.iter().take(most.max(1)) {
        let mut end = |sign: f64| {
            let moved = answer.moved_by(&mode.displacement, sign * amplitude / mode.largest(dimension))?;
            State::of(&moved, 0.0, shape, packer)
        };
        shown.push(ModeShown { amplitude, ends: [end(-1.0)?, end(1.0)?] });
    }
    Ok(shown)
}
