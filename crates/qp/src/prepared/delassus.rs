//! A contact problem as a linear complementarity problem in its contact forces z = -lambda and the gaps w = g - B u.
//!
//! With motions R without energy, `u = K+ (f - B'z) + R a`, and the forces balance on each motion:
//!
//! ```text
//! [ w ]   [ B K+ B'  -B R ] [ z ]   [ g - B K+ f ]
//! [ 0 ] = [  R'B'      0  ] [ a ] + [   -R'f     ]
//! ```
//!
//! As many springs N as there are motions, if they hold all, give a generalised inverse `K+ = (K + N)^-1`, exactly. A
//! motion that K holds by no more than the rounding of its entries counts as one without energy.

use super::Prepared;
use crate::certificate::{Bounding, EnergyNorm};
use crate::cost::{Kept, check_memory};
use crate::error::{Error, LinearError, Result};
use crate::existence::Existence;
use crate::linear::memory;
use crate::linear::watch::Watch;
use crate::linear::{SparseMatrix, SymmetricMatrix, check_finite, dot, subtract};
use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::transform::{Elimination, RowSelection};

/// Corrections of a displacement by its residual in twice the working precision.
const CORRECTIONS: usize = 2;

/// A contact problem as a linear complementarity problem: find x = (z, a) between its bounds with (w, 0) = M x + q,
/// `w >= 0` and z'w = 0. Equalities are eliminated.
#[derive(Clone, Debug)]
pub struct Delassus {
    /// M, (m + r) x (m + r), for m rows and r motions: first the compliance of the rows, symmetric to the last bit, in
    /// length over force.
    pub matrix: SparseMatrix,
    /// q, length m + r: the gaps without contact, in length, and the work of the load on each motion, negative.
    pub offset: Vec<f64>,
    /// The lower bounds of x, length m + r, in force and in length: zero for z, `-inf` for a.
    pub lower: Vec<f64>,
    /// The upper bounds of x, length m + r, in force and in length: `+inf`.
    pub upper: Vec<f64>,
    /// The contact row of each z, length m, increasing: those that can close. Two opposed rows that are an equality are
    /// eliminated; equalities that cannot be are two rows each, after those of B.
    pub rows: Vec<usize>,
    /// The motions R, each of length n, dimensionless: one at a dof of its own.
    pub motions: Vec<Vec<f64>>,
    /// The rest without equalities, with springs.
    held: ContactProblem,
    norm: EnergyNorm,
    elimination: Option<Elimination>,
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
    /// assert_eq!(lcp.displacement(&[1.0])?, [1.0]);
    /// # Ok::<(), signorini_qp::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::TooLarge`] before M, which is dense, is made; [`Error::Infeasible`] and [`LinearError::NotConvex`] as
    /// [`solve`](crate::solve()); [`LinearError::Numerical`] for a stiffness that is not definite to working precision
    /// without a motion, or with more than 256; those of [`Prepared::new`].
    pub fn delassus(&self) -> Result<Delassus, Error> {
        let (problem, settings) = (&self.problem, &self.settings.started()?);
        problem.check_rows()?;
        let elimination = if problem.equalities().is_empty() { None } else { Elimination::of(problem)? };
        let rest = elimination.as_ref().map_or(Ok(problem.clone()), |elimination| elimination.problem(problem))?;
        let selection = RowSelection::of(&rest);
        let (contact, gap) = (selection.contact(rest.contact()), selection.gap(rest.gap()));
        // W, and L^-1 B' on the contact dofs.
        let (boundary, m) = (contact.columns_with_entries().len(), gap.len());
        let kept = Kept::Condensed { values: boundary * m, contact_dofs: m, by_interior_point: false };
        check_memory(&rest, kept, Some(memory::allowed(settings.memory)))?;
        let with = |stiffness| ContactProblem::computed(stiffness, rest.load().to_vec(), contact, gap);
        let at_hand = self.bench.as_ref().filter(|_| elimination.is_none()).map(|bench| &bench.engine);
        let (held, norm, springs) = match at_hand.map(|engine| engine.bounding(&Watch::default())) {
            Some(Bounding::Factor(norm)) => (with(rest.stiffness().clone())?, norm, Vec::new()),
            _ => {
                let failed = |reason| Error::from(LinearError::Numerical { step: "the Delassus operator", reason });
                let many = || failed("the stiffness has more than 256 motions, or leaves the range of doubles".into());
                let existence = Existence::of(&rest, settings)?.ok_or_else(many)?;
                let springs = existence.springs();
                let added = SparseMatrix::from_triplets(rest.dofs(), rest.dofs(), &springs)?;
                let held = with(rest.stiffness().combined(1.0, 1.0, &SymmetricMatrix::from_lower(added)?)?)?;
                let by_factor = Settings { method: Method::ActiveSet, ..settings.clone() };
                let bench = Self::for_gaps(&held, 1, &by_factor)?.bench;
                let Some(Bounding::Factor(norm)) = bench.as_ref().map(|bench| bench.engine.bounding(&Watch::default()))
                else {
                    return Err(failed("the stiffness is not safely definite".into()));
                };
                (held, norm, springs)
            }
        };
        let row = |&row: &usize| elimination.as_ref().map_or(row, |elimination| elimination.rows[row]);
        let rows = selection.kept.iter().map(row).collect();
        let (matrix, offset, motions) = (SparseMatrix::from_triplets(0, 0, &[])?, Vec::new(), Vec::new());
        let (mut lower, upper) = (vec![0.0; m], vec![f64::INFINITY; m + springs.len()]);
        lower.resize(upper.len(), f64::NEG_INFINITY);
        Delassus { matrix, offset, lower, upper, rows, motions, held, norm, elimination }.made(&springs)
    }
}

