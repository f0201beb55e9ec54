//! Bodies near each other: contacts between all surfaces that face each other; overlaps of displaced bodies, where no
//! contact row keeps them apart, and between the rows where these lie too far apart.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::HashMap;
use std::sync::Arc;

use super::ties::tied_surfaces;
use crate::error::Error;
use crate::fem::element::Cell;
use crate::fem::geometry::{distance, length};
use crate::fem::mesh::extent;
use crate::fem::mortar::{Seen, Skin};
use crate::fem::surface::Tree;
use crate::fem::{ElasticBody, Mesh, Mortar, Region};
use crate::scene::input::obstacle::ShapeSpec;
use crate::scene::input::schema::{ObstacleSpec, Rule, Scene};
use crate::scene::{ContactRow, Model};

/// Overlaps below this share of the size of the mesh are rounding.
const ROUNDING: f64 = 1e-9;

/// A node that only takes part in the means of other nodes may lie this share of a facet inside.
const TAKING_PART: f64 = 0.01;

/// A point outside an element by less than this, in reference coordinates, is inside.
const SAME_PLACE: f64 = 1e-9;

/// A node with a row, or opposite to one, may lie this share of a facet inside: rows do not keep every point apart.
const KEPT_APART: f64 = 0.05;

/// A node of one body inside another.
#[derive(Clone, Debug)]
pub struct Overlap {
    pub node: usize,
    /// The distance from the surface of the other body, in length, positive.
    pub depth: f64,
    /// The body of the node, and the other, by their numbers.
    pub bodies: [usize; 2],
    /// Whether rows keep the bodies apart around the node.
    pub has_rows: bool,
}

/// A displaced body.
struct Solid {
    skin: Skin,
    /// How far each facet misses the curve for which it stands, in length.
    sags: Vec<f64>,
    /// Boxes around its elements.
    elements: Tree,
    /// Its first element.
    first: usize,
}

/// A point of a surface that must not lie in another body.
struct Point {
    at: [f64; 3],
    /// A node there, or of the facet around it.
    node: usize,
    /// How far the facet around it misses its curve; zero at nodes.
    sag: f64,
    /// How deep it may lie in the other body, in lengths of a facet.
    allowed: f64,
}

impl Solid {
    fn of(model: &Model, region: usize, nodes: &[[f64; 3]]) -> Self {
        let (mesh, elements) = (model.mesh(), model.body().regions()[region].elements());
        let numbers: Vec<u32> = (0..elements.len() as u32).collect();
        let tree_of_elements = Tree::new(&numbers, |number| {
            let places: Vec<[f64; 3]> =
                mesh.element(elements.start + number as usize).iter().map(|&node| nodes[node]).collect();
            let (low, high) = extent(&places);
            // A curved side leaves the box of its nodes.
            let room = (0..3).fold(0.0, |room: f64, axis| room.max(high[axis] - low[axis])) / 4.0;
            [low.map(|at| at - room), high.map(|at| at + room)]
        });
        let skin = Skin::new(mesh.surface(elements.clone()), nodes);
        let sags = Mortar::new((nodes, &skin.surface), (nodes, &skin.surface), *model.body().formulation()).sags();
        Solid { skin, sags, elements: tree_of_elements, first: elements.start }
    }

    /// The nodes of its surface, and the middles of its facets: where two bodies cross, no node need lie inside.
    /// `allowed` has how deep a node may lie in the other body, in lengths of a facet.
    fn points(&self, nodes: &[[f64; 3]], allowed: impl Fn(usize) -> f64) -> Vec<Point> {
        let of_nodes = self.skin.surface.nodes().into_iter();
        let mut points: Vec<Point> =
            of_nodes.map(|node| Point { at: nodes[node], node, sag: 0.0, allowed: allowed(node) }).collect();
        let reference = self.skin.surface.kind.reference();
        let shape = (reference.shape)(reference.centroid());
        points.extend(self.skin.surface.facets().zip(&self.sags).map(|(facet, &sag)| {
            let at =
                [0, 1, 2].map(|axis| facet.iter().zip(shape).map(|(&node, share)| share * nodes[node][axis]).sum());
            let allowed = facet.iter().map(|&node| allowed(node)).fold(0.0, f64::max);
            Point { at, node: facet[0], sag, allowed }
        }));
        points
    }

