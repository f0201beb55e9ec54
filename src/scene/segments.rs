//! Contact segments: connected closed parts of an obstacle's boundary, and their extent.
//!
//! Rows exist only at nodes, so that the edge of the contact lies between the last closed node and the next open one. Near the edge of a
//! smooth contact pressures are proportional to the square root of the distance: their squares lie on a straight line. The edge is
//! estimated at the zero of this line through the last two nodes. Half of the cells at the edge are given as uncertainty.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::Answer;
use super::resultants::Sum;
use crate::fem::element::FacetKind;
use crate::fem::geometry::{cross, distance, dot, length, minus};

/// Least cosine of the angle between the direction from an inner node to the last closed one and the direction to the open one.
const AHEAD: f64 = 0.5;

/// The extent of a contact, estimated between the nodes from the pressures next to its edge, with its uncertainty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ContactExtent {
    /// Half of the difference of the largest pressure from the mean over its node and the closed nodes around, in force
    /// per area; the pressure itself if only open nodes are around.
    pub pressure_uncertainty: f64,
    /// Estimated area of the contact, in area; thickness or circumference included.
    pub area: f64,
    /// Half of the area that lies in cells at the edge, in area.
    pub area_uncertainty: f64,
    /// Estimated length along the boundary, in length, if the model is plane or axisymmetric.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Half of the length that lies in cells at the edge, in length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width_uncertainty: Option<f64>,
}

/// Connected closed rows of one obstacle on its boundary: one piece of the contact, with its force and its extent. With planes of symmetry
/// all of it is of the meshed part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Segment {
    /// The obstacle, numbered from 0 in the order of the scene.
    pub obstacle: usize,
    /// Indices of the closed nodes in the mesh, from 0, in the order of the boundary.
    pub nodes: Vec<usize>,
    /// The force of the obstacle on the body, one component for each coordinate, in force, along the positive axes.
    pub force: Vec<f64>,
    /// A point on its line of action, one coordinate for each axis, in length, as in [`Resultant`](super::Resultant).
    pub centre: Option<Vec<f64>>,
    /// The largest pressure among its nodes, in force per area, `>= 0`.
    pub pressure_max: f64,
    /// Estimated area and width of the contact, with their uncertainty.
    #[serde(flatten)]
    pub extent: ContactExtent,
    /// The node of the largest pressure, if it is next to an open node although other closed nodes are not: an edge of the
    /// obstacle, where the exact pressure is unbounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edge_peak: Option<usize>,
    /// The two estimated ends, `[x, y]` each, in length, on the undeformed boundary, if the model is plane or
    /// axisymmetric and there are two ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ends: Option<[Vec<f64>; 2]>,
}

impl ContactExtent {
    /// The extent of all segments together; `None` without segments.
    pub(crate) fn of<'a>(segments: impl Iterator<Item = &'a Segment> + Clone) -> Option<Self> {
        let peak = segments.clone().max_by(|a, b| a.pressure_max.total_cmp(&b.pressure_max))?;
        let extents = || segments.clone().map(|segment| &segment.extent);
        Some(ContactExtent {
            pressure_uncertainty: peak.extent.pressure_uncertainty,
            area: extents().map(|extent| extent.area).sum(),
            area_uncertainty: extents().map(|extent| extent.area_uncertainty).sum(),
            width: extents().map(|extent| extent.width).sum(),
            width_uncertainty: extents().map(|extent| extent.width_uncertainty).sum(),
        })
    }

    /// The extent of `parts` mirror images together.
    pub(crate) fn of_parts(self, parts: f64) -> Self {
        ContactExtent {
            pressure_uncertainty: self.pressure_uncertainty,
            area: parts * self.area,
            area_uncertainty: parts * self.area_uncertainty,
            width: self.width.map(|width| parts * width),
            width_uncertainty: self.width_uncertainty.map(|off| parts * off),
        }
    }
}

/// A size with its uncertainty.
#[derive(Clone, Copy, Debug, Default)]
struct Size {
    inner: f64,
    estimate: f64,
    outer: f64,
}

impl Size {
    /// Adds a cell with only closed nodes.
    fn add_closed(&mut self, whole: f64) {
        self.inner += whole;
        self.add_edge(whole, whole);
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
    /// The contact segments of all obstacles, obstacle by obstacle, each in the order of its boundary.
    pub fn segments(&self) -> Vec<Segment> {
        (0..self.model().obstacles().len()).flat_map(|obstacle| self.segments_of(obstacle)).collect()
    }

    fn segments_of(&self, obstacle: usize) -> Vec<Segment> {
        let model = self.model();
        let Some(boundary) = model.mesh().boundary(model.obstacles()[obstacle].boundary()) else { return Vec::new() };
        let rows = model.rows().iter().enumerate().filter(|(_, row)| row.obstacle == obstacle);
        let row_of: BTreeMap<usize, usize> = rows
            .filter(|&(index, _)| self.contact_set().contains(index))
            .map(|(index, row)| (row.node, index))
            .collect();
        if row_of.is_empty() {
            return Vec::new();
        }
        let cells: Vec<Vec<usize>> = boundary.facets().flat_map(|facet| straight_cells(boundary.kind, facet)).collect();
        let order = boundary.nodes();
        let mut cells_of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, cell) in cells.iter().enumerate() {
            cell.iter().filter(|node| row_of.contains_key(node)).for_each(|&node| {
                cells_of.entry(node).or_default().push(index);
            });
        }
        let patch = Patch { answer: self, row_of, cells, cells_of };
        patch.pieces(&order).iter().map(|nodes| patch.segment(obstacle, nodes)).collect()
    }
}

