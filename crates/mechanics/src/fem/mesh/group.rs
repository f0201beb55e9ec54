//! Groups of elements: the physical groups of a mesh file that lie in the body.

/// Elements with a name; an element may be in several groups, or in none.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ElementGroup {
    pub name: String,
    /// From 0, increasing.
    pub elements: Vec<usize>,
}
