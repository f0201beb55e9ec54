//! M = integral of rho N_a N_b, in the free dofs: consistent, lumped, or redistributed so that contact nodes have no
//! mass.

use super::dofs::NO_COMPONENT;
use super::{DofMap, element_stiffness};
use crate::body::{BodyElement, ElasticBody, Region};
use crate::dense::DenseMatrix;
use crate::error::Error;
use crate::geometry::{dot, length};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use signorini_linear::{SparseMatrix, SymmetricMatrix};

/// The form of a mass matrix: it decides on the waves in the mesh, and on the inertia of nodes in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "MassSpec")]
#[schemars(description = "The forms of the mass to choose from.")]
#[serde(rename_all = "kebab-case")]
pub enum MassForm {
    /// Consistent: from the shape functions.
    #[default]
    #[schemars(description = "From the shape functions.")]
    Consistent,
    /// Diagonal: the sum of each row. On quadratic elements this sum is zero or negative at corners; they take the
    /// diagonal of the consistent mass, scaled to the mass of the element.
    #[schemars(description = "Diagonal.")]
    Lumped,
    /// The mean of the consistent and the lumped mass: along a uniform mesh of linear elements waves are then of fourth
    /// order.
    #[schemars(description = "The mean of the consistent and the lumped mass.")]
    Averaged,
    /// Consistent, except for the contact nodes: they have no mass, and their neighbours take it over. Total mass and
    /// centre of mass of each body are preserved.
    ///
    /// A contact node without inertia does not bounce: it follows the body and the obstacle, so that the contact
    /// pressure is that of the body and not a sequence of impacts.
    #[schemars(description = "From the shape functions, without mass at contact nodes; total \
        mass and centre of mass are preserved.")]
    Redistributed,
}

impl MassForm {
    /// Its word in a scene.
    #[doc(hidden)]
    pub fn word(self) -> &'static str {
        match self {
            MassForm::Consistent => "consistent",
            MassForm::Lumped => "lumped",
            MassForm::Averaged => "averaged",
            MassForm::Redistributed => "redistributed",
        }
    }
}

/// The mass matrix of the free dofs (n x n), in mass, from the densities of the materials; `contact_nodes`, node
/// indices from 0 in any order, lose their mass if it is redistributed.
///
/// The quadrature has five points in each direction: exact on straight elements of both orders, also in bodies of
/// revolution.
///
/// # Errors
/// [`linear::Error::Setting`](signorini_linear::Error::Setting) for a material without density,
/// [`linear::Error::Length`](signorini_linear::Error::Length) if `dofs` does not belong to the mesh, [`Error::Mesh`]
/// for a mesh too coarse to redistribute its mass, [`linear::Error::NotFinite`](signorini_linear::Error::NotFinite) if
/// the mass overflows.
///
/// # Source
/// H. B. Khenous, P. Laborde, Y. Renard, *Mass redistribution method for finite element contact problems in
/// elastodynamics*, Eur. J. Mech. A 27 (2008) 918-932: the mass matrix without mass at contact nodes that preserves
/// mass and centre of mass.
pub fn mass(
    body: &ElasticBody,
    dofs: &DofMap,
    form: MassForm,
    contact_nodes: &[usize],
) -> Result<SymmetricMatrix, Error> {
    free_mass(body, dofs, &nodal_mass(body, form, contact_nodes)?)
}

/// The mass of the nodes (`n_nodes x n_nodes`, the lower triangle), the same for each axis; `contact_nodes` lose their
/// mass if it is redistributed.
pub fn nodal_mass(body: &ElasticBody, form: MassForm, contact_nodes: &[usize]) -> Result<SparseMatrix, Error> {
    let elements = element_masses(body)?;
    let mut nodal = match form {
        MassForm::Redistributed => Redistribution::of(body, &elements, contact_nodes)?.triplets(body, &elements),
        MassForm::Consistent | MassForm::Lumped | MassForm::Averaged => {
            let of_lumped = match form {
                MassForm::Lumped => 1.0,
                MassForm::Averaged => 0.5,
                _ => 0.0,
            };
            let mut triplets = Vec::new();
            for (nodes, element) in body.mesh().elements().zip(&elements) {
                if of_lumped > 0.0 {
                    triplets.extend(nodes.iter().zip(lumped(element)).map(|(&a, mass)| (a, a, of_lumped * mass)));
                }
                if of_lumped < 1.0 {
                    let share = 1.0 - of_lumped;
                    for (&row, of_row) in nodes.iter().zip(element.columns()) {
                        triplets.extend(nodes.iter().zip(of_row).map(|(&column, &mass)| (row, column, share * mass)));
                    }
                }
            }
            triplets
        }
    };
    nodal.retain(|&(row, column, _)| row >= column);
    let nodes = body.mesh().nodes().len();
    Ok(SparseMatrix::from_triplets(nodes, nodes, &nodal)?)
}

/// A bound from below on `v'M v` over that of the lumped mass, for every velocity v; zero or positive, dimensionless.
/// It is sharp for bars.
pub fn least_over_lumped(body: &ElasticBody, form: MassForm) -> Result<f64, Error> {
    let of_consistent = || -> Result<f64, Error> {
        let of_element = |element: &ElementMass| {
            let lumped = lumped(element);
            // The norm of 1 - M_l^-1 M_c bounds its largest eigenvalue.
            let off = |(column, of_column): (usize, &[f64])| {
                let apart =
                    |(row, mass): (usize, &f64)| (f64::from(u8::from(row == column)) - mass / lumped[column]).abs();
                of_column.iter().enumerate().map(apart).sum::<f64>()
            };
            1.0 - element.columns().enumerate().map(|(column, of_column)| off((column, of_column))).fold(0.0, f64::max)
        };
        Ok(element_masses(body)?.iter().map(of_element).fold(1.0, f64::min).max(0.0))
    };
    Ok(match form {
        MassForm::Lumped => 1.0,
        MassForm::Averaged => 0.5 + of_consistent()? / 2.0,
        MassForm::Consistent => of_consistent()?,
        MassForm::Redistributed => 0.0,
    })
}

