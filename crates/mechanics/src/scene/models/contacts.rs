//! All contacts between the bodies of a scene: surfaces that face each other.

use std::sync::Arc;

use crate::error::Error;
use crate::fem::geometry::{distance, length};
use crate::fem::mortar::Seen;
use crate::fem::{Boundary, ElasticBody, Mortar, Region};
use crate::scene::input::obstacle::ShapeSpec;
use crate::scene::input::schema::{ObstacleSpec, Rule, Scene};

/// How far contacts are looked for, in sizes of the smaller body.
const REACH: f64 = 0.25;

/// Halvings of the reach until the surfaces lie in one layer before each other.
const HALVINGS: usize = 12;

impl Scene {
    /// The scene with an obstacle for each pair of bodies that face each other and that no obstacle names, and the body
    /// with the boundaries of these obstacles.
    pub(crate) fn with_contacts(&self, mut body: ElasticBody) -> Result<(Scene, ElasticBody), Error> {
        let (mut scene, nodes) = (self.clone(), body.mesh().nodes().to_vec());
        let regions = body.regions().to_vec();
        let named: Vec<[Option<usize>; 2]> = self.named_pairs(&body);
        let skins = Arc::clone(body.skins());
        let boxes: Vec<[[f64; 3]; 2]> =
            regions.iter().map(|region| body.mesh().extent_of(region.nodes()).into()).collect();
        let facets: Vec<f64> = skins.iter().map(|skin| largest_facet(&nodes, &skin.surface)).collect();
        let travel = self.largest_travel();
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
                let size = bodies
                    .map(|body| distance(boxes[body][0], boxes[body][1]))
                    .into_iter()
                    .fold(f64::INFINITY, f64::min);
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
        Ok((scene, body))
    }

    /// The bodies of the obstacles that are other bodies, and of tied surfaces.
    fn named_pairs(&self, body: &ElasticBody) -> Vec<[Option<usize>; 2]> {
        let region = |name: &str| body.region_of(body.mesh().boundary(name)?);
        let of_obstacle =
            |spec: &ObstacleSpec| Some([region(&spec.boundary), region(spec.shape.shape().other_boundary()?)]);
        let of_tie = |pair: [&str; 2]| pair.map(region);
        self.obstacles.iter().filter_map(of_obstacle).chain(self.tied_surfaces().map(of_tie)).collect()
    }

    /// The largest prescribed displacement, in length.
    fn largest_travel(&self) -> f64 {
        let parts = self.supports.iter().flat_map(|support| [support.x, support.y, support.z, support.value]);
        parts.flatten().fold(0.0, |largest: f64, part| largest.max(part.abs()))
    }
}

/// The distance of two boxes.
fn apart([low, high]: [[f64; 3]; 2], [other_low, other_high]: [[f64; 3]; 2]) -> f64 {
    length([0, 1, 2].map(|axis| (low[axis] - other_high[axis]).max(other_low[axis] - high[axis]).max(0.0)))
}

fn largest_facet(nodes: &[[f64; 3]], surface: &Boundary) -> f64 {
    surface.facets().map(|facet| facet_length(nodes, facet)).fold(0.0, f64::max)
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
