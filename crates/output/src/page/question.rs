//! The question: supports, loads, obstacles and gaps on the undeformed body.

use serde::Serialize;

use super::body::Shape;
use super::packed::{Packed, Packer};
use crate::view::obstacle::{eye, outline, ways_to_obstacle};
use signorini_mechanics::scene::{HeldNode, Hold, Model};

#[derive(Debug, Serialize)]
pub(super) struct Question {
    /// The scene-wide gap, in length.
    gap: f64,
    obstacles: Vec<ObstacleShown>,
    /// Number of meshed parts in the whole body.
    parts: f64,
    /// In space: the direction from the body to the eye, of any length.
    #[serde(skip_serializing_if = "Option::is_none")]
    eye: Option<[f64; 3]>,
    /// Vertices that are held in all directions.
    fixed: Packed,
    /// Vertices that are held along a direction, one entry for each.
    guided: Directed,
    /// Vertices with a spring to the ground, one entry for each direction.
    springs: Directed,
    /// Vertices of rigid faces.
    rigid: Packed,
    loads: Loads,
}

#[derive(Debug, Serialize)]
struct Directed {
    vertices: Packed,
    /// A component for each coordinate.
    directions: Packed,
}

/// The nodal forces of the loads.
#[derive(Debug, Serialize)]
struct Loads {
    vertices: Packed,
    /// A component for each coordinate, in force.
    forces: Packed,
    /// Number of loaded nodes that are not drawn, because they lie inside.
    inside: usize,
}

#[derive(Debug, Serialize)]
struct ObstacleShown {
    /// The boundary with its candidates.
    boundary: String,
    /// Direction from the body to this obstacle.
    approach: [f64; 3],
    /// Its shift along the approach direction in the outline or patch, in length.
    shift: f64,
    /// The force that presses it, in force, on the whole body.
    #[serde(skip_serializing_if = "Option::is_none")]
    force: Option<f64>,
    /// Its mass, and the speed towards the body with which it starts.
    #[serde(skip_serializing_if = "Option::is_none")]
    inertia: Option<[f64; 2]>,
    /// `true` if it is the surface of another body.
    is_body: bool,
    /// In the plane: points [x, y].
    #[serde(skip_serializing_if = "Option::is_none")]
    outline: Option<Packed>,
    /// In space: the facets at which the rows of the candidates meet it.
    #[serde(skip_serializing_if = "Option::is_none")]
    patch: Option<Patch>,
}

#[derive(Debug, Serialize)]
struct Patch {
    places: Packed,
    /// Triangles and quadrilaterals, the last vertex of a triangle twice.
    cells: Packed,
}

impl Question {
    pub fn of(model: &Model, shape: &Shape, packer: &mut Packer) -> Self {
        let holds = Holds::of(model, shape);
        let is_rigid = |index: &usize| model.obstacles()[*index].rigid().is_some();
        let seen = (0..model.obstacles().len()).find(is_rigid).or((!model.obstacles().is_empty()).then_some(0));
        let obstacles = (0..model.obstacles().len()).map(|index| obstacle(model, index, packer)).collect();
        Question {
            gap: model.gap(),
            obstacles,
            parts: model.parts_of_whole(),
            eye: (model.mesh().dimension() == 3).then(|| eye(model, seen)),
            fixed: packer.whole(&holds.fixed, 1),
            guided: holds.guided.packed(packer),
            springs: holds.springs.packed(packer),
            rigid: packer.whole(&holds.rigid, 1),
            loads: loads(model, shape, packer),
        }
    }
}

/// The supports at vertices of the body.
#[derive(Default)]
struct Holds {
    fixed: Vec<usize>,
    guided: Along,
    springs: Along,
    rigid: Vec<usize>,
}

/// Vertices, each with a direction of as many components as the body has dimensions.
#[derive(Default)]
struct Along {
    vertices: Vec<usize>,
    components: Vec<f64>,
    dimension: usize,
}

impl Holds {
    fn of(model: &Model, shape: &Shape) -> Self {
        let dimension = model.mesh().dimension();
        let along = || Along { dimension, ..Along::default() };
        let mut holds = Holds { guided: along(), springs: along(), ..Holds::default() };
        for HeldNode { node, hold, directions } in model.held_nodes() {
            let Some(vertex) = shape.vertex_of[node] else { continue };
            match hold {
                Hold::Fixed => holds.fixed.push(vertex),
                Hold::Guided => holds.guided.add(vertex, &directions),
                Hold::Spring => holds.springs.add(vertex, &directions),
                Hold::RigidFace => holds.rigid.push(vertex),
            }
        }
        holds
    }
}

impl Along {
    fn add(&mut self, vertex: usize, directions: &[[f64; 3]]) {
        for direction in directions {
            self.vertices.push(vertex);
            self.components.extend_from_slice(&direction[..self.dimension]);
        }
    }

    fn packed(&self, packer: &mut Packer) -> Directed {
        Directed {
            vertices: packer.whole(&self.vertices, 1),
            directions: packer.quantised(&self.components, self.dimension),
        }
    }
}

fn loads(model: &Model, shape: &Shape, packer: &mut Packer) -> Loads {
    let dimension = model.mesh().dimension();
    let (mut vertices, mut forces, mut inside) = (Vec::new(), Vec::new(), 0);
    for (node, force) in model.loaded_nodes() {
        match shape.vertex_of.get(node).copied().flatten() {
            Some(vertex) => {
                vertices.push(vertex);
                forces.extend_from_slice(force);
            }
            None => inside += 1,
        }
    }
    Loads { vertices: packer.whole(&vertices, 1), forces: packer.quantised(&forces, dimension), inside }
}

fn obstacle(model: &Model, index: usize, packer: &mut Packer) -> ObstacleShown {
    let obstacle = &model.obstacles()[index];
    let shift = obstacle.shift(model.gap());
    let points = outline(model, index, shift).concat();
    ObstacleShown {
        boundary: obstacle.boundary().to_string(),
        approach: obstacle.approach(),
        shift,
        force: model.pressing_force_on(index),
        inertia: obstacle.inertia().map(|inertia| [inertia.mass, inertia.speed]),
        is_body: obstacle.rigid().is_none(),
        outline: (!points.is_empty()).then(|| packer.exact(&points, 2)),
        patch: if obstacle.rigid().is_some() { patch(model, index, packer) } else { None },
    }
}

/// The part of an obstacle in space that faces the candidates: each facet is moved to the points at which the rows of
/// its nodes meet the obstacle.
fn patch(model: &Model, index: usize, packer: &mut Packer) -> Option<Patch> {
    if model.mesh().dimension() != 3 {
        return None;
    }
    let boundary = model.mesh().boundary(model.obstacles()[index].boundary())?;
    let mut place_of = vec![None; model.mesh().nodes().len()];
    let mut places = Vec::new();
    for (node, way) in ways_to_obstacle(model, index, 0.0) {
        place_of[node] = Some(places.len() / 3);
        places.extend([0, 1, 2].map(|axis| model.mesh().nodes()[node][axis] + way[axis]));
    }
    let mut cells = Vec::new();
    for cell in boundary.facets().flat_map(|facet| boundary.kind.straight_cells(facet)) {
        let found: Option<Vec<usize>> = cell.iter().map(|&node| place_of[node]).collect();
        let Some(found) = found.filter(|found| found.len() > 2) else { continue };
        cells.extend((0..4).map(|corner| found[corner.min(found.len() - 1)]));
    }
    (!cells.is_empty()).then(|| Patch { places: packer.quantised(&places, 3), cells: packer.whole(&cells, 4) })
}