/// The consistent mass of every element, in the order of the elements.
fn element_masses(body: &ElasticBody) -> Result<Vec<ElementMass>, Error> {
    let tables = body.finely_tabulated();
    let of_element = |(BodyElement { nodes, kind, cell, .. }, density): (BodyElement<'_>, f64)| {
        let mut mass = ElementMass::zeros(nodes.len(), nodes.len());
        let scale = density * cell.unit().powi(body.dimension() as i32);
        for at in &tables.at(kind).points {
            let weight = body.point(&cell, at).weight * scale;
            for (column, share) in mass.columns_mut().zip(at.shape) {
                column.iter_mut().zip(at.shape).for_each(|(mass, other)| *mass += weight * share * other);
            }
        }
        mass
    };
    Ok(body.elements().zip(body.densities()?).map(of_element).collect())
}

/// The lumped mass of an element, node by node.
fn lumped(element: &ElementMass) -> Vec<f64> {
    let sums: Vec<f64> = element.columns().map(|column| column.iter().sum()).collect();
    let own: Vec<f64> = (0..sums.len()).map(|node| element[(node, node)]).collect();
    let is_small = |&sum: &f64| sum <= 1e-12 * own[0].abs();
    let [total, trace] = [&sums, &own].map(|masses| masses.iter().sum::<f64>());
    let scaled = own.iter().map(|mass| mass * total / trace);
    if sums.iter().any(is_small) { scaled.collect() } else { sums }
}

/// The mass of the unknowns from that of the nodes, as [`nodal_mass`].
pub fn free_mass(body: &ElasticBody, dofs: &DofMap, nodal: &SparseMatrix) -> Result<SymmetricMatrix, Error> {
    body.check_nodal("dof map", dofs.nodal_count())?;
    let dimension = body.dimension();
    let moved_by: Vec<_> = (0..nodal.columns()).map(|node| dofs.displaced_by(node, dimension)).collect();
    let mut entries = Vec::with_capacity(dimension * nodal.entries());
    for (row, column, value) in nodal.triplets() {
        for &(p, by_p) in &moved_by[row] {
            for &(q, by_q) in &moved_by[column] {
                let product = dot(by_p, by_q);
                let is_rounding = || product.abs() <= NO_COMPONENT * length(by_p) * length(by_q);
                if product == 0.0 || row == column && p < q || is_rounding() {
                    continue;
                }
                // Entries off the diagonal have a mirror image.
                let times = if row != column && p == q { 2.0 } else { 1.0 };
                entries.push((p.max(q), p.min(q), times * value * product));
            }
        }
    }
    Ok(SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs.count(), dofs.count(), &entries)?)?)
}

// Moves the mass of contact nodes to their neighbours and applies the smallest linear correction of the density that
// preserves mass and centre of mass.

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
        let (low, high) = crate::mesh::extent(&nodes[region.nodes()]);
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

/// Marks a node that is not among the requested ones.
const OTHER: usize = usize::MAX;

/// The columns of the stiffness at `nodes`, in force per length: `nodal dofs x (dim * nodes.len())`, free and supported
/// dofs, along the coordinate axes. Only elements around these nodes are computed.
pub fn stiffness_columns(body: &ElasticBody, nodes: &[usize]) -> Result<SparseMatrix, Error> {
    let dimension = body.dimension();
    let place = places(body, nodes);
    let tables = body.tabulated();
    let mut entries = Vec::new();
    for placed in body.elements() {
        let around = placed.nodes;
        if around.iter().all(|&node| place[node] == OTHER) {
            continue;
        }
        let element = element_stiffness(body, &placed, tables.at(placed.kind));
        for (b, &column) in around.iter().enumerate().filter(|(_, column)| place[**column] != OTHER) {
            for (a, &row) in around.iter().enumerate() {
                let block = element.block(a.max(b), a.min(b));
                for (of_later, values) in block.iter().enumerate().take(dimension) {
                    for (of_earlier, &value) in values.iter().enumerate().take(dimension) {
                        let (i, j) = if a >= b { (of_later, of_earlier) } else { (of_earlier, of_later) };
                        entries.push((dimension * row + i, dimension * place[column] + j, value));
                    }
                }
            }
        }
    }
    Ok(SparseMatrix::from_triplets(body.nodal_dofs(), dimension * nodes.len(), &entries)?)
}

/// The columns at `nodes` of a nodal mass, given by its lower triangle (`n_nodes x n_nodes`): `n_nodes x nodes.len()`,
/// the same for each axis.
pub fn mass_columns(body: &ElasticBody, nodes: &[usize], mass: &SparseMatrix) -> Result<SparseMatrix, Error> {
    let place = places(body, nodes);
    let mut entries = Vec::new();
    for (row, column, value) in mass.triplets() {
        if place[column] != OTHER {
            entries.push((row, place[column], value));
        }
        if row != column && place[row] != OTHER {
            entries.push((column, place[row], value));
        }
    }
    Ok(SparseMatrix::from_triplets(body.mesh().nodes().len(), nodes.len(), &entries)?)
}

/// The place of each node of the body among `nodes`, or [`OTHER`].
fn places(body: &ElasticBody, nodes: &[usize]) -> Vec<usize> {
    let mut place = vec![OTHER; body.mesh().nodes().len()];
    nodes.iter().enumerate().for_each(|(index, &node)| place[node] = index);
    place
}
