//! The engine with a factor: everything that does not depend on load and gap is done once.

use std::sync::{Arc, OnceLock};

use crate::certificate::{Bounding, EnergyNorm};
use crate::cost::{bytes, check_time, seconds};
use crate::error::Result;
use crate::linear::watch::Watch;
use crate::linear::{Analysis, Augmented, Compliance, Equilibration, exponent, largest, ldexp};
use crate::plan::Tried;
use crate::problem::ContactProblem;
use crate::settings::Method;
use crate::solution::Seconds;
use crate::transform::{Condensation, RowSelection, Scaling};

/// Factorisations for one step of a loop if K is not definite by itself.
const SINGULAR: f64 = 3.0;

/// A contact problem, its rows selected, scaled, condensed if that pays, factorised.
#[derive(Debug)]
pub struct Factored {
    pub problem: ContactProblem,
    pub selection: RowSelection,
    pub scaling: Scaling,
    pub stiffest: f64,
    pub norm: Norm,
    pub condensation: Option<Condensation>,
    pub augmented: Augmented,
    /// Energy norm of the condensed stiffness, if it is definite, made at its first use.
    pub condensed_norm: OnceLock<Option<EnergyNorm>>,
    /// The method that the data were prepared for, and its unknowns.
    pub tried: Tried,
    /// Estimated seconds of the proof of the open and closed rows.
    pub proof_seconds: f64,
    /// Estimated seconds of the factorisation that a bound takes if the stiffness is not definite by itself.
    pub norm_seconds: f64,
    pub seconds: Seconds,
}

#[derive(Debug)]
pub enum Norm {
    /// The stiffness is not definite by itself.
    Missing,
    Kept(EnergyNorm),
    /// Memory is too short to keep the factor: it is made from this analysis at every use.
    Again(Analysis),
}

impl Factored {
    /// The method of an attempt, which may leave it to the rules.
    pub fn chosen(&self, method: Method) -> Method {
        if method == Method::Auto { self.tried.method } else { method }
    }

