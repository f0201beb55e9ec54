//! Points of a body with output in a motion: nodes, or points within elements.

use crate::error::Error;
use crate::scene::Model;
use crate::scene::input::entry::{PLACE_TOLERANCE, number, point, vector, wrong};
use crate::scene::input::schema::WatchSpec;

/// A point with output at every step: a node, or any place inside an element.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchedPoint {
    /// Its name in a table, as `node 12` or `point (0.5 1)`.
    pub name: String,
    /// The nodes around it as `(node, weight)`, in any order: index from 0, and a dimensionless weight. The weights are
    /// the shape functions of its element and add up to one; a node has only itself.
    pub nodes: Vec<(usize, f64)>,
}

impl WatchedPoint {
    /// The value at the point of a nodal vector (length `dimension * n_nodes`, order `[x_0, y_0, x_1, ...]`), one entry
    /// for each coordinate, in the same unit.
    pub fn value(&self, nodal: &[f64], dimension: usize) -> Vec<f64> {
        let along =
            |axis: usize| self.nodes.iter().map(|&(node, weight)| weight * nodal[dimension * node + axis]).sum();
        (0..dimension).map(along).collect()
    }

    /// The point of `spec`, which is at the JSON path `path`.
    pub(crate) fn new(model: &Model, spec: &WatchSpec, path: &str) -> Result<Self, Error> {
        let (mesh, dimension) = (model.mesh(), model.mesh().dimension());
        let at = match spec {
            &WatchSpec::Node(node) => {
                let count = mesh.nodes().len();
                if node >= count {
                    let message = format!("there is no node {node}: nodes have the numbers 0 to {}", count - 1);
                    return Err(wrong(format!("{path}.node"), message));
                }
                return Ok(WatchedPoint { name: format!("node {node}"), nodes: vec![(node, 1.0)] });
            }
            WatchSpec::Point(entries) => vector(&format!("{path}.point"), entries, dimension)?,
        };
        let shown = point(&at[..dimension]);
        for element in model.body().elements() {
            let Some(weights) = element.cell.weights_at(at, PLACE_TOLERANCE) else { continue };
            let nodes = element.nodes.iter().copied().zip(weights).filter(|&(_, weight)| weight != 0.0).collect();
            // A comma would end a column of the table.
            return Ok(WatchedPoint { name: format!("point {}", shown.replace(',', "")), nodes });
        }
        let nearest = mesh.nearest_node(at).map_or(String::new(), |(node, distance)| {
            let place = point(&mesh.nodes()[node][..dimension]);
            format!(": its distance to the nearest node, {node} at {place}, is {}", number(distance))
        });
        Err(wrong(format!("{path}.point"), format!("{shown} lies in no element of the body{nearest}")))
    }
}
