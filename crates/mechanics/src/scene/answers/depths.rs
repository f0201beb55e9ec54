//! The depth of a displaced body in rigid obstacles between its nodes, at which no row holds it.

use super::answer::Answer;
use crate::error::Error;
use crate::fem::element::{Tabulated, TabulatedPoint};

/// Depths between nodes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Depths {
    /// The largest depth on each element, in length; zero on an element outside all obstacles.
    pub of_elements: Vec<f64>,
    /// The displacement that the obstacles impose, or would impose: the largest displacement along a row at a
    /// penetrating place, or the largest depth before any displacement, in length.
    pub pushed: f64,
}

impl Depths {
    /// The largest depth over the displacement that the obstacles impose.
    pub fn relative(&self) -> f64 {
        let deepest = self.of_elements.iter().fold(0.0, |deepest: f64, depth| deepest.max(*depth));
        if deepest > 0.0 { deepest / self.pushed } else { 0.0 }
    }
}

impl Answer {
    /// The depths at five points in each direction of every facet that may touch a rigid obstacle. Parts of an obstacle
    /// narrower than the distance of these points are missed.
    pub(crate) fn depths_between_nodes(&self) -> Result<Depths, Error> {
        let (model, mesh) = (self.model(), self.model().mesh());
        let mut depths = Depths { of_elements: vec![0.0; mesh.element_count()], pushed: 0.0 };
        for (index, obstacle) in model.obstacles().iter().enumerate() {
            let (Some(rigid), Some(boundary)) = (obstacle.rigid(), mesh.boundary(obstacle.boundary())) else {
                continue;
            };
            let table = Tabulated::fine(boundary.kind.reference());
            for (facet, owner) in boundary.facets().zip(mesh.faces_of(boundary)) {
                let Some((element, _)) = owner else { continue };
                for at in &table.points {
                    let [place, moved] = self.on_facet(facet, at);
                    let row = rigid.shifted_row(place, self.shift(index)).map_err(|reason| Error::Scene {
                        path: format!("obstacles[{index}]"),
                        message: format!("the place {place:?} between nodes {reason}"),
                    })?;
                    let Some(row) = row else { continue };
                    let along: f64 = row.normal.iter().zip(moved).map(|(normal, moved)| normal * moved).sum();
                    let depth = along - row.gap;
                    if depth > 0.0 {
                        depths.pushed = depths.pushed.max(along.abs()).max(-row.gap);
                        depths.of_elements[element] = depths.of_elements[element].max(depth);
                    }
                }
            }
        }
        Ok(depths)
    }

    /// A point of a facet, and its displacement, both [x, y, z].
    fn on_facet(&self, facet: &[usize], at: &TabulatedPoint) -> [[f64; 3]; 2] {
        let (nodes, dimension) = (self.model().mesh().nodes(), self.model().body().dimension());
        let (mut place, mut moved) = ([0.0; 3], [0.0; 3]);
        for (&node, share) in facet.iter().zip(at.shape) {
            for axis in 0..dimension {
                place[axis] += share * nodes[node][axis];
                moved[axis] += share * self.displacement()[dimension * node + axis];
            }
        }
        [place, moved]
    }
}
