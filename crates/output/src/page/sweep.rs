//! A sweep: the exact path if it is known, else the solved gaps or forces.

use serde::Serialize;

use super::body::Shape;
use super::packed::Packer;
use super::rows::{Closed, ClosedShown};
use super::state::{State, kept};
use signorini_mechanics::Error;
use signorini_study::{ContactSummary, Status, Sweep, SweepCorner, SweepEvent, SweepPoint};

/// Bytes of all states together, before they are deflated.
pub(super) const MOST_BYTES: usize = 12 << 20;

#[derive(Debug, Serialize)]
pub(super) struct SweepShown<'a> {
    /// `gap` or `force`.
    swept: &'static str,
    points: Vec<Point<'a>>,
    events: &'a [SweepEvent],
    corners: &'a [SweepCorner],
    /// The closed rows of each piece of the exact path, with the pressures at both ends; for a sweep without a path
    /// those of each point.
    closed: ClosedShown,
    /// Number of states, kept or not.
    state_count: usize,
}

/// One solved gap or force.
#[derive(Debug, Serialize)]
struct Point<'a> {
    gap: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    force: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    travel: Option<f64>,
    status: Status,
    method: &'a str,
    contact: &'a ContactSummary,
    bound: f64,
}

impl<'a> SweepShown<'a> {
    pub fn of(sweep: &'a Sweep, shape: &Shape, packer: &mut Packer) -> Result<(Self, Vec<State>), Error> {
        let first = &sweep.points[0];
        let model = first.answer.model();
        let most = MOST_BYTES / State::bytes(shape, model.mesh().dimension()).max(1);
        let (closed, states, state_count) = match &sweep.path {
            Some(_) => on_path(sweep, shape, most, packer)?,
            None => at_points(sweep, shape, most, packer)?,
        };
        let shown = SweepShown {
            swept: if first.force.is_some() { "force" } else { "gap" },
            points: sweep.points.iter().map(Point::of).collect(),
            events: &sweep.events,
            corners: &sweep.corners,
            closed,
            state_count,
        };
        Ok((shown, states))
    }
}

impl<'a> Point<'a> {
    fn of(point: &'a SweepPoint) -> Self {
        Point {
            gap: point.gap,
            force: point.force,
            travel: point.travel(),
            status: point.summary.status,
            method: &point.summary.solution.method,
            contact: &point.summary.contact,
            bound: point.summary.solution.certificate.energy_error_bound,
        }
    }
}

type Found = (ClosedShown, Vec<State>, usize);

/// The pieces of the exact path, and the states at their ends.
fn on_path(sweep: &Sweep, shape: &Shape, most: usize, packer: &mut Packer) -> Result<Found, Error> {
    let mut closed = Closed::default();
    let Some(path) = &sweep.path else { return at_points(sweep, shape, most, packer) };
    for piece in 0..path.pieces() {
        let [from, to] = path.pressures(piece)?;
        closed.add(&path.contact_set(piece), &[&from, &to]);
    }
    let corners = path.corners();
    let mut states = Vec::new();
    for index in kept(corners.len(), most) {
        states.push(State::of(&path.answer(corners[index])?, path.gap(corners[index]), shape, packer)?);
    }
    Ok((closed.packed(packer), states, corners.len()))
}

/// The answers at the gaps or forces of the sweep.
fn at_points(sweep: &Sweep, shape: &Shape, most: usize, packer: &mut Packer) -> Result<Found, Error> {
    let mut closed = Closed::default();
    for point in &sweep.points {
        closed.add(point.answer.contact_set(), &[point.answer.pressure()]);
    }
    let mut states = Vec::new();
    for index in kept(sweep.points.len(), most) {
        states.push(State::of(&sweep.points[index].answer, index as f64, shape, packer)?);
    }
    Ok((closed.packed(packer), states, sweep.points.len()))
}
