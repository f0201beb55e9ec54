//! Contact segments: connected closed parts of an obstacle's boundary, and their extent.
//!
//! An uncertainty is meant to contain the value of a mesh that is four times finer (`reference/uncertainty.py` measures
//! in how many parts it does); where no number is known to do that, there is none.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::patch::ContactPatch;
use crate::fem::geometry::dot;
use crate::fem::recovery::{Stress, stress_at};
use crate::scene::Answer;
use crate::scene::models::model::place;
use crate::scene::models::resultants::{Sum, at_node};

/// A peak pressure at the end of a boundary is that of an edge if it is this many times the mean of the closed nodes
/// around. The weakest edge of practice, a right angle on a flat body of the same material, has a pressure proportional
/// to `d^-0.226` at the distance d: its means over the last half cell and the cell before are as 1.5 to 1. Smooth
/// pressures are as 1 to 1.
const EDGE: f64 = 4.0 / 3.0;

/// The extent of a contact, estimated between the nodes from the pressures next to its edge, with its uncertainty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ContactExtent {
    /// Uncertainty of the largest pressure, in force per area: the largest difference, at its node and the inner nodes
    /// around, between the pressure (the force of a row over its area) and the normal stress of the body, which is a
    /// second value with errors of its own; plus half of the difference of the largest pressure from the mean over its
    /// node and the closed nodes around. `None` if it stands at an edge, where refinement changes it by any amount, or
    /// if no node of the contact has only closed nodes around.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_uncertainty: Option<f64>,
    /// Estimated area of the contact, in area; thickness or circumference included.
    pub area: f64,
    /// Half of the area that lies in cells at the edge, in area; in closed cells the part by which a curved surface may
    /// differ.
    pub area_uncertainty: f64,
    /// Estimated length along the boundary, in length, if the model is plane or axisymmetric.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Half of the length that lies in cells at the edge, in length; in closed cells the part by which a curved line
    /// may differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width_uncertainty: Option<f64>,
    /// The contact begins at the axis of revolution, so that its width is a radius.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub from_axis: bool,
}

/// Connected closed rows of one obstacle on its boundary: one piece of the contact, with its force and its extent. With
/// planes of symmetry all of it is of the meshed part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Segment {
    /// The obstacle of the segment, numbered from 0 in the order of the scene.
    pub obstacle: usize,
    /// Indices of the closed nodes in the mesh, from 0, in the order of the boundary.
    pub nodes: Vec<usize>,
    /// The force of the obstacle on the body, one component for each coordinate, in force, along the positive axes.
    pub force: Vec<f64>,
    /// A point on its line of action, one coordinate for each axis, in length, as in
    /// [`Resultant`](crate::scene::Resultant).
    pub centre: Option<Vec<f64>>,
    /// The largest pressure among its nodes, in force per area, `>= 0`.
    pub pressure_max: f64,
    /// Estimated area and width of the contact, with their uncertainty.
    #[serde(flatten)]
    pub extent: ContactExtent,
    /// The node of the largest pressure, if it is next to an open node although other closed nodes are not, or at the
    /// end of the boundary and far above the nodes around: an edge of the obstacle or of the body, where the exact
    /// pressure is unbounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edge_peak: Option<usize>,
    /// The two estimated ends, `[x, y]` each, in length, on the undeformed boundary, if the model is plane or
    /// axisymmetric and there are two ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ends: Option<[Vec<f64>; 2]>,
}

impl ContactExtent {
    /// The extent of all segments together; `None` without segments.
    #[doc(hidden)]
    pub fn of<'a>(segments: impl Iterator<Item = &'a Segment> + Clone) -> Option<Self> {
        let peak = segments.clone().max_by(|a, b| a.pressure_max.total_cmp(&b.pressure_max))?;
        let extents = || segments.clone().map(|segment| &segment.extent);
        Some(ContactExtent {
            pressure_uncertainty: peak.extent.pressure_uncertainty,
            area: extents().map(|extent| extent.area).sum(),
            area_uncertainty: extents().map(|extent| extent.area_uncertainty).sum(),
            width: extents().map(|extent| extent.width).sum(),
            width_uncertainty: extents().map(|extent| extent.width_uncertainty).sum(),
            from_axis: extents().all(|extent| extent.from_axis),
        })
    }

    /// The extent of `parts` mirror images together.
    #[doc(hidden)]
    pub fn of_parts(self, parts: f64) -> Self {
        ContactExtent {
            pressure_uncertainty: self.pressure_uncertainty,
            area: parts * self.area,
            area_uncertainty: parts * self.area_uncertainty,
            width: self.width.map(|width| parts * width),
            width_uncertainty: self.width_uncertainty.map(|off| parts * off),
            from_axis: self.from_axis,
        }
    }
}

