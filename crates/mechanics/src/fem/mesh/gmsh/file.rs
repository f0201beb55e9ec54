//! A mesh file of Gmsh as data, without the meaning of its groups.

use std::path::PathBuf;

use super::cells::CellType;
use super::form::Form;
use crate::error::Error;

/// The content of a file: nodes, elements of any type, physical groups.
#[derive(Clone, Debug)]
pub struct GmshFile {
    pub(super) file: PathBuf,
    /// The form of the file. In binary form `line` here and below means a byte.
    pub(super) form: Form,
    /// In the order of the file, with their tags and lines.
    pub(super) nodes: Vec<[f64; 3]>,
    pub(super) node_tags: Vec<usize>,
    pub(super) node_lines: Vec<usize>,
    pub(super) blocks: Vec<Block>,
    pub(super) groups: Vec<PhysicalGroup>,
    pub(super) last_line: usize,
}

/// Elements of one type in the same physical groups.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub cell: &'static CellType,
    pub groups: Vec<u64>,
    pub tags: Vec<usize>,
    /// The position of each element in the file.
    pub lines: Vec<usize>,
    /// The nodes of element 0, then of element 1, ...: tags while the file is read, then indices into `nodes`.
    pub nodes: Vec<usize>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Element<'a> {
    pub cell: &'static CellType,
    pub tag: usize,
    pub line: usize,
    pub nodes: &'a [usize],
}

/// A physical group with a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PhysicalGroup {
    /// Dimension of its elements, 0 to 3.
    pub dimension: usize,
    /// Its number among the groups of this dimension.
    pub tag: u64,
    pub name: String,
    pub(super) line: usize,
}

impl GmshFile {
    pub(super) fn elements_of<'a>(&'a self, block: &'a Block) -> impl Iterator<Item = Element<'a>> + 'a {
        let (cell, nodes) = (block.cell, block.nodes.chunks_exact(block.cell.nodes));
        block.tags.iter().zip(&block.lines).zip(nodes).map(move |((&tag, &line), nodes)| Element {
            cell,
            tag,
            line,
            nodes,
        })
    }

    pub(super) fn fault(&self, line: usize, message: impl Into<String>) -> Error {
        self.form.fault(&self.file, line, message)
    }
}
