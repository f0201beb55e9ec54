//! The contact problem of a body before any mesh: the conditions on its surface.

use std::fmt::Debug;
use std::sync::Arc;

use super::mesh::{OuterFacet, SimplexMesh};
use super::simplex::{Point, Tensor, pairs};
use crate::fem::geometry::distance;
use crate::fem::material::Lame;

/// Frictionless contact of an elastic body that fills a polygon, in plane strain or plane stress, or a polyhedron.
#[derive(Clone, Debug)]
pub struct ContinuumProblem {
    /// 2 or 3.
    pub dimension: usize,
    /// The Lamé constants in the plane or in space, in force per area.
    pub lame: Lame,
    /// Depth across the plane, in length; 1 in space.
    pub thickness: f64,
    /// Force per volume, constant.
    pub body_force: Point,
    /// The conditions on the facets of the surface: sides of the outline in the plane.
    pub conditions: Vec<Condition>,
    /// The obstacles.
    pub obstacles: Vec<Facing>,
    /// The names of the parts of the surface.
    pub boundaries: Vec<String>,
}

/// The condition on a facet of the surface, constant on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Condition {
    /// The prescribed component of the displacement along each axis, in length.
    pub held: [Option<f64>; 3],
    /// The traction along each axis, in force per area; along a held axis its work is constant, and it is not used.
    pub traction: Point,
    /// The pressure against the outward normal, in force per area.
    pub pressure: f64,
    /// The obstacles that the facet may touch.
    pub obstacles: Vec<usize>,
    /// The named parts of the surface that the facet belongs to.
    pub boundaries: Vec<usize>,
    /// In the plane, the circle on which new nodes are placed; without it they halve the straight side.
    pub circle: Option<Circle>,
}

/// A circle that a side approximates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Its centre.
    pub centre: Point,
    /// Its radius, in length.
    pub radius: f64,
}

impl Condition {
    /// Traction and pressure on a facet with this outward unit normal, in force per area.
    pub fn pull(&self, normal: Point) -> Point {
        [0, 1, 2].map(|axis| self.traction[axis] - self.pressure * normal[axis])
    }
}

/// A rigid obstacle with rows along one axis.
#[derive(Clone, Debug)]
pub struct Facing {
    /// The axis, from 0.
    pub axis: usize,
    /// 1 if the obstacle lies towards larger coordinates, else -1.
    pub sense: f64,
    /// Its distance function.
    pub surface: Arc<dyn Distance>,
}

/// The distance to an obstacle.
pub trait Distance: Debug + Send + Sync {
    /// The gap on the straight facet between these corners, two in the plane and three in space; `None` if the obstacle is out of reach
    /// on all of the facet.
    fn gap(&self, corners: &[Point]) -> Option<Enclosure>;
}

/// A function on a facet, enclosed by two quadratic functions: `q - below <= g <= q + above`.
#[derive(Clone, Debug, PartialEq)]
pub struct Enclosure {
    /// The coefficients of q in the basis of Bernstein: `l_i^2` of each corner, then `2 l_i l_j` of the pairs i < j.
    pub coefficients: Vec<f64>,
    /// Largest distance of the function below q, `>= 0`.
    pub below: f64,
    /// Largest distance above q, `>= 0`; infinite if nothing can be touched there.
    pub above: f64,
}

impl Enclosure {
    /// Bernstein coefficients that a quadratic function must not exceed to stay below g everywhere.
    pub fn lower(&self) -> impl Iterator<Item = f64> + '_ {
        self.coefficients.iter().map(|coefficient| coefficient - self.below)
    }

    /// An upper bound on the mean of g with the weight of each corner, its barycentric coordinate.
    pub fn upper_means(&self, corners: usize) -> Vec<f64> {
        (0..corners).map(|corner| weighted_mean(corners, corner, &self.coefficients) + self.above).collect()
    }
}

