//! Planes of symmetry of a scene: their positions, their effect on nodes, and the whole body of which the model is a
//! part.

use super::held::{Component, Held, Holder};
use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::fem::geometry::{COORDINATES, cross, unit};
use crate::fem::mesh::Boundary;
use crate::scene::input::entry::{COORDINATE_ROUNDING, number, wrong};
use crate::scene::input::schema::{ModelSpec, Scene, SymmetryPlane};

/// The planes of symmetry of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Symmetry {
    /// The axis normal to each plane, and the coordinate of the plane along it.
    planes: Vec<(usize, f64)>,
    /// A node within this length of a plane of symmetry lies on it: rounding of coordinates.
    rounding: f64,
}

/// The planes of symmetry; they lie at flat ends of the body.
pub(crate) fn planes_of_symmetry(scene: &Scene, body: &ElasticBody) -> Result<Symmetry, Error> {
    let rounding = COORDINATE_ROUNDING * body.mesh().size();
    let mut symmetry = Symmetry { planes: Vec::new(), rounding };
    for (index, plane) in scene.symmetry.iter().enumerate() {
        let (path, name, axis) = (format!("symmetry[{index}]"), plane.name(), plane.axis());
        if axis >= scene.model.dimension() {
            return Err(wrong(path, format!("the model `{}` has no {name}", scene.model.name())));
        }
        if scene.model == ModelSpec::Axisymmetric && *plane == SymmetryPlane::X {
            return Err(wrong(path, "x is the radius: an axisymmetric body needs no plane across it; leave x out"));
        }
        if scene.symmetry[..index].contains(plane) {
            return Err(wrong(path, format!("`{name}` is named twice")));
        }
        symmetry.planes.push((axis, flat_end(body, axis, rounding).map_err(|message| wrong(path, message))?));
    }
    Ok(symmetry)
}

/// The coordinate of the flat end of the body along an axis: the plane of symmetry.
fn flat_end(body: &ElasticBody, axis: usize, rounding: f64) -> Result<f64, String> {
    let (mesh, name) = (body.mesh(), ["x", "y", "z"][axis]);
    let surfaces: Vec<Boundary> = body.regions().iter().map(|region| mesh.surface(region.elements())).collect();
    let (low, high) = mesh.extent();
    let lies = |at: f64| {
        let is_flat = |facet: &[usize]| facet.iter().all(|&node| (mesh.nodes()[node][axis] - at).abs() <= rounding);
        surfaces.iter().flat_map(Boundary::facets).any(is_flat)
    };
    let ends: Vec<f64> = [low[axis], high[axis]].into_iter().filter(|&end| lies(end)).collect();
    match ends[..] {
        [end] => Ok(end),
        [] => Err(format!(
            "the body does not end flat at {name} = {} or {name} = {}, so that it cannot be a part of a symmetric \
             body",
            number(low[axis]),
            number(high[axis])
        )),
        _ => match ends.iter().find(|end| end.abs() <= rounding) {
            Some(&end) => Ok(end),
            None => Err(format!(
                "the body ends flat at both {name} = {} and {name} = {}; move it, so that the plane of symmetry lies at 0",
                number(ends[0]),
                number(ends[1])
            )),
        },
    }
}

impl Symmetry {
    /// Returns `true` if a plane lies across this axis.
    pub fn crosses(&self, axis: usize) -> bool {
        self.planes.iter().any(|plane| plane.0 == axis)
    }

    /// Prescribes the displacement of the nodes on the planes.
    pub fn hold(&self, body: &ElasticBody, held: &mut Held) {
        for &(axis, at) in &self.planes {
            let lies = |node: &usize| self.lies_on((axis, at), &body.mesh().nodes()[*node]);
            for node in (0..body.mesh().nodes().len()).filter(lies) {
                held.prescribe(node, Component { direction: COORDINATES[axis], value: 0.0, by: Holder::Symmetry });
            }
        }
    }

    /// Number of parts that make up the whole.
    pub fn parts(&self) -> f64 {
        2.0_f64.powi(self.planes.len() as i32)
    }

    /// Number of parts that one obstacle with the approach direction `approach` presses: a plane normal to it gives a
    /// second obstacle on the other side.
    pub fn parts_of_obstacle(&self, approach: [f64; 3]) -> f64 {
        2.0_f64.powi(self.planes.iter().filter(|plane| approach[plane.0] == 0.0).count() as i32)
    }

    /// Number of places at which a contact at nodes stands on one copy of an obstacle. A contact that reaches a plane
    /// goes on in its mirror image and is one with it; a plane that it does not reach gives a second contact. Planes
    /// across the `approach` direction make another copy.
    pub fn contacts(&self, approach: [f64; 3], nodes: &[[f64; 3]], own: &[usize]) -> usize {
        let reached = |plane: (usize, f64)| own.iter().any(|&node| self.lies_on(plane, &nodes[node]));
        let beyond = self.planes.iter().filter(|plane| approach[plane.0] == 0.0 && !reached(**plane));
        beyond.fold(1, |contacts, _| 2 * contacts)
    }

