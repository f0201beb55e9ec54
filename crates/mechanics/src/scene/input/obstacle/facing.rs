//! The surface of another body: n . (u - u_partner) <= gap for nodes that lie opposite each other, or means over
//! segments.

use std::collections::{HashMap, HashSet};

use super::mortar;
use super::order::{Between, BodyRow};
use super::shape::{Geometry, ObstacleShape, ObstacleSite};
use crate::error::Error;
use crate::fem::assembly::{node_normals, outward};
use crate::fem::geometry::{cross, distance, dot, length, minus, sorted, unit};
use crate::fem::mesh::extent;
use crate::fem::mortar::{TwoSkins, has_corners};
use crate::fem::surface::Tree;
use crate::fem::{Boundary, FacetKind};
use crate::scene::input::entry::{PLACE_TOLERANCE, boundary, number, point, refused, wrong};
use crate::scene::input::schema::model::Rule;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use signorini_guarantee::SAME_PLACE;

/// Allowed lateral offset of a partner, in units of its distance: at the end of a curved boundary only the facets on
/// one side give the normal, which is wrong by half the angle of a facet.
const ASLANT: f64 = 0.2;

/// Two distances that differ by less, relative, differ by rounding.
const ROUNDING: f64 = 1e-12;

/// A boundary of another elastic body as an obstacle, with its rows and its reach.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FacingSpec {
    /// The boundary of the other body, as `name.boundary`.
    pub boundary: String,
    /// How rows are made: between pairs of nodes, or as means over segments of both meshes.
    #[serde(default, skip_serializing_if = "RowsSpec::is_auto")]
    pub rows: RowsSpec,
    /// The boundary that carries the rows if they are means.
    #[serde(default, skip_serializing_if = "SideSpec::is_auto")]
    pub side: SideSpec,
    /// The largest distance, positive, at which the surfaces get rows if they are means; without it any.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub reach: Option<f64>,
    /// The distance of the surfaces, instead of the distance that the meshes have.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fit: Option<FitSpec>,
}

/// The kind of the rows between two bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RowsSpec {
    /// Pairs if the nodes of both boundaries pair up, else means.
    #[default]
    Auto,
    /// Each node of the boundary lies opposite one node of the other.
    Pairs,
    /// Means over the area of each node of one boundary: the meshes need not match.
    Mortar,
}

/// The boundary that carries the rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SideSpec {
    /// That of the softer body, if Young's moduli differ by more than a factor of 2; else the one with the smaller
    /// facets. All bodies have one order.
    #[default]
    Auto,
    /// The boundary of the obstacle in the scene.
    This,
    /// The boundary of the other body.
    Other,
}

/// How two bodies fit before they are deformed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FitSpec {
    /// By how much the bodies overlap everywhere, in length, 0 or more: a press fit.
    Interference(f64),
    /// The distance of the bodies everywhere, in length, 0 or more.
    Clearance(f64),
}

impl FacingSpec {
    /// The surface `boundary` within reach, with rows and side chosen from the meshes.
    pub(crate) fn of(boundary: String, reach: f64) -> Self {
        FacingSpec { boundary, rows: RowsSpec::Auto, side: SideSpec::Auto, reach: Some(reach), fit: None }
    }
}

impl RowsSpec {
    fn is_auto(&self) -> bool {
        *self == RowsSpec::Auto
    }
}

impl SideSpec {
    /// `true` for the other boundary, `None` for the better one.
    fn is_other(self) -> Option<bool> {
        match self {
            SideSpec::Auto => None,
            SideSpec::This => Some(false),
            SideSpec::Other => Some(true),
        }
    }

    fn is_auto(&self) -> bool {
        *self == SideSpec::Auto
    }
}

/// What the nodes of two boundaries must do, and the page that shows how.
const PAIR_UP: &str = "for `\"rows\": \"pairs\"` the nodes of the two boundaries must pair up, as docs/assemblies.md shows; `mortar` takes any meshes";

/// The code of boundaries whose nodes do not pair up.
const UNPAIRED: &str = "unpaired-nodes";

