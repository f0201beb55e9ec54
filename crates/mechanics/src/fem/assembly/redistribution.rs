//! Moves the mass of contact nodes to their neighbours and applies the smallest linear correction of the density that
//! preserves mass and centre of mass.

use crate::error::Error;
use crate::fem::body::{ElasticBody, Region};
use crate::fem::dense::DenseMatrix;

/// Largest allowed change of the mass and of the centre of mass, relative to the mass and the size of the body.
const MASS_TOLERANCE: f64 = 1e-10;

/// A factor on the density of an element below this is not a small correction: the mesh is too coarse.
const LEAST_FACTOR: f64 = 0.1;

/// The mass of one element: each column has the masses that a node shares with all nodes.
pub(super) type ElementMass = DenseMatrix;

/// The nodes that take over the mass of each contact node, and the factor on the density of each element.
pub(super) struct Redistribution {
    /// Nodes with their shares, which add up to one; empty for a node that keeps its mass.
    heirs: Vec<Vec<(usize, f64)>>,
    factors: Vec<f64>,
}

impl Redistribution {
    /// Redistributes the given masses of all elements so that the nodes `massless` have none.
    pub fn of(body: &ElasticBody, elements: &[ElementMass], massless: &[usize]) -> Result<Self, Error> {
        let mut heirs = heirs(body, elements, massless)?;
        heirs.resize(body.mesh().nodes().len(), Vec::new());
        let mut redistribution = Redistribution { heirs, factors: vec![1.0; elements.len()] };
        for region in body.regions() {
            if massless.iter().any(|node| region.nodes().contains(node)) {
                redistribution.tilt(body, elements, region)?;
            }
        }
        Ok(redistribution)
    }

    /// The entries of the redistributed mass, for every pair of nodes.
    pub fn triplets(&self, body: &ElasticBody, elements: &[ElementMass]) -> Vec<(usize, usize, f64)> {
        let mut triplets = Vec::new();
        for ((nodes, element), factor) in body.mesh().elements().zip(elements).zip(&self.factors) {
            for (&a, row) in nodes.iter().zip(element.columns()) {
                for (&b, &mass) in nodes.iter().zip(row) {
                    match self.loser(a, b) {
                        None => triplets.push((a, b, factor * mass)),
                        Some(node) => {
                            let inherit = |&(heir, share): &(usize, f64)| (heir, heir, factor * mass * share);
                            triplets.extend(self.heirs[node].iter().map(inherit));
                        }
                    }
                }
            }
        }
        triplets
    }

    /// The node that loses the mass between two nodes, if one does.
    fn loser(&self, a: usize, b: usize) -> Option<usize> {
        [a, b].into_iter().find(|&node| !self.heirs[node].is_empty())
    }

