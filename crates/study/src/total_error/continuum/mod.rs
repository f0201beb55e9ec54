//! The contact problem of the continuum that a scene describes, before any mesh.

mod surface;

use std::f64::consts::TAU;
use std::sync::Arc;

use signorini_fem::body::{ON_THE_AXIS, Phase};
use signorini_fem::geometry::{COORDINATES, dot};
use signorini_fem::mesh::pieces::Pieces;
use signorini_fem::{Formulation, Region};
use signorini_guarantee::{
    Cells, ContinuumAnswer, ContinuumProblem, Distance, Enclosure, Facing, Linear, Medium, Point, Pressed,
    RigidFace as Plate, SimplexMesh, Surface, Unjoined, pairs,
};
use signorini_mechanics::Error;
use signorini_mechanics::scene::Model;
use signorini_mechanics::scene::input::entry::wrong;
use signorini_mechanics::scene::input::obstacle::{Between, PlacedObstacle};
use signorini_mechanics::scene::input::schema::LoadSpec;
use signorini_mechanics::scene::input::schema::{Rule, Scene};
use signorini_mechanics::scene::models::build::model_of;
use signorini_mechanics::scene::models::model::place;
use signorini_mechanics::scene::models::rigid_face::{Motion, RigidFace};
use surface::none;
pub use surface::{NoGuarantee, WhyNot};

/// Times that facets partly within the reach of a pressed obstacle are refined.
const MOST_ROUNDS: usize = 12;

/// Shares of a surface that differ by less are the same, as in the warning that surfaces are partly tied.
const ALL_OF_IT: f64 = 1e-6;

/// Refuses a scene without an answer in the continuum.
pub fn check(scene: &Scene) -> Result<(), Error> {
    match scene.loads.iter().position(LoadSpec::is_at_points) {
        Some(index) if scene.model.dimension() > 1 => {
            let message = "a force at a point makes an infinite displacement in a continuum, so that there is \
                           no total error; spread it over a boundary";
            let field = if scene.loads[index].is_at_point() { "force" } else { "nodal-forces" };
            Err(wrong(format!("loads[{index}].{field}"), message))
        }
        _ => Ok(()),
    }
}