/// The straight cells of a facet: the nodes around each cell.
pub(crate) fn straight_cells(kind: FacetKind, facet: &[usize]) -> Vec<Vec<usize>> {
    // A quadratic triangle is cut into four: the corners and the middle. A quadratic quadrilateral is cut into four corners and the
    // middle.
    const QUARTERS: [[usize; 3]; 4] = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
    const CORNERS_AND_MIDDLE: [&[usize]; 5] = [&[0, 4, 7], &[4, 1, 5], &[5, 2, 6], &[6, 3, 7], &[4, 5, 6, 7]];
    let of_facet = |cell: &[usize]| cell.iter().map(|&local| facet[local]).collect();
    match kind {
        FacetKind::Point1 | FacetKind::T3 | FacetKind::Q4 => vec![facet.to_vec()],
        FacetKind::Line2 | FacetKind::Line3 => {
            let along: Vec<usize> = kind.reference().along.iter().map(|&local| facet[local]).collect();
            along.windows(2).map(<[usize]>::to_vec).collect()
        }
        FacetKind::T6 => QUARTERS.iter().map(|cell| of_facet(cell)).collect(),
        FacetKind::Q8 => CORNERS_AND_MIDDLE.iter().map(|cell| of_facet(cell)).collect(),
    }
}

/// The boundary of an obstacle with its closed nodes.
struct Patch<'a> {
    answer: &'a Answer,
    /// The row of each closed node.
    row_of: BTreeMap<usize, usize>,
    cells: Vec<Vec<usize>>,
    /// The cells around each closed node.
    cells_of: BTreeMap<usize, Vec<usize>>,
}

