//! A contact problem as a linear complementarity problem in its contact forces z = -lambda and the gaps w = g - B u.
//!
//! A definite K gives `w = W z + g - B K^-1 f` with the Delassus operator `W = B K^-1 B'`. With motions R without energy,
//! `u = K+ (f - B'z) + R a`, and the forces balance on the motions:
//!
//! ```text
//! [ w ]   [ W     -B R ] [ z ]   [ g - B K+ f ]
//! [ 0 ] = [ R'B'    0  ] [ a ] + [   -R'f     ]
//! ```
//!
//! As many springs N as there are motions, if they hold all, give a generalised inverse `K+ = (K + N)^-1`, exactly.

use super::reuse::Prepared;
use crate::certificate::{Bounding, EnergyNorm};
use crate::cost::{Kept, check_memory};
use crate::error::Error;
use crate::existence::Existence;
use crate::linear::{SparseMatrix, dot};
use crate::memory;
use crate::problem::ContactProblem;
use crate::run::solve_any;
use crate::settings::{Method, Settings};
use crate::transform::{Elimination, RowSelection};
use crate::watch::Watch;

/// Corrections of a displacement by its residual in twice the working precision.
const CORRECTIONS: usize = 2;

/// A contact problem as a linear complementarity problem: find x = (z, a) between its bounds with (w, 0) = M x + q,
/// `w >= 0` and z'w = 0. Equalities are eliminated.
#[derive(Clone, Debug)]
pub struct Delassus {
    /// M, (m + r) x (m + r): the compliance W of m contact rows, symmetric to the last bit, in length over force; with r
    /// motions without energy a monotone matrix.
    pub matrix: SparseMatrix,
    /// q, length m + r: the gaps of the body without contact, in length, then the work of the load on each motion,
    /// negative.
    pub offset: Vec<f64>,
    /// The lower bounds of x, length m + r: zero for forces z, `-inf` for a.
    pub lower: Vec<f64>,
    /// The upper bounds of x, length m + r: `+inf`.
    pub upper: Vec<f64>,
    /// The contact row of each z, length m, increasing: all rows that can close, except for pairs that are equalities.
    /// Equalities that cannot be eliminated are two rows each, in the order of [`ContactProblem::gap`].
    pub rows: Vec<usize>,
    /// The motions R, each of length n, dimensionless: one at one dof that stays, zero at those of the others.
    pub motions: Vec<Vec<f64>>,
    inverse: Inverse,
    load: Vec<f64>,
    /// R in the dofs that stay.
    staying: Vec<Vec<f64>>,
    elimination: Option<Elimination>,
}

/// A generalised inverse of the stiffness.
#[derive(Clone, Debug)]
struct Inverse {
    /// The stiffness with its springs, and the rows, without load and gap.
    held: ContactProblem,
    norm: EnergyNorm,
    /// The dofs with a spring, and its stiffness.
    springs: Vec<(usize, f64)>,
}

