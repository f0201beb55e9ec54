//! Surfaces that are tied: there two bodies become one.
//!
//! In the plane edges are cut at the nodes of the other surface first. Then nodes at the same place become one node,
//! and so do the edges or faces between them.

use std::collections::{BTreeMap, HashMap};

use super::fans::{Cut, CutEdge};
use super::problem::{Condition, ContinuumProblem};
use super::simplex::{Point, size_of_facet};
use signorini_fem::geometry::{distance, dot, minus, shifted, sorted, unit};

/// Points closer than this share of an edge are one: far above the rounding of coordinates.
const ONE_PLACE: f64 = 1e-9;

/// The nodes of each facet of a surface.
type Facets = Vec<Vec<usize>>;

impl Condition {
    /// Returns `true` if it holds, loads or bounds its facet.
    pub fn acts(&self) -> bool {
        let Condition { boundaries, seams, circle, .. } = self.clone();
        *self != Condition { boundaries, seams, circle, ..Condition::default() }
    }

    /// The condition of the facet that two facets become; `None` if one of them acts.
    fn joined(&self, other: &Condition) -> Option<Condition> {
        let boundaries = [&self.boundaries[..], &other.boundaries[..]].concat();
        (!self.acts() && !other.acts()).then(|| Condition { boundaries, ..Condition::default() })
    }
}

impl Cut {
    /// Makes the two surfaces of each seam one. Returns for each seam how much of its two surfaces is joined, from 0 to
    /// 1.
    ///
    /// # Errors
    /// The number of a seam with a support, a load or an obstacle on it.
    pub(super) fn at_seams(&mut self, problem: &mut ContinuumProblem) -> Result<Vec<[f64; 2]>, usize> {
        let count =
            problem.conditions.iter().flat_map(|condition| &condition.seams).max().map_or(0, |last| last / 2 + 1);
        let mut joined = Vec::with_capacity(count);
        for seam in 0..count {
            let [one, other] = [0, 1].map(|side| self.side(&problem.conditions, 2 * seam + side));
            let sizes = [&one, &other].map(|side| self.size_of(side, problem));
            let pairs = if problem.dimension == 2 {
                self.cut_at_each_other(&one, &other)
            } else {
                self.nodes_of_same(&one, &other)
            };
            let facets = self.join(&pairs, &mut problem.conditions).ok_or(seam)?;
            joined.push(sizes.map(|size| self.size_of(&facets, problem) / size));
        }
        Ok(joined)
    }

    /// The facets on a side of a seam, in increasing order.
    fn side(&self, conditions: &[Condition], side: usize) -> Facets {
        let is_there = |entry: &(&Vec<usize>, &usize)| conditions[*entry.1].seams.contains(&side);
        let mut facets: Facets = self.cells.surface.iter().filter(is_there).map(|(facet, _)| facet.clone()).collect();
        facets.sort_unstable();
        facets
    }

    /// The length or area of facets, about an axis over a full turn and its angle.
    fn size_of(&self, facets: &Facets, problem: &ContinuumProblem) -> f64 {
        let size = |facet: &Vec<usize>| {
            let corners: Vec<Point> = facet.iter().map(|&node| self.cells.nodes[node]).collect();
            let radii = corners.iter().map(|&corner| problem.radius(corner)).sum::<f64>();
            size_of_facet(&corners) * radii / corners.len() as f64
        };
        facets.iter().map(size).sum()
    }

