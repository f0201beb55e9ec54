//! Plane meshes: nodes, elements, named boundaries.

mod rectangle;

pub use rectangle::{Axis, AxisError, MAX_NODES, rectangle};

use crate::error::Error;

/// The elements that a mesh can be made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    /// Linear triangle, three nodes counterclockwise.
    T3,
    /// Bilinear quadrilateral, four nodes counterclockwise.
    Q4,
}

impl ElementKind {
    /// Number of nodes of one element.
    pub fn nodes(self) -> usize {
        match self {
            ElementKind::T3 => 3,
            ElementKind::Q4 => 4,
        }
    }
}

/// A named part of the mesh's outline.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// Its name, as `top`.
    pub name: String,
    /// Its edges in order; each is a pair of nodes, and the second node of one is the first of the next.
    pub edges: Vec<[usize; 2]>,
}

impl Boundary {
    /// The nodes along the edges in order, each named once where it follows itself.
    pub fn nodes(&self) -> Vec<usize> {
        let mut nodes: Vec<usize> = Vec::with_capacity(self.edges.len() + 1);
        for &[start, end] in &self.edges {
            if nodes.last() != Some(&start) {
                nodes.push(start);
            }
            nodes.push(end);
        }
        nodes
    }
}

/// A mesh of one kind of element in the plane, checked once, when it is built.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    nodes: Vec<[f64; 2]>,
    kind: ElementKind,
    connectivity: Vec<usize>,
    boundaries: Vec<Boundary>,
}

impl Mesh {
    /// The mesh of `nodes` (coordinates x, y in the unit of length) and elements of one `kind`.
    ///
    /// `connectivity` lists the nodes of element 0, then of element 1, ..., each counterclockwise, indices from 0.
    ///
    /// # Errors
    /// [`Error::Mesh`] for a mesh without elements, coordinates that are not finite, a connectivity that is no
    /// multiple of the nodes of an element, a node beyond the last, a node that no element uses, two boundaries of
    /// one name.
    pub fn new(
        nodes: Vec<[f64; 2]>,
        kind: ElementKind,
        connectivity: Vec<usize>,
        boundaries: Vec<Boundary>,
    ) -> Result<Self, Error> {
        let fail = |message| Err(Error::Mesh { message });
        if connectivity.is_empty() {
            return fail("there are no elements; a mesh needs at least one".into());
        }
        if let Some(node) = nodes.iter().position(|at| !(at[0].is_finite() && at[1].is_finite())) {
            return fail(format!("node {node} lies at {:?}; coordinates must be finite", nodes[node]));
        }
        if !connectivity.len().is_multiple_of(kind.nodes()) {
            let (length, each) = (connectivity.len(), kind.nodes());
            return fail(format!(
                "the connectivity has length {length}, no multiple of the {each} nodes of an element"
            ));
        }
        let of_edges = boundaries.iter().flat_map(|boundary| boundary.edges.iter().flatten());
        if let Some(node) = connectivity.iter().chain(of_edges).find(|&&node| node >= nodes.len()) {
            return fail(format!("node {node} is used, but there are only {} (indices from 0)", nodes.len()));
        }
        let mut used = vec![false; nodes.len()];
        connectivity.iter().for_each(|&node| used[node] = true);
        if let Some(node) = used.iter().position(|used| !used) {
            return fail(format!("node {node} belongs to no element"));
        }
        for (index, boundary) in boundaries.iter().enumerate() {
            if boundaries[..index].iter().any(|other| other.name == boundary.name) {
                return fail(format!("two boundaries are called `{}`", boundary.name));
            }
        }
        Ok(Mesh { nodes, kind, connectivity, boundaries })
    }

    /// Coordinates x, y of every node.
    pub fn nodes(&self) -> &[[f64; 2]] {
        &self.nodes
    }

    /// What the elements are.
    pub fn kind(&self) -> ElementKind {
        self.kind
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.connectivity.len() / self.kind.nodes()
    }

    /// The nodes of each element, counterclockwise.
    pub fn elements(&self) -> impl Iterator<Item = &[usize]> + '_ {
        self.connectivity.chunks_exact(self.kind.nodes())
    }

    /// All named boundaries.
    pub fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    /// The boundary called `name`, if there is one.
    pub fn boundary(&self, name: &str) -> Option<&Boundary> {
        self.boundaries.iter().find(|boundary| boundary.name == name)
    }

    /// The smallest and the largest coordinates, `([x_min, y_min], [x_max, y_max])`.
    pub fn extent(&self) -> ([f64; 2], [f64; 2]) {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for node in &self.nodes {
            for axis in 0..2 {
                low[axis] = low[axis].min(node[axis]);
                high[axis] = high[axis].max(node[axis]);
            }
        }
        (low, high)
    }

    /// The diagonal of the extent: the body's size, in the unit of length.
    pub fn size(&self) -> f64 {
        let (low, high) = self.extent();
        (high[0] - low[0]).hypot(high[1] - low[1])
    }

    /// The node nearest to `point` and its distance; `None` in a mesh without nodes.
    pub fn nearest_node(&self, point: [f64; 2]) -> Option<(usize, f64)> {
        let distance = |node: &[f64; 2]| (node[0] - point[0]).hypot(node[1] - point[1]);
        self.nodes.iter().map(distance).enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
    }
}
