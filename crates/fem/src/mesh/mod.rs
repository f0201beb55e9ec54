//! Meshes in one, two or three dimensions: nodes, elements, named boundaries.

pub mod axis;
pub mod bisection;
mod boundary;
pub mod deck;
mod faces;
mod file;
pub mod gmsh;
pub mod pieces;

pub use super::element::{ElementKind, FacetKind};
pub use axis::{Axis, Zone};
pub use boundary::Boundary;
pub use boundary::{ElementGroup, NodeNames};

use crate::error::Error;
use crate::geometry::distance;
use std::collections::HashSet;
use std::ops::Range;

/// More nodes than this are refused before memory is allocated: a mesh of Tet4 has some 24 places of elements for each
/// node, and their numbers fit 32 bits.
pub const MAX_NODES: usize = 100_000_000;

/// A mesh, checked once, when it is built: elements of one kind, or blocks of them after [`Mesh::beside`].
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    nodes: Vec<[f64; 3]>,
    /// In the order of their elements; neighbours differ in kind.
    blocks: Vec<ElementBlock>,
    connectivity: Vec<usize>,
    boundaries: Vec<Boundary>,
    groups: Vec<ElementGroup>,
    node_names: NodeNames,
    /// The number of each element in its file; empty if there are none.
    element_numbers: Vec<usize>,
}

/// Consecutive elements of one kind.
#[derive(Clone, Debug, PartialEq)]
struct ElementBlock {
    kind: ElementKind,
    elements: Range<usize>,
    /// Index of the first node of the block in the connectivity of the mesh.
    first: usize,
}

impl Mesh {
    /// The mesh of `nodes` (coordinates x, y, z in the unit of length; those beyond the dimension of the element are
    /// zero) and elements of one `kind`.
    ///
    /// `connectivity` lists the nodes of element 0, then of element 1, ..., each in the order of [`ElementKind`],
    /// indices from 0.
    ///
    /// # Errors
    /// [`Error::Mesh`] for a mesh without elements, coordinates that are not finite or lie outside the space of the
    /// element, a connectivity whose length is not a multiple of the nodes of an element, a node beyond the last, a
    /// node that no element uses, two boundaries of one name, facets of the wrong kind, a facet that is not a face of
    /// an element.
    pub fn new(
        nodes: Vec<[f64; 3]>,
        kind: ElementKind,
        connectivity: Vec<usize>,
        boundaries: Vec<Boundary>,
    ) -> Result<Self, Error> {
        let each = kind.nodes();
        if !ElementKind::ALL.contains(&kind) {
            return fail(format!("a mesh does not consist of {}, which is a facet alone", kind.name()));
        }
        if !connectivity.len().is_multiple_of(each) {
            let length = connectivity.len();
            return fail(format!(
                "the connectivity has length {length}, which is not a multiple of the {each} nodes of an element"
            ));
        }
        let blocks = vec![ElementBlock { kind, elements: 0..connectivity.len() / each, first: 0 }];
        let (groups, node_names, element_numbers) = (Vec::new(), NodeNames::default(), Vec::new());
        Mesh { nodes, blocks, connectivity, boundaries, groups, node_names, element_numbers }.checked()
    }

    fn checked(self) -> Result<Self, Error> {
        self.check_nodes()?;
        self.check_names()?;
        self.check_boundaries(0)?;
        Ok(self)
    }

