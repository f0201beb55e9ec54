//! The exact path between two sets of gaps: every gap at which a row touches or releases, and every answer between.

use std::sync::Arc;

use super::reuse::Prepared;
use crate::engine::{Factored, walk};
use crate::error::Error;
use crate::method::Start;
use crate::method::parametric::{Event, Piece};
use crate::settings::Method;
use crate::solution::{ContactSet, Solution};

/// The answers for all gaps `(1 - t) from + t to`, t from 0 to 1, as polylines.
///
/// ```
/// use signorini_qp::{ContactProblem, Prepared, Settings, SparseMatrix, SymmetricMatrix};
///
/// // Four springs of stiffness 4 in a row, the end pushed with force 3: it goes to 3 by itself, and a wall at g takes 3 - g.
/// let springs = [(0, 0, 8.0), (1, 0, -4.0), (1, 1, 8.0), (2, 1, -4.0), (2, 2, 8.0), (3, 2, -4.0), (3, 3, 4.0)];
/// let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(4, 4, &springs)?)?;
/// let contact = SparseMatrix::from_triplets(1, 4, &[(0, 3, 1.0)])?;
/// let problem = ContactProblem::new(stiffness, vec![0.0, 0.0, 0.0, 3.0], contact, vec![4.0])?;
///
/// let path = Prepared::new(&problem, &Settings::default())?.path(&[4.0], &[2.0])?;
/// // Half way the wall is at 3, and the end touches it; a quarter later it is at 2.5 and takes 0.5.
/// assert!(path.events().len() == 1 && (path.events()[0].at - 0.5).abs() < 1e-12);
/// assert!((path.multiplier(0.75)[0] + 0.5).abs() < 1e-12);
/// assert_eq!((path.multiplier(0.25), path.contact_set(1.0).count()), (vec![0.0], 1));
/// # Ok::<(), signorini_qp::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Path {
    prepared: Prepared,
    from: Vec<f64>,
    to: Vec<f64>,
    pieces: Vec<Piece>,
    events: Vec<Event>,
    /// The engine that knows the way back from its rows, whose multipliers have this unit.
    engine: Arc<Factored>,
    unit: i32,
}

/// Entry by entry `(1 - t) from + t to`; an entry that is equal at both ends, as an infinite gap, stays unchanged.
pub(crate) fn between(from: &[f64], to: &[f64], t: f64) -> Vec<f64> {
    let mix = |(&from, &to): (&f64, &f64)| if from == to { from } else { (1.0 - t) * from + t * to };
    from.iter().zip(to).map(mix).collect()
}

impl Path {
    /// The rows that touch or release on the way, in the order of their place t.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// The corners of all polylines: the places t of the beginning, of every event and of the end, dimensionless,
    /// increasing from 0 to 1.
    pub fn corners(&self) -> Vec<f64> {
        let mut corners: Vec<f64> = self.pieces.iter().map(|piece| piece.from).collect();
        corners.extend(self.pieces.last().map(|piece| piece.to));
        corners
    }

    /// The stretches on which the contact set does not change.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The multipliers, one per row, in force, at `t` on `piece`: at a corner the pieces on both sides agree except for
    /// rounding.
    pub fn multiplier_on(&self, piece: &Piece, t: f64) -> Vec<f64> {
        let [multiplier, _] = self.multipliers_on(piece, t);
        multiplier
    }

    /// The multipliers of the rows of B, and those of the equality rows.
    fn multipliers_on(&self, piece: &Piece, t: f64) -> [Vec<f64>; 2] {
        self.prepared.problem.split(self.engine.expand_multiplier(&piece.multiplier(t), self.unit))
    }

    /// The closed rows on `piece`.
    pub fn contact_set_on(&self, piece: &Piece) -> ContactSet {
        self.prepared.problem.of_inequalities(&self.engine.expand_set(&piece.contact_set))
    }

    /// The gaps at `t`, length m, in the problem's unit of length; negative if the obstacle starts inside the body.
    pub fn gap(&self, t: f64) -> Vec<f64> {
        let count = self.prepared.problem.inequalities();
        between(&self.from[..count], &self.to[..count], t)
    }

    /// The multipliers at `t`, length m, in the problem's unit of force, `<= 0` in compression.
    pub fn multiplier(&self, t: f64) -> Vec<f64> {
        self.piece(t).map_or_else(Vec::new, |piece| self.multiplier_on(piece, t))
    }

    /// The multipliers of the equality rows at `t`, length p, in the problem's unit of force, of either sign.
    pub fn equality_multiplier(&self, t: f64) -> Vec<f64> {
        self.piece(t).map_or_else(Vec::new, |piece| {
            let [_, multiplier] = self.multipliers_on(piece, t);
            multiplier
        })
    }

    /// The closed rows at `t`; at an event those of the stretch before it.
    pub fn contact_set(&self, t: f64) -> ContactSet {
        self.piece(t).map_or_else(ContactSet::default, |piece| self.contact_set_on(piece))
    }

    /// The whole answer at `t`, certified like any other.
    ///
    /// # Errors
    /// As [`Prepared::solve`].
    pub fn solution(&self, t: f64) -> Result<Solution, Error> {
        self.prepared.starting_from(self.contact_set(t)).solve(&self.gap(t))
    }

    /// The displacement at `t`, length n, in length, without a certificate of its own.
    ///
    /// # Errors
    /// As [`Prepared::boundary`].
    pub fn displacement(&self, t: f64) -> Result<Vec<f64>, Error> {
        Ok(self.prepared.starting_from(self.contact_set(t)).boundary(&self.gap(t))?.displacement())
    }

    fn piece(&self, t: f64) -> Option<&Piece> {
        let index = self.pieces.partition_point(|piece| piece.to < t);
        self.pieces.get(index).or(self.pieces.last())
    }
}

impl Prepared {
    /// The exact path of the answer while the gaps move from `from` to `to` (length m each, in the problem's unit of
    /// length, negative inside the body) on a straight line.
    ///
    /// # Errors
    /// As [`Prepared::solve`] for both ends; [`Error::Interrupted`]; [`Error::NotCondensed`] for a problem that was not
    /// condensed or has a stiffness that is not definite by itself.
    pub fn path(&self, from: &[f64], to: &[f64]) -> Result<Path, Error> {
        let gap = |gap: &[f64]| self.problem.gaps_of_all_rows(gap.to_vec());
        let [from, to] = [&gap(from)[..], &gap(to)[..]];
        // A path takes a factor.
        if self.hierarchy().is_some() && self.settings.method == Method::Auto {
            return self.with_settings(&self.settings.clone().exactly())?.path(from, to);
        }
        let not_condensed = || Error::NotCondensed { step: "the exact path" };
        let walked = |start: &Start| {
            self.ask(from, start, |engine, task| walk(engine.factor().ok_or_else(not_condensed)?, task, to))
        };
        let found = match walked(&self.start)? {
            Some(found) => Some(found),
            None => walked(&Start::from(&self.solve(from)?.contact_set))?,
        };
        let (Some((pieces, mut events, unit)), Some(engine)) = (found, self.factored()) else {
            return Err(not_condensed());
        };
        events.retain(|event| event.row < self.problem.inequalities());
        let (prepared, from, to, engine) = (self.clone(), from.to_vec(), to.to_vec(), engine.clone());
        Ok(Path { prepared, from, to, pieces, events, engine, unit })
    }
}
