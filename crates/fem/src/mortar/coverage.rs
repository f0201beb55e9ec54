//! The covered part of a surface, facet by facet, the functions of the multipliers on it, and what facets of both
//! share.

use super::facet::PlacedFacet;
use crate::dense::DenseMatrix;
use crate::element::PerNode;
use crate::geometry::sorted;

/// A node with less than this share of its area covered carries no row.
const LEAST_COVERED: f64 = 0.1;

/// A facet covered by less than this share of its area counts as not covered.
const NO_COVER: f64 = 1e-10;

/// A facet that misses less than this share of its area is covered: the rest is rounding of polygons.
const WHOLE: f64 = 1e-6;

/// A facet whose covered area exceeds its area by more than this share lies behind several layers of the other surface;
/// curved facets exceed it by rounding of the curve, two layers by a half at least.
const TWICE: f64 = 0.1;

/// The integrals over the covered part of one slave facet.
pub(super) struct Covered<'a> {
    pub facet: &'a PlacedFacet<'a>,
    /// Its covered area, its whole area, and the area of all that it faces.
    pub area: f64,
    pub whole: f64,
    pub facing: f64,
    /// Integrals of the functions of its nodes over the covered part, and over all of it.
    functions: [f64; MOST],
    full: [f64; MOST],
    /// Integrals of their products.
    products: [[f64; MOST]; MOST],
    /// For each node of the other surface: the integrals of the products of its function with theirs.
    with_master: Vec<(usize, [f64; MOST])>,
}

impl<'a> Covered<'a> {
    pub fn new(facet: &'a PlacedFacet<'a>) -> Self {
        Covered {
            facet,
            area: 0.0,
            whole: 0.0,
            facing: 0.0,
            functions: [0.0; MOST],
            full: [0.0; MOST],
            products: [[0.0; MOST]; MOST],
            with_master: Vec::new(),
        }
    }

    /// Adds a point of the whole facet, with the values of its functions there.
    pub fn add_whole(&mut self, shape: &PerNode<f64>, area: f64) {
        self.whole += area;
        self.full.iter_mut().zip(shape).for_each(|(sum, value)| *sum += area * value);
    }

    /// Adds what it shares with the facets of the other surface, of which only the nearest count where the surface has
    /// a step.
    pub fn add(&mut self, mut shared: Vec<Shared>) {
        self.facing = shared.iter().map(|one| one.area).sum();
        keep_nearest(&mut shared, self.facet.radius);
        for one in shared {
            self.area += one.area;
            self.functions.iter_mut().zip(one.functions).for_each(|(sum, part)| *sum += part);
            let products = self.products.iter_mut().flatten().zip(one.products.iter().flatten());
            products.for_each(|(sum, part)| *sum += part);
            for (&node, sums) in one.other.nodes.iter().zip(&one.with) {
                match self.with_master.iter_mut().find(|entry| entry.0 == node) {
                    Some(entry) => entry.1.iter_mut().zip(sums).for_each(|(sum, part)| *sum += part),
                    None => self.with_master.push((node, *sums)),
                }
            }
        }
    }

    /// Returns `true` if several layers of the other surface face it.
    pub fn has_layers(&self) -> bool {
        self.facing > (1.0 + TWICE) * self.whole
    }

    /// Its nodes in ascending order, and the covered share of its area: facets on a curve exceed it by rounding of the
    /// curve.
    pub fn share(&self) -> (Vec<usize>, f64) {
        let (nodes, share) = (sorted(self.facet.nodes.iter().copied()), self.area / self.whole);
        (nodes, if share > 1.0 - WHOLE { 1.0 } else { share })
    }

    pub fn is_covered(&self) -> bool {
        self.area > NO_COVER * self.whole
    }

    /// The weights of the dual functions of the kept nodes: `psi_j = sum_k A_jk phi_k`. A node that is dropped hands
    /// its function over to the kept nodes of the facet, in equal parts.
    ///
    /// Without dropped nodes `integral psi_j phi_k = delta_jk integral phi_j`, and `sum_j psi_j = 1` always.
    fn dual(&self, is_kept: &[bool]) -> DenseMatrix {
        let count = is_kept.len();
        let kept: Vec<usize> = (0..count).filter(|&j| is_kept[j]).collect();
        let mut weights = DenseMatrix::zeros(count, count);
        if let [only] = kept[..] {
            (0..count).for_each(|k| weights[(only, k)] = 1.0);
            return weights;
        }
        let products = DenseMatrix::from_fn(count, count, |j, k| self.products[j][k]);
        let scaled = DenseMatrix::from_fn(count, count, |j, k| if j == k { self.functions[j] } else { 0.0 });
        // Products are symmetric: the transposed weights solve products * weights' = diagonal of the integrals.
        let Some(transposed) = products.solve(scaled) else { return weights };
        for k in 0..count {
            let dropped: f64 = (0..count).filter(|&d| !is_kept[d]).map(|d| transposed[(k, d)]).sum();
            kept.iter().for_each(|&j| weights[(j, k)] = transposed[(k, j)] + dropped / kept.len() as f64);
        }
        weights
    }
}

