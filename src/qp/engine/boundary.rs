//! The answer on the contact boundary alone: contact set, multipliers and forces, without the displacement of the body.

use std::sync::Arc;

use super::factored::Factored;
use super::found::Found;
use crate::error::Error;
use crate::qp::settings::Settings;
use crate::solution::{Certificate, ContactSet, Solution};

/// What a prepared problem says of its contact boundary at some gap and load.
///
/// The multipliers are those of the whole answer. Nothing in it costs a sweep through the factor of the body, unless it
/// is asked for: [`displacement`](Self::displacement) takes one, [`solution`](Self::solution) two.
#[derive(Clone, Debug)]
pub struct BoundarySolution {
    /// Contact multiplier lambda, one entry per contact row, in the problem's unit of force, `<= 0` in compression.
    pub multiplier: Vec<f64>,
    /// The closed rows.
    pub contact_set: ContactSet,
    /// Iterations of the method.
    pub iterations: usize,
    /// The certificate of the *condensed* problem, in its dimensionless units: its conditions are recomputed from the
    /// condensed stiffness, load and rows, not from the problem itself. That takes the displacement of the body.
    pub condensed_certificate: Certificate,
    body: Body,
}

/// What is known of the body inside.
#[derive(Clone, Debug)]
enum Body {
    /// What the whole answer can be made of.
    Reduced(Arc<Factored>, Box<Found>, Settings),
    /// The whole answer.
    Whole(Box<Solution>),
}

impl BoundarySolution {
    /// What was found with a factor and certified there.
    pub(super) fn on(engine: Arc<Factored>, on_boundary: (Found, Certificate), settings: &Settings) -> Self {
        let (found, condensed_certificate) = on_boundary;
        BoundarySolution {
            multiplier: engine.expand_multiplier(&found.outcome.multiplier, found.unit),
            contact_set: engine.expand_set(&found.outcome.contact_set),
            iterations: found.outcome.iterations,
            condensed_certificate,
            body: Body::Reduced(engine, Box::new(found), settings.clone()),
        }
    }

    /// Total contact force `-sum(lambda)`, `>= 0`, in the problem's unit of force.
    pub fn contact_force(&self) -> f64 {
        -self.multiplier.iter().sum::<f64>()
    }

    /// The displacement u of the whole body, one entry per dof, in the problem's unit of length; not certified.
    pub fn displacement(&self) -> Vec<f64> {
        match &self.body {
            Body::Reduced(engine, found, _) => engine.displacement(found),
            Body::Whole(solution) => solution.displacement.clone(),
        }
    }

    /// The whole answer, with the certificate of the problem itself.
    ///
    /// # Errors
    /// [`Error::NotCertified`] and [`Error::Infeasible`], as [`solve`](crate::solve()).
    pub fn solution(self) -> Result<Solution, Error> {
        match self.body {
            Body::Reduced(engine, found, settings) => engine.best(*found, &settings).map(|best| best.1),
            Body::Whole(solution) => Ok(*solution),
        }
    }
}

impl From<Solution> for BoundarySolution {
    /// The boundary of an answer that was not condensed.
    fn from(solution: Solution) -> Self {
        BoundarySolution {
            multiplier: solution.multiplier.clone(),
            contact_set: solution.contact_set.clone(),
            iterations: solution.iterations,
            condensed_certificate: solution.certificate,
            body: Body::Whole(Box::new(solution)),
        }
    }
}

impl Factored {
    /// What was found, with the certificate of the condensed problem: its conditions recomputed there, and its error bound where
    /// it is `bounded`.
    pub fn on_boundary(&self, found: Found, settings: &Settings, bounded: bool) -> Result<(Found, Certificate), Error> {
        let on_boundary = |found: &Found| -> Result<Certificate, Error> {
            let Found { problem, outcome, .. } = found;
            match if bounded { self.condensed_norm(problem)? } else { None } {
                None if bounded => problem.certify(&outcome.displacement, &outcome.multiplier),
                norm => problem.certify_in(norm, &outcome.displacement, &outcome.multiplier),
            }
        };
        if self.is_single() {
            // The condensed problem is that of the last step only.
            let (found, solution) = self.best(found, settings)?;
            return Ok((found, solution.certificate));
        }
        let certificate = on_boundary(&found)?;
        let is_met = match bounded {
            true => settings.goal().is_met_by(&certificate),
            false => certificate.conditions_hold(settings.tolerance),
        };
        if is_met {
            return Ok((found, certificate));
        }
        // The certificate of the whole answer tells what is wrong, unless it knows better.
        let found = self.best(found, settings)?.0;
        let certificate = on_boundary(&found)?;
        Ok((found, certificate))
    }
}