/// Asks for a guaranteed bound: the problem of the polygon or polyhedron that the mesh of `model` fills and the
/// initial simplices, or why not.
pub fn problem(scene: &Scene, model: &Model) -> Result<(ContinuumProblem, SimplexMesh), WhyNot> {
    let (body, formulation) = (model.body(), *model.body().formulation());
    let thickness = match formulation {
        Formulation::PlaneStrain { thickness } | Formulation::PlaneStress { thickness } => thickness,
        Formulation::Space => 1.0,
        Formulation::Axisymmetric => TAU,
        Formulation::Bar { .. } => {
            let message =
                "a bar has no guaranteed bound: only plane bodies, bodies of revolution and those in space have one";
            return Err(none("model", message));
        }
    };
    let media = body.phases().iter().map(|phase| medium(scene, phase, &formulation)).collect::<Result<_, _>>()?;
    let dimension = model.mesh().dimension();
    let mut problem = ContinuumProblem {
        dimension,
        is_axisymmetric: formulation.is_axisymmetric(),
        media,
        bodies: body.regions().iter().map(Region::elements).collect(),
        medium_of: body.elements().map(|element| element.phase_number as usize).collect(),
        thickness,
        conditions: Vec::new(),
        rigid_faces: model.parts.conditions.rigid_faces.iter().map(rigid_face).collect(),
        obstacles: (0..model.obstacles().len()).map(|index| facing(model, index)).collect::<Result<_, _>>()?,
        boundaries: model
            .mesh()
            .boundaries()
            .iter()
            .map(|boundary| (boundary.name.clone(), body.region_of(boundary).unwrap_or(0)))
            .collect(),
    };
    let at_body = |error: signorini_fem::Error| match error {
        signorini_fem::Error::Mesh { message } => {
            none("body", format!("{message}, so that there is no guaranteed bound"))
        }
        other => Error::from(other).into(),
    };
    let mut pieces = Pieces::of(model.mesh()).map_err(at_body)?;
    if problem.is_axisymmetric {
        let near = ON_THE_AXIS * model.mesh().size();
        pieces.nodes.iter_mut().filter(|node| node[0] <= near).for_each(|node| node[0] = 0.0);
    }
    let unmatched = || {
        let message = match dimension {
            2 => "the triangles of the mesh do not meet in whole edges, so that there is no guaranteed bound",
            _ => {
                "the cells of the mesh, cut into tetrahedra, do not meet in whole faces, so that there is no guaranteed bound"
            }
        };
        none("body", message)
    };
    if !pieces.meet(model.mesh()) {
        return Err(unmatched());
    }
    let surface = surface::conditions(scene, model, &pieces, &mut problem.conditions)?;
    let Pieces { nodes, cells, elements: origins, .. } = pieces;
    let cells = Cells { nodes, cells, origins, surface };
    let mesh = SimplexMesh::new(dimension, cells).ok_or_else(unmatched)?;
    let (mesh, joined) = mesh.joined(&mut problem).map_err(|why| match why {
        Unjoined::Layers(obstacle) => {
            let message =
                "several layers of the bodies lie before each other, so that there is no guaranteed bound; give a smaller `reach`";
            none(format!("obstacles[{obstacle}].shape.body"), message)
        }
        Unjoined::Unmatched => unmatched(),
        Unjoined::Acting(tie) => {
            let message = "a support, a load or an obstacle on a tied surface has no guaranteed bound";
            none(format!("ties[{tie}]"), message)
        }
    })?;
    for (tie, covered) in model.parts.ties.covered.iter().enumerate() {
        let is_joined = |&(side, share): &(usize, f64)| {
            joined.get(tie).is_some_and(|shares| (shares[side] - share).abs() <= ALL_OF_IT)
        };
        if !covered.as_ref().is_some_and(is_joined) {
            let message = match dimension {
                2 => "surfaces that do not lie on each other have no guaranteed bound if they are tied",
                _ => "tied surfaces whose faces, cut into triangles, are not the same have no guaranteed bound",
            };
            return Err(none(format!("ties[{tie}]"), message));
        }
    }
    within_reach(problem, mesh)
}

/// The scene on the last mesh of a guaranteed error, with the boundaries and parts of the first mesh.
pub fn on_last_mesh(scene: &Scene, first: &Model, last: &ContinuumAnswer) -> Result<Model, Error> {
    // Contacts that the program found are found again.
    let found: Vec<&str> = first.obstacles()[scene.obstacles.len()..]
        .iter()
        .flat_map(|obstacle| [Some(obstacle.boundary()), obstacle.other_body().map(|other| other.0)])
        .flatten()
        .collect();
    let mesh = last.mesh_with(|name| !found.contains(&name))?;
    let body = first.body().on(mesh, &last.origins)?;
    // The parts are boundaries of that mesh; to choose them again would move their ends.
    model_of(&Scene { parts: Vec::new(), ..scene.clone() }, vec![body], &[])
}

/// What fills the elements of a phase, under the body forces of the scene.
fn medium(scene: &Scene, phase: &Phase, formulation: &Formulation) -> Result<Medium, WhyNot> {
    if phase.law.turns() {
        let message = "a stiffness with axes around a line has no guaranteed bound";
        return Err(none("material.orthotropic.around", message));
    }
    let mut body_force = [0.0; 3];
    for (index, load) in scene.loads.iter().enumerate() {
        let (force, density) = match load {
            LoadSpec::BodyForce(force) => (force, 1.0),
            // The model is built, so that the density exists.
            LoadSpec::Gravity(acceleration) => (acceleration, phase.material().density().unwrap_or_default()),
            LoadSpec::Centrifugal(_) => {
                let message = "a force that grows with the distance from an axis has no guaranteed bound: only a constant body \
                               force has one";
                return Err(none(format!("loads[{index}].centrifugal"), message));
            }
            _ => continue,
        };
        body_force.iter_mut().zip(force).for_each(|(sum, part)| *sum += density * part);
    }
    // In the plane the stress across it does no work.
    let does_work = |entry: usize| entry != 2 || formulation.dimension() == 3 || formulation.is_axisymmetric();
    let own = |entry: usize| match does_work(entry) {
        true => Linear::of(|place| phase.own_stress(place).map_or(0.0, |stress| stress[entry])),
        false => Linear::default(),
    };
    let own_stress = phase.own.is_some().then(|| [0, 1, 2, 3, 4, 5].map(own));
    Ok(Medium { stiffness: phase.law.stiffness.clone(), own_stress, body_force })
}