    /// Returns `true` if a point lies in one of its elements.
    fn contains(&self, mesh: &Mesh, nodes: &[[f64; 3]], at: [f64; 3]) -> bool {
        let mut near = Vec::new();
        self.elements.around_line(at, [1.0, 0.0, 0.0], [0.0; 3], |number| near.push(self.first + number as usize));
        near.into_iter().any(|element| {
            let own = mesh.element(element);
            let cell = Cell::at(mesh.kind_of(element).reference(), |local| nodes[own[local]]);
            cell.weights_at(at, SAME_PLACE).is_some()
        })
    }
}

/// The deepest overlap of two displaced bodies at a node or in the middle of a facet, beyond what contact rows
/// between the two leave, and beyond the shortening of a bolt between them; `None` without one. `displacement` has
/// `dim` entries a node.
pub fn deepest_overlap(model: &Model, displacement: &[f64], unknowns: &[f64]) -> Option<Overlap> {
    let (mesh, regions, dimension) = (model.mesh(), model.body().regions(), model.body().dimension());
    if regions.len() < 2 || dimension < 2 {
        return None;
    }
    let moved = |(node, at): (usize, &[f64; 3])| {
        let mut at = *at;
        (0..dimension).for_each(|axis| at[axis] += displacement[dimension * node + axis]);
        at
    };
    let nodes: Vec<[f64; 3]> = mesh.nodes().iter().enumerate().map(moved).collect();
    let (allowed, drawn) = (depths_that_rows_leave(model), drawn_together(model, unknowns));
    let solids: Vec<OnceCell<Solid>> = (0..regions.len()).map(|_| OnceCell::new()).collect();
    let solid = |region: usize| solids[region].get_or_init(|| Solid::of(model, region, &nodes));
    let boxes: Vec<_> = regions.iter().map(|region| extent(&nodes[region.nodes()])).collect();
    let mut deepest: Option<Overlap> = None;
    for (own, other) in (0..regions.len()).flat_map(|own| (0..regions.len()).map(move |other| (own, other))) {
        let [(low, high), (least, most)] = [boxes[own], boxes[other]];
        let of_node = |node: usize| allowed.get(&(node, own)).copied().unwrap_or(0.0);
        // Only a point in the box of a body can be inside it.
        let is_near = |at: &[f64; 3]| (0..dimension).all(|axis| (low[axis]..=high[axis]).contains(&at[axis]));
        let boxes_meet = (0..dimension).all(|axis| least[axis] <= high[axis] && low[axis] <= most[axis]);
        if own == other || !boxes_meet {
            continue;
        }
        let (body, of_nodes) = (solid(own), solid(other));
        let drawn = drawn.get(&[own.min(other), own.max(other)]).copied().unwrap_or(0.0);
        let rounding = ROUNDING * mesh.size();
        let points = of_nodes.points(&nodes, of_node).into_iter().filter(|point| is_near(&point.at));
        for point in points.filter(|point| body.contains(mesh, &nodes, point.at)) {
            let (depth, facet) = body.skin.nearest(point.at);
            let length = facet_length(&nodes, body.skin.surface.facet(facet));
            let left = rounding + drawn + point.sag + body.sags[facet] + point.allowed * length;
            if depth > left && deepest.as_ref().is_none_or(|deepest| depth > deepest.depth) {
                let has_rows = point.allowed == KEPT_APART;
                deepest = Some(Overlap { node: point.node, depth, bodies: [other, own], has_rows });
            }
        }
    }
    deepest
}

