//! Values beside the nodes of the mesh: depths in rigid obstacles between them, at which no row holds a body; and those
//! of the nodes of a deck that the mesh does not have.

use std::collections::HashMap;

use super::answer::Answer;
use crate::error::Error;
use crate::fem::element::{Tabulated, TabulatedPoint};
use crate::fem::geometry::cross;
use crate::scene::models::resultants::{Resultant, at_node};
use signorini_deck::{Of, ReferenceNode, Requests};

impl Answer {
    /// The displacement and the force of each reference node of the deck that this is an answer to, by its number:
    /// along x, y and z, in length and in force, then the rotation about them, in radians, and the moment, in force
    /// times length. The force comes from outside: from loads, and from what holds prescribed displacements.
    pub fn of_references(&self, requests: &Requests) -> Result<HashMap<usize, [[f64; 6]; 2]>, Error> {
        let resultants = self.resultants()?;
        let named = |of: String| resultants.iter().find(|one| one.of == of);
        // The points of a deck are called by the numbers of their nodes.
        let points = self.model().parts.conditions.points.all.iter().zip(self.values_of_points());
        let mut all: HashMap<usize, [[f64; 6]; 2]> =
            points.filter_map(|(point, values)| Some((point.name.parse().ok()?, values))).collect();
        let of_node = |node: &ReferenceNode| {
            let values = match node.of {
                Of::Turns { point } => all.get(&point).map(|values| values.map(|of_point| from(3, of_point))),
                Of::Face { face, first, centre } => {
                    named(format!("rigid-faces[{face}]")).map(|one| self.of_face(one, centre, first))
                }
            };
            (node.number, values.unwrap_or_default())
        };
        let along_axes = |node: usize, values: [f64; 6]| {
            // Components of a node with local axes are along these.
            let Some(axes) = requests.axes.get(&node) else { return values };
            let along = |axis: usize| (0..3).map(|own| values[own] * axes[own][axis]).sum();
            [along(0), along(1), along(2), values[3], values[4], values[5]]
        };
        all.extend(requests.references.iter().map(of_node).collect::<Vec<_>>());
        Ok(all.into_iter().map(|(number, values)| (number, values.map(|values| along_axes(number, values)))).collect())
    }

    /// The displacement of each node of the deck that this is an answer to, in length, and the rotation of its
    /// reference nodes, in radians, by their numbers: `[x, y, z, about x, about y, about z]`.
    pub fn displacements_of_deck(&self, requests: &Requests) -> Result<HashMap<usize, [f64; 6]>, Error> {
        let numbers = self.model().mesh().node_numbers().unwrap_or_default();
        let of_node = |(node, number): (usize, usize)| {
            let [x, y, z] = at_node(self.model(), self.displacement(), node);
            (number, [x, y, z, 0.0, 0.0, 0.0])
        };
        let of_mesh = numbers.into_iter().enumerate().map(of_node);
        let references = self.of_references(requests)?;
        Ok(references.into_iter().map(|(number, [displacement, _])| (number, displacement)).chain(of_mesh).collect())
    }

    /// Motion and force of a rigid face about a centre, from the motion `first` on.
    fn of_face(&self, face: &Resultant, centre: [f64; 3], first: usize) -> [[f64; 6]; 2] {
        let turns = self.model().body().turns();
        let in_six = |along: &[f64], about: &[f64]| {
            let mut all = [0.0; 6];
            all.iter_mut().zip(along).for_each(|(all, part)| *all = *part);
            turns.iter().zip(about).for_each(|(&axis, part)| all[3 + axis] = *part);
            all
        };
        let moved = face.motion.as_ref().map_or([0.0; 6], |motion| in_six(&motion.displacement, &motion.rotation));
        let mut force = in_six(&face.force, &face.moment);
        let about = cross(centre, [force[0], force[1], force[2]]);
        turns.iter().for_each(|&axis| force[3 + axis] -= about[axis]);
        [from(first, moved), from(first, force)]
    }

    /// The depths at five points in each direction of every facet that may touch a rigid obstacle. Parts of an obstacle
    /// narrower than the distance of these points are missed.
    #[doc(hidden)]
    pub fn depths_between_nodes(&self) -> Result<Depths, Error> {
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

/// The values from this one on, and zeros.
fn from(first: usize, all: [f64; 6]) -> [f64; 6] {
    [0, 1, 2, 3, 4, 5].map(|kind| all.get(first + kind).copied().unwrap_or(0.0))
}

/// Depths between nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Depths {
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
