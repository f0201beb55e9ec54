//! The answer on the contact boundary alone: contact set, multipliers and forces, without the displacement of the body;
//! and the exact path between two sets of gaps: every gap at which a row touches or releases, and every answer between.

use std::sync::Arc;

use super::Prepared;
use crate::engine::{Factored, Reduced, displacement, on_boundary, response, settled, walk};
use crate::error::{Error, Result};
use crate::method::Start;
use crate::method::parametric::{Event, Piece};
use crate::settings::Method;
use crate::solution::{Certificate, ContactSet, Solution};

/// The answer of a prepared problem on its contact boundary at some gap and load.
///
/// The multipliers are those of the whole answer. Nothing here costs a sweep through the factor of the body, unless it
/// is asked for: [`displacement`](Self::displacement) takes one, [`solution`](Self::solution) two.
#[derive(Clone, Debug)]
pub struct BoundarySolution {
    /// Contact multiplier lambda of the whole answer, one entry per contact row, in the problem's unit of force, `<= 0`
    /// in compression.
    pub multiplier: Vec<f64>,
    /// The contact rows that are closed at this gap and load.
    pub contact_set: ContactSet,
    /// Linear solves of the method, or its interior-point steps, as in [`Solution::iterations`].
    pub iterations: usize,
    /// The certificate of the *condensed* problem, in its dimensionless units: its conditions are recomputed from the
    /// condensed stiffness, load and rows, not from the problem itself, which would need the displacement of the body.
    pub condensed_certificate: Certificate,
    inside: Inside,
}

#[derive(Clone, Debug)]
enum Inside {
    /// The answer was not condensed.
    Whole(Box<Solution>),
    /// The whole answer is found again from the same set, at these gaps.
    Condensed { engine: Arc<Factored>, found: Box<Reduced>, prepared: Box<Prepared>, gap: Vec<f64> },
}

impl BoundarySolution {
    /// Total contact force of the multipliers, `-sum(lambda)`, `>= 0`, in the problem's unit of force.
    pub fn contact_force(&self) -> f64 {
        -self.multiplier.iter().sum::<f64>()
    }

    /// The displacement u of the whole body, one entry per dof, in the problem's unit of length; not certified.
    pub fn displacement(&self) -> Vec<f64> {
        match &self.inside {
            Inside::Whole(solution) => solution.displacement.clone(),
            Inside::Condensed { engine, found, .. } => displacement(engine, found),
        }
    }

    /// The whole answer, with the certificate of the problem itself.
    pub fn solution(self) -> Result<Solution, Error> {
        match self.inside {
            Inside::Whole(solution) => Ok(*solution),
            Inside::Condensed { prepared, gap, .. } => {
                Ok(Solution { iterations: self.iterations, ..prepared.solve(&gap)? })
            }
        }
    }
}

impl From<Solution> for BoundarySolution {
    fn from(solution: Solution) -> Self {
        BoundarySolution {
            multiplier: solution.multiplier.clone(),
            contact_set: solution.contact_set.clone(),
            iterations: solution.iterations,
            condensed_certificate: solution.certificate,
            inside: Inside::Whole(Box::new(solution)),
        }
    }
}

impl Prepared {
    /// Contact set, multipliers and forces with these gaps, one per contact row, in the problem's unit of length,
    /// negative inside the body. The displacement of the body is not computed, so that a condensed problem costs only
    /// the solve on its contact boundary.
    ///
    /// # Errors
    /// As [`Prepared::solve`]; the certificate of the condensed problem must meet the tolerance.
    pub fn boundary(&self, gap: &[f64]) -> Result<BoundarySolution, Error> {
        self.on_boundary(gap, true)
    }

    fn on_boundary(&self, gap: &[f64], is_bounded: bool) -> Result<BoundarySolution> {
        if self.problem.equality_rows() > 0 {
            return Ok(self.solve(gap)?.into());
        }
        let found = self.ask(gap, &self.start, |engine, task| {
            let Some(engine) = engine.factor() else { return Ok(None) };
            Ok(on_boundary(engine, task, is_bounded)?.map(|found| (engine.clone(), found)))
        });
        // The certificate of the whole answer shows what is wrong, unless the answer meets its goal.
        let Ok(Some((engine, (found, condensed_certificate)))) = found else { return Ok(self.solve(gap)?.into()) };
        let multiplier = engine.expand_multiplier(&found.outcome.multiplier, found.unit);
        let contact_set = engine.selection.expand_set(&found.outcome.contact_set);
        let (iterations, prepared) = (found.outcome.iterations, Box::new(self.starting_from(&contact_set)));
        let inside = Inside::Condensed { engine, found: Box::new(found), prepared, gap: gap.to_vec() };
        Ok(BoundarySolution { multiplier, contact_set, iterations, condensed_certificate, inside })
    }

    /// As [`Prepared::boundary`] at these gaps (one entry per row, in length), for one of many steps: only its
    /// conditions must meet the tolerance, which costs no triangular solve, unless the settings name an accuracy.
    ///
    /// # Errors
    /// As [`Prepared::boundary`].
    pub fn step(&self, gap: &[f64]) -> Result<BoundarySolution, Error> {
        self.on_boundary(gap, self.settings.accuracy.is_some())
    }

    /// The displacement (one entry per dof, in length) at these gaps (one per row, in length), without a certificate;
    /// `None` if the method did not settle on a set, or if its answer is only valid with a certificate.
    ///
    /// # Errors
    /// As [`Prepared::boundary`].
    pub fn settled(&self, gap: &[f64]) -> Result<Option<Vec<f64>>, Error> {
        self.ask(gap, &self.start, |engine, task| engine.factor().map_or(Ok(None), |engine| settled(engine, task)))
    }

    /// The displacement, one entry per dof, in length, that the load causes if no row is closed; `None` without a
    /// factor.
    pub fn response(&self) -> Option<Vec<f64>> {
        self.bench.as_ref().and_then(|bench| response(bench.engine.factor()?, &bench.load))
    }

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
pub fn between(from: &[f64], to: &[f64], t: f64) -> Vec<f64> {
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
        self.prepared.problem.of_inequalities(&self.engine.selection.expand_set(&piece.contact_set))
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
