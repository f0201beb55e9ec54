//! The contact problem of a body in the plane before any mesh: the conditions on its outline.

use std::fmt::Debug;
use std::sync::Arc;

use super::triangulation::{Point, Triangulation, distance};
use crate::fem::material::Lame;

/// Frictionless contact of an elastic body that fills a polygon, in plane strain or plane stress.
#[derive(Clone, Debug)]
pub struct PlaneProblem {
    /// The Lamé constants in the plane, in force per area.
    pub lame: Lame,
    /// Depth across the plane, in length.
    pub thickness: f64,
    /// Force per volume, constant.
    pub body_force: Point,
    /// The conditions on the sides of the outline.
    pub conditions: Vec<Condition>,
    /// The obstacles.
    pub obstacles: Vec<Facing>,
    /// The names of the parts of the outline.
    pub boundaries: Vec<String>,
}

/// The condition on a side of the outline, constant along it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Condition {
    /// The prescribed component of the displacement along each axis, in length.
    pub held: [Option<f64>; 2],
    /// The traction along each axis, in force per area; along a held axis its work is constant, and it is not used.
    pub traction: Point,
    /// The pressure against the outward normal, in force per area.
    pub pressure: f64,
    /// The obstacles that the side may touch.
    pub obstacles: Vec<usize>,
    /// The named parts of the outline that the side belongs to.
    pub boundaries: Vec<usize>,
    /// The circle on which new nodes are placed; without it they halve the straight side.
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
    /// Traction and pressure on a side with this outward unit normal, in force per area.
    pub fn pull(&self, normal: Point) -> Point {
        [0, 1].map(|axis| self.traction[axis] - self.pressure * normal[axis])
    }
}

/// A rigid obstacle with rows along one axis.
#[derive(Clone, Debug)]
pub struct Facing {
    /// The axis, 0 or 1.
    pub axis: usize,
    /// 1 if the obstacle lies towards larger coordinates, else -1.
    pub sense: f64,
    /// Its distance function.
    pub surface: Arc<dyn Distance>,
}

/// The distance to an obstacle.
pub trait Distance: Debug + Send + Sync {
    /// The gap along the straight line between two points; `None` if the obstacle is out of reach on all of the line.
    fn gap(&self, from: Point, to: Point) -> Option<Enclosure>;
}

/// A function on an edge, enclosed by two quadratic functions: `q - below <= g <= q + above`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// q at the start, in the middle and at the end.
    pub values: [f64; 3],
    /// Largest distance of the function below q, `>= 0`.
    pub below: f64,
    /// Largest distance above q, `>= 0`; infinite if nothing can be touched there.
    pub above: f64,
}

impl Enclosure {
    /// The coefficients of q in the basis of Bernstein, `(1-s)^2, 2 s (1-s), s^2`.
    fn bernstein(&self) -> [f64; 3] {
        let [first, middle, last] = self.values;
        [first, 2.0 * middle - (first + last) / 2.0, last]
    }

    /// Bernstein coefficients that a quadratic function must not exceed to stay below g everywhere.
    pub fn lower(&self) -> [f64; 3] {
        self.bernstein().map(|coefficient| coefficient - self.below)
    }

    /// Upper bounds on the means of g with the weights `2 (1-s)` and `2 s`.
    pub fn upper_means(&self) -> [f64; 2] {
        let [first, middle, last] = self.bernstein();
        let mean = |near: f64, far: f64| near / 2.0 + middle / 3.0 + far / 6.0 + self.above;
        [mean(first, last), mean(last, first)]
    }
}

/// Symmetric tensors in the plane, `[xx, yy, xy]`.
pub type Tensor = [f64; 3];

impl PlaneProblem {
    /// The edges of the outline that may touch obstacles, each with its ends and the number of one obstacle.
    pub fn facing<'a>(&'a self, mesh: &'a Triangulation) -> impl Iterator<Item = (usize, [Point; 2], usize)> + 'a {
        mesh.outline().flat_map(move |(_, _, edge, condition)| {
            let ends = mesh.edges[edge].map(|node| mesh.nodes[node]);
            self.conditions[condition].obstacles.iter().map(move |&obstacle| (edge, ends, obstacle))
        })
    }

    /// Returns `true` if the polygon follows a circle more closely with each mesh.
    pub fn has_circles(&self) -> bool {
        self.conditions.iter().any(|condition| condition.circle.is_some())
    }

    /// The mesh in which the marked triangles are refined; new nodes of sides that approximate circles lie on the circles, unless a
    /// triangle would fold: then the new sides are straight.
    pub fn refined(&self, mesh: &Triangulation, marked: &[bool]) -> Triangulation {
        let straight = mesh.refined(marked, |_, middle| middle);
        if !self.has_circles() {
            return straight;
        }
        let round = mesh.refined(marked, |condition, middle| match self.conditions[condition].circle {
            Some(Circle { centre, radius }) => {
                let away = distance(centre, middle);
                [0, 1].map(|axis| centre[axis] + (middle[axis] - centre[axis]) * radius / away)
            }
            None => middle,
        });
        if round.is_folded_beside(&straight) { straight } else { round }
    }