impl ObstacleShape for FacingSpec {
    /// Finds the rows: pairs where all nodes pair up, else means.
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let mesh = site.body.mesh();
        let own = boundary(mesh, site.boundary, &format!("{}.boundary", site.obstacle))?;
        let other = boundary(mesh, &self.boundary, &site.field("boundary"))?;
        if site.body.region_of(own) == site.body.region_of(other) {
            let message = format!("`{}` and `{}` belong to one body; take a boundary of another", own.name, other.name);
            return Err(wrong(site.field("boundary"), message));
        }
        let fit = self.fit.map(|fit| fit.gap(&site.field("fit"))).transpose()?;
        let reach = self.reach.map(|reach| site.positive("reach", reach)).transpose()?;
        let is_pair = |error: &Error| matches!(error, Error::Refused { code: UNPAIRED, .. });
        let pairs = match self.rows {
            RowsSpec::Mortar => None,
            RowsSpec::Pairs => Some(pairs(site, own, other)?),
            RowsSpec::Auto => match pairs(site, own, other) {
                Err(error) if is_pair(&error) && mesh.dimension() > 1 => None,
                found => Some(found?),
            },
        };
        let Some(pairs) = pairs else {
            let between = mortar::between(site, [own, other], self.side.is_other(), reach, fit)?;
            return Ok(Geometry::Body(Box::new(between)));
        };
        let row = |(&(node, _), pair): (&(usize, f64), Pair)| {
            let distance = fit.unwrap_or(pair.distance);
            let ends = vec![(node, 1.0), (pair.partner, -1.0)];
            Some(BodyRow { ends, normal: pair.normal, mean: pair.mean, outward: None, distance, area: None })
        };
        let rows = site.candidates.iter().zip(pairs).map(row).collect();
        Ok(Geometry::Body(Box::new(Between {
            rows,
            further: Vec::new(),
            across: Vec::new(),
            other: other.name.clone(),
            covered: None,
            facets: None,
            reach: f64::INFINITY,
            fit,
            is_swapped: false,
            warnings: Vec::new(),
        })))
    }

    fn other_boundary(&self) -> Option<&str> {
        Some(&self.boundary)
    }
}

impl FitSpec {
    /// The gap of all rows, in length.
    fn gap(self, path: &str) -> Result<f64, Error> {
        let (name, size, sense) = match self {
            FitSpec::Interference(size) => ("interference", size, -1.0),
            FitSpec::Clearance(size) => ("clearance", size, 1.0),
        };
        if size >= 0.0 && size.is_finite() {
            return Ok(0.0 + sense * size);
        }
        Err(wrong(format!("{path}.{name}"), format!("{} is not allowed: a length is 0 or more", number(size))))
    }
}

/// The node of the other body opposite to each candidate.
fn pairs(site: &ObstacleSite, own: &Boundary, other: &Boundary) -> Result<Vec<Pair>, Error> {
    if [own, other].iter().any(|side| has_corners(site.body.mesh().nodes(), &outward(site.body, side))) {
        let message =
            format!("`{}` or `{}` has a corner, at which a pair has no normal; {PAIR_UP}", own.name, other.name);
        return Err(unpaired(site, message));
    }
    let (normals, partners) = (node_normals(site.body, own), node_normals(site.body, other));
    let edges = shortest_edges(own, site.body.mesh().nodes());
    let nodes = site.body.mesh().nodes();
    let numbers: Vec<u32> = (0..partners.len() as u32).collect();
    let tree = Tree::new(&numbers, |number| [nodes[partners[number as usize].0]; 2]);
    let search = Search { site, own, other, partners, tree, edges };
    let candidates = site.candidates.iter().zip(&normals);
    let pairs: Result<Vec<Pair>, Error> = candidates
        .map(|(&(node, _), &(_, outward))| {
            let way = search.nearest(node, outward)?;
            search.check(node, &way)?;
            Ok(way.pair)
        })
        .collect();
    let pairs = pairs?;
    search.check_others(&pairs)?;
    search.check_facets(&pairs)?;
    Ok(pairs)
}

fn unpaired(site: &ObstacleSite, message: String) -> Error {
    refused(UNPAIRED, site.field("boundary"), message)
}

/// The node of another body opposite to a candidate.
#[derive(Clone, Copy, Debug)]
struct Pair {
    partner: usize,
    /// The normal of the pair, of length 1, from the candidate's body into the other.
    normal: [f64; 3],
    /// The direction half way between the normals of both surfaces at the pair, from the candidate's body into the
    /// other.
    mean: [f64; 3],
    /// Distance along the normal from the candidate to its partner, in length.
    distance: f64,
}

/// The search for partners on another boundary.
struct Search<'a> {
    site: &'a ObstacleSite<'a>,
    own: &'a Boundary,
    other: &'a Boundary,
    /// Nodes of the other boundary with their outward normals.
    partners: Vec<(usize, [f64; 3])>,
    /// Their places.
    tree: Tree,
    /// The shortest edge of the facets at each node of the own boundary, in length; infinite at other nodes.
    edges: Vec<f64>,
}

/// The vector from a candidate to a node of the other boundary.
struct Way {
    /// Offset perpendicular to the direction of the row, in length.
    aside: f64,
    pair: Pair,
}

/// The shortest edge of the facets at each node of the mesh; infinite at nodes outside the boundary, and if facets are
/// points.
pub(crate) fn shortest_edges(boundary: &Boundary, nodes: &[[f64; 3]]) -> Vec<f64> {
    let mut shortest = vec![f64::INFINITY; nodes.len()];
    for facet in boundary.facets() {
        for (place, &node) in facet.iter().enumerate() {
            for &other in &facet[..place] {
                let edge = distance(nodes[node], nodes[other]);
                [node, other].iter().for_each(|&end| shortest[end] = shortest[end].min(edge));
            }
        }
    }
    shortest
}

