//! The surface of another body, node to node: n . (u - u_partner) <= gap.

use super::way::Approachable;
use crate::error::Error;
use crate::fem::assembly::node_normals;
use crate::fem::body::ElasticBody;
use crate::fem::geometry::{dot, length, minus, unit};
use crate::fem::mesh::Boundary;
use crate::scene::condition::boundary;
use crate::scene::entry::{PLACE_TOLERANCE, point, wrong};
use crate::scene::schema::{FacingSpec, ObstacleSpec, Rule};

/// A partner may be aside by this times its distance: at the end of a curved boundary the facets on one side only give
/// the normal, half the angle of a facet off.
const ASLANT: f64 = 0.2;

/// The pairs of nodes, in the order of the candidates.
#[derive(Clone, Debug)]
pub(super) struct Facing {
    pairs: Vec<Pair>,
}

#[derive(Clone, Copy, Debug)]
struct Pair {
    partner: usize,
    /// Unit vector from the candidate's body into the other.
    normal: [f64; 3],
    /// Along the normal from the candidate to its partner, in length.
    distance: f64,
}

impl Facing {
    /// Finds the node of another body across each candidate; `path` is the JSON path of the obstacle, `spec` its words.
    pub fn new(
        facing: &FacingSpec,
        spec: &ObstacleSpec,
        path: &str,
        body: &ElasticBody,
        approach: [f64; 3],
        candidates: &[(usize, f64)],
    ) -> Result<Self, Error> {
        let mesh = body.mesh();
        let own = boundary(mesh, &spec.boundary, &format!("{path}.boundary"))?;
        let shape_path = format!("{path}.shape.body.boundary");
        let other = boundary(mesh, &facing.boundary, &shape_path)?;
        let region = |of: &Boundary| {
            let first = of.connectivity.first().copied().unwrap_or(0);
            body.regions().iter().position(|region| region.nodes().contains(&first))
        };
        if region(own) == region(other) {
            let message = format!("`{}` and `{}` belong to one body; take a boundary of another", own.name, other.name);
            return Err(wrong(shape_path, message));
        }
        let (normals, partners) = (node_normals(body, own), node_normals(body, other));
        let tolerance = PLACE_TOLERANCE * mesh.size();
        let mut pairs = Vec::with_capacity(candidates.len());
        for (&(node, _), &(_, outward)) in candidates.iter().zip(&normals) {
            let at = mesh.nodes()[node];
            let place = || point(&at[..mesh.dimension()]);
            // The offset across the row's direction, the distance along it, the pair.
            let ways = partners.iter().map(|&(partner, facing)| {
                let way = minus(mesh.nodes()[partner], at);
                let mean = unit(minus(outward, facing));
                let normal = if spec.rule == Rule::Approach { approach } else { mean };
                let distance = dot(way, normal);
                let aside = length(minus(way, normal.map(|component| distance * component)));
                (aside, mean, Pair { partner, normal, distance })
            });
            let nearest = match spec.rule {
                // Of the nodes straight across, the nearest; or else the one that is least aside.
                Rule::Approach => ways.min_by(|a, b| {
                    let straight = |aside: f64| aside.max(tolerance);
                    straight(a.0).total_cmp(&straight(b.0)).then(a.2.distance.abs().total_cmp(&b.2.distance.abs()))
                }),
                Rule::ClosestPoint => ways.min_by(|a, b| a.0.hypot(a.2.distance).total_cmp(&b.0.hypot(b.2.distance))),
            };
            let Some((aside, mean, pair)) = nearest else {
                return Err(wrong(shape_path, format!("`{}` has no nodes", other.name)));
            };
            let slant = if spec.rule == Rule::Approach { 0.0 } else { ASLANT * pair.distance.abs() };
            if aside > tolerance.max(slant) {
                let message = format!(
                    "node {node} of `{}` at {} has no node of `{}` across it: the nearest is {aside:.3e} aside; the \
                     nodes of the two boundaries must pair up",
                    own.name,
                    place(),
                    other.name
                );
                return Err(wrong(shape_path, message));
            }
            if dot(mean, pair.normal) <= 0.0 {
                let message = format!(
                    "`{}` does not lead from `{}` into `{}` at node {node} at {}; take the opposite direction",
                    spec.approach.name(),
                    own.name,
                    other.name,
                    place()
                );
                return Err(wrong(format!("{path}.approach"), message));
            }
            pairs.push(pair);
        }
        Ok(Facing { pairs })
    }

    /// The node across a candidate.
    pub fn partner(&self, candidate: usize) -> Option<usize> {
        self.pairs.get(candidate).map(|pair| pair.partner)
    }

    /// The way from a candidate to its partner, the other body shifted by `gap` along the unit vector `approach`.
    pub fn row(&self, candidate: usize, gap: f64, approach: [f64; 3]) -> Option<Approachable> {
        let pair = self.pairs.get(candidate)?;
        Some(Approachable { normal: pair.normal, distance: pair.distance + gap * dot(pair.normal, approach) })
    }
}