    /// Returns `true` if all obstacles lie in one direction from the body.
    pub fn has_one_direction(&self) -> bool {
        let mut directions = self.obstacles.iter().map(|facing| (facing.axis, facing.sense));
        let first = directions.next();
        first.is_some() && directions.all(|direction| Some(direction) == first)
    }

    /// The strain of a stress.
    pub fn compliance(&self, stress: Tensor) -> Tensor {
        let Lame { lambda, mu } = self.lame;
        let [half_difference, mean] = [(stress[0] - stress[1]) / 2.0, (stress[0] + stress[1]) / 2.0];
        // The parts are kept separate: near incompressibility their sum would lose digits.
        let [shear, volume] = [half_difference / (2.0 * mu), mean / (2.0 * (lambda + mu))];
        [volume + shear, volume - shear, stress[2] / (2.0 * mu)]
    }

    /// The stress of a strain.
    pub fn stress(&self, strain: Tensor) -> Tensor {
        let Lame { lambda, mu } = self.lame;
        let [shear, volume] = [(strain[0] - strain[1]) / 2.0, (strain[0] + strain[1]) / 2.0];
        let [half_difference, mean] = [2.0 * mu * shear, 2.0 * (lambda + mu) * volume];
        [mean + half_difference, mean - half_difference, 2.0 * mu * strain[2]]
    }
}

/// The product of a stress and a strain, `[xx, yy, xy]` each.
pub fn work(stress: Tensor, strain: Tensor) -> f64 {
    stress[0] * strain[0] + stress[1] * strain[1] + 2.0 * stress[2] * strain[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bounds of an enclosure hold for the function `s^2` itself, and for one that leaves it by the margins.
    /// A flat triangle on a chord: the middle of the arc lies beyond its tip, or not.
    #[test]
    fn a_node_goes_onto_its_circle_unless_a_triangle_would_fold() {
        let on_circle = Circle { centre: [0.0, 1.0], radius: 2.0_f64.sqrt() };
        let side = |circle| Condition { circle, ..Condition::default() };
        let problem = PlaneProblem {
            lame: Lame { lambda: 1.0, mu: 1.0 },
            thickness: 1.0,
            body_force: [0.0; 2],
            conditions: vec![side(Some(on_circle)), side(None)],
            obstacles: Vec::new(),
            boundaries: Vec::new(),
        };
        let outline = [([0, 1], 0), ([1, 2], 1), ([0, 2], 1)].into_iter().collect();
        for (tip, moved) in [(-0.1, 0.0), (-2.0, 1.0 - on_circle.radius)] {
            let nodes = vec![[-1.0, 0.0], [1.0, 0.0], [0.0, tip]];
            let mesh = Triangulation::new(nodes, vec![[0, 2, 1]], vec![0], &outline).unwrap();
            let finer = problem.refined(&mesh, &[true]);
            let middle = finer.nodes.iter().skip(3).find(|node| node[0] == 0.0).unwrap();
            assert!((middle[1] - moved).abs() < 1e-15, "{middle:?}");
        }
    }

    #[test]
    fn an_enclosure_bounds_means_and_coefficients() {
        let square = Enclosure { values: [0.0, 0.25, 1.0], below: 0.0, above: 0.0 };
        assert_eq!(square.lower(), [0.0, 0.0, 1.0]);
        // The integrals of 2 (1-s) s^2 and 2 s s^2.
        let [near, far] = square.upper_means();
        assert!((near - 1.0 / 6.0).abs() < 1e-16 && (far - 0.5).abs() < 1e-16);
        let wide = Enclosure { below: 0.5, above: 0.25, ..square };
        assert_eq!(wide.lower(), [-0.5, -0.5, 0.5]);
        assert!((wide.upper_means()[0] - near - 0.25).abs() < 1e-16);
    }

    #[test]
    fn the_strain_of_the_stress_of_a_strain_is_that_strain() {
        let material = PlaneProblem {
            lame: Lame { lambda: 3.0, mu: 0.5 },
            thickness: 1.0,
            body_force: [0.0; 2],
            conditions: Vec::new(),
            obstacles: Vec::new(),
            boundaries: Vec::new(),
        };
        let strain = [0.25, -0.5, 0.125];
        let back = material.compliance(material.stress(strain));
        (0..3).for_each(|entry| assert!((back[entry] - strain[entry]).abs() < 1e-15, "{back:?}"));
        // sigma = lambda tr(eps) I + 2 mu eps.
        assert!((material.stress(strain)[0] - (3.0 * -0.25 + 0.25)).abs() < 1e-15);
    }
}