/// A size with its uncertainty.
#[derive(Clone, Copy, Debug, Default)]
struct Extent {
    inner: f64,
    estimate: f64,
    outer: f64,
}

impl Extent {
    /// Adds a cell with only closed nodes, from which the surface may differ by a share `bend`.
    fn add_closed(&mut self, whole: f64, bend: f64) {
        self.inner += (1.0 - bend) * whole;
        self.add_edge(whole, (1.0 + bend) * whole);
    }

    /// Adds a cell at the edge, a part of which is covered.
    fn add_edge(&mut self, covered: f64, whole: f64) {
        self.estimate += covered;
        self.outer += whole;
    }

    fn uncertainty(&self) -> f64 {
        0.5 * (self.outer - self.inner)
    }
}

impl Answer {
    /// The estimated length of the contact with an obstacle along its boundary in the meshed part, in length, as in
    /// [`ContactExtent::width`].
    pub(crate) fn width_on(&self, obstacle: usize) -> f64 {
        let Some(patch) = ContactPatch::new(self, obstacle) else { return 0.0 };
        patch.pieces().iter().map(|nodes| extent_of(&patch, nodes).0.estimate).sum()
    }

    /// The contact segments of all obstacles, obstacle by obstacle, each in the order of its boundary.
    pub fn segments(&self) -> Vec<Segment> {
        (0..self.model().obstacles().len()).flat_map(|obstacle| self.segments_of(obstacle)).collect()
    }

    fn segments_of(&self, obstacle: usize) -> Vec<Segment> {
        let Some(patch) = ContactPatch::new(self, obstacle) else { return Vec::new() };
        let pieces = patch.pieces();
        let pieces: Vec<_> = pieces.iter().filter_map(|nodes| Some((nodes, Peak::of(&patch, nodes)?))).collect();
        let recovered = self.recovered(&patch, pieces.iter().flat_map(|(_, peak)| peak.near.iter().copied()));
        pieces.iter().map(|(nodes, peak)| self.segment(&patch, obstacle, nodes, peak, &recovered)).collect()
    }

    /// The pressure at closed nodes by the stress of the body: the traction along the row over the area that faces the
    /// obstacle, without the part of the loads at the node.
    fn recovered(&self, patch: &ContactPatch, nodes: impl Iterator<Item = usize>) -> Recovered {
        let model = self.model();
        let stresses = stress_at(model.body(), self.displacement(), &nodes.collect());
        let pressure = |(node, stress): (usize, Stress)| {
            let row = patch.row(node)?;
            let facing = dot(row.normal, row.outward);
            let traction = dot(row.normal, stress.on(row.outward)) / if facing > 0.0 { facing } else { 1.0 };
            let load = dot(row.normal, at_node(model, model.nodal_load(), node)) / row.projected_area();
            // The end of a quadratic edge on an axis of revolution has no area.
            Some((node, if load.is_finite() { load - traction } else { -traction }))
        };
        stresses.into_iter().filter_map(pressure).collect()
    }

    fn segment(
        &self,
        patch: &ContactPatch,
        obstacle: usize,
        nodes: &[usize],
        peak: &Peak,
        recovered: &Recovered,
    ) -> Segment {
        let (formulation, dimension) = (self.model().body().formulation(), self.model().body().dimension());
        let (width, area) = extent_of(patch, nodes);
        let is_line = dimension == 2;
        let ends = if is_line { ends_of(patch, nodes) } else { Vec::new() };
        let mut sum = Sum::default();
        for &node in nodes {
            let Some(row) = patch.row(node) else { continue };
            sum.add(place(self.model(), node), row.normal.map(|component| 0.0 + patch.multiplier(node) * component));
        }
        let written = |at: [f64; 3]| at[..dimension].to_vec();
        Segment {
            obstacle,
            nodes: nodes.to_vec(),
            force: written(sum.force()),
            centre: sum.centre(formulation).map(written),
            pressure_max: patch.pressure(peak.node),
            extent: ContactExtent {
                pressure_uncertainty: peak.uncertainty(patch, recovered),
                area: area.estimate,
                area_uncertainty: area.uncertainty(),
                width: is_line.then_some(width.estimate),
                width_uncertainty: is_line.then(|| width.uncertainty()),
                from_axis: formulation.is_axisymmetric() && nodes.iter().any(|&node| patch.place(node)[0] == 0.0),
            },
            edge_peak: peak.is_at_edge.then_some(peak.node),
            ends: <[[f64; 3]; 2]>::try_from(ends).ok().map(|ends| ends.map(written)),
        }
    }
}

