//! The change of the contact rows of an obstacle with the places of nodes.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use crate::fem::assembly::{Density, FacetPoint, Points, integral_by_places, normal_sums};
use crate::fem::body::ON_THE_AXIS;
use crate::fem::geometry::{dot, length};
use crate::scene::answers::patch::{ContactPatch, StraightCell};
use crate::scene::derivatives::effect::derivative;
use crate::scene::input::entry::point;
use crate::scene::input::obstacle::{ObstacleRow, PlacedObstacle, shortest_edges};
use crate::scene::models::model::check_multiplier;
use crate::scene::models::resultants::at_node;
use crate::scene::models::rows::ContactRow;
use crate::scene::{Answer, Model, Rule};

pub(in crate::scene::derivatives) struct Slope {
    /// Nodes, each with the change of the gap along x, y and z, dimensionless.
    pub gap: Vec<(usize, [f64; 3])>,
    /// `[k]`: the change of the normal with the place of its node along axis k, per length.
    pub normal: [[f64; 3]; 3],
}

impl Slope {
    /// The change of `vector . normal` with the place of the node along x, y and z.
    pub fn of_normal(&self, vector: [f64; 3]) -> [f64; 3] {
        self.normal.map(|by_axis| dot(by_axis, vector))
    }
}

/// The rows of an obstacle at their nodes.
pub(in crate::scene::derivatives) struct Slopes<'a> {
    model: &'a Model,
    number: usize,
    obstacle: &'a PlacedObstacle,
    candidate_of: HashMap<usize, usize>,
    /// The shortest edge of the facets at each node of the mesh; infinite where facets are points.
    edges: Vec<f64>,
}

impl<'a> Slopes<'a> {
    /// The rows of obstacle `number`.
    pub fn of(model: &'a Model, number: usize) -> Self {
        let (obstacle, nodes) = (&model.obstacles()[number], model.mesh().nodes());
        let candidates = obstacle.candidates().iter().enumerate();
        let boundary = model.mesh().boundary(obstacle.boundary());
        let edges = boundary.map_or_else(Vec::new, |boundary| shortest_edges(boundary, nodes));
        let candidate_of = candidates.map(|(candidate, &(node, _))| (node, candidate)).collect();
        Slopes { model, number, obstacle, candidate_of, edges }
    }

    /// Returns `true` if the direction of every row is fixed.
    pub fn has_fixed_normals(&self) -> bool {
        self.obstacle.rule() == Some(Rule::Approach)
    }

    /// The row of a node at another place.
    fn row(&self, node: usize, at: [f64; 3]) -> Option<ObstacleRow> {
        let candidate = *self.candidate_of.get(&node)?;
        self.obstacle.row(candidate, at, self.obstacle.shift(self.model.gap())).ok()?
    }

    /// The change of the row of a node.
    pub fn at(&self, node: usize) -> Result<Slope, String> {
        match self.candidate_of.get(&node).and_then(|&candidate| self.obstacle.facing(candidate)) {
            Some(facing) if facing.area.is_some() => Err(format!(
                "obstacles[{}]: the rows between meshes that do not match depend on the places of many nodes; their \
                 derivative is not available yet",
                self.number
            )),
            Some(_) if self.obstacle.rule() != Some(Rule::Approach) => Err(format!(
                "obstacles[{}]: the rows between two bodies lie along the normals of both, which depend on the places of \
                 many nodes; their derivative is available for the rule `approach`",
                self.number
            )),
            Some(facing) => {
                let is_fit = self.obstacle.between().is_some_and(|between| between.fit.is_some());
                let ends = facing.ends.iter().filter(|_| !is_fit);
                let gap = ends.map(|&(node, share)| (node, facing.normal.map(|part| 0.0 - share * part))).collect();
                Ok(Slope { gap, normal: [[0.0; 3]; 3] })
            }
            None => self.of_rigid(node),
        }
    }