    fn check_nodes(&self) -> Result<(), Error> {
        if self.connectivity.is_empty() {
            return fail("there are no elements; a mesh needs at least one".into());
        }
        let (nodes, dimension) = (&self.nodes, self.dimension());
        for (node, at) in nodes.iter().enumerate() {
            if !at.iter().all(|value| value.is_finite()) {
                return fail(format!("node {node} lies at {:?}; coordinates must be finite", &at[..dimension]));
            }
            if at[dimension..].iter().any(|&value| value != 0.0) {
                let unused = ["y and z", "z"][dimension - 1];
                let name = self.kind_of(0).name();
                return fail(format!("node {node} lies at {at:?}; in a mesh of {name}, {unused} must be 0"));
            }
        }
        let of_facets = self.boundaries.iter().flat_map(|boundary| &boundary.connectivity);
        if let Some(node) = self.connectivity.iter().chain(of_facets).find(|&&node| node >= nodes.len()) {
            return fail(format!("node {node} is used, but there are only {} (indices from 0)", nodes.len()));
        }
        let mut used = vec![false; nodes.len()];
        self.connectivity.iter().for_each(|&node| used[node] = true);
        match used.iter().position(|used| !used) {
            Some(node) => fail(format!(
                "node {node} belongs to no element; it lies at {:?}: remove it",
                &nodes[node][..self.dimension()]
            )),
            None => Ok(()),
        }
    }

    /// Checks that the names of all boundaries differ.
    fn check_names(&self) -> Result<(), Error> {
        let mut names = HashSet::with_capacity(self.boundaries.len());
        let twice = self.boundaries.iter().find(|boundary| !names.insert(&boundary.name));
        twice.map_or(Ok(()), |boundary| named_twice(&boundary.name))
    }

    /// Checks the boundaries from a number on, but for their names.
    fn check_boundaries(&self, from: usize) -> Result<(), Error> {
        for boundary in &self.boundaries[from..] {
            let name = &boundary.name;
            let (found, count) = (boundary.kind, boundary.connectivity.len());
            if !self.kinds().any(|kind| kind.facet() == found) || !count.is_multiple_of(found.nodes()) {
                let expected: Vec<String> =
                    self.kinds().map(|kind| format!("faces of {} are {:?}", kind.name(), kind.facet())).collect();
                return fail(format!(
                    "boundary `{name}` has facets {found:?} and {count} node numbers; {}",
                    expected.join(", ")
                ));
            }
        }
        self.check_facets(from)
    }

    /// Coordinates [x, y, z] of every node, length `n_nodes`, in length; those beyond the dimension are zero.
    pub fn nodes(&self) -> &[[f64; 3]] {
        &self.nodes
    }

    /// The same mesh with one coordinate of a node changed.
    #[doc(hidden)]
    pub fn moved(mut self, node: usize, axis: usize, by: f64) -> Self {
        self.nodes[node][axis] += by;
        self
    }

