//! The contact problem of a body before any mesh: its media, and the conditions on its surface.

use std::fmt::Debug;
use std::ops::Range;
use std::sync::Arc;

use super::mesh::{OuterFacet, SimplexMesh};
use super::simplex::{ENTRIES, Point, Tensor, pairs, work};
use signorini_fem::geometry::{COORDINATES, distance, dot, minus, plus};
use signorini_fem::material::{Lame, Matrix, Stiffness, engineering};

/// Frictionless contact of elastic media that fill a polygon, in plane strain or plane stress, or a polyhedron.
#[derive(Clone, Debug)]
pub struct ContinuumProblem {
    /// Number of coordinates of the bodies, 2 or 3.
    pub dimension: usize,
    /// A body of revolution about the y axis, x being the radius.
    pub is_axisymmetric: bool,
    pub media: Vec<Medium>,
    /// The number of the medium of each element of the first mesh.
    pub medium_of: Vec<usize>,
    /// The elements of the first mesh of each body.
    pub bodies: Vec<Range<usize>>,
    /// Depth across the plane, in length; 1 in space, and the angle of a full turn about an axis.
    pub thickness: f64,
    /// The conditions on facets, most of them on the surface: sides of the outline in the plane.
    pub conditions: Vec<Condition>,
    /// The parts of the surface that move as rigid plates.
    pub rigid_faces: Vec<RigidFace>,
    pub obstacles: Vec<Facing>,
    /// The names of the parts of the surface, each with the number of its body.
    pub boundaries: Vec<(String, usize)>,
}

/// What fills a part of the body.
#[derive(Clone, Debug)]
pub struct Medium {
    /// The stiffness in the plane or in space, in force per area; its axes are those of the coordinates.
    pub stiffness: Stiffness,
    /// The stress `[xx, yy, zz, xy, yz, zx]` without strain, if there is one, in force per area.
    pub own_stress: Option<[Linear; 6]>,
    /// Force per volume, constant.
    pub body_force: Point,
}

/// A linear function of the place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Linear {
    pub at_origin: f64,
    pub slope: Point,
}

/// The condition on a facet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Condition {
    /// The prescribed components of the displacement.
    pub held: Vec<Held>,
    pub rigid_face: Option<usize>,
    /// The traction along each axis, in force per area.
    pub traction: [Linear; 3],
    /// The pressure against the outward normal, in force per area.
    pub pressure: Linear,
    /// Springs spread over the facet.
    pub springs: Foundation,
    /// The obstacles that the facet may touch.
    pub obstacles: Vec<usize>,
    /// The obstacles whose surface the facet is a part of: those that are bodies.
    pub faces: Vec<usize>,
    /// The sides of seams that the facet belongs to: 2k and 2k + 1 are the surfaces that are tied at seam k.
    pub seams: Vec<usize>,
    /// The named parts of the surface that the facet belongs to.
    pub boundaries: Vec<usize>,
    /// In the plane, the circle on which new nodes are placed; without it they halve the straight side.
    pub circle: Option<Circle>,
}

/// A prescribed component of the displacement: `direction . u = value`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// The direction of the prescribed component, of length 1.
    pub direction: Point,
    /// The prescribed displacement, in length, linear in space.
    pub value: Linear,
}

/// Springs at rest without displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Foundation {
    /// The stiffness along each axis, in force per volume.
    pub along: Point,
    /// The stiffness along the normal of the facet, in force per volume.
    pub normal: f64,
}

impl Foundation {
    /// The traction against a displacement, in force per area, on a facet with this unit normal.
    pub fn resistance(&self, normal: Point, displacement: Point) -> Point {
        let towards = self.normal * dot(normal, displacement);
        [0, 1, 2].map(|axis| self.along[axis] * displacement[axis] + towards * normal[axis])
    }

    pub fn is_there(&self) -> bool {
        *self != Self::default()
    }
}

/// A part of the surface that moves as a rigid plate: by prescribed motions and amounts of free ones.
#[derive(Clone, Debug)]
pub struct RigidFace {
    /// The displacement by the prescribed motions, along each axis, in length.
    pub prescribed: [Linear; 3],
    /// The displacement along each axis by one of each free motion, and the force or the moment along it.
    pub free: Vec<([Linear; 3], f64)>,
}

/// A circle that a side approximates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// The centre of the circle, in length.
    pub centre: Point,
    /// Its radius, in length.
    pub radius: f64,
}

impl Linear {
    /// The same value everywhere.
    pub fn constant(value: f64) -> Self {
        Linear { at_origin: value, slope: [0.0; 3] }
    }

