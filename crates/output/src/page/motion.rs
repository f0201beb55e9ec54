//! A motion: its history at every step that is plotted, and the body at its frames.

use serde::Serialize;

use super::body::Shape;
use super::packed::{Packed, Packer};
use super::rows::{Closed, ClosedShown};
use super::state::{State, kept};
use super::sweep::MOST_BYTES;
use signorini_mechanics::Error;
use signorini_mechanics::scene::Answer;

pub(crate) struct MotionFrames<'a> {
    /// Time, contact force, number of closed rows, penetration, kinetic, strain, potential and total energy, step after
    /// step.
    pub history: &'a [[f64; 9]],
    pub times: &'a [f64],
    pub answer: &'a dyn Fn(usize) -> Result<Answer, Error>,
}

#[derive(Debug, Serialize)]
pub(super) struct MotionShown {
    /// Nine columns, as in `history.csv`.
    history: Packed,
    times: Vec<f64>,
    /// The kept frame with the largest contact force, at which the page opens; the first without contact.
    opens: usize,
    /// The closed rows of each kept frame, with their pressures.
    closed: ClosedShown,
}

impl MotionShown {
    pub fn of(
        frames: &MotionFrames,
        shape: &Shape,
        dimension: usize,
        packer: &mut Packer,
    ) -> Result<(Self, Vec<State>), Error> {
        let most = MOST_BYTES / State::bytes(shape, dimension).max(1);
        let (mut closed, mut states) = (Closed::default(), Vec::new());
        let (mut opens, mut largest) = (0, 0.0);
        for frame in kept(frames.times.len(), most) {
            let answer = (frames.answer)(frame)?;
            closed.add(answer.contact_set(), &[answer.pressure()]);
            let force = -answer.multiplier().iter().sum::<f64>();
            if force > largest {
                (opens, largest) = (states.len(), force);
            }
            states.push(State::of(&answer, frame as f64, shape, packer)?);
        }
        let shown = MotionShown {
            history: packer.exact(&frames.history.concat(), frames.history.first().map_or(1, |row| row.len())),
            times: frames.times.to_vec(),
            opens,
            closed: closed.packed(packer),
        };
        Ok((shown, states))
    }
}
