//! The boundary of an obstacle with its closed nodes: its straight cells, connected pieces, edges of the contact.
//!
//! Rows exist only at nodes, so that the edge of the contact lies between the last closed node and the next open one.
//! Near the edge of a smooth contact pressures are proportional to the square root of the distance: their squares lie
//! on a straight line. The edge is estimated at the zero of this line through the last two nodes. A zero far beyond the
//! open node contradicts that node: the edge is then taken in the middle.

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet, HashMap};

use crate::fem::assembly::facet_sizes;
use crate::fem::geometry::{cross, distance, dot, length, minus, plus, shifted, sorted};
use crate::scene::Answer;
use crate::scene::models::rows::ContactRow;
use signorini_qp::Forest;

/// Least cosine of the angle between the direction from an inner node to the last closed one and the direction to the
/// open one.
const AHEAD: f64 = 0.5;

/// How far beyond the last closed node, in cells, the zero may lie although the edge lies within one cell: in the
/// contact of Hertz a line through nodes at 1/2 and 3/2 cells from the centre has its zero 2 cells beyond if the edge
/// is at 5/2, and less through nodes farther out.
const FARTHEST: f64 = 2.0;

/// Squared lengths of a mean normal that differ from 1 by less are rounding.
const ROUNDING_OF_NORMALS: f64 = 1e-12;

/// A straight cell of a facet.
pub(crate) struct StraightCell {
    pub nodes: Vec<usize>,
    /// The number of its facet in the boundary, from 0.
    pub facet: usize,
    /// The share of the facet that the other body covers; 1 for a rigid obstacle.
    pub share: f64,
    /// The length or area of the facet, as far as the other body covers it, in proportion to that of its straight
    /// cells.
    stretch: f64,
    /// The same with thickness, cross-section or circumference.
    enlargement: f64,
}

/// The boundary of an obstacle with its closed nodes.
pub(crate) struct ContactPatch<'a> {
    pub answer: &'a Answer,
    row_of: BTreeMap<usize, usize>,
    /// The nodes of a boundary with a row each, if the covered shares of its facets say where the contact ends.
    carrying: Option<BTreeSet<usize>>,
    /// Those of the boundary, facet by facet.
    pub cells: Vec<StraightCell>,
    cells_of: BTreeMap<usize, Vec<usize>>,
    /// The closed nodes in the order of the boundary.
    closed: Vec<usize>,
    /// A node at another place than in the mesh, and its way there.
    moved: Cell<Option<(usize, [f64; 3])>>,
}

impl<'a> ContactPatch<'a> {
    /// `None` if no node is closed.
    pub fn new(answer: &'a Answer, obstacle: usize) -> Option<Self> {
        let model = answer.model();
        let boundary = model.mesh().boundary(model.obstacles()[obstacle].boundary())?;
        let rows = || model.rows().iter().enumerate().filter(|(_, row)| row.obstacle == obstacle);
        let closed = rows().filter(|&(index, _)| answer.contact_set().contains(index));
        let row_of: BTreeMap<usize, usize> = closed.map(|(index, row)| (row.node, index)).collect();
        if row_of.is_empty() {
            return None;
        }
        let closed = boundary.nodes().into_iter().filter(|node| row_of.contains_key(node)).collect();
        let shares = model.obstacles()[obstacle].between().and_then(|between| between.facets.as_ref());
        let carrying = shares.map(|_| rows().map(|(_, row)| row.node).collect());
        let (cells, cells_of, moved) = (Vec::new(), BTreeMap::new(), Cell::default());
        let mut patch = ContactPatch { answer, row_of, carrying, cells, cells_of, closed, moved };
        let sizes = facet_sizes(model.body(), boundary);
        for (facet, (nodes, (extent, area))) in boundary.facets().zip(sizes).enumerate() {
            let straight = boundary.kind.straight_cells(nodes);
            let sizes = straight.iter().map(|cell| patch.straight_sizes(&patch.places(cell)));
            let (sum, area_sum) = sizes.fold((0.0, 0.0), |sum, (extent, area)| (sum.0 + extent, sum.1 + area));
            let ratio = |whole: f64, sum: f64| if sum > 0.0 { whole / sum } else { 1.0 };
            let share_of =
                |shares: &HashMap<Vec<usize>, f64>| shares.get(&sorted(nodes.iter().copied())).copied().unwrap_or(0.0);
            let share = shares.map_or(1.0, share_of);
            let (stretch, enlargement) = (share * ratio(extent, sum), share * ratio(area, area_sum));
            let cell = |nodes| StraightCell { nodes, facet, share, stretch, enlargement };
            patch.cells.extend(straight.into_iter().map(cell));
        }
        for (index, cell) in patch.cells.iter().enumerate() {
            for &node in cell.nodes.iter().filter(|node| patch.row_of.contains_key(node)) {
                patch.cells_of.entry(node).or_default().push(index);
            }
        }
        Some(patch)
    }