    /// A linear function, by its values at the origin and at the unit vectors.
    pub fn of(value: impl Fn(Point) -> f64) -> Self {
        let at_origin = value([0.0; 3]);
        Linear { at_origin, slope: COORDINATES.map(|axis| value(axis) - at_origin) }
    }

    pub fn at(&self, place: Point) -> f64 {
        self.at_origin + dot(self.slope, place)
    }

    pub fn times(&self, factor: f64) -> Self {
        Linear { at_origin: factor * self.at_origin, slope: self.slope.map(|part| factor * part) }
    }

    pub fn plus(&self, other: Linear) -> Self {
        let slope = plus(self.slope, other.slope);
        Linear { at_origin: self.at_origin + other.at_origin, slope }
    }
}

impl Condition {
    pub fn pull_along(&mut self, traction: [Linear; 3]) {
        self.traction = [0, 1, 2].map(|axis| self.traction[axis].plus(traction[axis]));
    }

    /// Traction and pressure at a place of a facet with this outward unit normal, in force per area.
    pub fn pull(&self, normal: Point, place: Point) -> Point {
        [0, 1, 2].map(|axis| self.traction[axis].at(place) - self.pressure.at(place) * normal[axis])
    }
}

/// An obstacle with rows along one direction.
#[derive(Clone, Debug)]
pub struct Facing {
    /// The unit vector from the body towards the obstacle.
    pub normal: Point,
    pub surface: Surface,
    /// What presses it, if it moves.
    pub pressed: Option<Pressed>,
}

/// What a body meets at an obstacle.
#[derive(Clone, Debug)]
pub enum Surface {
    /// A rigid surface with this distance function.
    Rigid(Arc<dyn Distance>),
    /// Another body, in the plane.
    Body {
        /// Largest distance at which the bodies may touch, in length.
        reach: f64,
        /// The gap everywhere, in length, instead of the distance of the bodies.
        fit: Option<f64>,
        /// How far the other body stands back along the normal, in length.
        shift: f64,
    },
}

/// The force on an obstacle that a force presses, and the direction of its travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pressed {
    /// The force along its travel.
    pub force: f64,
    /// The part of the travel against the normal: the cosine of their angle.
    pub cosine: f64,
}

pub trait Distance: Debug + Send + Sync {
    /// The gap on the straight facet between these corners, two in the plane and three in space; `None` if the obstacle
    /// is out of reach on all of the facet.
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

/// The distance along a normal from a place to the line through two points in the plane.
fn along_normal(normal: Point, place: Point, line: [Point; 2]) -> f64 {
    let across = [-normal[1], normal[0], 0.0];
    let ([first, second], along) = (line.map(|end| minus(end, place)), minus(line[1], line[0]));
    let share = -dot(across, first) / dot(across, along);
    (1.0 - share) * dot(normal, first) + share * dot(normal, second)
}

/// The mean over a facet of a quadratic function, given by its Bernstein coefficients, with the weight of a corner: its
/// barycentric coordinate.
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

    /// The gap to an obstacle on a facet; `None` if it is out of reach on all of the facet.
    pub fn gap(&self, mesh: &SimplexMesh, facet: usize, obstacle: usize) -> Option<Enclosure> {
        let Facing { normal, surface, .. } = &self.obstacles[obstacle];
        let corners = mesh.corners_of_facet(facet);
        match surface {
            Surface::Rigid(distance) => distance.gap(&corners),
            Surface::Body { fit, shift, .. } => {
                let partner = mesh.partner(facet, obstacle)?;
                let others = mesh.corners_of_facet(partner.on.facet);
                let away = |corner: usize| {
                    let measured = || along_normal(*normal, corners[corner], partner.corners.map(|of| others[of]));
                    fit.unwrap_or_else(measured) + shift
                };
                let of_corners = [away(0), away(1)];
                let coefficients = pairs(2).map(|[i, j]| (of_corners[i] + of_corners[j]) / 2.0).collect();
                Some(Enclosure { coefficients, below: 0.0, above: 0.0 })
            }
        }
    }

    pub fn springs(&self, outer: &OuterFacet) -> Foundation {
        self.conditions[outer.condition].springs
    }

    /// The factor of a traction at a corner of a facet of this length or area.
    pub fn share_of_corner(&self, size: f64) -> f64 {
        self.thickness * size / self.dimension as f64
    }

    /// Returns `true` if the polygon follows a circle more closely with each mesh.
    pub fn has_circles(&self) -> bool {
        self.conditions.iter().any(|condition| condition.circle.is_some())
    }