impl Prepared {
    /// The problem at its load and gaps as a linear complementarity problem in its contact forces.
    ///
    /// ```
    /// use signorini_qp::{ContactProblem, Prepared, Settings, SparseMatrix, SymmetricMatrix};
    ///
    /// // A spring of stiffness 2, pushed with force 3 towards a wall at distance 1: w = 1/2 z + 1 - 3/2.
    /// let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]);
    /// let problem = ContactProblem::new(SymmetricMatrix::from_lower(one(2.0)?)?, vec![3.0], one(1.0)?, vec![1.0])?;
    /// let lcp = Prepared::new(&problem, &Settings::default())?.delassus()?;
    /// assert_eq!((&lcp.matrix, &lcp.offset[..]), (&one(0.5)?, &[-0.5][..]));
    /// // z = 1 gives w = 0, and the displacement of the wall.
    /// assert_eq!(lcp.displacement(&[1.0])?, [1.0]);
    /// # Ok::<(), signorini_qp::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::TooLarge`] before M, which is dense, is made; [`Error::Infeasible`] and [`Error::NotConvex`] as
    /// [`solve`](crate::solve()); [`Error::Numerical`] for a stiffness that is singular only within rounding, or with
    /// more than 256 motions; those of [`Prepared::new`].
    pub fn delassus(&self) -> Result<Delassus, Error> {
        let (problem, settings) = (&self.problem, &self.settings.started()?);
        problem.check_rows()?;
        let elimination = if problem.equalities().is_empty() { None } else { Elimination::of(problem)? };
        let rest = match &elimination {
            Some(elimination) => elimination.problem(problem)?,
            None => problem.clone(),
        };
        let selection = RowSelection::of(&rest);
        let (contact, gap) = (selection.contact(rest.contact()), selection.gap(rest.gap()));
        let kept = Kept::Compliance { boundary: contact.columns_with_entries().len(), rows: gap.len() };
        check_memory(&rest, kept, Some(memory::allowed(settings.memory)))?;
        let at_hand = self.bench.as_ref().filter(|_| elimination.is_none()).map(|bench| &bench.engine);
        let inverse = match at_hand.map(|engine| engine.bounding(&Watch::default())) {
            Some(Bounding::Factor(norm)) => {
                let (load, gap) = (vec![0.0; rest.dofs()], vec![0.0; gap.len()]);
                let held = ContactProblem::computed(rest.stiffness().clone(), load, contact, gap)?;
                Inverse { held, norm, springs: Vec::new() }
            }
            _ => Inverse::of(&rest, contact, settings)?,
        };
        let rows = elimination.as_ref().map_or(selection.kept().to_vec(), |elimination| {
            selection.kept().iter().map(|&row| elimination.rows()[row]).collect()
        });
        Delassus::of(inverse, rest.load().to_vec(), &gap, rows, elimination)
    }
}

impl Inverse {
    fn of(rest: &ContactProblem, contact: SparseMatrix, settings: &Settings) -> Result<Self, Error> {
        let failed = |reason: String| Error::Numerical { step: "the Delassus operator", reason };
        let many =
            || failed("the stiffness has more than 256 motions without energy, or leaves the range of doubles".into());
        let existence = Existence::of(rest, settings, solve_any)?.ok_or_else(many)?;
        let springs = existence.springs();
        let (dofs, rows) = (rest.dofs(), contact.rows());
        let places: Vec<_> = springs.iter().enumerate().map(|(motion, spring)| (motion, spring.0, 1.0)).collect();
        let weights: Vec<f64> = springs.iter().map(|spring| spring.1).collect();
        let places = SparseMatrix::from_triplets(springs.len(), dofs, &places)?;
        let stiffness = rest.stiffness().plus_squares(&places, &weights)?;
        let held = ContactProblem::computed(stiffness, vec![0.0; dofs], contact, vec![0.0; rows])?;
        let by_factor = Settings { method: Method::ActiveSet, ..settings.clone() };
        let prepared = Prepared::for_gaps(&held, 1, &by_factor)?;
        match prepared.bench.as_ref().map(|bench| bench.engine.bounding(&Watch::default())) {
            Some(Bounding::Factor(norm)) => Ok(Inverse { held, norm, springs }),
            _ => Err(failed(existence.doubt().unwrap_or("the stiffness is not definite to working precision".into()))),
        }
    }

    /// `K+ (f + B' lambda)`, length n.
    fn displacement(&self, load: Vec<f64>, multiplier: &[f64]) -> Result<Vec<f64>, Error> {
        let (loaded, mut u) = (self.held.with_load(load)?, vec![0.0; self.held.dofs()]);
        for _ in 0..=CORRECTIONS {
            let correction = self.norm.displacement(&loaded.accurate_residual(&u, multiplier));
            u.iter_mut().zip(correction).for_each(|(u, change)| *u += change);
        }
        Ok(u)
    }