    /// The change of the row against a rigid obstacle with the place of its node.
    ///
    /// Along the approach direction a gap changes by -1, and the gap along a normal by minus the normal; all else is a
    /// difference.
    fn of_rigid(&self, node: usize) -> Result<Slope, String> {
        let (nodes, rule) = (self.model.mesh().nodes(), self.obstacle.rule());
        let approach = self.obstacle.approach();
        let (mut gap, mut normal) = ([0.0; 3], [[0.0; 3]; 3]);
        let row = self.row(node, nodes[node]).ok_or_else(|| self.without_slope(node))?;
        for axis in 0..self.model.mesh().dimension() {
            if rule == Some(Rule::Approach) && approach[axis] != 0.0 {
                gap[axis] = 0.0 - approach[axis];
                continue;
            }
            let found = match self.difference(node, axis) {
                Some(found) => found,
                None if self.is_symmetric(node, axis) => [0.0; 4],
                None => return Err(self.without_slope(node)),
            };
            let [of_gap, of_normal @ ..] = found;
            (gap[axis], normal[axis]) = (of_gap, of_normal);
        }
        if rule == Some(Rule::ClosestPoint) {
            gap = row.normal.map(|part| 0.0 - part);
        }
        Ok(Slope { gap: vec![(node, gap)], normal })
    }

    /// Returns `true` if a node lies on a plane of symmetry normal to an axis, or on the axis of revolution.
    fn is_symmetric(&self, node: usize, axis: usize) -> bool {
        let (mesh, at) = (self.model.mesh(), self.model.mesh().nodes()[node]);
        let is_on_axis = self.model.body().formulation().is_axisymmetric() && at[0] <= ON_THE_AXIS * mesh.size();
        self.model.parts.conditions.symmetry.axes_at(&at)[axis] || (axis == 0 && is_on_axis)
    }

    fn without_slope(&self, node: usize) -> String {
        let mesh = self.model.mesh();
        format!(
            "node {node} at {} meets a corner, an edge or an end of obstacles[{}], where its gap has no derivative with \
             respect to its place",
            point(&mesh.nodes()[node][..mesh.dimension()]),
            self.number
        )
    }

    /// The change of `[gap, normal x, y, z]` with the place of a node along an axis, by differences; `None` at a kink.
    fn difference(&self, node: usize, axis: usize) -> Option<[f64; 4]> {
        let (at, mesh) = (self.model.mesh().nodes()[node], self.model.mesh());
        let edge = self.edges.get(node).copied().filter(|edge| edge.is_finite());
        let moved = |by: f64| {
            let mut at = at;
            at[axis] += by;
            let ObstacleRow { normal: [x, y, z], gap } = self.row(node, at).ok_or(())?;
            Ok::<_, ()>(vec![gap, x, y, z])
        };
        let found = derivative(moved, edge.unwrap_or_else(|| mesh.size())).ok()??;
        Some([found[0], found[1], found[2], found[3]])
    }
}