    /// The mesh in which the marked simplices are refined; new nodes of sides that approximate circles lie on the
    /// circles, unless a simplex would fold: then the new sides are straight.
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

    /// The same body without loads and own stresses.
    pub fn unloaded(&self) -> Self {
        let without = |condition: &Condition| Condition {
            traction: Default::default(),
            pressure: Linear::default(),
            ..condition.clone()
        };
        let at_rest = |medium: &Medium| Medium { own_stress: None, body_force: [0.0; 3], ..medium.clone() };
        ContinuumProblem {
            media: self.media.iter().map(at_rest).collect(),
            conditions: self.conditions.iter().map(without).collect(),
            ..self.clone()
        }
    }

    /// Returns `true` if all obstacles stand still and lie in one direction from the body.
    pub fn has_one_direction(&self) -> bool {
        let mut facing = self.obstacles.iter().map(|facing| (facing.normal, facing.pressed));
        let first = facing.next();
        first.is_some_and(|first| first.1.is_none() && facing.all(|other| other == first))
    }

    /// The forces along the unknowns that are no displacements of places: the free motions of rigid faces, then the
    /// travels of pressed obstacles.
    pub fn loads_of_motions(&self) -> Vec<f64> {
        let of_faces = self.rigid_faces.iter().flat_map(|face| face.free.iter().map(|motion| motion.1));
        of_faces.chain(self.obstacles.iter().filter_map(|facing| Some(facing.pressed?.force))).collect()
    }

    /// The sum of the contact forces, as those that press the obstacles make it; `None` unless all are pressed.
    pub fn pressing_force(&self) -> Option<f64> {
        let along_normal = |facing: &Facing| facing.pressed.map(|Pressed { force, cosine }| force / cosine);
        if self.obstacles.is_empty() { None } else { self.obstacles.iter().map(along_normal).sum() }
    }

    /// The unknown travel of a pressed obstacle, behind the displacements of this number of places and the motions of
    /// rigid faces, with the cosine of its angle to the normal; `None` without a force.
    pub fn travel(&self, obstacle: usize, places: usize) -> Option<(usize, f64)> {
        let cosine = self.obstacles[obstacle].pressed?.cosine;
        let before = self.obstacles[..obstacle].iter().filter(|facing| facing.pressed.is_some()).count();
        let of_faces: usize = self.rigid_faces.iter().map(|face| face.free.len()).sum();
        Some((self.dimension * places + of_faces + before, cosine))
    }

    /// The factor between a stress and what the elements of the stress hold: the radius about an axis, else 1.
    pub fn radius(&self, place: Point) -> f64 {
        if self.is_axisymmetric { place[0] } else { 1.0 }
    }

    pub fn is_on_axis(&self, place: Point) -> bool {
        self.is_axisymmetric && place[0] == 0.0
    }

    /// Traction and pressure on a facet of a condition with this outward unit normal, at a place, times its radius.
    pub fn pull(&self, condition: usize, normal: Point, place: Point) -> Point {
        self.conditions[condition].pull(normal, place).map(|part| self.radius(place) * part)
    }

    pub fn medium(&self, origin: usize) -> &Medium {
        &self.media[self.medium_of[origin]]
    }

    /// The law of the medium of an element of the first mesh.
    pub fn law(&self, origin: usize) -> ElasticLaw<'_> {
        let normals = if self.is_axisymmetric { 3 } else { self.dimension };
        ElasticLaw { normals, stiffness: &self.medium(origin).stiffness }
    }

    /// The largest stiffness against a strain of one component, in force per area.
    pub fn stiffest(&self) -> f64 {
        let of_medium = |medium: &Medium| match &medium.stiffness {
            Stiffness::Isotropic(Lame { lambda, mu }) => lambda + 2.0 * mu,
            Stiffness::General(matrices) => (0..3).map(|axis| matrices.stiffness[axis][axis]).fold(0.0, f64::max),
        };
        self.media.iter().map(of_medium).fold(0.0, f64::max)
    }
}

impl Medium {
    pub fn own_stress(&self, place: Point) -> Tensor {
        self.own_stress.map_or([0.0; 6], |own| own.map(|component| component.at(place)))
    }
}

/// The law of stress and strain of a medium in the plane or in space. In the plane the components with z are zero.
#[derive(Clone, Copy, Debug)]
pub struct ElasticLaw<'a> {
    /// Components on the diagonal of a tensor, 2 in the plane.
    normals: usize,
    stiffness: &'a Stiffness,
}

