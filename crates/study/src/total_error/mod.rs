//! The mesh refined until the error against the continuum is small enough: guaranteed if the scene has a guarantee,
//! else estimated.

mod continuum;
mod estimated;
mod found;
mod guaranteed;

pub use found::{Bound, Domain, Ended, Guarantee, JudgedMesh, Level, LevelKind, TotalError, TotalErrorGoal};
pub use guaranteed::Examined;
pub use signorini_guarantee::ContinuumAnswer;

use std::sync::Arc;
use std::time::Instant;

use signorini_qp::{Settings, Solution};

use crate::Status;
use continuum::{NoGuarantee, WhyNot};
use found::Asked;
use signorini_mechanics::Error;
use signorini_mechanics::scene::{Answer, Model, Scene};

/// Refines the mesh of a scene until its total error is at most `goal`, as with the default settings.
///
/// ```
/// use signorini_mechanics::Scene;
///
/// let scene = Scene::from_json(
///     r#"{
///         "model": "plane-strain",
///         "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [2]}, "y": {"points": [0, 1], "divisions": [2]}}},
///         "material": {"young": 1, "poisson": 0.3},
///         "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
///         "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0.5, 0.95], "radius": 1}}}]
///     }"#,
///     "block",
/// )?;
/// let found = signorini_study::total_error(&scene, 0.2)?;
/// assert!(found.total_error.guaranteed && found.total_error.bound <= 0.2);
/// # Ok::<(), signorini_mechanics::Error>(())
/// ```
///
/// # Errors
/// [`signorini_qp::LinearError::Setting`] for a goal out of its range, [`Error::Scene`] for a scene without an answer
/// in the continuum; those of [`Scene::build`] and of [`signorini_qp::solve`] on the first mesh.
pub fn total_error(scene: &Scene, goal: impl Into<TotalErrorGoal>) -> Result<TotalError, Error> {
    let model = Arc::new(scene.build()?);
    TotalError::search(scene, &model, goal.into(), &Settings::default(), &|_| {}).map_err(|error| model.explain(error))
}

impl TotalError {
    /// Refines the mesh of a scene, given with its model, until its total error is small enough, or time or memory end.
    /// `keep` is called with what was found after each mesh but the last; errors are those of [`total_error`].
    pub fn search(
        scene: &Scene,
        model: &Arc<Model>,
        goal: TotalErrorGoal,
        settings: &Settings,
        keep: &dyn Fn(&TotalError),
    ) -> Result<Self, Error> {
        goal.check()?;
        continuum::check(scene)?;
        let search = Asked { scene, model, goal, settings, keep, clock: Instant::now() };
        let found = match continuum::problem(scene, model) {
            Ok((problem, mesh)) => guaranteed::total_error(&search, &problem, mesh),
            Err(WhyNot::NoGuarantee(NoGuarantee { path, message })) if goal.force_error.is_some() => {
                let message = format!("{message}; without it the force has no bound: leave out --force-error");
                Err(Error::Scene { path, message })
            }
            Err(WhyNot::NoGuarantee(why)) => estimated::total_error(&search, format!("{}: {}", why.path, why.message)),
            Err(WhyNot::Failed(error)) => Err(error),
        }?;
        let is_beyond = |last: &(Answer, Solution)| last.0.beyond_small_displacements().is_some();
        match &found.last {
            Ok(last) if !model.parts.scene.is_linear && is_beyond(last) => {
                Ok(TotalError { status: Status::BeyondSmallDisplacements, ..found })
            }
            _ => Ok(found),
        }
    }
}