impl Search<'_> {
    /// Lengths below this at a node of the own boundary are rounding of coordinates.
    fn tolerance(&self, node: usize) -> f64 {
        let edge = self.edges[node];
        if edge.is_finite() { SAME_PLACE * edge } else { PLACE_TOLERANCE * self.site.body.mesh().size() }
    }

    fn nearest(&self, node: usize, outward: [f64; 3]) -> Result<Way, Error> {
        let (nodes, rule) = (self.site.body.mesh().nodes(), self.site.rule);
        let way_to = |number: u32| {
            let (partner, facing) = self.partners[number as usize];
            let way = minus(nodes[partner], nodes[node]);
            let mean = unit(minus(outward, facing));
            let normal = if rule == Rule::Approach { self.site.direction() } else { mean };
            let distance = dot(way, normal);
            let aside = length(minus(way, normal.map(|component| distance * component)));
            Way { aside, pair: Pair { partner, normal, mean, distance } }
        };
        let nearest = match rule {
            // The nearest of the nodes straight across; without such a node, the node with the smallest offset.
            Rule::Approach => {
                let (tolerance, mut near) = (self.tolerance(node), Vec::new());
                let beside = [2.0 * tolerance, 0.0, f64::INFINITY];
                self.tree.around_line(nodes[node], self.site.direction(), beside, |number| near.push(number));
                near.retain(|&number| way_to(number).aside <= tolerance);
                if near.is_empty() {
                    near.extend(0..self.partners.len() as u32);
                }
                near.sort_unstable();
                near.into_iter().map(way_to).min_by(|a, b| {
                    let straight = |way: &Way| way.aside.max(tolerance);
                    let far = |way: &Way| way.pair.distance.abs();
                    straight(a).total_cmp(&straight(b)).then(far(a).total_cmp(&far(b)))
                })
            }
            Rule::ClosestPoint => {
                let mut nearest: Option<(f64, u32)> = None;
                self.tree.near(nodes[node], |number| {
                    let way = way_to(number);
                    let own = (way.aside.hypot(way.pair.distance), number);
                    let found = nearest.map_or(own, |one| if own < one { own } else { one });
                    nearest = Some(found);
                    found.0 * found.0 * (1.0 + ROUNDING)
                });
                nearest.map(|(_, number)| way_to(number))
            }
        };
        nearest.ok_or_else(|| wrong(self.site.field("boundary"), format!("`{}` has no nodes", self.other.name)))
    }

    /// Checks that a pair lies straight across, and that the row leads into the other body.
    fn check(&self, node: usize, way: &Way) -> Result<(), Error> {
        let (site, own, other) = (self.site, &self.own.name, &self.other.name);
        let mesh = site.body.mesh();
        let place = point(&mesh.nodes()[node][..mesh.dimension()]);
        let slant = if site.rule == Rule::Approach { 0.0 } else { ASLANT * way.pair.distance.abs() };
        if way.aside > self.tolerance(node).max(slant) {
            let message = format!(
                "node {node} of `{own}` at {place} has no node of `{other}` across it: the nearest is {:.3e} aside; {PAIR_UP}",
                way.aside
            );
            return Err(unpaired(site, message));
        }
        if dot(way.pair.mean, way.pair.normal) <= 0.0 {
            let message = format!(
                "`{}` does not lead from `{own}` into `{other}` at node {node} at {place}; take the opposite direction",
                site.approach.name()
            );
            return Err(wrong(format!("{}.approach", site.obstacle), message));
        }
        let [Some(own_body), Some(other_body)] = [self.own, self.other].map(|side| site.body.region_of(side)) else {
            return Ok(());
        };
        let skins = TwoSkins { skins: site.body.skins(), own: own_body, other: other_body };
        if !skins.is_clear(mesh.nodes()[node], mesh.nodes()[way.pair.partner], way.pair.normal) {
            let message = format!(
                "a body lies between node {node} of `{own}` at {place} and the node of `{other}` across it; {PAIR_UP}"
            );
            return Err(unpaired(site, message));
        }
        Ok(())
    }

    /// Checks that the nodes opposite to those of a facet are the nodes of a facet: otherwise the areas of a pair would
    /// differ, and a uniform pressure would not pass.
    fn check_facets(&self, pairs: &[Pair]) -> Result<(), Error> {
        let across: HashMap<usize, usize> =
            self.site.candidates.iter().zip(pairs).map(|(&(node, _), pair)| (node, pair.partner)).collect();
        let others: HashSet<Vec<usize>> = self.other.facets().map(|facet| sorted(facet.iter().copied())).collect();
        for (index, facet) in self.own.facets().enumerate() {
            if !others.contains(&sorted(facet.iter().filter_map(|node| across.get(node)).copied())) {
                let (own, other) = (&self.own.name, &self.other.name);
                let message = format!(
                    "the nodes of facet {index} of `{own}` lie opposite nodes of `{other}` that do not form a facet; {PAIR_UP}"
                );
                return Err(unpaired(self.site, message));
            }
        }
        Ok(())
    }

    /// Checks that no node of the other boundary faces the inside of a facet: it would have no row, and would
    /// penetrate.
    fn check_others(&self, pairs: &[Pair]) -> Result<(), Error> {
        let mesh = self.site.body.mesh();
        let nodes = mesh.nodes();
        let mut pair_of = vec![None; nodes.len()];
        let mut is_paired = vec![false; nodes.len()];
        for (&(node, _), pair) in self.site.candidates.iter().zip(pairs) {
            pair_of[node] = Some(*pair);
            is_paired[pair.partner] = true;
        }
        let numbers: Vec<u32> = (0..self.own.facets().count() as u32).collect();
        // A node that a facet faces lies in the box around the facet and its pairs.
        let facets = Tree::new(&numbers, |number| {
            let facet = self.own.facet(number as usize);
            let (low, high) = extent(&facet.iter().map(|&node| nodes[node]).collect::<Vec<_>>());
            let pairs = facet.iter().filter_map(|&node| pair_of[node]);
            let far = pairs.fold(0.0, |far: f64, pair| far.max(pair.distance.abs()));
            let room = far + 2.0 * distance(low, high);
            [low.map(|at| at - room), high.map(|at| at + room)]
        });
        for &(partner, facing) in self.partners.iter().filter(|entry| !is_paired[entry.0]) {
            let mut near = Vec::new();
            facets.near(nodes[partner], |number| {
                near.push(number);
                0.0
            });
            near.sort_unstable();
            for facet in near.into_iter().map(|number| self.own.facet(number as usize)) {
                let across = Across::of(self.own.kind, facet, nodes, &pair_of, nodes[partner]);
                let Some(across) = across.filter(|across| dot(across.normal, facing) < 0.0) else { continue };
                let (own, other) = (&self.own.name, &self.other.name);
                let place = point(&nodes[partner][..mesh.dimension()]);
                let message = format!(
                    "node {partner} of `{other}` at {place} has no node of `{own}` across it: it faces the inside of a facet at a \
                     distance of {:.3e}, and would go through; {PAIR_UP}",
                    across.distance
                );
                return Err(unpaired(self.site, message));
            }
        }
        Ok(())
    }
}