impl ElasticLaw<'_> {
    /// The strain of a stress.
    pub fn compliance(&self, stress: Tensor) -> Tensor {
        let &Lame { lambda, mu } = match self.stiffness {
            Stiffness::Isotropic(lame) => lame,
            Stiffness::General(matrices) => {
                let [xx, yy, zz, xy, yz, zx] = self.product(&matrices.compliance, stress);
                return [xx, yy, zz, xy / 2.0, yz / 2.0, zx / 2.0];
            }
        };
        let volume = self.normals as f64 * lambda + 2.0 * mu;
        self.split(stress, |mean| mean / volume, |rest| rest / (2.0 * mu))
    }

    pub fn stress(&self, strain: Tensor) -> Tensor {
        let &Lame { lambda, mu } = match self.stiffness {
            Stiffness::Isotropic(lame) => lame,
            Stiffness::General(matrices) => return self.product(&matrices.stiffness, engineering(&strain)),
        };
        let volume = self.normals as f64 * lambda + 2.0 * mu;
        self.split(strain, |mean| volume * mean, |rest| 2.0 * mu * rest)
    }

    /// The sum of functions of the mean of the diagonal and of the rest. The parts are kept separate: near
    /// incompressibility their sum would lose digits.
    fn split(&self, tensor: Tensor, of_mean: impl Fn(f64) -> f64, of_rest: impl Fn(f64) -> f64) -> Tensor {
        let mean = tensor.iter().take(self.normals).sum::<f64>() / self.normals as f64;
        let of_mean = of_mean(mean);
        let entry = |entry: usize| match entry < self.normals {
            true => of_mean + of_rest(tensor[entry] - mean),
            false => of_rest(tensor[entry]),
        };
        std::array::from_fn(entry)
    }

    /// The stress of the strain around an axis, whose energy contains a power of a radius.
    pub fn stress_over_radius(&self, strain: Tensor) -> Tensor {
        [0.0, 0.0, self.stress([0.0, 0.0, strain[2], 0.0, 0.0, 0.0])[2], 0.0, 0.0, 0.0]
    }

    /// The product of two such strains, per volume.
    pub fn over_radius(&self, strain: Tensor, other: Tensor) -> f64 {
        work(self.stress_over_radius(strain), other)
    }

    /// The square of the energy norm of a strain, per volume.
    pub fn square(&self, strain: Tensor) -> f64 {
        work(self.stress(strain), strain)
    }

    /// A matrix times the components of a tensor that exist in the plane or in space.
    fn product(&self, matrix: &Matrix, tensor: Tensor) -> Tensor {
        let entries = ENTRIES[self.normals - 2];
        let mut product = [0.0; 6];
        for &row in entries {
            product[row] = entries.iter().map(|&column| matrix[row][column] * tensor[column]).sum();
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::super::bodies::filled;
    use super::super::mesh::Cells;
    use super::*;

    /// A flat triangle on a chord: the middle of the arc lies beyond its tip, or not.
    #[test]
    fn a_node_goes_onto_its_circle_unless_a_triangle_would_fold() {
        let on_circle = Circle { centre: [0.0, 1.0, 0.0], radius: 2.0_f64.sqrt() };
        let side = |circle| Condition { circle, ..Condition::default() };
        let problem = ContinuumProblem {
            conditions: vec![side(Some(on_circle)), side(None)],
            ..filled(2, Lame { lambda: 1.0, mu: 1.0 }, [0.0; 3])
        };
        let surface = HashMap::from([(vec![0, 1], 0), (vec![1, 2], 1), (vec![0, 2], 1)]);
        for (tip, moved) in [(-0.1, 0.0), (-2.0, 1.0 - on_circle.radius)] {
            let nodes = vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, tip, 0.0]];
            let cells = Cells { nodes, cells: vec![vec![0, 2, 1]], origins: vec![0], surface: surface.clone() };
            let mesh = SimplexMesh::new(2, cells).unwrap();
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
        // On a triangle the mean of l_0^2 with the weight 3 l_0 is 3/10, with 3 l_1 1/10; that of 2 l_0 l_1 is 1/5 and,
        // with 3 l_2, 1/10.
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
            let material = filled(dimension, Lame { lambda: 3.0, mu: 0.5 }, [0.0; 3]);
            let material = material.law(0);
            let back = material.compliance(material.stress(strain));
            (0..6).for_each(|entry| assert!((back[entry] - strain[entry]).abs() < 1e-15, "{back:?}"));
            // sigma = lambda tr(eps) I + 2 mu eps.
            let trace: f64 = strain[..3].iter().sum();
            assert!((material.stress(strain)[0] - (3.0 * trace + 0.25)).abs() < 1e-15);
        }
    }
}