/// The problem with a mesh on which some facet lies all within the reach of each pressed obstacle; it is refined there
/// if need be.
fn within_reach(problem: ContinuumProblem, mut mesh: SimplexMesh) -> Result<(ContinuumProblem, SimplexMesh), WhyNot> {
    for round in 0.. {
        let (mut has_facet, mut partly) = (vec![false; problem.obstacles.len()], Vec::new());
        for (outer, obstacle) in problem.facing(&mesh) {
            let Some(gap) = problem.gap(&mesh, outer.facet, obstacle) else { continue };
            if gap.below.is_infinite() {
                let message = "the distance to a surface of this shape has no bounds between nodes, so that there is no guaranteed bound";
                return Err(none(format!("obstacles[{obstacle}].shape"), message));
            }
            has_facet[obstacle] |= gap.above.is_finite();
            partly.push((outer.cell, obstacle));
        }
        let is_missed = |obstacle: &usize| !has_facet[*obstacle] && problem.obstacles[*obstacle].pressed.is_some();
        let Some(obstacle) = (0..has_facet.len()).find(is_missed) else { break };
        let mut marked = vec![false; mesh.count()];
        partly.iter().filter(|of| of.1 == obstacle).for_each(|of| marked[of.0] = true);
        if round == MOST_ROUNDS || problem.has_circles() || !marked.contains(&true) {
            let message = "no facet of the mesh lies all within the reach of the pressed obstacle, so that there is no guaranteed bound; \
                           take smaller cells there";
            return Err(none(format!("obstacles[{obstacle}].force"), message));
        }
        mesh = problem.refined(&mesh, &marked);
    }
    Ok((problem, mesh))
}

/// A rigid face by its motions.
fn rigid_face(face: &RigidFace) -> Plate {
    let field = |moved: &dyn Fn(Point) -> Point| [0, 1, 2].map(|axis| Linear::of(|place| moved(place)[axis]));
    let free = face.motions.iter().filter(|motion| motion.prescribed.is_none());
    let by_one = |motion: &Motion| {
        let unit = face.unit(motion);
        (field(&|place| face.displacement(motion, place).map(|part| unit * part)), unit * motion.force)
    };
    Plate { prescribed: field(&|place| face.prescribed(place)), free: free.map(by_one).collect() }
}

/// The component of a unit vector normal to a coordinate axis below which it is rounding of the written components.
const ALONG_AXIS: f64 = 1e-14;

/// Normals and heights that differ by less than this, relative to the size of the body, belong to one plane.
const IN_PLANE: f64 = 1e-12;

/// The unit vector; along an axis without the rounding of its other components.
fn along_axis(direction: [f64; 3]) -> [f64; 3] {
    let is_across = |axis: usize| (0..3).all(|other| other == axis || direction[other].abs() <= ALONG_AXIS);
    let axis = (0..3).find(|&axis| is_across(axis));
    axis.map_or(direction, |axis| COORDINATES[axis].map(|part| part * direction[axis].signum()))
}

