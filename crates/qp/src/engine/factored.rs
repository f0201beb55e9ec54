//! The engine with a factor: everything that does not depend on load and gap is done once.

use std::sync::OnceLock;

use crate::certificate::{Bounding, EnergyNorm};
use crate::cost::{bytes, check_time, seconds};
use crate::error::Error;
use crate::linear::watch::Watch;
use crate::linear::{Analysis, Augmented, Compliance, Equilibration};
use crate::plan::Tried;
use crate::problem::ContactProblem;
use crate::settings::Method;
use crate::solution::{ContactSet, Seconds};
use crate::transform::{Condensation, RowSelection, Scaling};

/// Factorisations for one step of a loop if K is not definite by itself.
const SINGULAR: f64 = 3.0;

/// A contact problem, its rows selected, scaled, condensed if that pays, factorised.
#[derive(Debug)]
pub(crate) struct Factored {
    pub(super) problem: ContactProblem,
    pub(super) selection: RowSelection,
    pub(super) scaling: Scaling,
    /// The largest diagonal entry of the stiffness.
    pub(super) stiffest: f64,
    pub(super) norm: Norm,
    pub(super) condensation: Option<Condensation>,
    pub(super) augmented: Augmented,
    /// Energy norm of the condensed stiffness, if it is definite, made at its first use.
    pub(super) condensed_norm: OnceLock<Option<EnergyNorm>>,
    /// The method that the data were prepared for, and its unknowns.
    pub(super) tried: Tried,
    /// Estimated seconds of the proof of the open and closed rows.
    pub(super) proof_seconds: f64,
    /// Estimated seconds of the factorisation that a bound takes if the stiffness is not definite by itself.
    pub(super) norm_seconds: f64,
    pub(super) seconds: Seconds,
}

#[derive(Debug)]
pub(super) enum Norm {
    /// The stiffness is not definite by itself.
    Missing,
    Kept(EnergyNorm),
    /// Memory is too short to keep the factor: it is made from this analysis at every use.
    Again(Analysis),
}

impl Factored {
    /// The method of an attempt, which may leave it to the rules.
    pub(super) fn chosen(&self, method: Method) -> Method {
        if method == Method::Auto { self.tried.method } else { method }
    }

    pub(super) fn tried(&self, method: Method) -> Tried {
        Tried { method: self.chosen(method), ..self.tried }
    }

    pub(super) fn bounding(&self, watch: &Watch) -> Bounding<'_> {
        let in_time = watch.allows(self.norm_seconds);
        // A norm that is made again takes the time of a factorisation too.
        let norm = if self.is_norm_at_hand() || watch.allows(self.norm_seconds) { self.norm() } else { None };
        match norm {
            Some(norm) => Bounding::Factor(norm.watched(watch)),
            None if in_time => Bounding::OwnFactor,
            None => Bounding::Nothing,
        }
    }

    pub(super) fn bytes(&self) -> f64 {
        let of_factor = |values: usize| bytes::of_factor(values as f64);
        match (&self.condensation, self.compliance()) {
            (Some(condensed), _) => {
                let dofs = condensed.stiffness.dim();
                of_factor(condensed.factor_entries()) + bytes::of_dense(dofs as f64)
            }
            (None, Some(compliance)) => compliance.bytes(),
            (None, None) => of_factor(self.augmented.matrix().map_or(0, |matrix| matrix.analysis().factor_entries())),
        }
    }

    /// Values of the factor; zero if the methods factorise by themselves.
    pub fn factor_entries(&self) -> usize {
        self.condensation.as_ref().map_or(0, Condensation::factor_entries)
    }

    pub(super) fn is_definite(&self) -> bool {
        !matches!(self.norm, Norm::Missing)
    }

    /// The compliance of the rows, if the energy norm has one: balances by it then cost less than by factors of the
    /// augmented matrix.
    pub(super) fn compliance(&self) -> Option<&Compliance> {
        if let Norm::Kept(norm) = &self.norm { norm.compliance() } else { None }
    }

    /// Returns `true` if the energy norm costs no factorisation.
    pub(super) fn is_norm_at_hand(&self) -> bool {
        !matches!(self.norm, Norm::Again(_))
    }

    /// The energy norm, if the stiffness is definite by itself; `None` also if there is no memory to make it again.
    pub(super) fn norm(&self) -> Option<EnergyNorm> {
        match &self.norm {
            Norm::Missing => None,
            Norm::Kept(norm) => Some(norm.clone()),
            Norm::Again(analysis) => {
                let factor = analysis.factor(self.scaling.stiffness()).ok()?;
                Some(EnergyNorm::new(factor, self.scaling.equilibration.clone(), Vec::new()))
            }
        }
    }

    pub fn expand_multiplier(&self, multiplier: &[f64], unit: i32) -> Vec<f64> {
        self.selection.expand_multiplier(&self.scaling.expand_multiplier(multiplier, unit))
    }

    pub fn expand_set(&self, set: &ContactSet) -> ContactSet {
        self.selection.expand_set(set)
    }

    /// The means of a certificate of the problem that the methods work on.
    pub(super) fn condensed_bounding(&self, problem: &ContactProblem, watch: &Watch) -> Bounding<'static> {
        let norm = self.condensed_norm(problem).map(|norm| norm.watched(&watch.finishing()));
        norm.map_or(Bounding::OwnFactor, Bounding::Factor)
    }

    /// The energy norm of the problem that the methods work on.
    fn condensed_norm(&self, problem: &ContactProblem) -> Option<EnergyNorm> {
        if self.condensation.is_none() || !self.is_definite() {
            return self.norm().map(|norm| norm.equilibrated());
        }
        let of_boundary = || {
            let augmented = self.augmented.matrix().ok()?;
            let factor = augmented.factor(augmented.matrix(|_| 0.0, 0.0)).ok()?;
            Some(EnergyNorm::new(factor, Equilibration::none(problem.dofs()), (0..problem.dofs()).collect()))
        };
        self.condensed_norm.get_or_init(of_boundary).clone()
    }

    /// A watch that is over as soon as there is no time left for one more factorisation of a loop and for the
    /// certificate.
    pub(super) fn watch_of_loop(&self, method: Method, watch: &Watch) -> Result<Watch, Error> {
        if watch.time_left().is_none() {
            return Ok(watch.clone());
        }
        let analysis = self.augmented.matrix()?.analysis();
        // If K is not definite, the start and the test of uniqueness factorise too.
        let factors = if self.is_definite() { 1.0 } else { SINGULAR };
        let of_loop = factors * seconds::factorisation(analysis);
        let (first, each) = match method {
            Method::Qp(_) => (2.0 * seconds::interior_point(analysis), seconds::interior_point(analysis).max(of_loop)),
            _ => (of_loop, of_loop),
        };
        check_time(watch, first)?;
        Ok(watch.keeping(each + seconds::certificate(&self.problem)))
    }
}
