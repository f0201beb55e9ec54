//! Rows against another body: which of two bodies carries means, by one order of all bodies of a scene.

use std::collections::{HashMap, HashSet};

use super::row::ObstacleRow;
use crate::fem::assembly::facet_sizes;
use crate::fem::geometry::dot;
use crate::fem::{Boundary, ElasticBody};
use crate::scene::Warning;

/// A body whose Young's modulus exceeds that of the softest one of a class by more than this factor begins the next
/// class.
const AS_SOFT: f64 = 2.0;

/// The places of all bodies in one order: soft before stiff, then small facets before large ones, then as in the scene.
/// The body that comes first carries the rows of a pair, so that rows never lead in a circle.
#[derive(Clone, Debug)]
pub(crate) struct SideOrder {
    places: Vec<usize>,
}

impl SideOrder {
    /// The order by the surfaces with which the bodies may touch each other.
    pub fn of<'a>(body: &ElasticBody, surfaces: impl Iterator<Item = &'a Boundary>) -> Self {
        let mut touching: Vec<Vec<&Boundary>> = vec![Vec::new(); body.regions().len()];
        surfaces.for_each(|surface| touching[body.region_of(surface).unwrap_or(0)].push(surface));
        let moduli: Vec<f64> = touching.iter().map(|surfaces| modulus_behind(body, surfaces)).collect();
        let sizes: Vec<f64> = touching.iter().map(|surfaces| facet_size(body, surfaces)).collect();
        let mut order: Vec<usize> = (0..touching.len()).collect();
        order.sort_by(|&a, &b| moduli[a].total_cmp(&moduli[b]));
        let (mut class, mut softest) = (0, moduli[order[0]]);
        let mut classes = vec![0; order.len()];
        for &one in &order {
            if moduli[one] > AS_SOFT * softest {
                (class, softest) = (class + 1, moduli[one]);
            }
            classes[one] = class;
        }
        order.sort_by(|&a, &b| classes[a].cmp(&classes[b]).then(sizes[a].total_cmp(&sizes[b])).then(a.cmp(&b)));
        let mut places = vec![0; order.len()];
        order.iter().enumerate().for_each(|(place, &one)| places[one] = place);
        SideOrder { places }
    }

    /// Returns `true` if the second of two boundaries carries the rows.
    pub fn carries_other(&self, body: &ElasticBody, boundaries: [&Boundary; 2]) -> bool {
        let [own, other] = boundaries.map(|boundary| body.region_of(boundary).map(|region| self.places[region]));
        other < own
    }

    /// The first obstacle whose side is against the order, and whose rows lead to nodes that carry rows which lead
    /// back: a contact would count twice. Rows are given with the numbers of their obstacles. Without sides against the
    /// order there is none.
    pub fn circle<'a>(&self, body: &ElasticBody, rows: impl Iterator<Item = (usize, &'a BodyRow)>) -> Option<usize> {
        let mut steps: Vec<(usize, usize, usize)> = Vec::new();
        for (obstacle, row) in rows.filter(|(_, row)| row.area.is_some()) {
            let own = row.ends[0].0;
            let others = row.ends.iter().filter(|end| body.region_at(end.0) != body.region_at(own));
            steps.extend(others.map(|end| (own, end.0, obstacle)));
        }
        // Steps that no other one precedes, or follows, are on no circle.
        loop {
            let (before, starts): (_, HashSet<usize>) = (steps.len(), steps.iter().map(|step| step.0).collect());
            let ends: HashSet<usize> = steps.iter().map(|step| step.1).collect();
            steps.retain(|step| starts.contains(&step.1) && ends.contains(&step.0));
            if steps.len() == before {
                break;
            }
        }
        let place = |node: usize| body.region_at(node).map(|region| self.places[region]);
        steps.iter().filter(|step| place(step.0) > place(step.1)).map(|step| step.2).min()
    }
}

/// The mean of Young's modulus in the elements behind boundaries.
fn modulus_behind(body: &ElasticBody, boundaries: &[&Boundary]) -> f64 {
    let owners = boundaries.iter().flat_map(|boundary| body.mesh().faces_of(boundary)).flatten();
    let young: Vec<f64> = owners.map(|owner| body.phase_of(owner.0).material().young()[1]).collect();
    young.iter().sum::<f64>() / young.len().max(1) as f64
}

/// The mean length or area of the facets of boundaries.
pub(crate) fn facet_size(body: &ElasticBody, boundaries: &[&Boundary]) -> f64 {
    let sizes: Vec<f64> =
        boundaries.iter().flat_map(|boundary| facet_sizes(body, boundary)).map(|(extent, _)| extent).collect();
    sizes.iter().sum::<f64>() / sizes.len().max(1) as f64
}

/// The row of a candidate against another body: the node opposite to it, or the mean over its area.
#[derive(Clone, Debug)]
pub struct BodyRow {
    /// The nodes that it couples, as in a [`ContactRow`](crate::scene::ContactRow).
    pub ends: Vec<(usize, f64)>,
    /// The normal of the row, of length 1, from the candidate's body into the other.
    pub normal: [f64; 3],
    /// The direction half way between the normals of both surfaces at the row, from the candidate's body into the
    /// other.
    pub mean: [f64; 3],
    /// The outward normal of the candidate's body at the row; `None` for the mean of all facets around the candidate.
    pub outward: Option<[f64; 3]>,
    /// Distance along the normal to the other body, in length.
    pub distance: f64,
    /// The area over which the row is a mean, in area; `None` for a pair of nodes.
    pub area: Option<f64>,
}

impl BodyRow {
    /// The row of the candidate, with the other body shifted by `gap` along the unit vector `approach`.
    pub fn row(&self, gap: f64, approach: [f64; 3]) -> ObstacleRow {
        ObstacleRow { normal: self.normal, gap: self.distance + gap * dot(self.normal, approach) }
    }
}

/// The rows between two bodies.
#[derive(Clone, Debug)]
pub struct Between {
    /// The row of each candidate of the boundary that carries the rows; `None` where nothing faces it.
    pub rows: Vec<Option<BodyRow>>,
    /// Further rows of candidates, by their numbers: a node at a corner has one for each side.
    pub further: Vec<(usize, BodyRow)>,
    /// For nodes of the other body the place that they face, as a row against their own normal: not a row of the
    /// problem, but the same contact seen from there.
    pub across: Vec<(usize, BodyRow)>,
    /// Name of the boundary that the rows lead to.
    pub other: String,
    /// Covered shares of the carrying and of the other boundary, if rows are means.
    pub covered: Option<[f64; 2]>,
    /// The nodes, in ascending order, of each facet of the carrying boundary that faces the other, with the covered
    /// share of its area, if rows are means.
    pub facets: Option<HashMap<Vec<usize>, f64>>,
    /// Largest distance at which the bodies may touch, in length; infinite without one.
    pub reach: f64,
    /// The gap of all rows, in length, instead of the distance of the bodies.
    pub fit: Option<f64>,
    /// The boundary of the other body carries the rows, so that they lead against the approach direction.
    pub is_swapped: bool,
    /// What the search for rows noticed.
    pub warnings: Vec<Warning>,
}
