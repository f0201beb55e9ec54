//! The change of the projected areas of contact rows with the places of nodes.

use super::slopes::Slopes;
use crate::fem::assembly::{Density, FacetPoint, Points, integral_by_places, normal_sums};
use crate::fem::geometry::{dot, length};
use crate::scene::Model;
use crate::scene::models::rows::ContactRow;

/// The change of the sum of weight times [projected area](ContactRow::projected_area) over all contact rows, one weight
/// for each, with the place of each node (length `dim * n_nodes`, order `[x_0, y_0, x_1, ...]`), in area per length
/// times the unit of the weights.
///
/// The projected area of a row is A (n . o) with the outward normal o of the body, or A where the boundary faces away.
/// A is a sum of integrals of shape functions N, and o is along the integral s of N^2 times the normal, less its parts
/// along the normals of planes of symmetry on which the node lies. Thus `n . do = v . ds` with
/// `v = (n - (n . o) o)/|s|`.
pub(crate) fn areas_by_places(model: &Model, weights: &[f64]) -> Result<Vec<f64>, String> {
    model.check_multiplier(weights).map_err(|error| error.to_string())?;
    let mut gradient = vec![0.0; model.body().nodal_dofs()];
    for obstacle in 0..model.obstacles().len() {
        let rows = model.rows().iter().zip(weights.iter().copied());
        let rows: Vec<(&ContactRow, f64)> =
            rows.filter(|(row, weight)| row.obstacle == obstacle && *weight != 0.0).collect();
        if !rows.is_empty() {
            add_obstacle(model, obstacle, &rows, &mut gradient)?;
        }
    }
    Ok(gradient)
}

/// Adds the change of the projected areas of some rows of an obstacle, with their weights.
fn add_obstacle(
    model: &Model,
    obstacle: usize,
    rows: &[(&ContactRow, f64)],
    gradient: &mut [f64],
) -> Result<(), String> {
    let (body, dimension, slopes) = (model.body(), model.body().dimension(), Slopes::of(model, obstacle));
    let Some(boundary) = model.mesh().boundary(model.obstacles()[obstacle].boundary()) else { return Ok(()) };
    let (nodes, sums) = (model.mesh().nodes(), normal_sums(body, boundary));
    // Of the area of each node, and of s.
    let (mut of_area, mut of_sum) = (vec![0.0; nodes.len()], vec![[0.0; 3]; nodes.len()]);
    for &(row, weight) in rows {
        if row.is_mean {
            slopes.at(row.node)?;
        }
        let facing = dot(row.normal, row.outward);
        if facing <= 0.0 {
            of_area[row.node] += weight;
            continue;
        }
        of_area[row.node] += weight * facing;
        let on_planes = model.axes_of_symmetry(&nodes[row.node]);
        let in_planes = |vector: [f64; 3]| [0, 1, 2].map(|axis| if on_planes[axis] { 0.0 } else { vector[axis] });
        let factor = weight * row.tributary_area / length(in_planes(sums[row.node]));
        let normal = in_planes(row.normal);
        of_sum[row.node] = [0, 1, 2].map(|axis| factor * (normal[axis] - facing * row.outward[axis]));
        if !slopes.has_fixed_normals() {
            let turning = slopes.at(row.node)?.of_normal(row.outward);
            let own = &mut gradient[dimension * row.node..dimension * (row.node + 1)];
            own.iter_mut().zip(turning).for_each(|(sum, part)| *sum += weight * row.tributary_area * part);
        }
    }
    // The area of a coefficient is a sum of those of nodes.
    model.dofs().basis.evaluate(&mut of_area, 1);
    let density = |point: &FacetPoint| {
        let mut density = Density::default();
        for (&node, share) in point.nodes.iter().zip(point.shape) {
            density.value += share * of_area[node];
            for (sum, part) in density.by_normal.iter_mut().zip(of_sum[node]) {
                *sum += share * share * part;
            }
        }
        density.value += dot(density.by_normal, point.normal);
        density
    };
    integral_by_places(body, boundary, Points::Own, density, gradient);
    Ok(())
}