    /// The kinds of its elements, each once, in the order of their first element.
    pub fn kinds(&self) -> impl Iterator<Item = ElementKind> + '_ {
        let is_first = |place: usize| self.blocks[..place].iter().all(|block| block.kind != self.blocks[place].kind);
        (0..self.blocks.len()).filter(move |&place| is_first(place)).map(|place| self.blocks[place].kind)
    }

    /// The kind of an element, numbered from 0.
    ///
    /// # Panics
    /// If there is no such element.
    #[inline]
    pub fn kind_of(&self, element: usize) -> ElementKind {
        self.block_of(element).kind
    }

    #[inline]
    fn block_of(&self, element: usize) -> &ElementBlock {
        // There are as many blocks as bodies at most.
        &self.blocks[self.blocks.iter().take_while(|block| block.elements.end <= element).count()]
    }

    /// Number of coordinates: 1, 2 or 3.
    pub fn dimension(&self) -> usize {
        self.blocks[0].kind.dimension()
    }

    /// Number of elements, of all bodies in the mesh.
    pub fn element_count(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.elements.end)
    }

    /// The node indices of each element, from 0, in the order of [`ElementKind`].
    pub fn elements(&self) -> impl Iterator<Item = &[usize]> + '_ {
        self.blocks.iter().flat_map(|block| {
            let each = block.kind.nodes();
            self.connectivity[block.first..block.first + each * block.elements.len()].chunks_exact(each)
        })
    }

    /// The nodes of one element, from 0, in the order of its reference cell.
    ///
    /// # Panics
    /// If there is no such element.
    #[inline]
    pub fn element(&self, element: usize) -> &[usize] {
        let block = self.block_of(element);
        let each = block.kind.nodes();
        let start = block.first + (element - block.elements.start) * each;
        &self.connectivity[start..start + each]
    }

    /// All named boundaries, in the order in which they were given.
    pub fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    /// The boundary called `name`, if there is one.
    pub fn boundary(&self, name: &str) -> Option<&Boundary> {
        self.boundaries.iter().find(|boundary| boundary.name == name)
    }

    /// The groups of elements; only a mesh from a file has groups.
    #[doc(hidden)]
    pub fn groups(&self) -> &[ElementGroup] {
        &self.groups
    }

    fn with_groups(self, groups: Vec<ElementGroup>) -> Self {
        Mesh { groups, ..self }
    }

    /// The names of its nodes in its file.
    #[doc(hidden)]
    pub fn node_names(&self) -> &NodeNames {
        &self.node_names
    }

    fn with_node_names(self, node_names: NodeNames) -> Self {
        Mesh { node_names, ..self }
    }

    /// The same mesh with the number of each element in its file.
    fn with_element_numbers(self, element_numbers: Vec<usize>) -> Self {
        Mesh { element_numbers, ..self }
    }

    /// The number of each node in the deck that the mesh comes from, in the order of [`Mesh::nodes`]; `None` for a mesh
    /// from elsewhere.
    pub fn node_numbers(&self) -> Option<Vec<usize>> {
        self.node_names.numbers(self.nodes.len())
    }

    /// The number of each element in the deck that the mesh comes from, in the order of [`Mesh::elements`]; `None` for
    /// a mesh from elsewhere.
    pub fn element_numbers(&self) -> Option<&[usize]> {
        (self.element_numbers.len() == self.element_count()).then_some(&self.element_numbers)
    }

    /// The mirror image across the plane where the coordinate `axis` (0, 1, 2 for x, y, z) is `plane`; boundaries keep
    /// their names.
    pub fn mirrored(mut self, axis: usize, plane: f64) -> Self {
        self.nodes.iter_mut().filter_map(|at| at.get_mut(axis)).for_each(|value| *value = 2.0 * plane - *value);
        let mut connectivity = Vec::with_capacity(self.connectivity.len());
        for (element, nodes) in self.elements().enumerate() {
            connectivity.extend(self.kind_of(element).reference().mirrored().iter().map(|&local| nodes[local]));
        }
        Mesh { connectivity, ..self }
    }

    /// This mesh and `other` in one, sharing no node: nodes and elements of `other` follow those of this mesh; its
    /// boundaries are called `name.boundary`, and its groups of elements `name.group`.
    ///
    /// # Errors
    /// [`Error::Mesh`] for meshes of two dimensions, or a boundary name that exists.
    pub fn beside(mut self, other: &Mesh, name: &str) -> Result<Self, Error> {
        if self.dimension() != other.dimension() {
            let [one, two] = [&self, other].map(|mesh| mesh.kind_of(0).name());
            return fail(format!("a mesh has elements of one dimension; here {one} and {two}"));
        }
        let (elements, entries) = (self.element_count(), self.connectivity.len());
        for block in &other.blocks {
            let Range { start, end } = block.elements;
            match self.blocks.last_mut().filter(|last| last.kind == block.kind) {
                Some(last) => last.elements.end = elements + end,
                None => self.blocks.push(ElementBlock {
                    kind: block.kind,
                    elements: elements + start..elements + end,
                    first: entries + block.first,
                }),
            }
        }
        let of_other =
            |boundary: &Boundary| boundary.name.strip_prefix(name)?.strip_prefix('.').and_then(|of| other.boundary(of));
        if let Some(boundary) = self.boundaries.iter().find(|boundary| of_other(boundary).is_some()) {
            return named_twice(&boundary.name);
        }
        let first = self.nodes.len();
        self.node_names.extend(&other.node_names, name, first);
        let behind = |nodes: &[usize]| nodes.iter().map(|node| first + node).collect::<Vec<usize>>();
        self.nodes.extend_from_slice(&other.nodes);
        self.connectivity.extend(behind(&other.connectivity));
        self.boundaries.extend(other.boundaries.iter().map(|boundary| {
            Boundary::new(format!("{name}.{}", boundary.name), boundary.kind, behind(&boundary.connectivity))
        }));
        // Numbers of some elements only would be those of others.
        self.element_numbers.truncate(if self.element_numbers.len() == elements { elements } else { 0 });
        self.element_numbers.extend_from_slice(&other.element_numbers);
        self.groups.extend(other.groups.iter().map(|group| ElementGroup {
            name: format!("{name}.{}", group.name),
            elements: group.elements.iter().map(|element| elements + element).collect(),
        }));
        Ok(self)
    }

    /// The same mesh with one more boundary, after the others.
    pub(crate) fn with_boundary(mut self, boundary: Boundary) -> Result<Self, Error> {
        if self.boundary(&boundary.name).is_some() {
            return named_twice(&boundary.name);
        }
        self.boundaries.push(boundary);
        self.check_boundaries(self.boundaries.len() - 1)?;
        Ok(self)
    }

    /// The smallest and the largest coordinates, `([x_min, y_min, z_min], [x_max, y_max, z_max])`, in length.
    pub fn extent(&self) -> ([f64; 3], [f64; 3]) {
        extent(&self.nodes)
    }

    /// The smallest and the largest coordinates of some of its nodes, numbered from 0: `[x, y, z]` each, in length.
    pub fn extent_of(&self, nodes: Range<usize>) -> ([f64; 3], [f64; 3]) {
        extent(&self.nodes[nodes])
    }

    /// The diagonal of the extent: the body's size, in the unit of length.
    pub fn size(&self) -> f64 {
        let (low, high) = self.extent();
        distance(low, high)
    }

    /// The index of the node nearest to `point` ([x, y, z], in length), from 0, and its distance, in length; `None` in
    /// a mesh without nodes.
    pub fn nearest_node(&self, point: [f64; 3]) -> Option<(usize, f64)> {
        let away = |&node: &[f64; 3]| distance(node, point);
        self.nodes.iter().map(away).enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The smallest and the largest coordinates of `nodes`.
pub fn extent(nodes: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for node in nodes {
        for axis in 0..3 {
            low[axis] = low[axis].min(node[axis]);
            high[axis] = high[axis].max(node[axis]);
        }
    }
    (low, high)
}

/// An [`Error::Mesh`].
pub fn fail<T, E: From<Error>>(message: String) -> Result<T, E> {
    Err(Error::Mesh { message }.into())
}

fn named_twice<T>(name: &str) -> Result<T, Error> {
    fail(format!("two boundaries are called `{name}`"))
}

/// Checks the lines of a structured mesh and counts the nodes of the grid that is `refined` times as fine.
pub fn check_lines(axes: &[(&str, &[f64])], refined: usize) -> Result<(), Error> {
    let mut nodes: usize = 1;
    for (name, lines) in axes {
        let increasing = |pair: &[f64]| pair[1].partial_cmp(&pair[0]) == Some(std::cmp::Ordering::Greater);
        if lines.len() < 2 || !lines.windows(2).all(increasing) {
            return fail(format!("the {name} lines must be at least two, and increase"));
        }
        nodes = nodes.saturating_mul((lines.len() - 1).saturating_mul(refined).saturating_add(1));
    }
    if nodes > MAX_NODES {
        let cells: Vec<String> = axes.iter().map(|(_, lines)| (lines.len() - 1).to_string()).collect();
        return fail(format!("{} cells make more than the {MAX_NODES} nodes that are allowed", cells.join(" x ")));
    }
    Ok(())
}
