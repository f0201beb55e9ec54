//! The dependence of an output on the places of nodes, at fixed displacement and multipliers.

use super::differences::derivative;
use super::effect::Why;
use super::output::{Branch, Direct, by_component, stress_of};
use super::places::areas_by_places;
use crate::fem::assembly::internal_work_by_places;
use crate::fem::body::BodyElement;
use crate::fem::element::Cell;
use crate::fem::geometry::{COORDINATES, Symmetric, cross, distance};
use crate::scene::answers::answer::Answer;
use crate::scene::input::schema::Rule;

impl Branch {
    /// The change with the place of each node, length `dim * n_nodes`, per length.
    pub(super) fn direct_by_places(&self, answer: &Answer) -> Result<Vec<f64>, Why> {
        let (model, body) = (answer.model(), answer.model().body());
        let mut gradient = vec![0.0; body.nodal_dofs()];
        match &self.direct {
            Direct::None => {}
            Direct::Width => {
                return Err(
                    "the width depends on the places of its nodes themselves; that derivative is not available yet"
                        .into(),
                );
            }
            Direct::Pressure(row) => {
                let mut weights = vec![0.0; model.rows().len()];
                weights[*row] = -self.value / model.rows()[*row].projected_area();
                gradient = areas_by_places(model, &weights)?;
            }
            Direct::Energy => {
                let displacement = answer.displacement();
                internal_work_by_places(body, displacement, displacement, &mut gradient)?;
                gradient.iter_mut().for_each(|entry| *entry *= 0.5 * model.parts_of_whole());
            }
            Direct::Moment(obstacle, axis) => {
                if model.obstacles()[*obstacle].rule() != Some(Rule::Approach) {
                    return Err("the moment depends on normals that turn with the places of nodes; it is available for the rule `approach`".into());
                }
                if !model.dofs().basis.is_nodal() {
                    return Err(
                        "the moment of coefficients on quadratic faces has no derivative with respect to places yet"
                            .into(),
                    );
                }
                let dimension = body.dimension();
                for (row, lambda) in
                    model.rows().iter().zip(answer.multiplier()).filter(|one| one.0.obstacle == *obstacle)
                {
                    for (along, direction) in COORDINATES.iter().enumerate().take(dimension) {
                        gradient[dimension * row.node + along] += lambda * cross(*direction, row.normal)[*axis];
                    }
                }
            }
            Direct::Stress { element, at, component } => {
                add_stress(answer, (*element, *at, *component), &mut gradient)?
            }
        }
        Ok(gradient)
    }
}

/// Adds the change of a component of the stress at reference coordinates of an element: the point moves with the element.
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
