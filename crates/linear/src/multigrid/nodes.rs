//! The dofs of a matrix in groups, one for each node, and the matrix in blocks of these; displacements of almost no
//! energy, which a hierarchy must represent on every level.

use super::blocks::BlockMatrix;
use super::filling::Filling;
use crate::error::Error;
use crate::quotient::Quotient;
use crate::real::Real;
use crate::{Equilibration, SymmetricMatrix, check_finite, exponent, extend, largest, ldexp};

/// Largest number of dofs of a node; if more have the same neighbours, they count as dofs of several nodes.
const MOST_DOFS: usize = 3;

/// The nodes of a problem, with the places of its dofs in them. Nodes with fewer dofs than others, such as nodes at a
/// roller, are filled up with dofs that nothing touches.
#[derive(Clone, Debug)]
pub struct Nodes {
    /// Number of places of each node, at least its number of dofs.
    pub size: usize,
    pub count: usize,
    /// The place `size * node + component` of each dof.
    pub place: Vec<u32>,
    /// The exponent of the unit of each node, `>= 0`: its displacement is `2^exponent` times the unknown of the
    /// hierarchy. With these units, nodes of stiff and of soft bodies have diagonal entries of the same order. Those of
    /// the stiffest nodes are zero.
    exponents: Vec<i32>,
}

/// The group of each dof, which is its node, and the exponent of its unit: `u = 2^exponent v`. All dofs of a node have
/// the same one.
///
/// In the unknowns v, nodes of stiff and of soft bodies have diagonal entries of the same order. A projection that is
/// orthogonal in v then moves soft and stiff nodes of a row by what their stiffness allows; one that is orthogonal in u
/// does not, and the smoother diverges.
#[derive(Clone, Debug)]
pub struct Units {
    /// The group of each unknown.
    pub groups: Vec<u32>,
    /// The exponent of the unit of each unknown.
    pub exponents: Vec<i32>,
}

impl Units {
    /// The nodes by the pattern of `matrix` alone, all with one unit.
    pub fn by_pattern(matrix: &SymmetricMatrix) -> Self {
        let (size, place, _) = places(&Quotient::of(matrix.lower()), matrix.dim());
        let groups = place.iter().map(|&place| place / size as u32).collect();
        Units { groups, exponents: vec![0; matrix.dim()] }
    }

    /// One unit for all dofs, as if they were those of one node.
    pub fn alone(dofs: usize) -> Self {
        Units { groups: vec![0; dofs], exponents: vec![0; dofs] }
    }
}

impl Nodes {
    /// Groups dofs with the same neighbours, and writes the matrix in blocks of these groups, in the unit of each node,
    /// times `2^exponent` so that its diagonal is of order one; not rounded as well, if nearly all its rows repeat.
    pub fn of<T: Real>(
        matrix: &SymmetricMatrix,
        threads: usize,
    ) -> (Self, BlockMatrix<T>, Option<BlockMatrix<f64>>, i32) {
        let graph = Quotient::of(matrix.lower());
        let (size, place, first_node) = places(&graph, matrix.dim());
        let count = first_node[graph.count()] as usize;
        let (exponents, shift) = units(&matrix.diagonal(), |dof| place[dof] as usize / size, count);
        let filling = Filling { matrix, graph: &graph, first_node: &first_node, size, exponents: &exponents, shift };
        let (blocks, exact) = filling.blocks(threads);
        (Nodes { size, count, place, exponents }, blocks, exact, shift)
    }

    /// `count` nodes of `size` dofs each, one after another.
    pub fn in_order(size: usize, count: usize) -> Self {
        Nodes { size, count, place: (0..(size * count) as u32).collect(), exponents: vec![0; count] }
    }

    /// Number of dofs of a node, and the component of each dof.
    pub fn components(matrix: &SymmetricMatrix) -> (usize, Vec<usize>) {
        let (size, place, _) = places(&Quotient::of(matrix.lower()), matrix.dim());
        (size, place.into_iter().map(|place| place as usize % size).collect())
    }

    pub fn units(&self) -> Units {
        let groups = self.place.iter().map(|&place| place / self.size as u32).collect();
        Units { groups, exponents: self.places().map(|place| place.1).collect() }
    }

