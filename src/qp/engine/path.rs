//! The exact path between two sets of gaps: every gap at which a row touches or releases, and every answer between.

use super::factored::Prepared;
use super::found::Found;
use crate::error::Error;
use crate::qp::linear::ldexp;
use crate::qp::method::parametric::{Compliance, Event, Piece};
use crate::qp::settings::Settings;
use crate::solution::{ContactSet, Solution};

/// The answers for all gaps `(1 - t) from + t to`, t from 0 to 1, as polylines.
#[derive(Clone, Debug)]
pub struct Path<'a> {
    pub(super) prepared: &'a Prepared,
    pub(super) from: Vec<f64>,
    pub(super) to: Vec<f64>,
    pub(super) unit: i32,
    pub(super) pieces: Vec<Piece>,
    pub(super) events: Vec<Event>,
}

impl Path<'_> {
    /// The rows that touch or release on the way, in order.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// The corners of all polylines: the beginning, every event, the end.
    pub fn corners(&self) -> Vec<f64> {
        let mut corners: Vec<f64> = self.pieces.iter().map(|piece| piece.from).collect();
        corners.extend(self.pieces.last().map(|piece| piece.to));
        corners
    }

    /// The stretches on which the contact set does not change.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The multipliers at `t` as they are on `piece`: at a corner the pieces on both sides agree but for rounding.
    pub fn multiplier_on(&self, piece: &Piece, t: f64) -> Vec<f64> {
        self.prepared.expand_multiplier(&piece.multiplier(t), self.unit)
    }

    /// The closed rows on `piece`.
    pub fn contact_set_on(&self, piece: &Piece) -> ContactSet {
        self.prepared.expand_set(&piece.contact_set)
    }

    /// The gaps at `t`, length m.
    pub fn gap(&self, t: f64) -> Vec<f64> {
        let mix = |(&from, &to): (&f64, &f64)| if from == to { from } else { (1.0 - t) * from + t * to };
        self.from.iter().zip(&self.to).map(mix).collect()
    }

    /// The multipliers at `t`, length m, in force.
    pub fn multiplier(&self, t: f64) -> Vec<f64> {
        self.piece(t).map_or_else(Vec::new, |piece| self.multiplier_on(piece, t))
    }

    /// The closed rows at `t`; at an event those of the stretch before it.
    pub fn contact_set(&self, t: f64) -> ContactSet {
        self.piece(t).map_or_else(ContactSet::default, |piece| self.contact_set_on(piece))
    }

    /// The whole answer at `t`, certified like any other.
    ///
    /// # Errors
    /// As [`Prepared::solve_gap`].
    pub fn solution(&self, t: f64, settings: &Settings) -> Result<Solution, Error> {
        self.prepared.solve_gap(self.gap(t), Some(&self.contact_set(t)), settings)
    }

    fn piece(&self, t: f64) -> Option<&Piece> {
        let index = self.pieces.partition_point(|piece| piece.to < t);
        self.pieces.get(index).or(self.pieces.last())
    }
}

impl Prepared {
    /// The exact path of the answer while the gaps move from `from` to `to` (length m each) on a straight line.
    ///
    /// # Errors
    /// As [`Prepared::solve_gap`] for both ends; [`Error::Interrupted`]; [`Error::NotCondensed`] for a problem that was not condensed or whose
    /// stiffness is not definite by itself.
    pub fn path(&self, from: &[f64], to: &[f64], settings: &Settings) -> Result<Path<'_>, Error> {
        let Some(condensed) =
            self.reduction.condensation.as_ref().filter(|_| self.reduction.is_definite && !self.is_single())
        else {
            return Err(Error::NotCondensed { step: "the exact path" });
        };
        self.check_gap(to)?;
        let settings = &settings.started()?;
        let found = self.find(self.own_load(), from.to_vec(), None, settings)?;
        let start = self.on_boundary(found, settings)?;
        let Found { loading, unit, problem, .. } = &start.found;
        let free = condensed.contact().mul(&condensed.free_displacement(&loading.sweep));
        let at_end = self.reduction.scaling.gap(&self.reduction.selection.gap(to), *unit);
        let constant =
            free.iter().zip(problem.gap()).map(|(&free, gap)| ldexp(free, loading.unit - unit) - gap).collect();
        let slope = problem.gap().iter().zip(&at_end).map(|(first, last)| first - last).collect();
        let compliance = Compliance::new(condensed.compliance(), constant, slope);
        let (pieces, mut events) =
            compliance.walk(&self.reduction.selection.restrict_set(&start.contact_set), &settings.watch)?;
        events.iter_mut().for_each(|event| event.row = self.reduction.selection.kept()[event.row]);
        Ok(Path { prepared: self, from: from.to_vec(), to: to.to_vec(), unit: *unit, pieces, events })
    }
}
