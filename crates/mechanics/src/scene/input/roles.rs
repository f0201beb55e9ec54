//! The boundaries of a mesh that a first scene holds and presses: chosen by name and by the direction that they face.

use std::collections::HashSet;

use super::schema::PartSpec;
use super::schema::part::PartNormalSpec;
use crate::fem::assembly::{node_normals, tributary_areas};
use crate::fem::body::ElasticBody;
use crate::fem::geometry::{along_axis, dot, length};
use crate::fem::mesh::{Boundary, Mesh, extent};

/// Words in the name of a boundary that is held, and of a boundary that is pressed.
const HELD: [&str; 9] = ["fix", "clamp", "support", "held", "base", "bottom", "root", "cut", "ground"];
const PRESSED: [&str; 8] = ["contact", "touch", "press", "top", "upper", "seat", "round", "arc"];

/// A mean normal shorter than this belongs to a boundary that faces all directions.
const FACING: f64 = 0.5;

/// A component within this share of the largest one counts as equal: the boundary faces several axes alike.
const ALIKE: f64 = 0.99;

/// The facets of a part have normals within this angle of its direction, in degrees.
const WITHIN: f64 = 45.0;

/// The plate first touches a node whose normal makes an angle with this cosine or a larger one with the way of the plate: about 60 degrees,
/// above the angle of a face that is inclined to all axes alike.
const FIRST: f64 = 0.5;

/// Sines below this are rounding: such a normal is perpendicular to the way of the plate.
const SIDEWAYS: f64 = 1e-6;

/// Nodes within this share of the body's size of the highest one are as high.
const AS_HIGH: f64 = 1e-6;

/// An axis and a sense along it, 1 or -1.
pub(crate) type Way = (usize, f64);

/// Facets that are held or pressed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Chosen {
    /// A boundary.
    Boundary(String),
    /// The facets that face a direction: of a boundary, or of the whole surface.
    Facing(Way, Option<String>),
}

impl Chosen {
    /// The part of a scene that has the facets which face a direction.
    pub fn spec((axis, sense): Way, of: Option<String>, dimension: usize) -> PartSpec {
        let direction = along_axis(axis, sense)[..dimension].to_vec();
        let normal = Some(PartNormalSpec { direction, within: WITHIN });
        PartSpec { name: String::new(), of, cuboid: None, sphere: None, normal }
    }
}

/// The boundaries that are held and pressed.
#[derive(Clone, Debug)]
pub(crate) struct Roles {
    pub held: Chosen,
    pub pressed: Chosen,
    /// The axis and the sense of the way of the plate.
    pub way: Way,
    /// The smallest and the largest coordinates of what is pressed.
    pub extent: ([f64; 3], [f64; 3]),
}

/// What is pressed, with its nodes that the plate touches first.
struct Pressed {
    chosen: Chosen,
    way: Way,
    extent: ([f64; 3], [f64; 3]),
    first: Vec<usize>,
}

/// The roles that fit, the best first: those of two named boundaries, then those of the sides that face down and up.
pub(crate) fn roles(body: &ElasticBody) -> Vec<Roles> {
    let mesh = body.mesh();
    let (surface, pieces) = (mesh.surface(0..mesh.element_count()), mesh.pieces());
    let named: Vec<&Boundary> = mesh.boundaries().iter().filter(|boundary| is_outside(boundary, &surface)).collect();
    let held_by_word = named.iter().find(|boundary| has(&HELD, &boundary.name)).copied();
    let is_held = |boundary: &Boundary| held_by_word.is_some_and(|held| held.name == boundary.name);
    let mut pressed: Vec<(usize, &Boundary)> =
        named.iter().copied().enumerate().filter(|(_, boundary)| !is_held(boundary)).collect();
    // Boundaries with a word first, then those that face one direction, then the last ones of the file.
    pressed.sort_by_key(|(place, boundary)| {
        let faces_all = length(mean_normal(body, boundary)) < FACING;
        (!has(&PRESSED, &boundary.name), faces_all, std::cmp::Reverse(*place))
    });
    let of_names = pressed.iter().find_map(|(_, boundary)| {
        let pressed = Pressed::of(body, boundary)?;
        let others = held_by_word.into_iter().chain(named.iter().copied()).filter(|other| other.name != boundary.name);
        let held = others.into_iter().find(|other| pressed.is_free_of(other) && holds_all(mesh, &pieces, other))?;
        Some(pressed.held_at(Chosen::Boundary(held.name.clone())))
    });
    let up = mesh.dimension() - 1;
    let of_sides = || {
        let [lower, upper] = [-1.0, 1.0].map(|sense| part(body, &surface, (up, sense)));
        let (lower, pressed) = (lower?, Pressed::new(body, &upper?, Chosen::Facing((up, 1.0), None), (up, 1.0))?);
        let is_fit = pressed.is_free_of(&lower) && holds_all(mesh, &pieces, &lower);
        is_fit.then(|| pressed.held_at(Chosen::Facing((up, -1.0), None)))
    };
    of_names.into_iter().chain(of_sides()).collect()
}