    /// The lower triangle of W, column by column.
    fn compliance(&self) -> Result<Vec<Vec<f64>>, Error> {
        let contact = self.held.contact();
        if let Some(entry) = self.norm.compliances(contact) {
            return Ok((0..contact.rows()).map(|j| (j..contact.rows()).map(|i| entry(i, j)).collect()).collect());
        }
        let column = |row: usize| {
            let mut force = vec![0.0; contact.rows()];
            force[row] = 1.0;
            Ok(contact.mul(&self.displacement(vec![0.0; contact.columns()], &force)?).split_off(row))
        };
        (0..contact.rows()).map(column).collect()
    }
}

impl Delassus {
    fn of(
        inverse: Inverse,
        load: Vec<f64>,
        gap: &[f64],
        rows: Vec<usize>,
        elimination: Option<Elimination>,
    ) -> Result<Self, Error> {
        let (m, contact) = (rows.len(), inverse.held.contact());
        let motion = |&(dof, stiffness): &(usize, f64)| {
            let mut force = vec![0.0; load.len()];
            force[dof] = stiffness;
            inverse.displacement(force, &vec![0.0; m])
        };
        let staying: Vec<Vec<f64>> = inverse.springs.iter().map(motion).collect::<Result<_, Error>>()?;
        let (closing, compliance): (Vec<_>, _) =
            (staying.iter().map(|r| contact.mul(r)).collect(), inverse.compliance()?);
        let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
        let mut column = |entries: &mut dyn Iterator<Item = f64>| {
            for (place, value) in entries.enumerate().filter(|entry| entry.1 != 0.0) {
                places.push(place);
                values.push(value);
            }
            starts.push(values.len());
        };
        for j in 0..m {
            let above = compliance[..j].iter().enumerate().map(|(i, of_row)| of_row[j - i]);
            column(&mut above.chain(compliance[j].iter().copied()).chain(closing.iter().map(|r| r[j])));
        }
        closing.iter().for_each(|of_motion| column(&mut of_motion.iter().map(|value| -value)));
        let size = m + staying.len();
        let matrix = SparseMatrix::from_csc(size, starts, places, values)?;
        let free = inverse.displacement(load.clone(), &vec![0.0; m])?;
        let violation = inverse.held.with_gap(gap.to_vec())?.accurate_violation(&free);
        let offset = violation.into_iter().chain(staying.iter().map(|motion| dot(motion, &load))).map(|v| -v).collect();
        let lower = (0..size).map(|place| if place < m { 0.0 } else { f64::NEG_INFINITY }).collect();
        let whole = |motion: &Vec<f64>| match &elimination {
            Some(elimination) => elimination.motion(motion).into_iter().map(|value| value.rounded()).collect(),
            None => motion.clone(),
        };
        let (upper, motions) = (vec![f64::INFINITY; size], staying.iter().map(whole).collect());
        Ok(Delassus { matrix, offset, lower, upper, rows, motions, inverse, load, staying, elimination })
    }

    /// The displacement u of all dofs, length n, in length, of x = (z, a), length m + r, in force and in length:
    /// `K+ (f - B'z) + R a`.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::NotFinite`] for an x that does not fit.
    pub fn displacement(&self, x: &[f64]) -> Result<Vec<f64>, Error> {
        Error::check_length("unknowns x", x.len(), self.offset.len(), "rows of M")?;
        if let Some((at, &value)) = x.iter().enumerate().find(|entry| !entry.1.is_finite()) {
            return Err(Error::NotFinite { name: "unknowns x", at: at.to_string(), value, allowed: "finite" });
        }
        let (z, a) = x.split_at(self.rows.len());
        let multiplier: Vec<f64> = z.iter().map(|z| -z).collect();
        let mut u = self.inverse.displacement(self.load.clone(), &multiplier)?;
        for (a, motion) in a.iter().zip(&self.staying) {
            u.iter_mut().zip(motion).for_each(|(u, r)| *u += a * r);
        }
        Ok(self.elimination.as_ref().map_or_else(|| u.clone(), |elimination| elimination.displacement(&u)))
    }
}