/// How far bolts draw two bodies into each other, by the numbers of the bodies in increasing order: the meshes
/// have the length of a bolt before it is shortened.
fn drawn_together(model: &Model, unknowns: &[f64]) -> HashMap<[usize; 2], f64> {
    let (mut drawn, dofs) = (HashMap::new(), model.dofs());
    for one in &model.parts.ties.shortenings {
        let ends = [one.form.terms.first(), one.form.terms.last()].map(|term| model.body().region_at(term?.0));
        if let [Some(own), Some(other)] = ends {
            let shortening = one.sense * dofs.through(&one.form, model.body().dimension()).value(unknowns);
            let known = drawn.entry([own.min(other), own.max(other)]).or_insert(0.0_f64);
            *known = known.max((1.0 + KEPT_APART) * shortening);
        }
    }
    drawn
}

/// How deep nodes may lie in a body, in lengths of a facet, because contact rows keep the two apart: nodes that
/// carry a row or lie opposite to one, and nodes that take part in the means of others. By node and body.
fn depths_that_rows_leave(model: &Model) -> HashMap<(usize, usize), f64> {
    let region_of = |node: usize| model.body().region_at(node).unwrap_or(0);
    let [mut kept_apart, mut taking_part] = [HashMap::new(), HashMap::new()];
    let rows = model.rows().iter().chain(model.rows_across());
    for ContactRow { node, ends, .. } in rows {
        let own = region_of(*node);
        let Some(other) = ends.iter().map(|end| region_of(end.0)).find(|&region| region != own) else { continue };
        kept_apart.insert((*node, other), KEPT_APART);
        let facing = ends.iter().map(|end| (end.0, if region_of(end.0) == own { other } else { own }));
        taking_part.extend(facing.map(|node| (node, TAKING_PART)));
    }
    // The other node of a pair is held by the same row.
    let pairs = model.rows().iter().filter_map(|row| Some((row.partner()?, region_of(row.node))));
    kept_apart.extend(pairs.map(|pair| (pair, KEPT_APART)));
    let ties = model.parts.ties.rows.iter().filter(|row| row.at.is_some());
    for (node, other) in ties.flat_map(|row| row.sides()) {
        kept_apart.insert((node, region_of(other)), KEPT_APART);
    }
    taking_part.extend(kept_apart);
    taking_part
}

/// How far contacts are looked for, in sizes of the smaller body.
const REACH: f64 = 0.25;

/// Halvings of the reach until the surfaces lie in one layer before each other.
const HALVINGS: usize = 12;

