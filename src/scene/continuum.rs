//! The plane contact problem that a scene describes, before any mesh.

use std::collections::HashMap;

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
        let mut sides: HashMap<[usize; 2], Vec<[usize; 2]>> = HashMap::new();
        for &[a, b, c] in triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                sides.entry([from.min(to), from.max(to)]).or_default().push([from, to]);
            }
        }
        sides.retain(|_, directed| directed.len() == 1);
        let mut own: HashMap<[usize; 2], Condition> = sides.keys().map(|&edge| (edge, Condition::default())).collect();
        let edges = |path: String, name: &str| -> Result<Vec<[usize; 2]>, Error> {
            let edges = edges_of(model.mesh(), name);
            match edges.iter().all(|edge| sides.contains_key(edge)) {
                true => Ok(edges),
                false => {
                    Err(wrong(path, format!("`{name}` runs through the body, so that there is no guaranteed bound")))
                }
            }
        };
        for (index, support) in self.supports.iter().enumerate() {
            let path = format!("supports[{index}].on");
            let Place::Boundary(name) = &support.on else {
                return Err(wrong(
                    path,
                    "a support at a point holds nothing in a continuum, so that there is no guaranteed bound; hold a boundary",
                ));
            };
            let edges = edges(format!("{path}.boundary"), name)?;
            for component in self.components(index, support)? {
                let Some(axis) = axis_of(component.direction) else {
                    let path = format!("supports[{index}].normal");
                    return Err(wrong(
                        path,
                        "an inclined support has no guaranteed bound: only one along x or y has one",
                    ));
                };
                for edge in &edges {
                    let value = component.value * component.direction[axis];
                    own.entry(*edge).or_default().held[axis] = Some(value);
                }
            }
        }
        for (index, load) in self.loads.iter().enumerate() {
            self.add_tractions(index, load, &edges, &mut |edge, traction_of| {
                let [from, to] = sides[&edge][0].map(|node| nodes[node]);
                let length = (to[0] - from[0]).hypot(to[1] - from[1]);
                let normal = [(to[1] - from[1]) / length, (from[0] - to[0]) / length];
                let traction = traction_of(normal);
                let sum = &mut own.entry(edge).or_default().traction;
                (0..2).for_each(|axis| sum[axis] += traction[axis]);
            })?;
        }
        for (index, obstacle) in model.obstacles().iter().enumerate() {
            for edge in edges(format!("obstacles[{index}].boundary"), obstacle.boundary())? {
                own.entry(edge).or_default().obstacles.push(index);
            }
        }
        let mut number = |condition: Condition| {
            conditions.iter().position(|other| *other == condition).unwrap_or_else(|| {
                conditions.push(condition);
                conditions.len() - 1
            })
        };
        let mut sorted: Vec<_> = own.into_iter().collect();
        sorted.sort_unstable_by_key(|entry| entry.0);
        Ok(sorted.into_iter().map(|(edge, condition)| (edge, number(condition))).collect())
    }

    /// Gives each edge of a load its traction, by the outward normal there.
    fn add_tractions(
        &self,
        index: usize,
        load: &LoadSpec,
        edges: &dyn Fn(String, &str) -> Result<Vec<[usize; 2]>, Error>,
        add: &mut dyn FnMut([usize; 2], &dyn Fn(Point) -> Point),
    ) -> Result<(), Error> {
        let path = format!("loads[{index}]");
        match load {
            LoadSpec::Traction(spec) => {
                let value = [0, 1].map(|axis| spec.value.get(axis).copied().unwrap_or(0.0));
                edges(format!("{path}.traction.boundary"), &spec.boundary)?
                    .into_iter()
                    .for_each(|edge| add(edge, &|_| value));
            }
            LoadSpec::Pressure(spec) => {
                let against = |normal: Point| normal.map(|part| -spec.value * part);
                edges(format!("{path}.pressure.boundary"), &spec.boundary)?
                    .into_iter()
                    .for_each(|edge| add(edge, &against));
            }
            LoadSpec::BodyForce(_) => {}
            LoadSpec::Force(_) => {
                let message = "a force at a point makes a displacement without end in a continuum, so that there is no guaranteed bound; spread it over a boundary";
                return Err(wrong(format!("{path}.force"), message));
            }
        }
        Ok(())
    }
}

impl Model {
    /// The strain `[xx, yy, xy]` of a nodal displacement at a point of an element of a plane mesh.
    pub(crate) fn plane_strain_at(&self, displacement: &[f64], element: usize, [x, y]: Point) -> [f64; 3] {
        let (body, nodes) = (self.body(), self.mesh().element(element));
        let cell = Cell::new(self.mesh().kind().reference(), &body.coordinates(nodes));
        let reference = cell.reference_coordinates([x, y, 0.0]);
        let derivative = (self.mesh().kind().reference().derivative)(reference);
        let point = LocalPoint { gradients: cell.map(&derivative).gradients, hoop: [0.0; MAX_NODES], weight: 0.0 };
        let strain = point.strain(&body.gather(displacement, nodes), cell.unit());
        [strain[0], strain[1], strain[3]]
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
