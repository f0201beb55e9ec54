//! The plane contact problem that a scene describes, before any mesh.

use std::collections::{BTreeMap, HashMap};

use super::Model;
use super::entry::wrong;
use super::obstacle::PlacedObstacle;
use super::schema::{LoadSpec, Place, Rule, Scene};
use crate::continuum::{Condition, Distance, Enclosure, Facing, PlaneProblem, Point, Triangulation, twice_area};
use crate::error::Error;
use crate::fem::body::LocalPoint;
use crate::fem::element::{Cell, MAX_NODES};
use crate::fem::formulation::Formulation;
use crate::fem::geometry::distance;
use crate::fem::mesh::Mesh;

/// A node in the middle of an edge that lies off its chord by less than this, relative to the chord, is rounding.
const STRAIGHT: f64 = 1e-9;

/// A direction leans out of a coordinate axis by less than this: rounding of written components.
const ALONG_AXIS: f64 = 1e-14;

impl Scene {
    /// The plane problem of the polygon that the mesh of `model` fills, and the triangles to begin with.
    ///
    /// # Errors
    /// [`Error::Scene`] for what has no guaranteed bound, with the reason.
    pub(crate) fn plane_problem(&self, model: &Model) -> Result<(PlaneProblem, Triangulation), Error> {
        let body = model.body();
        let formulation = *body.formulation();
        let (Formulation::PlaneStrain { thickness } | Formulation::PlaneStress { thickness }) = formulation else {
            let message =
                format!("{} has no guaranteed bound: only plane strain and plane stress have one", formulation.name());
            return Err(wrong("model", message));
        };
        let [region] = body.regions() else {
            return Err(wrong(
                "further-bodies",
                "several bodies have no guaranteed bound: only one body before rigid obstacles has one",
            ));
        };
        let mut body_force = [0.0; 2];
        for load in &self.loads {
            if let LoadSpec::BodyForce(force) = load {
                body_force.iter_mut().zip(force).for_each(|(sum, part)| *sum += part);
            }
        }
        let obstacles = model.obstacles().iter().enumerate();
        let mut problem = PlaneProblem {
            lame: region.material().lame(&formulation)?,
            thickness,
            body_force,
            conditions: Vec::new(),
            obstacles: obstacles
                .map(|(index, obstacle)| facing(index, obstacle, model.gap()))
                .collect::<Result<_, _>>()?,
        };
        let (nodes, triangles, origins) = triangles(model.mesh());
        let outline = self.outline(model, &nodes, &triangles, &mut problem.conditions)?;
        let unmatched = || {
            wrong("body", "the triangles of the mesh do not meet in whole edges, so that there is no guaranteed bound")
        };
        let mesh = Triangulation::new(nodes, triangles, origins, &outline).ok_or_else(unmatched)?;
        Ok((problem, mesh))
    }

    /// The condition of each edge of the outline.
    fn outline(
        &self,
        model: &Model,
        nodes: &[Point],
        triangles: &[[usize; 3]],
        conditions: &mut Vec<Condition>,
    ) -> Result<HashMap<[usize; 2], usize>, Error> {
        let mut outline = Outline::of(model.mesh(), nodes, triangles);
        for (index, support) in self.supports.iter().enumerate() {
            let path = format!("supports[{index}].on");
            let Place::Boundary(name) = &support.on else {
                let message = "a support at a point holds nothing in a continuum, so that there is no guaranteed bound; \
                               hold a boundary";
                return Err(wrong(path, message));
            };
            for component in self.components(index, support)? {
                let Some(axis) = axis_of(component.direction) else {
                    let message = "an inclined support has no guaranteed bound: only one along x or y has one";
                    return Err(wrong(format!("supports[{index}].normal"), message));
                };
                let value = component.value * component.direction[axis];
                outline.change(&format!("{path}.boundary"), name, |condition, _| condition.held[axis] = Some(value))?;
            }
        }
        for (index, load) in self.loads.iter().enumerate() {
            let Some((path, boundary, traction, pressure)) = spread(index, load)? else { continue };
            outline.change(&path, boundary, |condition, normal| {
                (0..2).for_each(|axis| condition.traction[axis] += traction[axis] - pressure * normal[axis]);
            })?;
        }
        for (index, obstacle) in model.obstacles().iter().enumerate() {
            let path = format!("obstacles[{index}].boundary");
            outline.change(&path, obstacle.boundary(), |condition, _| condition.obstacles.push(index))?;
        }
        Ok(outline.numbered(conditions))
    }
}

