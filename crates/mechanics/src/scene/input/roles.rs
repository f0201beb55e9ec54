//! The boundaries of the bodies that a first scene holds and presses: chosen by name and by the direction that they
//! face.

use std::collections::HashSet;

use super::schema::PartSpec;
use super::schema::body::PartNormalSpec;
use crate::fem::assembly::{node_normals, tributary_areas};
use crate::fem::body::ElasticBody;
use crate::fem::geometry::{along_axis, dot, length, shifted, sorted};
use crate::fem::mesh::{Boundary, extent};

/// Words in the name of a boundary that is held, and of a boundary that is pressed.
const HELD: [&str; 9] = ["fix", "clamp", "support", "held", "base", "bottom", "root", "cut", "ground"];
const PRESSED: [&str; 8] = ["contact", "touch", "press", "top", "upper", "seat", "round", "arc"];

/// A mean normal shorter than this belongs to a boundary that faces all directions.
const FACING: f64 = 0.5;

/// A component within this share of the largest one counts as equal: the boundary faces several axes alike.
const ALIKE: f64 = 0.99;

/// The facets of a part have normals within this angle of its direction, in degrees.
const WITHIN: f64 = 45.0;

/// The plate first touches a node whose normal makes an angle with this cosine or a larger one with the way of the
/// plate: about 60 degrees, above the angle of a face that is inclined to all axes alike.
const FIRST: f64 = 0.5;

/// Sines below this are rounding: such a normal is perpendicular to the way of the plate.
const SIDEWAYS: f64 = 1e-6;

/// Nodes within this share of the body's size of the highest one are as high.
const AS_HIGH: f64 = 1e-6;

/// An axis and a sense along it, 1 or -1.
pub(crate) type Way = (usize, f64);

/// The smallest and the largest coordinates of a set of nodes.
type Extent = ([f64; 3], [f64; 3]);

/// Facets that are held or pressed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Chosen {
    Boundary(String),
    /// The facets that face a direction: of a boundary, or of the whole surface.
    Facing(Way, Option<String>),
}

impl Chosen {
    /// The further body, or the boundary, of which it has the facets that face a direction.
    pub fn of(&self) -> Option<&str> {
        match self {
            Chosen::Boundary(_) => None,
            Chosen::Facing(_, of) => of.as_deref(),
        }
    }

    /// The part of a scene that has the facets which face a direction.
    pub fn spec((axis, sense): Way, of: Option<String>, dimension: usize) -> PartSpec {
        let direction = along_axis(axis, sense)[..dimension].to_vec();
        let normal = Some(PartNormalSpec { direction, within: WITHIN });
        PartSpec { name: String::new(), of, cuboid: None, sphere: None, normal }
    }
}

/// What is held and what is pressed.
#[derive(Clone, Debug)]
pub(crate) struct Roles {
    pub held: Chosen,
    /// What is held too: the boundaries of the same name on other bodies, or the sides of other bodies that lie as low.
    pub also_held: Vec<Chosen>,
    /// The bodies without a held boundary, by their numbers.
    pub loose: Vec<usize>,
    pub pressed: Chosen,
    /// The axis and the sense of the way of the plate.
    pub way: Way,
    /// That of what is pressed.
    pub extent: Extent,
}

/// What is pressed, with its nodes that the plate touches first.
struct PressedFacets {
    chosen: Chosen,
    way: Way,
    extent: Extent,
    first: Vec<usize>,
}

/// How well a held and a pressed side go together, the best first: the force goes from body to body, or at least from
/// one to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fit {
    Stacked,
    Apart,
    SameBody,
}

/// The sides of the bodies that may be held or pressed.
struct BodySides<'a> {
    body: &'a ElasticBody,
    /// The surface of each body.
    surfaces: Vec<Boundary>,
    /// The piece of the mesh of each element.
    pieces: Vec<usize>,
    /// The boundaries on the outside.
    named: Vec<&'a Boundary>,
}

/// The roles that fit, the best first: among those as good, those of two named boundaries, then those of the sides that
/// face an axis.
pub(crate) fn roles(body: &ElasticBody) -> Vec<Roles> {
    let mesh = body.mesh();
    let surfaces: Vec<Boundary> = body.regions().iter().map(|region| mesh.surface(region.elements())).collect();
    let named = mesh.boundaries().iter().filter(|boundary| is_outside(boundary, &surfaces)).collect();
    let sides = BodySides { body, surfaces, pieces: mesh.pieces(), named };
    let mut found: Vec<(Fit, Roles)> = sides.of_names().into_iter().chain(sides.of_axes()).collect();
    found.sort_by_key(|(fit, _)| *fit);
    found.into_iter().map(|(_, roles)| roles).collect()
}