    /// A unit vector of the body's surface at a node of the part, as the whole has it: at a plane it lies in the plane.
    pub fn of_whole(&self, at: &[f64; 3], normal: [f64; 3]) -> [f64; 3] {
        let mut along = normal;
        self.planes.iter().filter(|plane| self.lies_on(**plane, at)).for_each(|plane| along[plane.0] = 0.0);
        if along == normal { normal } else { unit(along) }
    }

    /// The images of the place `other` around the place `at` in the whole: one on each side of a plane on which only
    /// `at` lies.
    pub fn images_around(&self, at: &[f64; 3], other: &[f64; 3]) -> Vec<[f64; 3]> {
        let mut all = vec![*other];
        for &(axis, plane) in self.planes.iter().filter(|plane| self.lies_on(**plane, at)) {
            let beyond: Vec<[f64; 3]> = all
                .iter()
                .filter(|place| !self.lies_on((axis, plane), place))
                .map(|place| {
                    let mut image = *place;
                    image[axis] = 2.0 * plane - image[axis];
                    image
                })
                .collect();
            all.extend(beyond);
        }
        all
    }

    /// The moment about an axis through the origin of a force of one obstacle at a place, with its mirror images.
    /// Planes normal to the `approach` direction make a second obstacle, whose forces do not count.
    pub fn moment(&self, approach: [f64; 3], at: [f64; 3], force: [f64; 3], axis: usize) -> f64 {
        let mut all = vec![(at, force)];
        for &(normal, plane) in self.planes.iter().filter(|plane| approach[plane.0] == 0.0) {
            let image = |&(mut at, mut force): &([f64; 3], [f64; 3])| {
                (at[normal], force[normal]) = (2.0 * plane - at[normal], -force[normal]);
                (at, force)
            };
            let beyond: Vec<_> = all.iter().map(image).collect();
            all.extend(beyond);
        }
        all.into_iter().map(|(at, force)| cross(at, force)[axis]).sum()
    }

    /// Returns `true` for each axis across which a place lies on a plane.
    pub fn axes_at(&self, at: &[f64; 3]) -> [bool; 3] {
        [0, 1, 2].map(|axis| self.planes.iter().any(|plane| plane.0 == axis && self.lies_on(*plane, at)))
    }

    /// Returns `true` if two places lie on one plane.
    pub fn share_plane(&self, at: &[f64; 3], other: &[f64; 3]) -> bool {
        self.planes.iter().any(|&plane| self.lies_on(plane, at) && self.lies_on(plane, other))
    }

    fn lies_on(&self, (axis, plane): (usize, f64), at: &[f64; 3]) -> bool {
        (at[axis] - plane).abs() <= self.rounding
    }

    /// A force at a place with its mirror images, in the planes for whose axis `across` is `true`. A place on a plane
    /// is its own image: the whole has one node there, with both forces.
    pub fn images(&self, at: [f64; 3], force: [f64; 3], across: impl Fn(usize) -> bool) -> Vec<([f64; 3], [f64; 3])> {
        let mut all = vec![(at, force)];
        for &(axis, plane) in self.planes.iter().filter(|plane| across(plane.0)) {
            if self.lies_on((axis, plane), &at) {
                for (_, force) in &mut all {
                    *force = force.map(|part| 2.0 * part);
                    force[axis] = 0.0;
                }
                continue;
            }
            let mirrored = |&(mut at, mut force): &([f64; 3], [f64; 3])| {
                at[axis] = 2.0 * plane - at[axis];
                force[axis] = -force[axis];
                (at, force)
            };
            let images: Vec<_> = all.iter().map(mirrored).collect();
            all.extend(images);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::Symmetry;

    #[test]
    fn a_moment_counts_the_mirror_images_of_one_obstacle() {
        let symmetry = Symmetry { planes: vec![(0, 4.0), (2, 1.0)], rounding: 1e-12 };
        // The image of the force lies at x = 3, and that across z belongs to a second obstacle.
        let of = |axis: usize| symmetry.moment([0.0, 0.0, 1.0], [5.0, 2.0, 3.0], [0.5, 0.0, -1.0], axis);
        assert_eq!([of(0), of(1), of(2)], [-4.0, 8.0, 0.0]);
    }

    #[test]
    fn images_around_an_edge_lie_beyond_planes_away_from_the_origin() {
        let symmetry = Symmetry { planes: vec![(0, 4.0), (1, -2.0)], rounding: 1e-12 };
        let images = symmetry.images_around(&[4.0, -2.0, 7.0], &[5.0, -1.5, 8.0]);
        assert_eq!(images, [[5.0, -1.5, 8.0], [3.0, -1.5, 8.0], [5.0, -2.5, 8.0], [3.0, -2.5, 8.0]]);
        // A place on a plane is its own image, and a plane on which the middle does not lie makes none.
        assert_eq!(symmetry.images_around(&[4.0, 0.0, 7.0], &[4.0, -1.5, 8.0]), [[4.0, -1.5, 8.0]]);
    }
}