/// The path, the boundary, the traction and the pressure of a load on the outline; none of a body force.
#[allow(clippy::type_complexity)]
fn spread(index: usize, load: &LoadSpec) -> Result<Option<(String, &str, Point, f64)>, Error> {
    let path = |field: &str| format!("loads[{index}].{field}");
    match load {
        LoadSpec::Traction(spec) => {
            let traction = [0, 1].map(|axis| spec.value.get(axis).copied().unwrap_or(0.0));
            Ok(Some((path("traction.boundary"), &spec.boundary, traction, 0.0)))
        }
        LoadSpec::Pressure(spec) => Ok(Some((path("pressure.boundary"), &spec.boundary, [0.0; 2], spec.value))),
        LoadSpec::BodyForce(_) => Ok(None),
        LoadSpec::Force(_) => {
            let message = "a force at a point makes a displacement without end in a continuum, so that there is no \
                           guaranteed bound; spread it over a boundary";
            Err(wrong(path("force"), message))
        }
    }
}

/// The edges of one triangle alone, by their nodes, increasing: the outward normal and the condition of each.
struct Outline<'a> {
    mesh: &'a Mesh,
    edges: BTreeMap<[usize; 2], (Point, Condition)>,
}

impl<'a> Outline<'a> {
    fn of(mesh: &'a Mesh, nodes: &[Point], triangles: &[[usize; 3]]) -> Self {
        let mut sides: BTreeMap<[usize; 2], Vec<[usize; 2]>> = BTreeMap::new();
        for &[a, b, c] in triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                sides.entry([from.min(to), from.max(to)]).or_default().push([from, to]);
            }
        }
        let normal = |side: [usize; 2]| {
            let [from, to] = side.map(|node| nodes[node]);
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            [(to[1] - from[1]) / length, (from[0] - to[0]) / length]
        };
        let outer = sides.into_iter().filter_map(|(edge, of_edge)| match of_edge[..] {
            [side] => Some((edge, (normal(side), Condition::default()))),
            _ => None,
        });
        Outline { mesh, edges: outer.collect() }
    }

    /// Changes the condition, given the outward normal, on each edge of a boundary that stands at a JSON path.
    fn change(&mut self, path: &str, name: &str, change: impl Fn(&mut Condition, Point)) -> Result<(), Error> {
        for edge in edges_of(self.mesh, name) {
            let Some((normal, condition)) = self.edges.get_mut(&edge) else {
                let message = format!("`{name}` runs through the body, so that there is no guaranteed bound");
                return Err(wrong(path, message));
            };
            change(condition, *normal);
        }
        Ok(())
    }

    /// The number of the condition of each edge; equal ones have one number.
    fn numbered(self, conditions: &mut Vec<Condition>) -> HashMap<[usize; 2], usize> {
        let mut number = |condition: Condition| {
            conditions.iter().position(|other| *other == condition).unwrap_or_else(|| {
                conditions.push(condition);
                conditions.len() - 1
            })
        };
        self.edges.into_iter().map(|(edge, (_, condition))| (edge, number(condition))).collect()
    }
}

impl Model {
    /// The strain `[xx, yy, xy]` of a nodal displacement in an element of a plane mesh, at a point.
    pub(crate) fn plane_strain_in(&self, displacement: &[f64], element: usize) -> impl Fn(Point) -> [f64; 3] {
        let (body, nodes, reference) = (self.body(), self.mesh().element(element), self.mesh().kind().reference());
        let cell = Cell::new(reference, &body.coordinates(nodes));
        let own = body.gather(displacement, nodes);
        move |[x, y]| {
            let derivative = (reference.derivative)(cell.reference_coordinates([x, y, 0.0]));
            let point = LocalPoint { gradients: cell.map(&derivative).gradients, hoop: [0.0; MAX_NODES], weight: 0.0 };
            let strain = point.strain(&own, cell.unit());
            [strain[0], strain[1], strain[3]]
        }
    }
}

/// The axis along which a unit vector lies.
fn axis_of(direction: [f64; 3]) -> Option<usize> {
    (0..2).find(|&axis| direction[axis].abs() > 1.0 - ALONG_AXIS)
}

/// An obstacle whose rows lie along one axis.
fn facing(index: usize, obstacle: &PlacedObstacle, gap: f64) -> Result<Facing, Error> {
    let path = format!("obstacles[{index}]");
    match (obstacle.rule(), axis_of(obstacle.approach())) {
        (Some(Rule::Approach), Some(axis)) if obstacle.rigid().is_some() => {
            let (sense, surface) = (obstacle.approach()[axis].signum(), Shifted { obstacle: obstacle.clone(), gap });
            Ok(Facing { axis, sense, surface: std::sync::Arc::new(surface) })
        }
        (Some(Rule::ClosestPoint), _) => Err(wrong(
            format!("{path}.rule"),
            "rows along the normals of an obstacle have no guaranteed bound: rule `approach` has one",
        )),
        _ => Err(wrong(path, "only the rigid obstacles of a scene have a guaranteed bound")),
    }
}