/// The mean over a facet of a quadratic function, given by its Bernstein coefficients, with the weight of a corner: its barycentric
/// coordinate.
pub fn weighted_mean(corners: usize, corner: usize, coefficients: &[f64]) -> f64 {
    let weight = |pair: [usize; 2]| 1 + pair.into_iter().filter(|&of| of == corner).count();
    let sum: f64 = pairs(corners).zip(coefficients).map(|(pair, value)| weight(pair) as f64 * value).sum();
    2.0 * sum / ((corners + 1) * (corners + 2)) as f64
}

impl ContinuumProblem {
    /// The facets of the surface that may touch obstacles, each with the number of one obstacle.
    pub fn facing<'a>(&'a self, mesh: &'a SimplexMesh) -> impl Iterator<Item = (OuterFacet, usize)> + 'a {
        mesh.surface().flat_map(move |outer| {
            self.conditions[outer.condition].obstacles.iter().map(move |&obstacle| (outer, obstacle))
        })
    }

    /// The axes along which a facet is held, and the prescribed displacements.
    pub fn held(&self, outer: &OuterFacet) -> impl Iterator<Item = (usize, f64)> {
        let held = self.conditions[outer.condition].held.into_iter().enumerate().take(self.dimension);
        held.filter_map(|(axis, value)| Some((axis, value?)))
    }

    /// The factor of a traction at a corner of a facet of this length or area.
    pub fn share_of_corner(&self, size: f64) -> f64 {
        self.thickness * size / self.dimension as f64
    }

    /// Returns `true` if the polygon follows a circle more closely with each mesh.
    pub fn has_circles(&self) -> bool {
        self.conditions.iter().any(|condition| condition.circle.is_some())
    }

    /// The mesh in which the marked simplices are refined; new nodes of sides that approximate circles lie on the circles, unless a
    /// simplex would fold: then the new sides are straight.
    pub fn refined(&self, mesh: &SimplexMesh, marked: &[bool]) -> SimplexMesh {
        let straight = mesh.refined(marked, |_, middle| middle);
        if !self.has_circles() {
            return straight;
        }
        let round = mesh.refined(marked, |condition, middle| match self.conditions[condition].circle {
            Some(Circle { centre, radius }) => {
                let away = distance(centre, middle);
                [0, 1, 2].map(|axis| centre[axis] + (middle[axis] - centre[axis]) * radius / away)
            }
            None => middle,
        });
        if round.is_folded_beside(&straight) { straight } else { round }
    }

    /// The same body without loads.
    pub fn unloaded(&self) -> Self {
        let without = |condition: &Condition| Condition { traction: [0.0; 3], pressure: 0.0, ..condition.clone() };
        let conditions = self.conditions.iter().map(without).collect();
        ContinuumProblem { body_force: [0.0; 3], conditions, ..self.clone() }
    }

    /// Returns `true` if all obstacles lie in one direction from the body.
    pub fn has_one_direction(&self) -> bool {
        let mut directions = self.obstacles.iter().map(|facing| (facing.axis, facing.sense));
        let first = directions.next();
        first.is_some() && directions.all(|direction| Some(direction) == first)
    }

    /// Returns `true` for an entry of a tensor on the diagonal, if it exists in the plane or in space.
    fn is_on_diagonal(&self, entry: usize) -> bool {
        entry < self.dimension
    }

    /// The strain of a stress.
    pub fn compliance(&self, stress: Tensor) -> Tensor {
        let (Lame { lambda, mu }, count) = (self.lame, self.dimension as f64);
        let mean = stress.iter().take(self.dimension).sum::<f64>() / count;
        // The parts are kept separate: near incompressibility their sum would lose digits.
        let volume = mean / (count * lambda + 2.0 * mu);
        let of_entry = |entry: usize| match self.is_on_diagonal(entry) {
            true => volume + (stress[entry] - mean) / (2.0 * mu),
            false => stress[entry] / (2.0 * mu),
        };
        std::array::from_fn(of_entry)
    }