    /// Computes the density factors `1 + c_0 + c . (x - centre)` that restore mass and centre of mass of a body.
    fn tilt(&mut self, body: &ElasticBody, elements: &[ElementMass], region: &Region) -> Result<(), Error> {
        let (nodes, dimension) = (body.mesh().nodes(), body.dimension());
        let (low, high) = crate::fem::mesh::extent(&nodes[region.nodes()]);
        let size = (0..3).fold(0.0, |size: f64, axis| size.max(high[axis] - low[axis]));
        // Coordinates relative to the centre of the body, divided by its size, with a leading one.
        let place = |at: [f64; 3]| {
            let mut place = [1.0; 4];
            (0..3).for_each(|axis| place[axis + 1] = (at[axis] - (low[axis] + high[axis]) / 2.0) / size);
            place
        };
        let at_node = |node: usize| match self.heirs[node].as_slice() {
            [] => place(nodes[node]),
            heirs => heirs.iter().fold([0.0; 4], |sum, &(heir, share)| {
                let at = place(nodes[heir]);
                [0, 1, 2, 3].map(|axis| sum[axis] + share * at[axis])
            }),
        };
        let count = dimension + 1;
        let (mut matrix, mut missing) = (DenseMatrix::zeros(count, count), vec![0.0; count]);
        let mut middles = Vec::with_capacity(region.elements().len());
        let mut total = 0.0;
        for element in region.elements() {
            let of_element = body.mesh().element(element);
            let (mut moment, mut redistributed) = ([0.0; 4], [0.0; 4]);
            for (&a, row) in of_element.iter().zip(elements[element].columns()) {
                for (&b, &mass) in of_element.iter().zip(row) {
                    let (was, is) = (place(nodes[a]), at_node(self.loser(a, b).unwrap_or(a)));
                    for axis in 0..4 {
                        moment[axis] += mass * was[axis];
                        redistributed[axis] += mass * is[axis];
                    }
                }
            }
            let middle = moment.map(|value| value / moment[0]);
            for i in 0..count {
                missing[i] += moment[i] - redistributed[i];
                (0..count).for_each(|j| matrix[(i, j)] += redistributed[i] * middle[j]);
            }
            total += moment[0];
            middles.push(middle);
        }
        let too_coarse = || Error::Mesh {
            message: "it is too coarse for a redistributed mass: mass and centre of mass can only be kept with more \
                      nodes behind the contact nodes; take smaller cells, or a consistent or lumped mass"
                .into(),
        };
        let correction = matrix.clone().singular_values().solve(&missing, 1e-12);
        let off = matrix.mul(&correction).into_iter().zip(missing).map(|(kept, missing)| (kept - missing).abs());
        if off.fold(0.0, f64::max) > MASS_TOLERANCE * total {
            return Err(too_coarse());
        }
        for (element, middle) in region.elements().zip(middles) {
            let factor = 1.0 + (0..count).map(|i| correction[i] * middle[i]).sum::<f64>();
            if factor.is_nan() || factor < LEAST_FACTOR {
                return Err(too_coarse());
            }
            self.factors[element] = factor;
        }
        Ok(())
    }
}

/// The nodes that take over the mass of each massless node: its neighbours, weighted by the mass that they share with
/// it, ring by ring if the neighbours are massless too.
fn heirs(body: &ElasticBody, elements: &[ElementMass], massless: &[usize]) -> Result<Vec<Vec<(usize, f64)>>, Error> {
    let count = body.mesh().nodes().len();
    let mut waiting: Vec<bool> = vec![false; count];
    massless.iter().filter(|&&node| node < count).for_each(|&node| waiting[node] = true);
    let mut shared: Vec<Vec<(usize, f64)>> = vec![Vec::new(); count];
    for (nodes, element) in body.mesh().elements().zip(elements) {
        for (&a, row) in nodes.iter().zip(element.columns()).filter(|(a, _)| waiting[**a]) {
            shared[a].extend(nodes.iter().zip(row).filter(|(b, _)| **b != a).map(|(&b, mass)| (b, mass.abs())));
        }
    }
    let mut heirs: Vec<Vec<(usize, f64)>> = vec![Vec::new(); count];
    let mut left: Vec<usize> = (0..count).filter(|&node| waiting[node]).collect();
    while !left.is_empty() {
        let ring: Vec<usize> =
            left.iter().copied().filter(|&node| shared[node].iter().any(|&(other, _)| !waiting[other])).collect();
        if ring.is_empty() {
            let message = "every node of a body is a contact node, so that no other node can carry its mass; take \
                           smaller cells, or a consistent or lumped mass";
            return Err(Error::Mesh { message: message.into() });
        }
        for &node in &ring {
            let known = || shared[node].iter().filter(|(other, _)| !waiting[*other]);
            let total: f64 = known().map(|(_, mass)| mass).sum();
            let mut inherit: Vec<(usize, f64)> = Vec::new();
            for &(other, mass) in known() {
                match heirs[other].as_slice() {
                    [] => inherit.push((other, mass / total)),
                    further => inherit.extend(further.iter().map(|&(heir, share)| (heir, share * mass / total))),
                }
            }
            heirs[node] = inherit;
        }
        ring.iter().for_each(|&node| waiting[node] = false);
        left.retain(|&node| waiting[node]);
    }
    Ok(heirs)
}
