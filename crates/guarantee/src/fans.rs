//! Where bodies meet: in the plane, edges of one lie opposite to edges of the other, end by end.
//!
//! Meshes that do not match are cut at the nodes of the other body: a triangle with an edge on the contact becomes a
//! fan from its third corner. Then a pressure that is linear on the edges of one body is so on those of the other, and
//! both displacements are quadratic on the same edges.

use std::collections::HashMap;

use super::mesh::{Cells, EdgePair, SimplexMesh};
use super::problem::{Condition, ContinuumProblem, Surface};
use super::simplex::{Point, Simplex};
use signorini_fem::geometry::{distance, dot, key, minus, shifted};

/// Height over length of a triangle of a fan below which the triangle is refined before the cut, if its own is not
/// small too.
const SLENDER: f64 = 0.01;

/// The same over that of the triangle before the cut.
const MORE_SLENDER: f64 = 0.1;

/// Largest number of rounds of refinement before the cut.
const ROUNDS: usize = 12;

/// Lengths below this share of the shortest edge of the facets at a node are rounding of coordinates: seven digits, as
/// in single precision, leave 5e-7 of the size of the bodies, which is below this share of a facet if at most 2000
/// facets lie side by side. A place nearer to an edge of a facet than this share of the edge counts as on the edge.
pub const SAME_PLACE: f64 = 1e-3;

/// An edge on a contact, along a line across the direction of the rows, or an edge on a seam, along itself.
#[derive(Clone, Debug)]
pub(super) struct CutEdge {
    /// Its lower end, places at which it is cut, and its upper end: along the line, and the node.
    pub stops: Vec<(f64, usize)>,
}

impl CutEdge {
    pub fn ends(&self) -> [f64; 2] {
        [self.stops[0].0, self.stops[self.stops.len() - 1].0]
    }

    pub fn length(&self) -> f64 {
        let [low, high] = self.ends();
        high - low
    }

    /// The point of the edge at a place along the line.
    pub fn at(&self, nodes: &[Point], place: f64) -> Point {
        let [first, last] = [self.stops[0].1, self.stops[self.stops.len() - 1].1].map(|node| nodes[node]);
        let share = (place - self.ends()[0]) / self.length();
        shifted(first, share, minus(last, first))
    }

    /// The node at a place along the line; one within the margin, or a new one.
    pub fn node_at(&mut self, nodes: &mut Vec<Point>, place: f64, margin: f64) -> usize {
        if let Some(stop) = self.stops.iter().find(|stop| (stop.0 - place).abs() <= margin) {
            return stop.1;
        }
        let node = nodes.len();
        nodes.push(self.at(nodes, place));
        self.stops.push((place, node));
        self.stops.sort_by(|a, b| a.0.total_cmp(&b.0));
        node
    }
}

/// Simplices that are cut and joined where bodies meet.
pub(super) struct Cut {
    pub cells: Cells,
    /// The triangle before the cut of each one.
    parents: Vec<usize>,
    /// The triangles before the cut that are too large for it.
    too_large: Vec<usize>,
}

/// Why bodies cannot be joined where they meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unjoined {
    /// A body lies before another, or before two, in several layers at the obstacle of this number.
    Layers(usize),
    /// A support, a load or an obstacle acts on a surface of the seam of this number.
    Acting(usize),
    /// The simplices do not meet in whole facets afterwards.
    Unmatched,
}

impl SimplexMesh {
    /// The mesh whose bodies are one at seams, and which is cut at contacts of bodies in the plane: there edges lie
    /// opposite to each other. Triangles that are large beside their pieces are refined first. The second value says
    /// how much of the two surfaces of each seam is joined, from 0 to 1. Facets inside, at seams, get conditions of
    /// their own.
    pub fn joined(self, problem: &mut ContinuumProblem) -> Result<(Self, Vec<[f64; 2]>), Unjoined> {
        let has_contacts = problem.obstacles.iter().any(|facing| matches!(facing.surface, Surface::Body { .. }));
        let has_seams = problem.conditions.iter().any(|condition| !condition.seams.is_empty());
        if !has_contacts && !has_seams {
            return Ok((self, Vec::new()));
        }
        let (mut mesh, mut rounds) = (self, 0);
        loop {
            let cells = mesh.cells();
            let (parents, too_large) = ((0..cells.cells.len()).collect(), Vec::new());
            let mut cut = Cut { cells, parents, too_large };
            let joined = cut.at_seams(problem).map_err(Unjoined::Acting)?;
            let opposites = cut.at_contacts(problem).map_err(Unjoined::Layers)?;
            if cut.too_large.is_empty() || rounds == ROUNDS {
                let cut = SimplexMesh::new(mesh.dimension, cut.cells).ok_or(Unjoined::Unmatched)?;
                return Ok((cut.with_opposites(opposites), joined));
            }
            let mut marked = vec![false; mesh.count()];
            cut.too_large.iter().for_each(|&cell| marked[cell] = true);
            (mesh, rounds) = (problem.refined(&mesh, &marked), rounds + 1);
        }
    }
}