    /// The place of each dof, and the exponent of its unit.
    pub fn places(&self) -> impl Iterator<Item = (usize, i32)> {
        self.place.iter().map(|&place| (place as usize, self.exponents[place as usize / self.size]))
    }

    /// Puts the forces on the dofs into their places in `gathered`, in the units of the nodes, times `2^exponent`.
    /// Returns that exponent: they are then of order one, because single precision has a small range.
    pub fn gather<T: Real>(&self, forces: &[f64], gathered: &mut [T]) -> i32 {
        let all = || self.places().zip(forces);
        let largest = all().filter(|of| *of.1 != 0.0).map(|((_, unit), &force)| exponent(force) + unit).max();
        let scale = -largest.unwrap_or(0);
        all().for_each(|((place, unit), &force)| gathered[place] = T::of(ldexp(force, scale + unit)));
        scale
    }

    /// Puts the displacements of the dofs, of unknowns in the units of the nodes, times `2^exponent`, into
    /// `displacements`.
    pub fn scatter<T: Real>(&self, gathered: &[T], exponent: i32, displacements: &mut [f64]) {
        for ((place, unit), displacement) in self.places().zip(displacements) {
            *displacement = ldexp(gathered[place].double(), exponent + unit);
        }
    }
}

/// Number of places of a node, the place of each dof, which is `size * node + component`, and the first node of each
/// group, with the number of nodes at the end.
fn places(graph: &Quotient, dofs: usize) -> (usize, Vec<u32>, Vec<u32>) {
    let (size, mut place, mut first_node) = (usual_dofs(graph), vec![0; dofs], vec![0]);
    let mut count = 0;
    for group in 0..graph.count() as u32 {
        for part in graph.members(group).chunks(size) {
            part.iter().enumerate().for_each(|(component, &dof)| place[dof] = (size * count + component) as u32);
            count += 1;
        }
        first_node.push(count as u32);
    }
    (size, place, first_node)
}

/// The exponent of the unit of each of `count` nodes, from the largest diagonal entry there, and the exponent that then
/// makes all diagonal entries of order one. A node without stiffness has the unit of the stiffest.
fn units(diagonal: &[f64], node_of: impl Fn(usize) -> usize, count: usize) -> (Vec<i32>, i32) {
    let mut of_node = vec![0.0_f64; count];
    diagonal.iter().enumerate().for_each(|(dof, &own)| of_node[node_of(dof)] = of_node[node_of(dof)].max(own));
    let units = Equilibration::of_diagonal(&of_node);
    (units.diagonal, units.factor)
}

/// Dofs of the nodes of a graph: the number in most groups. Nodes inside an element may share a group.
fn usual_dofs(graph: &Quotient) -> usize {
    let mut with = [0_usize; MOST_DOFS + 1];
    for group in 0..graph.count() as u32 {
        if let Some(count) = with.get_mut(graph.members(group).len()) {
            *count += 1;
        }
    }
    (1..=MOST_DOFS).max_by_key(|&size| (with[size], size)).unwrap_or(1)
}

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
            let (name, value) = ("the number of near-null vectors", vectors.len() as f64);
            return Err(Error::Setting { name, value, allowed: "at least 1 and at most the number of dofs" });
        }
        for vector in &vectors {
            check_finite("near-null vector", vector, (dofs, "dofs"))?;
        }
        let mut basis = Vec::with_capacity(vectors.len());
        let follows = |vector: &Vec<f64>| {
            let size = largest(vector);
            size == 0.0 || !extend(&mut basis, vector.iter().map(|value| value / size).collect(), DEPENDENT_VECTOR)
        };
        let Some(rank) = vectors.iter().position(follows) else { return Ok(NearNullSpace { vectors }) };
        let allowed = "its number of vectors: they must be linearly independent, each by more than 1e-8 of its length";
        Err(Error::Setting { name: "the rank of the near-null space", value: rank as f64, allowed })
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
        let check = |axis: &Vec<f64>| Error::check_length("axis of coordinates", axis.len(), nodes, "nodes");
        axes.iter().try_for_each(check)?;
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
