//! The dependence of an output on the places of nodes, at fixed displacement and multipliers.

use super::differences::derivative;
use super::effect::Why;
use super::output::{Branch, Direct, by_component, moment_of, obstacles_of, stress_of};
use super::places::{Slopes, add_width, areas_by_places};
use crate::fem::assembly::{internal_work_by_places, own_energy_by_places};
use crate::fem::body::BodyElement;
use crate::fem::element::Cell;
use crate::fem::geometry::{COORDINATES, Symmetric, distance};
use crate::scene::answers::answer::Answer;
use crate::scene::models::rows::ContactRow;

impl Branch {
    /// The change with the place of each node, length `dim * n_nodes`, per length.
    pub(super) fn direct_by_places(&self, answer: &Answer) -> Result<Vec<f64>, Why> {
        let (model, body) = (answer.model(), answer.model().body());
        let mut gradient = vec![0.0; body.nodal_dofs()];
        match &self.direct {
            Direct::None => {}
            Direct::Width(obstacle) => {
                // The width depends on the pressures, the forces of rows over their areas.
                let rows = model.rows().iter().zip(answer.multiplier()).zip(&self.by_multiplier);
                let weight = |((row, lambda), by_force): ((&ContactRow, &f64), &f64)| match *by_force {
                    0.0 => 0.0,
                    by_force => -by_force * lambda / row.projected_area(),
                };
                gradient = areas_by_places(model, &rows.map(weight).collect::<Vec<f64>>())?;
                for obstacle in obstacles_of(model, *obstacle) {
                    add_width(answer, obstacle, model.parts_of_whole(), &mut gradient)?;
                }
            }
            Direct::Pressure(row) => {
                let mut weights = vec![0.0; model.rows().len()];
                weights[*row] = -self.value / model.rows()[*row].projected_area();
                gradient = areas_by_places(model, &weights)?;
            }
            Direct::Energy => {
                // The mean of the works of the last and of the first internal forces, and the energy before them.
                let displacement = answer.displacement();
                internal_work_by_places(body, displacement, displacement, &mut gradient)?;
                if body.has_own_stress() {
                    internal_work_by_places(body, &vec![0.0; displacement.len()], displacement, &mut gradient)?;
                }
                gradient.iter_mut().for_each(|entry| *entry *= 0.5);
                own_energy_by_places(body, &mut gradient);
                gradient.iter_mut().for_each(|entry| *entry *= model.parts_of_whole());
            }
            Direct::Moment(obstacle, axis) => add_moment(answer, *obstacle, *axis, &mut gradient)?,
            Direct::Stress { element, at, component } => {
                add_stress(answer, (*element, *at, *component), &mut gradient)?
            }
        }
        Ok(gradient)
    }
}

/// Adds the change of the moment `sum of lambda (r x n)` of an obstacle about an axis through the origin: with the
/// places r of rows, which are those of their coefficients, and with normals that turn.
fn add_moment(answer: &Answer, obstacle: usize, axis: usize, gradient: &mut [f64]) -> Result<(), Why> {
    let (model, dimension) = (answer.model(), answer.model().body().dimension());
    let slopes = Slopes::of(model, obstacle);
    let rows = model.rows().iter().zip(answer.multiplier());
    for (row, &lambda) in rows.filter(|(row, lambda)| row.obstacle == obstacle && **lambda != 0.0) {
        let mut add = |node: usize, change: [f64; 3]| {
            let own = &mut gradient[dimension * node..dimension * (node + 1)];
            own.iter_mut().zip(change).for_each(|(sum, part)| *sum += lambda * part);
        };
        let moment = |at: [f64; 3], force: [f64; 3]| moment_of(model, obstacle, at, force, axis);
        let at_origin = moment([0.0; 3], row.normal);
        let of_place = COORDINATES.map(|direction| moment(direction, row.normal) - at_origin);
        for (node, share) in model.dofs().basis.shares(row.node) {
            add(node, of_place.map(|change| share * change));
        }
        if !slopes.has_fixed_normals() || row.is_mean {
            let place = model.place(row.node);
            add(row.node, slopes.at(row.node)?.of_normal(COORDINATES.map(|force| moment(place, force))));
        }
    }
    Ok(())
}

/// Adds the change of a component of the stress at reference coordinates of an element: the point moves with the
/// element.
fn add_stress(
    answer: &Answer,
    (element, at, component): (usize, [f64; 3], usize),
    gradient: &mut [f64],
) -> Result<(), Why> {
    let body = answer.model().body();
    let dimension = body.dimension();
    let Some(own) = body.element(element) else { return Ok(()) };
    let places = body.coordinates(own.nodes);
    let size =
        own.nodes.iter().enumerate().fold(0.0, |size: f64, (local, _)| size.max(distance(places[local], places[0])));
    let stress_at = |places: &_| -> Symmetric {
        let cell = Cell::new(own.kind.reference(), places);
        stress_of(body, answer.displacement(), &BodyElement { cell, ..own }, at)
    };
    let stress = stress_at(&places);
    for (local, &node) in own.nodes.iter().enumerate() {
        for axis in 0..dimension {
            let moved = |by: f64| {
                let mut moved = places;
                moved[local][axis] += by;
                Ok::<_, Why>(stress_at(&moved).to_vec())
            };
            let change = derivative(moved, size)?.ok_or_else(|| "the stress has no derivative there".to_string())?;
            let change = [0, 1, 2, 3, 4, 5].map(|entry| change[entry]);
            gradient[dimension * node + axis] += by_component(&stress, &change, component);
        }
    }
    Ok(())
}