impl Cut {
    /// Cuts the triangles, and returns the edges that lie opposite to each other.
    ///
    /// # Errors
    /// The number of an obstacle if a body lies before another, or before two, in several layers.
    fn at_contacts(&mut self, problem: &ContinuumProblem) -> Result<Vec<EdgePair>, usize> {
        let mut opposites = Vec::new();
        for (obstacle, facing) in problem.obstacles.iter().enumerate() {
            let Surface::Body { reach, .. } = &facing.surface else { continue };
            let along = [-facing.normal[1], facing.normal[0], 0.0];
            let faces = |of: fn(&Condition) -> &[usize], towards: f64| {
                let has = |condition: usize| of(&problem.conditions[condition]).contains(&obstacle);
                self.edges(has, facing.normal.map(|part| towards * part), along)
            };
            let mut own = faces(|condition| &condition.obstacles, 1.0);
            let mut other = faces(|condition| &condition.faces, -1.0);
            let mut covered: [Vec<Vec<[f64; 2]>>; 2] = [&own, &other].map(|edges| vec![Vec::new(); edges.len()]);
            for (first, one) in own.iter_mut().enumerate() {
                for (second, two) in other.iter_mut().enumerate() {
                    let ([low, high], [from, to]) = (one.ends(), two.ends());
                    let (from, to, nodes) = (low.max(from), high.min(to), &self.cells.nodes);
                    let margin = SAME_PLACE * one.length().min(two.length());
                    let away = |place: f64| dot(facing.normal, minus(two.at(nodes, place), one.at(nodes, place))).abs();
                    if to - from <= margin || away(from).min(away(to)) > *reach {
                        continue;
                    }
                    let meets = |&[start, end]: &[f64; 2]| to.min(end) - from.max(start) > margin;
                    if covered[0][first].iter().chain(&covered[1][second]).any(meets) {
                        return Err(obstacle);
                    }
                    covered[0][first].push([from, to]);
                    covered[1][second].push([from, to]);
                    let mut ends =
                        |edge: &mut CutEdge| [from, to].map(|at| edge.node_at(&mut self.cells.nodes, at, margin));
                    opposites.push(EdgePair { obstacle, own: ends(one), other: ends(two) });
                }
            }
            own.iter().chain(&other).for_each(|edge| self.fan(edge));
        }
        let is_lost = |opposite: &&EdgePair| {
            opposite.edges().iter().any(|edge| !self.cells.surface.contains_key(edge.as_slice()))
        };
        if let Some(opposite) = opposites.iter().find(is_lost) {
            return Err(opposite.obstacle);
        }
        // The elements of the first mesh stay in their order.
        let Cells { cells, origins, .. } = &mut self.cells;
        let mut order: Vec<usize> = (0..cells.len()).collect();
        order.sort_by_key(|&cell| origins[cell]);
        *cells = order.iter().map(|&cell| cells[cell].clone()).collect();
        origins.sort_unstable();
        Ok(opposites)
    }

    /// The edges of chosen conditions whose outward normals have a part along a direction, in increasing order.
    fn edges(&self, has: impl Fn(usize) -> bool, towards: Point, along: Point) -> Vec<CutEdge> {
        let mut chosen: Vec<[usize; 2]> =
            self.cells.surface.iter().filter(|entry| has(*entry.1)).map(|(edge, _)| [edge[0], edge[1]]).collect();
        chosen.sort_unstable();
        let mut third = HashMap::new();
        for cell in &self.cells.cells {
            for corner in 0..3 {
                let [a, b] = [1, 2].map(|next| cell[(corner + next) % 3]);
                third.insert(key(a, b), cell[corner]);
            }
        }
        let edge = |ends: [usize; 2]| {
            let stops = ends.map(|node| (dot(along, self.cells.nodes[node]), node));
            let mut edge = CutEdge { stops: stops.to_vec() };
            edge.stops.sort_by(|a, b| a.0.total_cmp(&b.0));
            let tip = self.cells.nodes[*third.get(&key(ends[0], ends[1]))?];
            let is_parallel = edge.length() <= SAME_PLACE * dot(towards, minus(self.cells.nodes[ends[0]], tip)).abs();
            let below = dot(towards, minus(edge.at(&self.cells.nodes, dot(along, tip)), tip));
            (!is_parallel && below > 0.0).then_some(edge)
        };
        chosen.into_iter().filter_map(edge).collect()
    }

    /// Cuts the triangle at an edge in a fan.
    pub fn fan(&mut self, edge: &CutEdge) {
        let nodes: Vec<usize> = edge.stops.iter().map(|stop| stop.1).collect();
        let (Some(&first), Some(&last)) = (nodes.first(), nodes.last()) else { return };
        let is_at = |cell: &Vec<usize>| cell.contains(&first) && cell.contains(&last);
        let Cells { nodes: places, cells, origins, surface } = &mut self.cells;
        let Some(index) = cells.iter().position(is_at).filter(|_| nodes.len() > 2) else { return };
        let Some(&tip) = cells[index].iter().find(|&&node| node != first && node != last) else { return };
        let mut pieces = nodes.windows(2).map(|ends| [ends[0], ends[1]]);
        let condition = surface.remove(key(first, last).as_slice());
        surface.extend(
            condition.into_iter().flat_map(|of| pieces.clone().map(move |ends| (key(ends[0], ends[1]).to_vec(), of))),
        );
        let height = |[a, b]: [usize; 2]| {
            let corners = [a, b, tip].map(|node| places[node]);
            let size = |k: usize| distance(corners[k], corners[(k + 1) % 3]);
            2.0 * Simplex::new(2, corners).size() / (0..3).map(size).fold(0.0, f64::max).powi(2)
        };
        let least = f64::min(SLENDER, MORE_SLENDER * height([first, last]));
        if pieces.clone().any(|piece| height(piece) < least) {
            self.too_large.push(self.parents[index]);
        }
        if let Some([a, b]) = pieces.next() {
            cells[index] = vec![a, b, tip];
        }
        for [a, b] in pieces {
            cells.push(vec![a, b, tip]);
            origins.push(origins[index]);
            self.parents.push(self.parents[index]);
        }
    }
}