/// A place opposite to the inside of a facet.
struct Across {
    /// Unit vector from the facet to the other body.
    normal: [f64; 3],
    /// Distance along the normal, in length.
    distance: f64,
}

impl Across {
    /// The place `at` if it is opposite to the inside of `facet`, at most as far as the distance of its pairs plus the
    /// length of the facet.
    fn of(
        kind: FacetKind,
        facet: &[usize],
        nodes: &[[f64; 3]],
        pair_of: &[Option<Pair>],
        at: [f64; 3],
    ) -> Option<Self> {
        let corners = &facet[..kind.corners()];
        if corners.len() < 2 {
            return None;
        }
        let pairs: Option<Vec<Pair>> = corners.iter().map(|&corner| pair_of[corner]).collect();
        let pairs = pairs?;
        let normal = unit(pairs.iter().fold([0.0; 3], |sum, pair| minus(sum, pair.normal.map(|component| -component))));
        let first = nodes[corners[0]];
        let way = dot(minus(at, first), normal);
        let long = corners.iter().fold(0.0, |long: f64, &corner| long.max(distance(nodes[corner], first)));
        let far = pairs.iter().fold(0.0, |far: f64, pair| far.max(pair.distance.abs()));
        if way.abs() > far + long {
            return None;
        }
        let is_inside = match *corners {
            [a, b] => {
                let along = minus(nodes[b], nodes[a]);
                let share = dot(minus(at, nodes[a]), along) / dot(along, along);
                share > SAME_PLACE && share < 1.0 - SAME_PLACE
            }
            _ => {
                let turns = (0..corners.len()).map(|corner| {
                    let (a, b) = (nodes[corners[corner]], nodes[corners[(corner + 1) % corners.len()]]);
                    let edge = minus(b, a);
                    dot(cross(edge, minus(at, a)), normal) / dot(edge, edge)
                });
                let turns: Vec<f64> = turns.collect();
                turns.iter().all(|&turn| turn > SAME_PLACE) || turns.iter().all(|&turn| turn < -SAME_PLACE)
            }
        };
        is_inside.then_some(Across { normal, distance: way })
    }
}
