//! What a slave facet shares with the facets of the other surface that it faces, and which of these it can touch.

use super::facet::Facet;
use crate::fem::element::PerNode;

/// Most nodes of a facet.
pub(super) const MOST: usize = 8;

/// Parts of the other surface that do not join before a facet lie at other distances if these differ by more than this
/// share of its size.
const STEP: f64 = 0.1;

/// The integrals over what a slave facet shares with one facet of the other surface.
pub(super) struct Shared<'a> {
    pub other: &'a Facet<'a>,
    pub area: f64,
    /// Of the distance, along the direction of the slave facet.
    gap: f64,
    /// Of the places on the slave facet and on the other.
    places: [[f64; 3]; 2],
    /// Of the functions of the nodes of the slave facet, of their products, and of those with the functions of the
    /// other facet.
    pub functions: [f64; MOST],
    pub products: [[f64; MOST]; MOST],
    pub with: [[f64; MOST]; MOST],
}

impl<'a> Shared<'a> {
    pub fn new(other: &'a Facet<'a>) -> Self {
        let products = [[0.0; MOST]; MOST];
        Shared { other, area: 0.0, gap: 0.0, places: [[0.0; 3]; 2], functions: [0.0; MOST], products, with: products }
    }

    /// Adds the area around two opposite places, of the slave facet and of the other.
    pub fn add_places(&mut self, area: f64, places: [[f64; 3]; 2]) {
        let sums = self.places.iter_mut().flatten().zip(places.iter().flatten());
        sums.for_each(|(sum, part)| *sum += area * part);
    }

    /// The middles of the shared part on both facets.
    pub fn middles(&self) -> [[f64; 3]; 2] {
        self.places.map(|sums| sums.map(|sum| sum / self.area))
    }

    /// Adds a point with the values of the functions of both facets, and their distance there.
    pub fn add(&mut self, count: usize, area: f64, gap: f64, [shape, other]: [&PerNode<f64>; 2]) {
        self.area += area;
        self.gap += area * gap;
        for j in 0..count {
            let part = area * shape[j];
            self.functions[j] += part;
            (0..count).for_each(|k| self.products[j][k] += part * shape[k]);
            (0..self.other.nodes.len()).for_each(|l| self.with[l][j] += part * other[l]);
        }
    }
}

/// Leaves the nearest part of the other surface. Behind a step other parts begin, which share no node with it before
/// the facet: a mean over both would be the distance of neither.
pub(super) fn keep_nearest(all: &mut Vec<Shared>, size: f64) {
    let part_of = joined(all);
    let distance = |part: usize| {
        let own = || all.iter().zip(&part_of).filter(move |(_, of)| **of == part).map(|(one, _)| one);
        own().map(|one| one.gap).sum::<f64>() / own().map(|one| one.area).sum::<f64>()
    };
    let distances: Vec<f64> = part_of.iter().map(|&part| distance(part)).collect();
    let Some(nearest) = distances.iter().copied().min_by(|a, b| a.abs().total_cmp(&b.abs())) else { return };
    let mut kept = distances.iter().map(|distance| (distance - nearest).abs() <= STEP * size);
    all.retain(|_| kept.next().unwrap_or(true));
}

/// The number of the part of each facet: facets that share a node are of one part.
fn joined(all: &[Shared]) -> Vec<usize> {
    let mut part_of: Vec<usize> = (0..all.len()).collect();
    for one in 0..all.len() {
        for other in 0..one {
            let [from, to] = [part_of[one], part_of[other]];
            if from != to && all[one].other.nodes.iter().any(|node| all[other].other.nodes.contains(node)) {
                part_of.iter_mut().filter(|part| **part == from).for_each(|part| *part = to);
            }
        }
    }
    part_of
}
