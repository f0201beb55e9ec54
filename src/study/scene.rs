//! Answers to a scene: its summary, and a sweep over the scene-wide gap.

use std::time::Instant;

use serde::Serialize;

use super::{ModelSize, Summary};
use crate::error::Error;
use crate::formulation::Formulation;
use crate::scene::Model;
use crate::solution::{ContactSet, Solution};
use crate::solve::{Settings, solve};

/// The numbers of an answer to a scene: with pressures, the width of the contact, and the balance of all forces.
///
/// # Errors
/// [`Error::Length`] where the answer is not one to this model.
pub fn scene_summary(
    model: &Model,
    solution: &Solution,
    tolerance: f64,
    assemble_seconds: f64,
) -> Result<Summary, Error> {
    let mesh = model.mesh();
    let size = ModelSize {
        nodes: Some(mesh.nodes().len()),
        elements: Some(mesh.element_count()),
        ..ModelSize::of(model.problem())
    };
    let mut summary = Summary::new(solution, size, tolerance, assemble_seconds);
    let pressure = model.pressure(&solution.multiplier)?;
    summary.contact.pressure_max = Some(pressure.iter().copied().fold(0.0, f64::max));
    summary.contact.width = contact_width(model, &solution.contact_set);
    summary.contact.area = Some(contact_area(model, &solution.contact_set));
    summary.contact.force_balance = Some(model.force_balance(&solution.displacement, &solution.multiplier)?);
    Ok(summary)
}

/// Area of the boundary that the closed rows stand for; thickness, cross-section or circumference included.
pub fn contact_area(model: &Model, closed: &ContactSet) -> f64 {
    closed.iter().filter_map(|row| model.rows().get(row)).map(|row| row.tributary_area).sum()
}

/// Length of the boundary that the closed rows stand for, in the unit of length, where the model has a thickness.
pub fn contact_width(model: &Model, closed: &ContactSet) -> Option<f64> {
    match *model.body().formulation() {
        Formulation::PlaneStrain { thickness } | Formulation::PlaneStress { thickness } => {
            Some(contact_area(model, closed) / thickness)
        }
        _ => None,
    }
}

/// One gap of a sweep.
#[derive(Clone, Debug, Serialize)]
pub struct SweepPoint {
    /// The scene-wide gap.
    pub gap: f64,
    /// The numbers of the answer.
    #[serde(flatten)]
    pub summary: Summary,
    /// The scene at this gap.
    #[serde(skip)]
    pub model: Model,
    /// The answer.
    #[serde(skip)]
    pub solution: Solution,
}

/// Solves a scene at every one of `gaps`; an answer that is not certified is an answer here.
///
/// # Errors
/// As [`Model::with_gap`] and [`solve`].
pub fn sweep(model: &Model, gaps: &[f64], settings: &Settings) -> Result<Vec<SweepPoint>, Error> {
    let point = |&gap: &f64| {
        let clock = Instant::now();
        let model = model.with_gap(gap)?;
        let assemble_seconds = clock.elapsed().as_secs_f64();
        let solution = match solve(model.problem(), settings) {
            Ok(solution) => solution,
            Err(Error::NotCertified { solution, .. }) => *solution,
            Err(error) => return Err(model.explain(error)),
        };
        let summary = scene_summary(&model, &solution, settings.tolerance, assemble_seconds)?;
        Ok(SweepPoint { gap, summary, model, solution })
    };
    gaps.iter().map(point).collect()
}

/// `count` gaps from `first` to `last`, both included.
pub fn even_gaps(first: f64, last: f64, count: usize) -> Vec<f64> {
    let share = |i: usize| i as f64 / (count.max(2) - 1) as f64;
    (0..count).map(|i| first * (1.0 - share(i)) + last * share(i)).collect()
}
