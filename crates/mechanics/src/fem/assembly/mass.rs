//! M = integral of rho N_a N_b, in the free dofs: consistent, lumped, or redistributed so that contact nodes have no
//! mass.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::DofMap;
use super::redistribution::{ElementMass, Redistribution};
use crate::error::Error;
use crate::fem::body::{BodyElement, ElasticBody};
use crate::fem::geometry::dot;
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
    pub(crate) fn word(self) -> &'static str {
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
pub(crate) fn nodal_mass(body: &ElasticBody, form: MassForm, contact_nodes: &[usize]) -> Result<SparseMatrix, Error> {
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
pub(crate) fn least_over_lumped(body: &ElasticBody, form: MassForm) -> Result<f64, Error> {
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

/// The mass of the free dofs from that of the nodes, as [`nodal_mass`].
pub(crate) fn free_mass(body: &ElasticBody, dofs: &DofMap, nodal: &SparseMatrix) -> Result<SymmetricMatrix, Error> {
    body.check_nodal("dof map", dofs.nodal_count())?;
    let dimension = body.dimension();
    let nodal = match dofs.basis.is_nodal() {
        true => nodal.clone(),
        false => {
            let values =
                (0..nodal.columns()).flat_map(|node| dofs.basis.values(node).map(move |(of, share)| (of, node, share)));
            let values = SparseMatrix::from_triplets(nodal.rows(), nodal.columns(), &values.collect::<Vec<_>>())?;
            SymmetricMatrix::from_lower(nodal.clone())?.congruent(&values)?.lower().clone()
        }
    };
    let mut entries = Vec::with_capacity(dimension * nodal.entries());
    for (row, column, value) in nodal.triplets() {
        let [of_row, of_column] = [row, column].map(|node| dofs.axes(node));
        for (i, own) in of_row.iter().enumerate().take(dimension) {
            let Some(first) = dofs.number(dimension * row + i) else { continue };
            for (j, other) in of_column.iter().enumerate().take(dimension) {
                let cosine = if row == column { f64::from(i == j) } else { dot(*own, *other) };
                if let Some(second) = dofs.number(dimension * column + j).filter(|_| cosine != 0.0) {
                    entries.push((first, second, value * cosine));
                }
            }
        }
    }
    let free = dofs.free().len();
    Ok(SymmetricMatrix::from_lower(SparseMatrix::from_triplets(free, free, &entries)?)?)
}
