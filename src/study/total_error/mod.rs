//! The mesh refined until the error against the continuum is small enough: guaranteed in the plane, estimated elsewhere.

mod estimated;
mod goal;
mod guaranteed;

pub(crate) use estimated::{Estimated, EstimatedLevel};
pub(crate) use goal::{Ended, TotalErrorGoal};
pub(crate) use guaranteed::{Domain, Keep, TotalError, TotalErrorLevel, half_width};
pub use guaranteed::{Examined, examined};

use std::sync::Arc;

use crate::error::Error;
use crate::qp::Settings;
use crate::scene::{Model, Scene};

/// An answer and its total error.
pub(crate) enum Found {
    /// A proven bound.
    Guaranteed(Box<TotalError>),
    /// An estimate.
    Estimated(Box<Estimated>),
}

/// Refines the mesh of a scene, given with its model, until its total error is small enough, or time or memory end. `keep` is called
/// with what was found after each mesh that has a guaranteed bound, but not after the last.
///
/// # Errors
/// [`Error::Scene`] for a scene without an answer in the continuum, and for a bound of the force without a guarantee; those of
/// [`crate::solve`] on the first mesh.
pub(crate) fn total_error(
    scene: &Scene,
    model: &Arc<Model>,
    goal: TotalErrorGoal,
    settings: &Settings,
    keep: Keep,
) -> Result<Found, Error> {
    scene.check_continuum()?;
    match scene.plane_problem(model) {
        Ok((problem, mesh)) => {
            let found = guaranteed::total_error(scene, &problem, mesh, model, goal, settings, keep)?;
            Ok(Found::Guaranteed(Box::new(found)))
        }
        Err(Error::Scene { path, message }) if goal.force_error.is_some() => {
            let message = format!("{message}; without it the force has no bound: leave out --force-error");
            Err(Error::Scene { path, message })
        }
        Err(Error::Scene { path, message }) => {
            let found = estimated::total_error(scene, model, goal, format!("{path}: {message}"), settings)?;
            Ok(Found::Estimated(Box::new(found)))
        }
        Err(other) => Err(other),
    }
}