impl BodySides<'_> {
    /// The best roles of two named boundaries.
    fn of_names(&self) -> Option<(Fit, Roles)> {
        let by_word: Vec<&Boundary> =
            self.named.iter().copied().filter(|boundary| has(&HELD, &boundary.name)).collect();
        let is_held = |boundary: &Boundary| by_word.first().is_some_and(|first| first.name == boundary.name);
        let mut pressed: Vec<(usize, &Boundary)> =
            self.named.iter().copied().enumerate().filter(|(_, boundary)| !is_held(boundary)).collect();
        // Boundaries with a word first, then those that face one direction, then the last ones of the file.
        pressed.sort_by_key(|(place, boundary)| {
            let faces_all = length(mean_normal(self.body, boundary)) < FACING;
            (!has(&PRESSED, &boundary.name), faces_all, std::cmp::Reverse(*place))
        });
        let held: Vec<&Boundary> = by_word.iter().chain(&self.named).copied().collect();
        let mut best: Option<(Fit, PressedFacets, &Boundary)> = None;
        for (_, boundary) in pressed {
            let Some(pressed) = PressedFacets::of(self.body, boundary) else { continue };
            let others = held.iter().filter(|other| other.name != boundary.name);
            let fits = others.filter_map(|other| Some((self.fit(&pressed, boundary, other)?, *other)));
            let Some((fit, other)) = fits.min_by_key(|(fit, _)| *fit) else { continue };
            if best.as_ref().is_none_or(|(least, ..)| fit < *least) {
                best = Some((fit, pressed, other));
            }
            if fit == Fit::Stacked {
                break;
            }
        }
        let (fit, pressed, held) = best?;
        let alike = self.named.iter().copied().filter(|other| self.is_alike(other, held));
        let also = alike.map(|other| (Chosen::Boundary(other.name.clone()), other)).collect();
        Some((fit, self.roles(pressed, (Chosen::Boundary(held.name.clone()), held), also)))
    }

    /// The roles of sides that face an axis: up and down alone for a single body.
    fn of_axes(&self) -> Vec<(Fit, Roles)> {
        let (up, count) = (self.body.dimension() - 1, self.surfaces.len());
        let senses: &[f64] = if count > 1 { &[1.0, -1.0] } else { &[1.0] };
        let axes = (0..=up).rev().filter(|&axis| axis == up || count > 1);
        let mut found = Vec::new();
        for (axis, &sense) in axes.flat_map(|axis| senses.iter().map(move |sense| (axis, sense))) {
            let (way, back) = ((axis, sense), (axis, -sense));
            let of = |region: usize| (region > 0).then(|| self.body.regions()[region].name().to_string());
            let side = |region: usize, way: Way| part(self.body, &self.surfaces[region], way);
            let lowest = |region: &usize| self.is_last(self.extent_of(*region), back);
            let lows: Vec<(usize, Boundary)> =
                (0..count).filter(lowest).filter_map(|region| Some((region, side(region, back)?))).collect();
            for upper in 0..count {
                let Some(top) = side(upper, way) else { continue };
                for (lower, held) in &lows {
                    let chosen = Chosen::Facing(way, of(upper));
                    let Some(pressed) = PressedFacets::new(self.body, &top, chosen, way) else { break };
                    let Some(fit) = self.fit(&pressed, &top, held) else { continue };
                    let as_low = lows.iter().filter(|(other, _)| other != lower);
                    let also = as_low.map(|(other, side)| (Chosen::Facing(back, of(*other)), side)).collect();
                    found.push((fit, self.roles(pressed, (Chosen::Facing(back, of(*lower)), held), also)));
                }
            }
        }
        found
    }

    /// How well a pressed and a held side go together; `None` if they do not.
    fn fit(&self, pressed: &PressedFacets, facets: &Boundary, held: &Boundary) -> Option<Fit> {
        if !pressed.is_free_of(held) || !self.holds_all(held) {
            return None;
        }
        let (upper, lower) = (self.body.region_of(facets)?, self.body.region_of(held)?);
        let (way, back) = (pressed.way, (pressed.way.0, -pressed.way.1));
        if self.surfaces.len() == 1 {
            return Some(Fit::Stacked);
        }
        let nodes = self.body.mesh().nodes();
        let of_held = extent(&held.nodes().into_iter().map(|node| nodes[node]).collect::<Vec<_>>());
        if !self.is_last(pressed.extent, way) || !self.is_last(of_held, back) {
            return None;
        }
        let [above, below] = [upper, lower].map(|region| self.extent_of(region));
        let lies_above = reach(above, back) + reach(below, way) < self.tolerance();
        Some(match (upper == lower, lies_above) {
            (true, _) => Fit::SameBody,
            (false, true) => Fit::Stacked,
            (false, false) => Fit::Apart,
        })
    }

    fn extent_of(&self, region: usize) -> Extent {
        self.body.mesh().extent_of(self.body.regions()[region].nodes())
    }

    /// Returns `true` if no node of any body lies farther along a way than this extent.
    fn is_last(&self, extent: Extent, way: Way) -> bool {
        reach(extent, way) > reach(self.body.mesh().extent(), way) - self.tolerance()
    }

    fn tolerance(&self) -> f64 {
        AS_HIGH * self.body.mesh().size()
    }

    /// Returns `true` if a boundary has the name of another one that is held, on another body.
    fn is_alike(&self, other: &Boundary, held: &Boundary) -> bool {
        let own_name = |boundary: &Boundary| {
            let region = self.body.region_of(boundary).map_or("", |region| self.body.regions()[region].name());
            let own = boundary.name.strip_prefix(region).and_then(|rest| rest.strip_prefix('.'));
            own.filter(|_| !region.is_empty()).unwrap_or(&boundary.name).to_string()
        };
        has(&HELD, &held.name) && other.name != held.name && own_name(other) == own_name(held)
    }

    fn roles(
        &self,
        pressed: PressedFacets,
        (chosen, held): (Chosen, &Boundary),
        also: Vec<(Chosen, &Boundary)>,
    ) -> Roles {
        let fits = |(_, other): &(Chosen, &Boundary)| pressed.is_free_of(other) && self.holds_all(other);
        let also: Vec<(Chosen, &Boundary)> = also.into_iter().filter(fits).collect();
        let fixed = also.iter().map(|(_, other)| *other).chain([held]);
        let fixed: Vec<usize> = fixed.filter_map(|boundary| self.body.region_of(boundary)).collect();
        Roles {
            held: chosen,
            loose: (0..self.surfaces.len()).filter(|region| !fixed.contains(region)).collect(),
            also_held: also.into_iter().map(|(chosen, _)| chosen).collect(),
            pressed: pressed.chosen,
            way: pressed.way,
            extent: pressed.extent,
        }
    }

    /// Returns `true` if a boundary has a facet of every piece of its body.
    fn holds_all(&self, boundary: &Boundary) -> bool {
        let Some(region) = self.body.region_of(boundary) else { return false };
        let all: HashSet<usize> = self.pieces[self.body.regions()[region].elements()].iter().copied().collect();
        let held: HashSet<usize> = self
            .body
            .mesh()
            .faces_of(boundary)
            .into_iter()
            .flatten()
            .map(|(element, _)| self.pieces[element])
            .collect();
        held == all
    }
}