impl Delassus {
    /// The same with M, q and motions, for springs at these places of the diagonal.
    fn made(mut self, springs: &[(usize, usize, f64)]) -> Result<Self> {
        let (m, contact, load) = (self.rows.len(), self.held.contact(), self.held.load());
        let motion = |&(own, _, stiffness): &(usize, usize, f64)| {
            let load: Vec<f64> = (0..load.len()).map(|dof| if dof == own { stiffness } else { 0.0 }).collect();
            self.moved(&load, &vec![0.0; m])
        };
        let motions: Vec<Vec<f64>> = springs.iter().map(motion).collect::<Result<_>>()?;
        let (closing, below): (Vec<_>, _) = (motions.iter().map(|r| contact.mul(r)).collect(), self.compliance()?);
        let entry = |i: usize, j: usize| match (i < m, j < m) {
            (true, true) => below[i.min(j)][i.abs_diff(j)],
            (true, false) => -closing[j - m][i],
            (false, true) => closing[i - m][j],
            (false, false) => 0.0,
        };
        let size = self.lower.len();
        let table: Vec<f64> = (0..size * size).map(|place| entry(place / size, place % size)).collect();
        let free = self.held.accurate_violation(&self.moved(load, &vec![0.0; m])?);
        let works = motions.iter().map(|motion| dot(motion, load));
        self.offset = free.into_iter().chain(works).map(|value| -value).collect();
        self.matrix = SparseMatrix::from_table(size, size, &table)?;
        let whole = |motion: Vec<f64>| match &self.elimination {
            Some(elimination) => elimination.motion(&motion).into_iter().map(|value| value.rounded()).collect(),
            None => motion,
        };
        self.motions = motions.into_iter().map(whole).collect();
        Ok(self)
    }

    /// `K+ (f + B' lambda)` of the dofs that stay.
    fn moved(&self, load: &[f64], multiplier: &[f64]) -> Result<Vec<f64>> {
        let (loaded, mut u) = (self.held.with_load(load.to_vec())?, vec![0.0; load.len()]);
        for _ in 0..=CORRECTIONS {
            let correction = self.norm.displacement(&loaded.accurate_residual(&u, multiplier));
            u.iter_mut().zip(correction).for_each(|(u, change)| *u += change);
        }
        Ok(u)
    }

    /// The lower triangle of W, column by column.
    fn compliance(&self) -> Result<Vec<Vec<f64>>> {
        let (m, contact) = (self.rows.len(), self.held.contact());
        if let Some(entry) = self.norm.compliances(contact) {
            return Ok((0..m).map(|j| (j..m).map(|i| entry(i, j)).collect()).collect());
        }
        let column = |j: usize| {
            let pressed: Vec<f64> = (0..m).map(|i| f64::from(i == j)).collect();
            Ok(contact.mul(&self.moved(&vec![0.0; contact.columns()], &pressed)?).split_off(j))
        };
        (0..m).map(column).collect()
    }

    /// The displacement u of all dofs, length n, in length, of x = (z, a), length m + r, in force and in length:
    /// `K+ (f - B'z) + R a`.
    ///
    /// # Errors
    /// [`LinearError::Length`] and [`LinearError::NotFinite`] for an x that does not fit.
    pub fn displacement(&self, x: &[f64]) -> Result<Vec<f64>, Error> {
        check_finite("unknowns x", x, (self.offset.len(), "rows of M"))?;
        let (z, a) = x.split_at(self.rows.len());
        let u = self.moved(self.held.load(), &z.iter().map(|z| -z).collect::<Vec<_>>())?;
        let mut u = self.elimination.as_ref().map_or_else(|| u.clone(), |elimination| elimination.displacement(&u));
        a.iter().zip(&self.motions).for_each(|(a, motion)| subtract(&mut u, -a, motion));
        Ok(u)
    }
}