    pub fn bounding(&self, watch: &Watch) -> Bounding<'_> {
        let in_time = watch.allows(self.norm_seconds);
        // A norm that is made again takes the time of a factorisation too.
        match (self.is_norm_at_hand() || in_time).then(|| self.norm()).flatten() {
            Some(norm) => Bounding::Factor(norm.watched(watch)),
            None if in_time => Bounding::OwnFactor,
            None => Bounding::Nothing,
        }
    }

    pub fn bytes(&self) -> f64 {
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

    pub fn is_definite(&self) -> bool {
        !matches!(self.norm, Norm::Missing)
    }

    /// The compliance of the rows, if the norm has one: balances by it cost less than by factors of augmented matrices.
    pub fn compliance(&self) -> Option<&Compliance> {
        if let Norm::Kept(norm) = &self.norm { norm.compliance() } else { None }
    }

    /// Returns `true` if the energy norm costs no factorisation.
    pub fn is_norm_at_hand(&self) -> bool {
        !matches!(self.norm, Norm::Again(_))
    }

    /// The energy norm, if the stiffness is definite by itself; `None` also if there is no memory to make it again.
    pub fn norm(&self) -> Option<EnergyNorm> {
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

    /// The means of a certificate of the problem that the methods work on.
    pub fn condensed_bounding(&self, problem: &ContactProblem, watch: &Watch) -> Bounding<'static> {
        let norm = self.condensed_norm(problem).map(|norm| norm.watched(&watch.finishing()));
        norm.map_or(Bounding::OwnFactor, Bounding::Factor)
    }

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

    /// A watch that is over once no time is left for one more factorisation of a loop and the certificate.
    pub fn watch_of_loop(&self, method: Method, watch: &Watch) -> Result<Watch> {
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

/// A load, and its sweep through a factor once that has been used.
#[derive(Debug)]
pub struct Load {
    force: Vec<f64>,
    swept: OnceLock<Arc<Loading>>,
}

impl Load {
    pub fn new(force: Vec<f64>) -> Self {
        Load { force, swept: OnceLock::new() }
    }

    /// The load swept through a factor, by the first call in a unit that fits `gap`, the gaps of the selected rows.
    pub fn swept(&self, engine: &Factored, gap: &[f64]) -> Arc<Loading> {
        self.swept.get_or_init(|| Arc::new(Loading::of(engine, &self.force, gap))).clone()
    }
}

/// A load in all the forms in which a solve needs it.
#[derive(Clone, Debug)]
pub struct Loading {
    /// Exponent of the reference displacement of the fields below.
    pub unit: i32,
    /// Forward sweep of the scaled load, if the body is condensed.
    pub sweep: Vec<f64>,
    /// The scaled load on the dofs that the methods work on.
    scaled: Vec<f64>,
    /// The largest displacement that the load alone causes, once it has been asked for.
    free: OnceLock<Option<f64>>,
    /// The load over the stiffness.
    statics: f64,
}

impl Loading {
    /// Scales `load` (length n) in a unit that fits it and `gap`, the gaps of the selected rows, and sweeps it.
    pub fn of(engine: &Factored, load: &[f64], gap: &[f64]) -> Self {
        let stiffness = engine.stiffest;
        let statics = if stiffness > 0.0 { largest(load) / stiffness } else { 0.0 };
        let unit = exponent(largest(gap).max(statics));
        let scaled = engine.scaling.load(load, unit);
        let (sweep, scaled) = match &engine.condensation {
            Some(condensed) => {
                let sweep = condensed.sweep(&scaled);
                let condensed = condensed.load(&sweep);
                (sweep, condensed)
            }
            None => (Vec::new(), scaled),
        };
        Loading { unit, sweep, scaled, free: OnceLock::new(), statics }
    }

    /// The largest displacement that the load alone causes, if the stiffness is definite and its factor is at hand.
    fn free(&self, engine: &Factored) -> Option<f64> {
        *self.free.get_or_init(|| {
            let moved = match &engine.condensation {
                Some(condensed) => engine.is_definite().then(|| condensed.free_displacement(&self.sweep)),
                None if engine.is_norm_at_hand() => {
                    engine.norm().map(|norm| norm.equilibrated().displacement(&self.scaled))
                }
                None => None,
            };
            moved.map(|moved| ldexp(largest(&moved), self.unit))
        })
    }

    /// The load together with a force (length n) on contact dofs alone, which needs no sweep.
    pub fn with_contact_force(mut self, engine: &Factored, force: &[f64]) -> Self {
        if let Some(condensed) = &engine.condensation {
            let scaled = engine.scaling.load(force, self.unit);
            self.scaled.iter_mut().zip(&condensed.contact_dofs).for_each(|(entry, &dof)| *entry += scaled[dof]);
        }
        self
    }

    /// The exponent of the reference displacement with the gaps of the selected rows.
    ///
    /// If the stiffness is definite, the reference displacement is the larger of what the load alone causes and what
    /// the obstacle enforces. It is at most the larger of the gaps and the load over the stiffness, because on a soft
    /// support the free body would move far. The load over the stiffness moves the body about as far at least, so that
    /// smaller gaps need no solve.
    pub fn unit_with(&self, engine: &Factored, gap: &[f64]) -> i32 {
        let local = largest(gap).max(self.statics);
        let enforced = gap.iter().fold(0.0, |enforced: f64, gap| enforced.max(-gap));
        let free = if local > self.statics { self.free(engine) } else { None };
        match free.map(|free| free.max(enforced)) {
            Some(reach) if reach > 0.0 && reach < local => exponent(reach),
            _ => exponent(local),
        }
    }

    /// The load on the dofs that the methods work on, for u0 = `2^unit`.
    pub fn scaled(&self, unit: i32) -> Vec<f64> {
        self.scaled.iter().map(|&value| ldexp(value, self.unit - unit)).collect()
    }

    pub fn expand(&self, engine: &Factored, unit: i32, displacement: &[f64]) -> Vec<f64> {
        match &engine.condensation {
            Some(condensed) => {
                // In the unit of the sweep.
                let moved: Vec<f64> = displacement.iter().map(|&v| ldexp(v, unit - self.unit)).collect();
                engine.scaling.expand_displacement(&condensed.expand(&self.sweep, &moved), self.unit)
            }
            None => engine.scaling.expand_displacement(displacement, unit),
        }
    }

    /// The share of the energy norm of a condensed displacement, of the square `on_boundary`, in that of the body.
    pub fn share_of_boundary(&self, engine: &Factored, unit: i32, on_boundary: f64) -> f64 {
        let Some(condensed) = &engine.condensation else { return 1.0 };
        let interior = ldexp(condensed.interior_energy(&self.sweep), 2 * (self.unit - unit));
        if interior > 0.0 { (on_boundary / (on_boundary + interior)).max(0.0).sqrt() } else { 1.0 }
    }
}