    /// Moves one node from its place in the mesh, and all others back to theirs; the stretches of facets stay.
    pub fn set_moved(&self, node: usize, by: [f64; 3]) {
        self.moved.set(Some((node, by)));
    }

    /// The cells with a closed node of these, and those of the same facets without a row, where the other body ends;
    /// each once.
    pub fn cells_with(&self, nodes: &[usize]) -> impl Iterator<Item = &StraightCell> {
        let own = nodes.iter().filter_map(|node| self.cells_of.get(node)).flatten().copied();
        let mut cells: BTreeSet<usize> = own.collect();
        if self.carrying.is_some() {
            let facets: BTreeSet<usize> = cells.iter().map(|&cell| self.cells[cell].facet).collect();
            let is_beyond = |cell: &StraightCell| cell.nodes.iter().all(|&node| !self.carries(node));
            let beyond = self.cells.iter().enumerate().filter(|(_, cell)| facets.contains(&cell.facet));
            cells.extend(beyond.filter(|(_, cell)| is_beyond(cell)).map(|(index, _)| index));
        }
        cells.into_iter().map(|cell| &self.cells[cell])
    }

    /// Returns `false` for a node without a row because the other body ends there.
    fn carries(&self, node: usize) -> bool {
        self.carrying.as_ref().is_none_or(|carrying| carrying.contains(&node))
    }

    /// The length or area of an outline in a cell, and its area with thickness, cross-section or circumference.
    pub fn sizes(&self, cell: &StraightCell, outline: &[[f64; 3]]) -> (f64, f64) {
        let (extent, area) = self.straight_sizes(outline);
        (cell.stretch * extent, cell.enlargement * area)
    }

    fn straight_sizes(&self, outline: &[[f64; 3]]) -> (f64, f64) {
        let radius = outline.iter().map(|at| at[0]).sum::<f64>() / outline.len().max(1) as f64;
        let extent = extent(outline);
        (extent, self.answer.model().body().formulation().measure(radius) * extent)
    }

    /// `1 - |n|^2` with the mean n of the outward unit normals at the nodes of a closed cell: 0 if it is flat.
    pub fn bend(&self, cell: &StraightCell) -> f64 {
        let normals = cell.nodes.iter().filter_map(|&node| self.row(node)).map(|row| row.outward);
        let sum = normals.fold([0.0; 3], plus);
        let closed = cell.nodes.iter().filter(|&&node| self.is_closed(node)).count();
        let bend = 1.0 - (length(sum) / closed as f64).powi(2);
        if bend > ROUNDING_OF_NORMALS { bend } else { 0.0 }
    }

    pub fn row(&self, node: usize) -> Option<&ContactRow> {
        self.row_of.get(&node).map(|&row| &self.answer.model().rows()[row])
    }

    /// The multiplier of a closed node, in force, `<= 0`.
    pub fn multiplier(&self, node: usize) -> f64 {
        self.row_of.get(&node).map_or(0.0, |&row| self.answer.multiplier()[row])
    }

    /// Returns `true` if the boundary of the whole body ends at a closed node.
    pub fn is_at_rim(&self, node: usize) -> bool {
        let mut beside: BTreeMap<usize, usize> = BTreeMap::new();
        for cell in self.cells_of.get(&node).into_iter().flatten().map(|&cell| &self.cells[cell].nodes) {
            match cell[..] {
                [_] => {}
                // A line has one end on each side of the node.
                [_, _] => *beside.entry(node).or_default() += 1,
                _ => {
                    let place = cell.iter().position(|&other| other == node).unwrap_or(0);
                    for step in [1, cell.len() - 1] {
                        *beside.entry(cell[(place + step) % cell.len()]).or_default() += 1;
                    }
                }
            }
        }
        // Beyond a plane of symmetry the boundary goes on.
        beside.iter().any(|(&other, &cells)| cells == 1 && !self.share_plane(node, other))
    }

    /// Returns `true` if a node lies on a plane of symmetry: the boundary of the meshed part ends there, not that of
    /// the whole.
    pub fn is_on_plane(&self, node: usize) -> bool {
        self.share_plane(node, node)
    }

    fn share_plane(&self, node: usize, other: usize) -> bool {
        let (model, nodes) = (self.answer.model(), self.answer.model().mesh().nodes());
        model.parts.conditions.symmetry.share_plane(&nodes[node], &nodes[other])
    }

    /// The mean pressure of nodes around a node, itself or not, in force per area. A node on a plane of symmetry has
    /// the mirror images of its neighbours around it as well.
    pub fn mean_around(&self, node: usize, around: &BTreeSet<usize>) -> f64 {
        let images = |other: usize| self.images_around(node, other).len() as f64;
        let count: f64 = around.iter().map(|&other| images(other)).sum();
        around.iter().map(|&other| images(other) * self.pressure(other)).sum::<f64>() / count
    }

    /// The places of the node `other` and its mirror images that are around a node in the whole.
    fn images_around(&self, node: usize, other: usize) -> Vec<[f64; 3]> {
        self.answer.model().parts.conditions.symmetry.images_around(&self.place(node), &self.place(other))
    }