/// The length or area of closed nodes, and the area with thickness, cross-section or circumference.
fn extent_of(patch: &ContactPatch, nodes: &[usize]) -> (Extent, Extent) {
    let (mut width, mut area) = (Extent::default(), Extent::default());
    for cell in patch.cells_with(nodes) {
        let whole = patch.sizes(cell, &patch.places(&cell.nodes));
        if patch.is_whole(cell) {
            let bend = patch.bend(cell);
            width.add_closed(whole.0, bend);
            area.add_closed(whole.1, bend);
        } else {
            let covered = patch.sizes(cell, &patch.covered(&cell.nodes));
            width.add_edge(covered.0, whole.0);
            area.add_edge(covered.1, whole.1);
        }
    }
    (width, area)
}

/// The ends of closed nodes on a line: between a closed and an open node, or where the boundary ends.
fn ends_of(patch: &ContactPatch, nodes: &[usize]) -> Vec<[f64; 3]> {
    let edge = |cell: &[usize]| match *cell {
        [a, b] if patch.is_closed(a) && !patch.is_closed(b) => Some(patch.edge(a, b)),
        [a, b] if patch.is_closed(b) && !patch.is_closed(a) => Some(patch.edge(b, a)),
        _ => None,
    };
    let inside = patch.cells_with(nodes).filter_map(|cell| edge(&cell.nodes));
    let ends = |node: &&usize| patch.is_at_rim(**node) || patch.is_on_plane(**node);
    let rim = nodes.iter().filter(ends).map(|&node| patch.place(node));
    inside.chain(rim).collect()
}

/// The largest pressure of a segment.
struct Peak {
    node: usize,
    /// The node and the closed nodes around.
    near: BTreeSet<usize>,
    /// Whether it stands at an edge of the obstacle or of the body.
    is_at_edge: bool,
    /// Whether a node of the segment has only closed nodes around.
    is_resolved: bool,
}

/// The pressure at closed nodes by the stress of the body.
type Recovered = BTreeMap<usize, f64>;

impl Peak {
    /// `None` without nodes.
    fn of(patch: &ContactPatch, nodes: &[usize]) -> Option<Self> {
        let node = nodes.iter().copied().max_by(|&a, &b| patch.pressure(a).total_cmp(&patch.pressure(b)))?;
        let around = patch.closed_around(node);
        let mean = patch.mean_around(node, &around);
        let ends_high = !around.is_empty() && patch.is_at_rim(node) && patch.pressure(node) > EDGE * mean;
        let is_resolved = nodes.iter().any(|&node| patch.is_inside(node));
        let is_at_edge = is_resolved && (!patch.is_inside(node) || ends_high);
        let near = around.into_iter().chain([node]).collect();
        Some(Peak { node, near, is_at_edge, is_resolved })
    }

    /// As [`ContactExtent::pressure_uncertainty`].
    fn uncertainty(&self, patch: &ContactPatch, recovered: &Recovered) -> Option<f64> {
        if self.is_at_edge || !self.is_resolved {
            return None;
        }
        let off = |&node: &usize| Some((patch.pressure(node) - recovered.get(&node)?).abs());
        // Next to the edge of the contact pressure and stress differ by the edge.
        let inner = self.near.iter().filter(|&&node| node == self.node || patch.is_inside(node));
        let of_stress = inner.map(off).try_fold(0.0, |most: f64, off| Some(most.max(off?)))?;
        let mean = patch.mean_around(self.node, &self.near);
        Some(of_stress + 0.5 * (patch.pressure(self.node) - mean).abs())
    }
}