impl Pressed {
    /// The boundary, if its normals allow it, or else its facets that face its direction; `None` without such facets.
    fn of(body: &ElasticBody, boundary: &Boundary) -> Option<Self> {
        let way = facing(mean_normal(body, boundary), body.dimension() - 1);
        let name = || boundary.name.clone();
        Self::new(body, boundary, Chosen::Boundary(name()), way)
            .or_else(|| Self::new(body, &part(body, boundary, way)?, Chosen::Facing(way, Some(name())), way))
    }

    /// Facets whose normals all allow a plate to come this way; `None` if one does not, or without facets.
    fn new(body: &ElasticBody, facets: &Boundary, chosen: Chosen, way: Way) -> Option<Self> {
        let nodes = body.mesh().nodes();
        let places: Vec<[f64; 3]> = facets.nodes().into_iter().map(|node| nodes[node]).collect();
        let height = |node: usize| way.1 * nodes[node][way.0];
        let facing = along_axis(way.0, way.1);
        let leans: Vec<(usize, f64)> =
            node_normals(body, facets).into_iter().map(|(node, normal)| (node, dot(normal, facing))).collect();
        let top = leans.iter().map(|&(node, _)| height(node)).reduce(f64::max)?;
        let is_first = |node: usize| height(node) > top - AS_HIGH * body.mesh().size();
        let allows = |&(node, lean): &(usize, f64)| lean > if is_first(node) { FIRST } else { -SIDEWAYS };
        let first = leans.iter().map(|&(node, _)| node).filter(|&node| is_first(node)).collect();
        leans.iter().all(allows).then(|| Pressed { chosen, way, extent: extent(&places), first })
    }

    /// Returns `true` if `held` holds none of the nodes that the plate touches first: they would stop it.
    fn is_free_of(&self, held: &Boundary) -> bool {
        let held: HashSet<usize> = held.nodes().into_iter().collect();
        self.first.iter().all(|node| !held.contains(node))
    }

    fn held_at(self, held: Chosen) -> Roles {
        Roles { held, pressed: self.chosen, way: self.way, extent: self.extent }
    }
}

/// Returns `true` if a boundary has a facet of every piece of the mesh.
fn holds_all(mesh: &Mesh, pieces: &[usize], boundary: &Boundary) -> bool {
    let all: HashSet<usize> = pieces.iter().copied().collect();
    let held: HashSet<usize> =
        mesh.faces_of(boundary).into_iter().flatten().map(|(element, _)| pieces[element]).collect();
    held == all
}

fn has(words: &[&str], name: &str) -> bool {
    words.iter().any(|word| name.to_lowercase().contains(word))
}

/// Returns `true` if every facet of a boundary lies on the surface of the mesh.
fn is_outside(boundary: &Boundary, surface: &Boundary) -> bool {
    let sorted = |facet: &[usize]| {
        let mut nodes = facet.to_vec();
        nodes.sort_unstable();
        nodes
    };
    let outer: HashSet<Vec<usize>> = surface.facets().map(sorted).collect();
    boundary.facets().all(|facet| outer.contains(&sorted(facet)))
}

/// The facets of a boundary that face a direction along an axis; `None` without one.
fn part(body: &ElasticBody, boundary: &Boundary, way: Way) -> Option<Boundary> {
    Chosen::spec(way, None, body.dimension()).facets(body, boundary, "").ok()
}

/// The mean of the outward normals of a boundary by area; short if they cancel.
fn mean_normal(body: &ElasticBody, boundary: &Boundary) -> [f64; 3] {
    let areas = tributary_areas(body, boundary);
    let area: f64 = areas.iter().map(|(_, area)| area).sum();
    let mut normal = [0.0; 3];
    for ((_, of_node), (_, own)) in areas.iter().zip(node_normals(body, boundary)) {
        (0..3).for_each(|axis| normal[axis] += of_node / area * own[axis]);
    }
    normal
}

/// The axis and the sense of a boundary's normal; the vertical axis if the normal is as close to it as to another, and up if the boundary
/// faces all directions.
fn facing(normal: [f64; 3], up: usize) -> Way {
    if length(normal) < FACING {
        return (up, 1.0);
    }
    let largest = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(up);
    let axis = if normal[up].abs() > ALIKE * normal[largest].abs() { up } else { largest };
    (axis, normal[axis].signum())
}