    /// Where edges lie on each other, cuts their triangles at the nodes of both, and returns the nodes that are one.
    fn cut_at_each_other(&mut self, one: &Facets, other: &Facets) -> Vec<[usize; 2]> {
        let edge = |facet: &Vec<usize>, nodes: &[Point]| {
            let [from, to] = [facet[0], facet[1]];
            CutEdge { stops: vec![(0.0, from), (distance(nodes[from], nodes[to]), to)] }
        };
        let [mut one, mut other] =
            [one, other].map(|side| side.iter().map(|facet| edge(facet, &self.cells.nodes)).collect::<Vec<_>>());
        let mut pairs = Vec::new();
        for own in &mut one {
            let [from, to] = [own.stops[0].1, own.stops[own.stops.len() - 1].1].map(|node| self.cells.nodes[node]);
            let along = unit(minus(to, from));
            for facing in &mut other {
                let margin = ONE_PLACE * own.length().min(facing.length());
                let ends = facing.ends().map(|end| facing.at(&self.cells.nodes, end));
                let places = ends.map(|end| dot(along, minus(end, from)));
                let is_aside = |k: usize| {
                    let foot = shifted(from, places[k], along);
                    distance(foot, ends[k]) > margin
                };
                let [low, high] = [places[0].min(places[1]).max(0.0), places[0].max(places[1]).min(own.length())];
                if high - low <= margin || is_aside(0) || is_aside(1) {
                    continue;
                }
                for place in [low, high] {
                    let node = own.node_at(&mut self.cells.nodes, place, margin);
                    pairs.push([node, facing.node_at(&mut self.cells.nodes, (place - places[0]).abs(), margin)]);
                }
            }
        }
        one.iter().chain(&other).for_each(|edge| self.fan(edge));
        pairs
    }

    /// The nodes that are one where faces are the same.
    fn nodes_of_same(&self, one: &Facets, other: &Facets) -> Vec<[usize; 2]> {
        let at = |node: usize| self.cells.nodes[node];
        let sum = |face: &Vec<usize>| face.iter().map(|&node| at(node)[0]).sum::<f64>();
        let mut by_place: Vec<(f64, &Vec<usize>)> = other.iter().map(|face| (sum(face), face)).collect();
        by_place.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut pairs = Vec::new();
        for face in one {
            let margin = ONE_PLACE * distance(at(face[0]), at(face[1]));
            let (here, reach) = (sum(face), face.len() as f64 * margin);
            let first = by_place.partition_point(|entry| entry.0 < here - reach);
            for (_, facing) in by_place[first..].iter().take_while(|entry| entry.0 <= here + reach) {
                let twin = |&node: &usize| facing.iter().find(|&&other| distance(at(node), at(other)) <= margin);
                let twins: Option<Vec<[usize; 2]>> = face.iter().map(|node| Some([*node, *twin(node)?])).collect();
                pairs.extend(twins.into_iter().flatten());
            }
        }
        pairs
    }

    /// Makes nodes one, and returns the facets that two facets became; `None` if one of these acts.
    fn join(&mut self, pairs: &[[usize; 2]], conditions: &mut Vec<Condition>) -> Option<Facets> {
        let mut stands_for: Vec<usize> = (0..self.cells.nodes.len()).collect();
        let first = |stands_for: &[usize], mut node: usize| {
            while stands_for[node] != node {
                node = stands_for[node];
            }
            node
        };
        for &[one, other] in pairs {
            let [one, other] = [one, other].map(|node| first(&stands_for, node));
            stands_for[one.max(other)] = one.min(other);
        }
        // Numbers without those that are left out.
        let mut number = vec![0; stands_for.len()];
        let mut nodes = Vec::with_capacity(stands_for.len());
        for node in 0..stands_for.len() {
            let stays = first(&stands_for, node);
            if stays == node {
                number[node] = nodes.len();
                nodes.push(self.cells.nodes[node]);
            } else {
                number[node] = number[stays];
            }
        }
        self.cells.nodes = nodes;
        self.cells.cells.iter_mut().flatten().for_each(|node| *node = number[*node]);
        let mut found: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
        for (facet, condition) in &self.cells.surface {
            let facet = sorted(facet.iter().map(|&node| number[node]));
            found.entry(facet).or_default().push(*condition);
        }
        let (mut surface, mut joined) = (HashMap::new(), Vec::new());
        for (facet, of_sides) in found {
            let condition = match of_sides[..] {
                [condition] => condition,
                _ => {
                    joined.push(facet.clone());
                    let both = conditions[*of_sides.iter().min()?].joined(&conditions[*of_sides.iter().max()?])?;
                    conditions.iter().position(|known| *known == both).unwrap_or_else(|| {
                        conditions.push(both);
                        conditions.len() - 1
                    })
                }
            };
            surface.insert(facet, condition);
        }
        self.cells.surface = surface;
        Some(joined)
    }
}
