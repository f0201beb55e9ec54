//! The answer on the contact boundary alone: contact set, multipliers and forces, without the displacement of the body.

use std::sync::Arc;

use super::reuse::Prepared;
use crate::engine::{Factored, Reduced, displacement, on_boundary, response, settled};
use crate::error::Error;
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

/// The means to compute the answer inside the body.
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

    fn on_boundary(&self, gap: &[f64], is_bounded: bool) -> Result<BoundarySolution, Error> {
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
        let contact_set = engine.expand_set(&found.outcome.contact_set);
        let (iterations, prepared) = (found.outcome.iterations, Box::new(self.starting_from(&contact_set)));
        let inside = Inside::Condensed { engine, found: Box::new(found), prepared, gap: gap.to_vec() };
        Ok(BoundarySolution { multiplier, contact_set, iterations, condensed_certificate, inside })
    }
}

/// The functions that a motion calls in every step.
impl Prepared {
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
}