/// Obstacle number `index` of a model, with rows along one direction.
pub(crate) fn facing(model: &Model, index: usize) -> Result<Facing, WhyNot> {
    let (obstacle, path) = (&model.obstacles()[index], format!("obstacles[{index}]"));
    let (shift, approach) = (obstacle.shift(model.gap()), obstacle.approach());
    let rigid = || Shifted { obstacle: obstacle.clone(), gap: shift };
    let changing = || {
        let message = "rows along normals that change along the obstacle have no guaranteed bound: rule `approach` has \
                       one, and a plane";
        none(format!("{path}.rule"), message)
    };
    let body = |normal: Point, between: &Between| {
        if model.mesh().dimension() == 3 {
            return Err(none(&*path, "two bodies in space have no guaranteed bound: only those in the plane have one"));
        }
        let Between { reach, fit, .. } = *between;
        let surface = Surface::Body { reach, fit, shift: shift * dot(normal, approach) };
        Ok((along_axis(normal), surface))
    };
    let (normal, surface): (Point, Surface) = match (obstacle.rule(), obstacle.between()) {
        (Some(Rule::Approach), None) => (along_axis(approach), Surface::Rigid(Arc::new(rigid()))),
        (Some(Rule::Approach), Some(between)) => body(approach, between)?,
        (Some(Rule::ClosestPoint), None) => {
            (along_axis(flat(model, index).ok_or_else(changing)?), Surface::Rigid(Arc::new(Closest(rigid()))))
        }
        (Some(Rule::ClosestPoint), Some(between)) => body(one_normal(model, index).ok_or_else(changing)?, between)?,
        (None, _) => return Err(none(path, "an obstacle without a rule has no guaranteed bound")),
    };
    let pressed = |force| Pressed { force: model.parts.share_of(index, force), cosine: dot(normal, approach) };
    Ok(Facing { normal, surface, pressed: obstacle.force().map(pressed) })
}

/// The normal of all rows of an obstacle, if they have one.
fn one_normal(model: &Model, index: usize) -> Option<Point> {
    let mut rows = model.rows().iter().filter(|row| row.obstacle == index);
    let normal = rows.next()?.normal;
    rows.all(|row| dot(row.normal, normal) > 1.0 - IN_PLANE).then_some(normal)
}

/// The normal of all rows of an obstacle, if they meet it in one plane.
fn flat(model: &Model, index: usize) -> Option<Point> {
    let normal = one_normal(model, index)?;
    let mut heights = model
        .rows()
        .iter()
        .filter(|row| row.obstacle == index)
        .map(|row| dot(place(model, row.node), normal) + row.gap);
    let first = heights.next()?;
    heights.all(|height| (height - first).abs() <= IN_PLANE * model.mesh().size()).then_some(normal)
}

/// An obstacle of the model at its gap.
#[derive(Debug)]
struct Shifted {
    obstacle: PlacedObstacle,
    gap: f64,
}

/// A plane along its normal.
#[derive(Debug)]
struct Closest(Shifted);

impl Distance for Closest {
    fn gap(&self, corners: &[Point]) -> Option<Enclosure> {
        let Closest(Shifted { obstacle, gap }) = self;
        let of_corner = |&corner: &Point| obstacle.rigid()?.shifted_row(corner, *gap).ok()?.map(|row| row.gap);
        let of_corners = corners.iter().map(of_corner).collect::<Option<Vec<f64>>>()?;
        let coefficients = pairs(corners.len()).map(|[i, j]| (of_corners[i] + of_corners[j]) / 2.0).collect();
        Some(Enclosure { coefficients, below: 0.0, above: 0.0 })
    }
}

impl Distance for Shifted {
    fn gap(&self, corners: &[Point]) -> Option<Enclosure> {
        let rigid = self.obstacle.rigid()?;
        match *corners {
            [from, to] => {
                let ([first, middle, last], [below, above]) = rigid.gap_along(from, to, self.gap)?;
                let coefficients = vec![first, last, 2.0 * middle - (first + last) / 2.0];
                Some(Enclosure { coefficients, below, above })
            }
            [first, second, third] => {
                let (coefficients, [below, above]) = rigid.gap_over([first, second, third], self.gap)?;
                Some(Enclosure { coefficients: coefficients.to_vec(), below, above })
            }
            _ => None,
        }
    }
}
