//! Displacements of almost no energy, which a hierarchy must represent on every level.

use super::nodes::Nodes;
use crate::error::Error;
use crate::{SymmetricMatrix, check_finite, extend, largest};

/// A vector follows from those before it if less than this share of its length is left after their components are
/// removed.
const DEPENDENT_VECTOR: f64 = 1e-8;

/// The near-null space of a stiffness: for a body its rigid-body modes, for a scalar problem the constants.
///
/// One vector for each mode, one entry per free dof, linearly independent. Bodies that share no dof can share the same
/// vectors, such as the rigid-body modes of all space.
#[derive(Clone, Debug, PartialEq)]
pub struct NearNullSpace {
    vectors: Vec<Vec<f64>>,
}

impl NearNullSpace {
    /// From its vectors, length `dofs` each: displacements without a unit, of either sign, as only their span counts.
    ///
    /// # Errors
    /// [`Error::Length`] for a vector of another length, [`Error::NotFinite`], [`Error::Setting`] for no vector, more
    /// vectors than dofs, and a vector that follows from those before it.
    pub fn new(vectors: Vec<Vec<f64>>, dofs: usize) -> Result<Self, Error> {
        if vectors.is_empty() || vectors.len() > dofs {
            let allowed = "at least 1 and at most the number of dofs";
            return Err(Error::Setting {
                name: "the number of near-null vectors",
                value: vectors.len() as f64,
                allowed,
            });
        }
        for vector in &vectors {
            check_finite("near-null vector", vector, (dofs, "dofs"))?;
        }
        match first_dependent(&vectors) {
            Some(index) => Err(Error::Setting {
                name: "the rank of the near-null space",
                value: index as f64,
                allowed: "its number of vectors: they must be linearly independent, each by more than 1e-8 of its length",
            }),
            None => Ok(NearNullSpace { vectors }),
        }
    }

    /// From vectors, one entry per dof each, that are known to be finite; a vector that follows from others, such as a
    /// mode that supports suppress, does no harm. `None` without vectors.
    pub fn of_modes(vectors: Vec<Vec<f64>>) -> Option<Self> {
        let dofs = vectors.first().map_or(0, Vec::len);
        (dofs > 0 && vectors.iter().all(|vector| vector.len() == dofs)).then_some(NearNullSpace { vectors })
    }

    /// The rigid-body modes of nodes with free dofs that follow each other: translations and rotations, as
    /// displacements in the order `[x_0, y_0, x_1, ...]`. One vector of coordinates for each axis, 1 to 3, in any unit;
    /// its length is the number of nodes.
    ///
    /// # Errors
    /// As [`NearNullSpace::new`]; [`Error::Setting`] for another number of axes, [`Error::Length`] for axes that do not
    /// fit each other, [`Error::NotFinite`] for a coordinate, named by node and axis.
    pub fn of_nodes(axes: &[Vec<f64>]) -> Result<Self, Error> {
        let (dimension, nodes) = (axes.len(), axes.first().map_or(0, Vec::len));
        if !(1..=3).contains(&dimension) {
            let (name, value) = ("the number of coordinates of a node", dimension as f64);
            return Err(Error::Setting { name, value, allowed: "1, 2 or 3" });
        }
        if let Some(axis) = axes.iter().find(|axis| axis.len() != nodes) {
            return Err(Error::Length { name: "axis of coordinates", found: axis.len(), expected: nodes, of: "nodes" });
        }
        for (axis, values) in axes.iter().enumerate() {
            if let Some((node, &value)) = values.iter().enumerate().find(|entry| !entry.1.is_finite()) {
                let at = format!("({node}, {axis})");
                return Err(Error::NotFinite { name: "coordinates", at, value, allowed: "finite" });
            }
        }
        Self::new(modes(axes), dimension * nodes)
    }

    /// The constants: one vector for each dof of a node, in their order, by the pattern of `matrix` alone.
    ///
    /// # Errors
    /// [`Error::Setting`] for a matrix without dofs.
    pub fn constants(matrix: &SymmetricMatrix) -> Result<Self, Error> {
        let (size, components) = Nodes::components(matrix);
        let vector = |of: usize| components.iter().map(|&component| f64::from(u8::from(component == of))).collect();
        Self::new((0..size).map(vector).collect(), matrix.dim())
    }

    /// The vectors, one for each mode, length [`dofs`](Self::dofs) each, in the order given: displacements without a
    /// unit, as only their span counts.
    pub fn vectors(&self) -> &[Vec<f64>] {
        &self.vectors
    }

    /// Number of vectors, and so of modes; at least 1.
    pub fn count(&self) -> usize {
        self.vectors.len()
    }

    /// Length of each vector.
    pub fn dofs(&self) -> usize {
        self.vectors.first().map_or(0, Vec::len)
    }
}

/// Translations and rotations of nodes with the coordinates `axes`, node by node.
fn modes(axes: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let (dimension, nodes) = (axes.len(), axes.first().map_or(0, Vec::len));
    let mut modes = vec![vec![0.0; dimension * nodes]; dimension];
    for (axis, mode) in modes.iter_mut().enumerate() {
        (0..nodes).for_each(|node| mode[dimension * node + axis] = 1.0);
    }
    for first in 0..dimension {
        for second in first + 1..dimension {
            let mut rotation = vec![0.0; dimension * nodes];
            let middle = [first, second].map(|axis| axes[axis].iter().sum::<f64>() / nodes.max(1) as f64);
            for node in 0..nodes {
                rotation[dimension * node + first] = middle[1] - axes[second][node];
                rotation[dimension * node + second] = axes[first][node] - middle[0];
            }
            modes.push(rotation);
        }
    }
    modes
}

/// The first vector that follows from those before it, by modified Gram-Schmidt.
fn first_dependent(vectors: &[Vec<f64>]) -> Option<usize> {
    let mut basis = Vec::with_capacity(vectors.len());
    vectors.iter().position(|vector| {
        let size = largest(vector);
        size == 0.0 || !extend(&mut basis, vector.iter().map(|value| value / size).collect(), DEPENDENT_VECTOR)
    })
}