/// The parts of the rows of all kept nodes of a surface, by node.
#[derive(Clone, Debug, Default)]
pub(super) struct RowPart {
    /// The covered area of the node, with what dropped nodes hand over; its whole area.
    pub area: f64,
    pub full: f64,
    /// The integral of its dual function with the function of a slave node, and with that of a master node.
    pub slave: Vec<(usize, f64)>,
    pub master: Vec<(usize, f64)>,
}

fn add(list: &mut Vec<(usize, f64)>, node: usize, value: f64) {
    match list.iter_mut().find(|entry| entry.0 == node) {
        Some(entry) => entry.1 += value,
        None => list.push((node, value)),
    }
}

/// The nodes that carry rows, from all facets of the surface: of those that `may_carry` one, the nodes of which enough
/// is covered, and the best covered node of each covered facet that would have none.
pub(super) fn kept(covered: &[Covered], nodes: usize, may_carry: &dyn Fn(usize) -> bool) -> Vec<bool> {
    let (mut area, mut full, mut around) = (vec![0.0; nodes], vec![0.0; nodes], vec![0.0; nodes]);
    for facet in covered {
        for (local, &node) in facet.facet.nodes.iter().enumerate() {
            area[node] += facet.functions[local];
            full[node] += facet.full[local];
            around[node] += facet.whole;
        }
    }
    // The end of a quadratic edge on an axis of revolution has no area among the facets around it.
    let share = |node: usize| if full[node] > NO_COVER * around[node] { area[node] / full[node] } else { 0.0 };
    let mut kept: Vec<bool> = (0..nodes).map(|node| may_carry(node) && share(node) > LEAST_COVERED).collect();
    for facet in covered.iter().filter(|facet| facet.is_covered()) {
        let nodes = facet.facet.nodes;
        if nodes.iter().any(|&node| kept[node]) {
            continue;
        }
        let best = nodes.iter().filter(|&&node| may_carry(node)).max_by(|&&a, &&b| share(a).total_cmp(&share(b)));
        if let Some(&best) = best.filter(|&&node| share(node) > 0.0) {
            kept[best] = true;
        }
    }
    kept
}

/// The parts of the rows, by node; `None` for nodes that carry none.
pub(super) fn parts(covered: &[Covered], kept: &[bool]) -> Vec<Option<RowPart>> {
    let mut parts: Vec<Option<RowPart>> = vec![None; kept.len()];
    for facet in covered.iter().filter(|facet| facet.is_covered()) {
        let nodes = facet.facet.nodes;
        let is_kept: Vec<bool> = nodes.iter().map(|&node| kept[node]).collect();
        let count = is_kept.iter().filter(|&&is_kept| is_kept).count();
        if count == 0 {
            continue;
        }
        let weights = facet.dual(&is_kept);
        for j in (0..nodes.len()).filter(|&j| is_kept[j]) {
            let part = parts[nodes[j]].get_or_insert_default();
            for (k, &node) in nodes.iter().enumerate() {
                // The dual functions see the own node, and what dropped nodes hand over.
                let own = match (k == j, is_kept[k]) {
                    (true, _) => facet.functions[k],
                    (false, true) => continue,
                    (false, false) => facet.functions[k] / count as f64,
                };
                part.area += own;
                add(&mut part.slave, node, own);
            }
            for (node, with) in &facet.with_master {
                let sum = (0..nodes.len()).map(|k| weights[(j, k)] * with[k]).sum();
                add(&mut part.master, *node, sum);
            }
        }
    }
    for facet in covered {
        for (local, &node) in facet.facet.nodes.iter().enumerate() {
            parts[node].iter_mut().for_each(|part| part.full += facet.full[local]);
        }
    }
    parts
}

/// Most nodes of a facet.
pub(super) const MOST: usize = 8;

/// Parts of the other surface that do not join before a facet lie at other distances if these differ by more than this
/// share of its size.
const STEP: f64 = 0.1;

/// The integrals over what a slave facet shares with one facet of the other surface.
pub(super) struct Shared<'a> {
    pub other: &'a PlacedFacet<'a>,
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
    pub fn new(other: &'a PlacedFacet<'a>) -> Self {
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