/// The scene, with `"contact": "auto"` with an obstacle for each pair of bodies that face each other and that no
/// obstacle names, and the body with the boundaries of these obstacles.
pub(crate) fn with_contacts(scene: &Scene, mut body: ElasticBody) -> Result<(Cow<'_, Scene>, ElasticBody), Error> {
    if scene.contact.is_none() {
        return Ok((Cow::Borrowed(scene), body));
    }
    let nodes = body.mesh().nodes().to_vec();
    let regions = body.regions().to_vec();
    let named = named_pairs(scene, &body);
    let skins = Arc::clone(body.skins());
    let boxes: Vec<[[f64; 3]; 2]> = regions.iter().map(|region| body.mesh().extent_of(region.nodes()).into()).collect();
    let lengths = |skin: &Skin| skin.surface.facets().map(|facet| facet_length(&nodes, facet)).fold(0.0, f64::max);
    let facets: Vec<f64> = skins.iter().map(lengths).collect();
    let prescribed = scene.supports.iter().flat_map(|support| [support.x, support.y, support.z, support.value]);
    let travel = prescribed.flatten().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    let mut scene = scene.clone();
    for second in 1..skins.len() {
        for first in 0..second {
            let pair = [Some(first), Some(second)];
            if named.iter().any(|one| *one == pair || [one[1], one[0]] == pair) {
                continue;
            }
            let bodies = [first, second];
            let sides = bodies.map(|body| &skins[body].surface);
            let between = |[own, other]: [usize; 2]| {
                Mortar::new((&nodes, sides[own]), (&nodes, sides[other]), *body.formulation())
                    .between(&skins, [bodies[own], bodies[other]])
            };
            let size =
                bodies.map(|body| distance(boxes[body][0], boxes[body][1])).into_iter().fold(f64::INFINITY, f64::min);
            let least = facets[first].max(facets[second]);
            let widest = (REACH * size).max(least + travel);
            // A curved facet leaves the box of its nodes.
            if apart(boxes[first], boxes[second]) > widest + least {
                continue;
            }
            let both = |reach: f64| -> Result<[Seen; 2], Error> {
                Ok([between([0, 1]).within(reach).seen()?, between([1, 0]).within(reach).seen()?])
            };
            let mut reach = widest;
            let mut seen = both(reach)?;
            let mut halvings = 1;
            while reach != least && seen.iter().any(|seen| seen.has_layers) {
                let half = reach / 2.0;
                reach = if halvings < HALVINGS && half >= least / 2.0 { half } else { least };
                (seen, halvings) = (both(reach)?, halvings + 1);
            }
            let mut found = Vec::new();
            for ([own, other], Seen { faces, .. }) in [[0, 1], [1, 0]].into_iter().zip(seen) {
                let [of, at] = [bodies[own], bodies[other]].map(|region| name_of(&regions[region]));
                let name = free_name(&body, &format!("{of}-at-{at}"));
                found.push(sides[own].part(&name, |facet| faces[facet]));
            }
            if found.iter().any(|side| side.connectivity.is_empty()) {
                continue;
            }
            scene.obstacles.push(ObstacleSpec {
                boundary: found[0].name.clone(),
                approach: None,
                rule: Rule::ClosestPoint,
                gap: None,
                force: None,
                mass: None,
                speed: None,
                shape: ShapeSpec::other_body(found[1].name.clone(), reach),
            });
            for side in found {
                body = body.with_boundary(side)?;
            }
        }
    }
    Ok((Cow::Owned(scene), body))
}

/// The bodies of the obstacles that are other bodies, and of tied surfaces.
fn named_pairs(scene: &Scene, body: &ElasticBody) -> Vec<[Option<usize>; 2]> {
    let region = |name: &str| body.region_of(body.mesh().boundary(name)?);
    let of_obstacle =
        |spec: &ObstacleSpec| Some([region(&spec.boundary), region(spec.shape.shape().other_boundary()?)]);
    let of_tie = |pair: [&str; 2]| pair.map(region);
    scene.obstacles.iter().filter_map(of_obstacle).chain(tied_surfaces(scene).map(of_tie)).collect()
}

/// The distance of two boxes.
fn apart([low, high]: [[f64; 3]; 2], [other_low, other_high]: [[f64; 3]; 2]) -> f64 {
    length([0, 1, 2].map(|axis| (low[axis] - other_high[axis]).max(other_low[axis] - high[axis]).max(0.0)))
}

/// The largest distance of two nodes of a facet.
pub(super) fn facet_length(nodes: &[[f64; 3]], facet: &[usize]) -> f64 {
    let pairs = facet.iter().flat_map(|&a| facet.iter().map(move |&b| distance(nodes[a], nodes[b])));
    pairs.fold(0.0, f64::max)
}

/// The name of a body in the names of its boundaries.
fn name_of(region: &Region) -> &str {
    if region.name().is_empty() { "body" } else { region.name() }
}

/// The name, or one with a number behind it, that no boundary has.
fn free_name(body: &ElasticBody, name: &str) -> String {
    let mut names = std::iter::once(name.to_string()).chain((2..).map(|number| format!("{name}-{number}")));
    names.find(|name| body.mesh().boundary(name).is_none()).unwrap_or_default()
}