/// An obstacle of the model at its gap.
#[derive(Debug)]
struct Shifted {
    obstacle: PlacedObstacle,
    gap: f64,
}

impl Distance for Shifted {
    fn gap(&self, from: Point, to: Point) -> Option<Enclosure> {
        let [from, to] = [from, to].map(|[x, y]| [x, y, 0.0]);
        let (values, [below, above]) = self.obstacle.rigid()?.gap_along(from, to, self.gap)?;
        Some(Enclosure { values, below, above })
    }
}

/// The pieces of the facets of a boundary, as edges of the triangles of [`triangles`].
fn edges_of(mesh: &Mesh, name: &str) -> Vec<[usize; 2]> {
    let (numbers, straight) = (numbers(mesh), is_straight(mesh));
    let boundary = mesh.boundary(name);
    let key = |a: usize, b: usize| {
        let [a, b] = [numbers[a], numbers[b]];
        [a.min(b), a.max(b)]
    };
    let of_facet = |facet: &[usize]| match *facet {
        [a, b, middle] if !straight => vec![key(a, middle), key(middle, b)],
        [a, b, ..] => vec![key(a, b)],
        _ => Vec::new(),
    };
    boundary.into_iter().flat_map(|boundary| boundary.facets()).flat_map(of_facet).collect()
}

/// Do all nodes in the middle of edges lie in the middle of their chords?
fn is_straight(mesh: &Mesh) -> bool {
    let nodes = mesh.nodes();
    mesh.elements().all(|element| {
        let corners = corners(element.len());
        (0..element.len() - corners).all(|side| {
            let [from, to] = [element[side], element[(side + 1) % corners]].map(|node| nodes[node]);
            let middle = [0, 1, 2].map(|axis| (from[axis] + to[axis]) / 2.0);
            distance(nodes[element[corners + side]], middle) <= STRAIGHT * distance(from, to)
        })
    })
}

/// Corners of a triangle or a quadrilateral of so many nodes.
fn corners(nodes: usize) -> usize {
    if nodes.is_multiple_of(3) { 3 } else { 4 }
}

/// The number of each node that is a corner of a triangle, in their order.
fn numbers(mesh: &Mesh) -> Vec<usize> {
    let straight = is_straight(mesh);
    let mut used = vec![!straight; mesh.nodes().len()];
    for element in mesh.elements() {
        element[..corners(element.len())].iter().for_each(|&node| used[node] = true);
    }
    let mut next = 0;
    let number = |used: bool| {
        next += usize::from(used);
        next - usize::from(used)
    };
    used.into_iter().map(number).collect()
}

/// The elements cut into triangles, counterclockwise, with the number of the element of each: by their corners where all edges are straight,
/// else by all nodes.
fn triangles(mesh: &Mesh) -> (Vec<Point>, Vec<[usize; 3]>, Vec<usize>) {
    let (numbers, straight) = (numbers(mesh), is_straight(mesh));
    let at = |node: usize| [mesh.nodes()[node][0], mesh.nodes()[node][1]];
    let (mut triangles, mut origins) = (Vec::new(), Vec::new());
    for (number, element) in mesh.elements().enumerate() {
        let corners = corners(element.len());
        let mut inner: Vec<usize> = element[..corners].to_vec();
        if !straight && element.len() > corners {
            let before = |k: usize| element[corners + (k + corners - 1) % corners];
            triangles.extend((0..corners).map(|k| [element[k], element[corners + k], before(k)]));
            inner = element[corners..].to_vec();
        }
        match inner[..] {
            [a, b, c] => triangles.push([a, b, c]),
            [a, b, c, d] => {
                let length = |a: usize, b: usize| distance(mesh.nodes()[a], mesh.nodes()[b]);
                // The shorter diagonal: its triangles are less flat.
                let cut = if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                triangles.extend(cut);
            }
            _ => {}
        }
        origins.resize(triangles.len(), number);
    }
    for triangle in &mut triangles {
        if twice_area(triangle.map(at)) < 0.0 {
            triangle.swap(1, 2);
        }
    }
    let mut nodes = vec![[0.0; 2]; numbers.iter().max().map_or(0, |last| last + 1)];
    triangles.iter().flatten().for_each(|&node| nodes[numbers[node]] = at(node));
    (nodes, triangles.iter().map(|triangle| triangle.map(|node| numbers[node])).collect(), origins)
}