impl Patch<'_> {
    /// The other nodes of the cells around a closed node, each as often as it shares a cell.
    fn around(&self, node: usize) -> impl Iterator<Item = usize> {
        let cells = self.cells_of.get(&node).into_iter().flatten();
        cells.flat_map(|&cell| self.cells[cell].iter().copied()).filter(move |&other| other != node)
    }

    fn is_closed(&self, node: usize) -> bool {
        self.row_of.contains_key(&node)
    }

    fn pressure(&self, node: usize) -> f64 {
        self.row_of.get(&node).map_or(0.0, |&row| self.answer.pressure()[row])
    }

    fn place(&self, node: usize) -> [f64; 3] {
        self.answer.model().mesh().nodes()[node]
    }

    /// The closed nodes in connected pieces: nodes of one cell belong together.
    fn pieces(&self, order: &[usize]) -> Vec<Vec<usize>> {
        let closed: Vec<usize> = order.iter().copied().filter(|&node| self.is_closed(node)).collect();
        let mut root: BTreeMap<usize, usize> = closed.iter().map(|&node| (node, node)).collect();
        fn find(root: &mut BTreeMap<usize, usize>, node: usize) -> usize {
            let mut at = node;
            while root[&at] != at {
                let above = root[&root[&at]];
                root.insert(at, above);
                at = above;
            }
            at
        }
        for cell in &self.cells {
            let inside: Vec<usize> = cell.iter().copied().filter(|&node| self.is_closed(node)).collect();
            for pair in inside.windows(2) {
                let (a, b) = (find(&mut root, pair[0]), find(&mut root, pair[1]));
                root.insert(a, b);
            }
        }
        let mut pieces: Vec<Vec<usize>> = Vec::new();
        let mut place_of: BTreeMap<usize, usize> = BTreeMap::new();
        for node in closed {
            let top = find(&mut root, node);
            let place = *place_of.entry(top).or_insert_with(|| {
                pieces.push(Vec::new());
                pieces.len() - 1
            });
            pieces[place].push(node);
        }
        pieces
    }

    fn segment(&self, obstacle: usize, nodes: &[usize]) -> Segment {
        let model = self.answer.model();
        let (formulation, dimension) = (model.body().formulation(), model.body().dimension());
        let (mut area, mut width, mut ends) = (Size::default(), Size::default(), Vec::new());
        let own = nodes.iter().filter_map(|node| self.cells_of.get(node)).flatten().copied();
        for cell in own.collect::<BTreeSet<usize>>() {
            let cell = &self.cells[cell];
            let covered = self.covered(cell);
            let whole: Vec<[f64; 3]> = cell.iter().map(|&node| self.place(node)).collect();
            let measure = |outline: &[[f64; 3]]| {
                let count = outline.len().max(1) as f64;
                let radius = outline.iter().map(|at| at[0]).sum::<f64>() / count;
                formulation.measure(radius) * extent(outline)
            };
            if cell.iter().all(|&node| self.is_closed(node)) {
                area.add_closed(measure(&whole));
                width.add_closed(extent(&whole));
            } else {
                area.add_edge(measure(&covered), measure(&whole));
                width.add_edge(extent(&covered), extent(&whole));
            }
            if let [a, b] = cell[..] {
                match (self.is_closed(a), self.is_closed(b)) {
                    (true, false) => ends.push(self.edge(a, b)),
                    (false, true) => ends.push(self.edge(b, a)),
                    _ => {}
                }
            }
        }
        let is_line = dimension == 2;
        // The contact ends at the end of the boundary.
        let stops = |node: &&usize| is_line && self.around(**node).count() == 1;
        ends.extend(nodes.iter().filter(stops).map(|&node| self.place(node)));
        let highest = nodes.iter().copied().max_by(|&a, &b| self.pressure(a).total_cmp(&self.pressure(b)));
        let is_inside = |node: &usize| self.around(*node).all(|other| self.is_closed(other));
        let edge_peak = highest.filter(|highest| !is_inside(highest) && nodes.iter().any(is_inside));
        let rows = || nodes.iter().filter_map(|node| self.row_of.get(node).copied());
        let mut sum = Sum::default();
        for row in rows() {
            let (row, lambda) = (&model.rows()[row], self.answer.multiplier()[row]);
            sum.add(model.place(row.node), row.normal.map(|component| 0.0 + lambda * component));
        }
        let written = |at: [f64; 3]| at[..dimension].to_vec();
        Segment {
            obstacle,
            nodes: nodes.to_vec(),
            force: written(sum.force()),
            centre: sum.centre(formulation).map(written),
            pressure_max: highest.map_or(0.0, |node| self.pressure(node)),
            extent: ContactExtent {
                pressure_uncertainty: highest.map_or(0.0, |node| self.spread(node)),
                area: area.estimate,
                area_uncertainty: area.uncertainty(),
                width: is_line.then_some(width.estimate),
                width_uncertainty: is_line.then(|| width.uncertainty()),
            },
            edge_peak,
            ends: <[[f64; 3]; 2]>::try_from(ends).ok().map(|ends| ends.map(written)),
        }
    }

    /// Half of the difference of the pressure at a closed node from the mean over it and the closed nodes around. If only open nodes
    /// are around, the area of the contact is unknown, and so is the whole pressure.
    fn spread(&self, node: usize) -> f64 {
        let around: BTreeSet<usize> = self.around(node).collect();
        let mut near: BTreeSet<usize> = around.iter().copied().filter(|&other| self.is_closed(other)).collect();
        if near.is_empty() && !around.is_empty() {
            return self.pressure(node);
        }
        near.insert(node);
        // A node on a plane of symmetry has the mirror images of its neighbours around it as well.
        let images = |other: usize| self.answer.model().images_around(node, other);
        let count: f64 = near.iter().map(|&other| images(other)).sum();
        let mean = near.iter().map(|&other| images(other) * self.pressure(other)).sum::<f64>() / count;
        0.5 * (self.pressure(node) - mean).abs()
    }

    /// The outline of the closed part of a cell.
    fn covered(&self, cell: &[usize]) -> Vec<[f64; 3]> {
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
    fn edge(&self, closed: usize, open: usize) -> [f64; 3] {
        let (from, to) = (self.place(closed), self.place(open));
        let way = minus(to, from);
        let ahead = |inner: usize| {
            let before = minus(from, self.place(inner));
            dot(before, way) / (length(before) * length(way))
        };
        let inner = self
            .around(closed)
            .filter(|&node| self.is_closed(node) && ahead(node) > AHEAD)
            .max_by(|&a, &b| ahead(a).total_cmp(&ahead(b)));
        let share = match inner {
            Some(inner) => {
                let (last, before) = (self.pressure(closed).powi(2), self.pressure(inner).powi(2));
                let reach = last / (before - last) * distance(from, self.place(inner)) / length(way);
                // Pressures that rise towards the edge give no estimate of the edge.
                if before > last { reach.min(1.0) } else { 0.5 }
            }
            None => 0.5,
        };
        [0, 1, 2].map(|axis| from[axis] + share * way[axis])
    }
}

/// The length of a line of two points, the area of a polygon; zero of a point.
fn extent(outline: &[[f64; 3]]) -> f64 {
    match outline {
        [] | [_] => 0.0,
        [a, b] => distance(*a, *b),
        [first, rest @ ..] => {
            let turned = rest.windows(2).map(|pair| cross(minus(pair[0], *first), minus(pair[1], *first)));
            0.5 * length(turned.fold([0.0; 3], |sum, part| [0, 1, 2].map(|axis| sum[axis] + part[axis])))
        }
    }
}