/// The change of the sum of weight times [projected area](ContactRow::projected_area) over all contact rows, one weight
/// for each, with the place of each node (length `dim * n_nodes`, order `[x_0, y_0, x_1, ...]`), in area per length
/// times the unit of the weights.
///
/// The projected area of a row is A (n . o) with the outward normal o of the body, or A where the boundary faces away.
/// A is a sum of integrals of shape functions N, and o is along the integral s of N^2 times the normal, less its parts
/// along the normals of planes of symmetry on which the node lies. Thus `n . do = v . ds` with
/// `v = (n - (n . o) o)/|s|`.
pub(crate) fn areas_by_places(model: &Model, weights: &[f64]) -> Result<Vec<f64>, String> {
    check_multiplier(model, weights).map_err(|error| error.to_string())?;
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
        let on_planes = model.parts.conditions.symmetry.axes_at(&nodes[row.node]);
        let in_planes = |vector: [f64; 3]| [0, 1, 2].map(|axis| if on_planes[axis] { 0.0 } else { vector[axis] });
        let factor = weight * row.tributary_area / length(in_planes(sums[row.node]));
        let normal = in_planes(row.normal);
        of_sum[row.node] = [0, 1, 2].map(|axis| factor * (normal[axis] - facing * row.outward[axis]));
        if !slopes.has_fixed_normals() {
            let turning = slopes.at(row.node)?.of_normal(row.outward);
            add_at(gradient, dimension, row.node, weight * row.tributary_area, turning);
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

/// Adds `factor` times the change of the width on an obstacle, dimensionless, to a gradient (length `dim * n_nodes`,
/// order `[x_0, y_0, x_1, ...]`).
///
/// The width is the sum of L c over the facets: the length L, and the share c of its straight cells that the contact
/// covers. L changes in closed form. The share changes only at the ends of the contact; it depends on few nodes there,
/// and its change is a difference.
pub(crate) fn add_width(answer: &Answer, obstacle: usize, factor: f64, gradient: &mut [f64]) -> Result<(), String> {
    let (model, body) = (answer.model(), answer.model().body());
    let Some(boundary) = model.mesh().boundary(model.obstacles()[obstacle].boundary()) else { return Ok(()) };
    let Some(patch) = ContactPatch::new(answer, obstacle) else { return Ok(()) };
    let mut cells_of: BTreeMap<usize, Vec<&StraightCell>> = BTreeMap::new();
    patch.cells.iter().for_each(|cell| cells_of.entry(cell.facet).or_default().push(cell));
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
fn lengths(patch: &ContactPatch, cells: &[&StraightCell]) -> [f64; 2] {
    let has_contact = cells.iter().any(|cell| cell.nodes.iter().any(|&node| patch.is_closed(node)));
    cells.iter().fold([0.0; 2], |[covered, whole], cell| {
        let all = patch.sizes(cell, &patch.places(&cell.nodes)).0;
        let own =
            if has_contact && patch.is_whole(cell) { all } else { patch.sizes(cell, &patch.covered(&cell.nodes)).0 };
        [covered + own, whole + all]
    })
}

/// Adds `factor` L dc for a facet at an end of the contact.
fn add_end(patch: &ContactPatch, cells: &[&StraightCell], factor: f64, gradient: &mut [f64]) -> Result<(), String> {
    let model = patch.answer.model();
    let dimension = model.body().dimension();
    let [covered, whole] = lengths(patch, cells);
    let own: Vec<usize> = cells.iter().flat_map(|cell| cell.nodes.iter().copied()).collect();
    let around = patch.cells_with(&own).flat_map(|cell| cell.nodes.iter().copied());
    let nodes: BTreeSet<usize> = own.iter().copied().chain(around).collect();
    for node in nodes {
        let on_planes = model.parts.conditions.symmetry.axes_at(&model.mesh().nodes()[node]);
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

fn add_row(
    pairing: &Pairing,
    adjoint: &[f64],
    (row, lambda, nu): (&ContactRow, f64, f64),
    slopes: &Slopes,
    gradient: &mut [f64],
) -> Result<(), String> {
    let (answer, model) = (pairing.answer, pairing.answer.model());
    let dimension = model.body().dimension();
    if !slopes.has_fixed_normals() || row.is_mean {
        // The displacement of the node against its obstacle, whose travel is against the approach direction.
        let approach = model.obstacles()[row.obstacle].approach();
        let unknown = model.parts.travel(row.obstacle);
        let relative = |nodal: &[f64], travel: Option<f64>| {
            let travelled = approach.map(|part| travel.unwrap_or(0.0) * part);
            let at = |axis: usize| model.dofs().coefficient(row.node, |node| at_node(model, nodal, node)[axis]);
            [0, 1, 2].map(|axis| at(axis) + travelled[axis])
        };
        let u = relative(answer.displacement(), answer.travel(row.obstacle));
        let w = relative(adjoint, unknown.map(|unknown| pairing.adjoint[unknown]));
        let vector = [0, 1, 2].map(|axis| lambda * w[axis] + nu * u[axis]);
        add_at(gradient, dimension, row.node, 1.0, slopes.at(row.node)?.of_normal(vector));
    }
    if nu != 0.0 {
        for (node, share) in shares_of_gap(pairing, row, slopes) {
            for (node, slope) in slopes.at(node)?.gap {
                add_at(gradient, dimension, node, -nu * share, slope);
            }
        }
    }
    Ok(())
}

pub(super) fn add_at(gradient: &mut [f64], dimension: usize, node: usize, factor: f64, vector: [f64; 3]) {
    let own = &mut gradient[dimension * node..dimension * (node + 1)];
    own.iter_mut().zip(vector).for_each(|(sum, part)| *sum += factor * part);
}

/// The nodes whose gaps make up the gap of a row of the problem, with their shares: the node alone, or those of its
/// coefficient. A node that the obstacle does not reach has the gap of the row.
fn shares_of_gap<'a>(
    pairing: &'a Pairing,
    row: &'a ContactRow,
    slopes: &'a Slopes,
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let model = pairing.answer.model();
    let is_met = move |node: usize| node == row.node || slopes.row(node, model.mesh().nodes()[node]).is_some();
    let owner = move |node: usize| if is_met(node) { node } else { row.node };
    model.dofs().basis.shares(row.node).map(move |(node, share)| (owner(node), share))
}
