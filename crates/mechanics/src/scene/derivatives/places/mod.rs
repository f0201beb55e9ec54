//! The derivative of the conditions of an answer with respect to the places of all nodes.
//!
//! Moving a node changes the stiffness K, the load f, the contact rows B and the gaps g. With the displacement u and
//! the multiplier lambda of an answer, and the solution w, nu of an adjoint problem, a result changes by the change of
//!
//! `R = w . (f - K u + B' lambda) - nu . (g - B u)`
//!
//! with u, lambda, w and nu kept. In nodal terms, prescribed displacements included, with the forces p of loads and s
//! of springs, the internal forces q and the rows b_i . u <= g_i:
//!
//! `R = w . (p + s - q(u)) + sum of lambda_i b_i . w + nu_i (b_i . u - g_i)`.
//!
//! Supports, frames of inclined supports, forces at points, groups of elements and boundaries stay with their nodes. A
//! plane of symmetry and the axis of revolution do too: entries along the normal of such a plane mean something only
//! for motions that keep the end flat. A gap with a corner there counts as that of a symmetric obstacle, which does not
//! change to first order.

mod areas;
mod loads;
mod rows;
mod slopes;
#[cfg(test)]
mod tests;
mod widths;

pub(crate) use areas::areas_by_places;
pub(crate) use rows::Pairing;
pub(super) use slopes::Slopes;
pub(crate) use widths::add_width;

use crate::error::Error;
use crate::fem::assembly::internal_work_by_places;
use crate::scene::Scene;
use crate::scene::input::schema::{SupportSpec, TieSpec};

/// The change of R with the place of each node (length `dim * n_nodes`, order `[x_0, y_0, x_1, ...]`), per length.
pub(crate) fn by_places(scene: &Scene, pairing: &Pairing) -> Result<Vec<f64>, String> {
    refused(scene).map_or(Ok(()), Err)?;
    let said = |error: Error| error.to_string();
    let (answer, model) = (pairing.answer, pairing.answer.model());
    let (body, parts) = (model.body(), &model.parts);
    model.check_multiplier(pairing.forces).map_err(said)?;
    let motion = parts.unknowns.motion(pairing.adjoint).map_err(said)?;
    let adjoint = parts.dofs.expand_motion(&motion).map_err(said)?;
    let mut gradient = vec![0.0; body.nodal_dofs()];
    internal_work_by_places(body, answer.displacement(), &adjoint, &mut gradient)?;
    gradient.iter_mut().for_each(|entry| *entry = 0.0 - *entry);
    loads::add_loads(scene, body, &adjoint, &mut gradient).map_err(said)?;
    loads::add_springs(scene, body, [answer.displacement(), &adjoint], &mut gradient).map_err(said)?;
    rows::add(pairing, &adjoint, &mut gradient)?;
    Ok(gradient)
}

/// What depends on the places of nodes beyond elements, loads, springs and rows.
fn refused(scene: &Scene) -> Option<String> {
    let is_moved = |support: &&SupportSpec| {
        let values = [support.x, support.y, support.z, support.value];
        support.profile.is_some() && values.into_iter().flatten().any(|value| value != 0.0)
    };
    let reason = if scene.analysis.is_some() {
        "a motion in time depends on the places of nodes by its mass too; derivatives are those of equilibria"
    } else if !scene.rigid_faces.is_empty() {
        "the motions of rigid faces depend on the places of their nodes; their derivative is not available yet"
    } else if scene.ties.iter().any(|tie| !matches!(tie, TieSpec::Equation(_))) {
        "ties of surfaces and of bolts depend on the places of many nodes; their derivative is not available yet"
    } else if scene.supports.iter().any(|support| is_moved(&support)) {
        "prescribed displacements with a profile depend on the places of their nodes; their derivative is not available yet"
    } else {
        return None;
    };
    Some(reason.into())
}
