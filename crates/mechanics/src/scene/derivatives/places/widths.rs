//! The change of the width of a contact with the places of nodes, at fixed pressures.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use crate::fem::assembly::{Density, FacetPoint, Points, integral_by_places};
use crate::scene::Answer;
use crate::scene::answers::patch::{Patch, StraightCell};
use crate::scene::derivatives::differences::derivative;

/// Adds `factor` times the change of the width on an obstacle, dimensionless, to a gradient (length `dim * n_nodes`,
/// order `[x_0, y_0, x_1, ...]`).
///
/// The width is the sum of L c over the facets: the length L, and the share c of its straight cells that the contact
/// covers. L changes in closed form. The share changes only at the ends of the contact; it depends on few nodes there,
/// and its change is a difference.
pub(crate) fn add_width(answer: &Answer, obstacle: usize, factor: f64, gradient: &mut [f64]) -> Result<(), String> {
    let (model, body) = (answer.model(), answer.model().body());
    let Some(boundary) = model.mesh().boundary(model.obstacles()[obstacle].boundary()) else { return Ok(()) };
    let Some(patch) = Patch::new(answer, obstacle) else { return Ok(()) };
    let mut cells_of: BTreeMap<usize, Vec<&StraightCell>> = BTreeMap::new();
    patch.cells().iter().for_each(|cell| cells_of.entry(cell.facet).or_default().push(cell));
    let mut share_of: HashMap<&[usize], f64> = HashMap::new();
    for (facet, nodes) in boundary.facets().enumerate() {
        let cells = cells_of.get(&facet).map_or(&[][..], Vec::as_slice);
        let [covered, whole] = lengths(&patch, cells);
        if covered == 0.0 {
            continue;
        }
        if cells.iter().any(|cell| cell.share < 1.0) {
            return Err(format!("the other body ends within facet {facet} of `{}`", boundary.name));
        }
        share_of.insert(nodes, covered / whole);
        if covered < whole {
            add_end(&patch, cells, factor, gradient)?;
        }
    }
    let by_radius = body.formulation().measure_by_x();
    let density = |point: &FacetPoint| {
        let measure = point.area / point.extent;
        let value = factor * share_of.get(point.nodes).copied().unwrap_or(0.0) / measure;
        // The width counts no circumference.
        Density { value, by_place: [-value * by_radius / measure, 0.0, 0.0], ..Density::default() }
    };
    integral_by_places(body, boundary, Points::Own, density, gradient);
    Ok(())
}

/// The covered and the whole length of straight cells, stretched.
fn lengths(patch: &Patch, cells: &[&StraightCell]) -> [f64; 2] {
    let has_contact = cells.iter().any(|cell| cell.nodes.iter().any(|&node| patch.is_closed(node)));
    cells.iter().fold([0.0; 2], |[covered, whole], cell| {
        let all = patch.sizes(cell, &patch.places(&cell.nodes)).0;
        let own =
            if has_contact && patch.is_whole(cell) { all } else { patch.sizes(cell, &patch.covered(&cell.nodes)).0 };
        [covered + own, whole + all]
    })
}

/// Adds `factor` L dc for a facet at an end of the contact.
fn add_end(patch: &Patch, cells: &[&StraightCell], factor: f64, gradient: &mut [f64]) -> Result<(), String> {
    let model = patch.answer().model();
    let dimension = model.body().dimension();
    let [covered, whole] = lengths(patch, cells);
    let own: Vec<usize> = cells.iter().flat_map(|cell| cell.nodes.iter().copied()).collect();
    let around = patch.cells_with(&own).flat_map(|cell| cell.nodes.iter().copied());
    let nodes: BTreeSet<usize> = own.iter().copied().chain(around).collect();
    for node in nodes {
        let on_planes = model.axes_of_symmetry(&model.mesh().nodes()[node]);
        for axis in (0..dimension).filter(|&axis| !on_planes[axis]) {
            let off = |by: f64| {
                let mut way = [0.0; 3];
                way[axis] = by;
                patch.set_moved(node, way);
                let [of_contact, of_facet] = lengths(patch, cells);
                Ok::<_, String>(vec![of_contact - covered / whole * of_facet])
            };
            let change = derivative(off, whole)?.ok_or_else(|| {
                format!("the estimated end of the contact next to node {node} has no derivative with its place")
            })?;
            gradient[dimension * node + axis] += factor * change[0];
        }
    }
    patch.set_moved(own[0], [0.0; 3]);
    Ok(())
}