    /// Returns `true` if all nodes around a node are closed.
    pub fn is_inside(&self, node: usize) -> bool {
        self.around(node).all(|other| self.is_closed(other))
    }

    /// The closed nodes around a closed node, each once.
    pub fn closed_around(&self, node: usize) -> BTreeSet<usize> {
        self.around(node).filter(|&other| self.is_closed(other)).collect()
    }

    /// The other nodes of the cells around a closed node, each as often as it shares a cell.
    fn around(&self, node: usize) -> impl Iterator<Item = usize> {
        let cells = self.cells_of.get(&node).into_iter().flatten();
        cells.flat_map(|&cell| self.cells[cell].nodes.iter().copied()).filter(move |&other| other != node)
    }

    /// Returns `true` if a cell with a closed node has no edge of the contact between its nodes: all are closed, or
    /// carry no row because the other body ends there.
    pub fn is_whole(&self, cell: &StraightCell) -> bool {
        cell.nodes.iter().all(|&node| self.is_closed(node) || !self.carries(node))
    }

    pub fn is_closed(&self, node: usize) -> bool {
        self.row_of.contains_key(&node)
    }

    /// The pressure at a closed node, in force per area; 0 at others.
    pub fn pressure(&self, node: usize) -> f64 {
        self.row_of.get(&node).map_or(0.0, |&row| self.answer.pressure()[row])
    }

    pub fn place(&self, node: usize) -> [f64; 3] {
        let at = self.answer.model().mesh().nodes()[node];
        match self.moved.get() {
            Some((moved, by)) if moved == node => plus(at, by),
            _ => at,
        }
    }

    pub fn places(&self, nodes: &[usize]) -> Vec<[f64; 3]> {
        nodes.iter().map(|&node| self.place(node)).collect()
    }

    /// The closed nodes in connected pieces: nodes of one cell belong together.
    pub fn pieces(&self) -> Vec<Vec<usize>> {
        let numbered = self.closed.iter().enumerate().map(|(number, &node)| (node, number));
        let number_of: BTreeMap<usize, usize> = numbered.collect();
        let mut forest = Forest::new(self.closed.len());
        for cell in &self.cells {
            let inside: Vec<usize> = cell.nodes.iter().filter_map(|node| number_of.get(node).copied()).collect();
            inside.windows(2).for_each(|pair| forest.join(pair[0], pair[1]));
        }
        let (piece_of, count) = forest.into_trees();
        let mut pieces = vec![Vec::new(); count];
        self.closed.iter().zip(piece_of).for_each(|(&node, piece)| pieces[piece].push(node));
        pieces
    }

    /// The outline of the closed part of a cell.
    pub fn covered(&self, cell: &[usize]) -> Vec<[f64; 3]> {
        let mut outline = Vec::new();
        for (place, &node) in cell.iter().enumerate() {
            if self.is_closed(node) {
                outline.push(self.place(node));
            }
            let next = cell[(place + 1) % cell.len()];
            // A line has one connection between its nodes, not two.
            let is_way = cell.len() > 2 || place == 0;
            if is_way && self.is_closed(node) != self.is_closed(next) {
                let (closed, open) = if self.is_closed(node) { (node, next) } else { (next, node) };
                outline.push(self.edge(closed, open));
            }
        }
        outline
    }

    /// The point at which the contact ends, between a closed and an open node.
    pub fn edge(&self, closed: usize, open: usize) -> [f64; 3] {
        let (from, to) = (self.place(closed), self.place(open));
        let way = minus(to, from);
        let ahead = |inner: [f64; 3]| {
            let before = minus(from, inner);
            dot(before, way) / (length(before) * length(way))
        };
        // The whole has mirror images of nodes around a node on a plane of symmetry.
        let images = |node: usize| self.images_around(closed, node).into_iter().map(move |at| (node, at));
        let inner = self.around(closed).filter(|&node| self.is_closed(node)).flat_map(images);
        let inner = inner.filter(|&(_, at)| ahead(at) > AHEAD);
        let inner = inner.max_by(|&(_, a), &(_, b)| ahead(a).total_cmp(&ahead(b)));
        let reach = inner.map(|(inner, at)| {
            let (last, before) = (self.pressure(closed).powi(2), self.pressure(inner).powi(2));
            last / (before - last) * distance(from, at) / length(way)
        });
        // Pressures that rise towards the edge, or fall too little for the open node, give no estimate of the edge.
        let share = reach.filter(|reach| (0.0..=FARTHEST).contains(reach)).map_or(0.5, |reach| reach.min(1.0));
        shifted(from, share, way)
    }
}

/// The length of a line of two points, the area of a polygon; zero of a point.
fn extent(outline: &[[f64; 3]]) -> f64 {
    match outline {
        [] | [_] => 0.0,
        [a, b] => distance(*a, *b),
        [first, rest @ ..] => {
            let turned = rest.windows(2).map(|pair| cross(minus(pair[0], *first), minus(pair[1], *first)));
            0.5 * length(turned.fold([0.0; 3], plus))
        }
    }
}
