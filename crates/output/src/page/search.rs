//! The search for the contact set, step by step.

use serde::Serialize;

use super::body::Shape;
use super::packed::{Packed, Packer};
use super::rows::closed;
use super::state::{State, kept};
use crate::view::iterations::iterations;
use signorini_mechanics::Error;
use signorini_mechanics::scene::Answer;
use signorini_qp::Iteration;

/// Largest number of steps shown; more steps are thinned out.
const MOST_STEPS: usize = 200;

#[derive(Debug, Serialize)]
pub(super) struct Search {
    /// Number of steps, shown or not.
    count: usize,
    steps: Vec<Step>,
}

#[derive(Debug, Serialize)]
struct Step {
    /// Its number, from 1.
    number: usize,
    /// Number of rows that are closed in this step.
    closed: usize,
    /// The penalty, in multiples of the local stiffness.
    #[serde(skip_serializing_if = "Option::is_none")]
    penalty: Option<f64>,
    /// 1 for a row that is closed in this step, 0 for an open one.
    set: Packed,
    /// The body with these rows held at their gaps; `None` if it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    state: Option<State>,
}

impl Search {
    /// The steps of `history`; for a body in the plane with their displacements, if known.
    pub fn of(answer: &Answer, history: &[Iteration], shape: &Shape, packer: &mut Packer) -> Result<Self, Error> {
        // In space each step would need a solve of its own, and a picture of the size of the answer.
        let in_plane = answer.model().mesh().dimension() == 2;
        let shown = if in_plane { iterations(answer.model(), history)? } else { Vec::new() };
        let mut steps = Vec::new();
        for index in kept(history.len(), MOST_STEPS) {
            let (number, step) = (index + 1, &history[index]);
            let own = shown.iter().find(|shown| shown.index == index);
            let state = own.map(|own| State::of(&own.answer, number as f64, shape, packer)).transpose()?;
            steps.push(Step {
                number,
                closed: step.contact_set.count(),
                penalty: (step.penalty > 0.0).then_some(step.penalty),
                set: closed(&step.contact_set, packer),
                state,
            });
        }
        Ok(Search { count: history.len(), steps })
    }
}
