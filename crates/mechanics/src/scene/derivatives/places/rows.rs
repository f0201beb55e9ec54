//! The change of the terms of contact rows in R with the places of nodes.

use super::slopes::Slopes;
use crate::scene::Answer;
use crate::scene::models::rows::ContactRow;

/// An answer with the solution of an adjoint problem.
pub(crate) struct Pairing<'a> {
    /// The answer: u and lambda.
    pub answer: &'a Answer,
    /// w, one entry per unknown of the problem.
    pub adjoint: &'a [f64],
    /// nu, one entry per contact row; zero where the result does not depend on the gap.
    pub forces: &'a [f64],
}

/// Adds the change of `lambda_i b_i . w + nu_i (b_i . u - g_i)` over all rows; `adjoint` is w at the nodes.
///
/// Rows with zero lambda and zero nu take no part, wherever they meet their obstacle.
///
/// # Errors
/// Why a row has no derivative.
pub(super) fn add(pairing: &Pairing, adjoint: &[f64], gradient: &mut [f64]) -> Result<(), String> {
    let (answer, model) = (pairing.answer, pairing.answer.model());
    let multipliers = answer.multiplier().iter().zip(pairing.forces);
    let rows = model.rows().iter().zip(multipliers).filter(|(_, (lambda, nu))| **lambda != 0.0 || **nu != 0.0);
    for obstacle in 0..model.obstacles().len() {
        let mut of_obstacle = rows.clone().filter(|(row, _)| row.obstacle == obstacle).peekable();
        if of_obstacle.peek().is_none() {
            continue;
        }
        let slopes = Slopes::of(model, obstacle);
        for (row, (&lambda, &nu)) in of_obstacle {
            add_row(pairing, adjoint, (row, lambda, nu), &slopes, gradient)?;
        }
    }
    Ok(())
}

/// Adds the change of the terms of one row.
fn add_row(
    pairing: &Pairing,
    adjoint: &[f64],
    (row, lambda, nu): (&ContactRow, f64, f64),
    slopes: &Slopes,
    gradient: &mut [f64],
) -> Result<(), String> {
    let (answer, model) = (pairing.answer, pairing.answer.model());
    let dimension = model.body().dimension();
    let mut add_at = |node: usize, factor: f64, vector: [f64; 3]| {
        let own = &mut gradient[dimension * node..dimension * (node + 1)];
        own.iter_mut().zip(vector).for_each(|(sum, part)| *sum += factor * part);
    };
    if !slopes.has_fixed_normals() || row.is_mean {
        // The displacement of the node against its obstacle, whose travel is against the approach direction.
        let approach = model.obstacles()[row.obstacle].approach();
        let unknown = model.parts.unknowns.travel(row.obstacle);
        let relative = |nodal: &[f64], travel: Option<f64>| {
            let travelled = approach.map(|part| travel.unwrap_or(0.0) * part);
            let at = |axis: usize| model.dofs().coefficient(row.node, |node| model.at_node(nodal, node)[axis]);
            [0, 1, 2].map(|axis| at(axis) + travelled[axis])
        };
        let u = relative(answer.displacement(), answer.travel(row.obstacle));
        let w = relative(adjoint, unknown.map(|unknown| pairing.adjoint[unknown]));
        let vector = [0, 1, 2].map(|axis| lambda * w[axis] + nu * u[axis]);
        add_at(row.node, 1.0, slopes.at(row.node)?.of_normal(vector));
    }
    if nu != 0.0 {
        for (node, share) in shares_of_gap(pairing, row, slopes) {
            slopes.at(node)?.gap.into_iter().for_each(|(node, slope)| add_at(node, -nu * share, slope));
        }
    }
    Ok(())
}

/// The nodes whose gaps make up the gap of a row of the problem, with their shares: the node alone, or those of its
/// coefficient. A node that the obstacle does not reach has the gap of the row.
fn shares_of_gap<'a>(
    pairing: &'a Pairing,
    row: &'a ContactRow,
    slopes: &'a Slopes,
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let owner = |node: usize| if node == row.node || slopes.has_row(node) { node } else { row.node };
    pairing.answer.model().dofs().basis.shares(row.node).map(move |(node, share)| (owner(node), share))
}