    /// The stress of a strain.
    pub fn stress(&self, strain: Tensor) -> Tensor {
        let (Lame { lambda, mu }, count) = (self.lame, self.dimension as f64);
        let volume = strain.iter().take(self.dimension).sum::<f64>() / count;
        let mean = (count * lambda + 2.0 * mu) * volume;
        let of_entry = |entry: usize| match self.is_on_diagonal(entry) {
            true => mean + 2.0 * mu * (strain[entry] - volume),
            false => 2.0 * mu * strain[entry],
        };
        std::array::from_fn(of_entry)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    /// A flat triangle on a chord: the middle of the arc lies beyond its tip, or not.
    #[test]
    fn a_node_goes_onto_its_circle_unless_a_triangle_would_fold() {
        let on_circle = Circle { centre: [0.0, 1.0, 0.0], radius: 2.0_f64.sqrt() };
        let side = |circle| Condition { circle, ..Condition::default() };
        let problem = ContinuumProblem {
            dimension: 2,
            lame: Lame { lambda: 1.0, mu: 1.0 },
            thickness: 1.0,
            body_force: [0.0; 3],
            conditions: vec![side(Some(on_circle)), side(None)],
            obstacles: Vec::new(),
            boundaries: Vec::new(),
        };
        let surface = HashMap::from([(vec![0, 1], 0), (vec![1, 2], 1), (vec![0, 2], 1)]);
        for (tip, moved) in [(-0.1, 0.0), (-2.0, 1.0 - on_circle.radius)] {
            let nodes = vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, tip, 0.0]];
            let mesh = SimplexMesh::new(2, nodes, &[vec![0, 2, 1]], vec![0], &surface).unwrap();
            let finer = problem.refined(&mesh, &[true]);
            let middle = finer.nodes.iter().skip(3).find(|node| node[0] == 0.0).unwrap();
            assert!((middle[1] - moved).abs() < 1e-15, "{middle:?}");
        }
    }

    /// The bounds of an enclosure hold for the function `s^2` itself, and for one that leaves it by the margins.
    #[test]
    fn an_enclosure_bounds_means_and_coefficients() {
        let square = Enclosure { coefficients: vec![0.0, 1.0, 0.0], below: 0.0, above: 0.0 };
        // The integrals of 2 (1-s) s^2 and 2 s s^2.
        let means = square.upper_means(2);
        assert!((means[0] - 1.0 / 6.0).abs() < 1e-16 && (means[1] - 0.5).abs() < 1e-16);
        let wide = Enclosure { below: 0.5, above: 0.25, ..square };
        assert_eq!(wide.lower().collect::<Vec<_>>(), [-0.5, 0.5, -0.5]);
        assert!((wide.upper_means(2)[0] - means[0] - 0.25).abs() < 1e-16);
        // On a triangle the mean of l_0^2 with the weight 3 l_0 is 3/10, with 3 l_1 1/10; that of 2 l_0 l_1 is 1/5 and, with 3 l_2, 1/10.
        let of = |place: usize| Enclosure {
            coefficients: (0..6).map(|other| f64::from(u8::from(other == place))).collect(),
            below: 0.0,
            above: 0.0,
        };
        for (place, exact) in [(0, [0.3, 0.1, 0.1]), (3, [0.2, 0.2, 0.1])] {
            of(place).upper_means(3).iter().zip(exact).for_each(|(mean, exact)| assert!((mean - exact).abs() < 1e-16));
        }
    }

    #[test]
    fn the_strain_of_the_stress_of_a_strain_is_that_strain() {
        for (dimension, strain) in [(2, [0.25, -0.5, 0.0, 0.125, 0.0, 0.0]), (3, [0.25, -0.5, 0.75, 0.125, 0.5, -0.25])]
        {
            let material = ContinuumProblem {
                dimension,
                lame: Lame { lambda: 3.0, mu: 0.5 },
                thickness: 1.0,
                body_force: [0.0; 3],
                conditions: Vec::new(),
                obstacles: Vec::new(),
                boundaries: Vec::new(),
            };
            let back = material.compliance(material.stress(strain));
            (0..6).for_each(|entry| assert!((back[entry] - strain[entry]).abs() < 1e-15, "{back:?}"));
            // sigma = lambda tr(eps) I + 2 mu eps.
            let trace: f64 = strain[..3].iter().sum();
            assert!((material.stress(strain)[0] - (3.0 * trace + 0.25)).abs() < 1e-15);
        }
    }
}