impl PressedFacets {
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
        leans.iter().all(allows).then(|| PressedFacets { chosen, way, extent: extent(&places), first })
    }

    /// Returns `true` if `held` holds none of the nodes that the plate touches first: they would stop it.
    fn is_free_of(&self, held: &Boundary) -> bool {
        let held: HashSet<usize> = held.nodes().into_iter().collect();
        self.first.iter().all(|node| !held.contains(node))
    }
}

fn has(words: &[&str], name: &str) -> bool {
    words.iter().any(|word| name.to_lowercase().contains(word))
}

/// The largest coordinate of an extent along a way, positive along it.
fn reach((low, high): Extent, (axis, sense): Way) -> f64 {
    if sense > 0.0 { high[axis] } else { -low[axis] }
}

/// Returns `true` if every facet of a boundary lies on the surface of a body.
fn is_outside(boundary: &Boundary, surfaces: &[Boundary]) -> bool {
    let key = |facet: &[usize]| sorted(facet.iter().copied());
    let outer: HashSet<Vec<usize>> = surfaces.iter().flat_map(Boundary::facets).map(key).collect();
    boundary.facets().all(|facet| outer.contains(&key(facet)))
}

/// The facets of a boundary that face a direction along an axis; `None` without one.
fn part(body: &ElasticBody, boundary: &Boundary, way: Way) -> Option<Boundary> {
    Chosen::spec(way, None, body.dimension()).facets(body, boundary, "").ok()
}

/// The mean of the outward normals of a boundary by area; short if they cancel.
fn mean_normal(body: &ElasticBody, boundary: &Boundary) -> [f64; 3] {
    let areas = tributary_areas(body, boundary);
    let area: f64 = areas.iter().map(|(_, area)| area).sum();
    let parts = areas.iter().zip(node_normals(body, boundary));
    parts.fold([0.0; 3], |sum, ((_, of_node), (_, own))| shifted(sum, of_node / area, own))
}

/// The axis and the sense of a boundary's normal; the vertical axis if the normal is as close to it as to another, and
/// up if the boundary faces all directions.
fn facing(normal: [f64; 3], up: usize) -> Way {
    if length(normal) < FACING {
        return (up, 1.0);
    }
    let largest = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(up);
    let axis = if normal[up].abs() > ALIKE * normal[largest].abs() { up } else { largest };
    (axis, normal[axis].signum())
}
