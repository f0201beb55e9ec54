//! The content that both versions fill, without the meaning of its groups: nodes by tag, elements in blocks, names.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::path::PathBuf;

use super::record::{FileForm, MshSource, Record, shortened};
use crate::error::Error;
use crate::mesh::MAX_NODES;

impl GmshFile {
    /// Adds the node `tag`, which is in `record`.
    pub(super) fn add_node(&mut self, record: &Record, tag: usize, at: [f64; 3]) -> Result<(), Error> {
        match self.places.entry(tag) {
            Entry::Occupied(_) => return Err(record.fault(format!("node {tag} is given twice"))),
            Entry::Vacant(place) => place.insert(self.nodes.len()),
        };
        self.nodes.push(at);
        self.node_tags.push(tag);
        self.node_lines.push(record.place());
        Ok(())
    }

    /// Starts a new block of elements of type `number` in these groups.
    pub(super) fn begin_block(&mut self, record: &Record, number: usize, groups: &[u64]) -> Result<(), Error> {
        if self.blocks.last().is_some_and(|block| block.cell.number == number && block.groups == groups) {
            return Ok(());
        }
        let Some(cell) = cell_type(number) else {
            let message = format!(
                "the element type {number} is not supported; save elements of first or second order (in Gmsh, \
                 `Mesh.ElementOrder = 1` or 2)"
            );
            return Err(record.fault(message));
        };
        let groups = groups.to_vec();
        self.blocks.push(ElementBlock { cell, groups, tags: Vec::new(), lines: Vec::new(), nodes: Vec::new() });
        Ok(())
    }

    /// Adds the element `tag` to the last block; the rest of `record` is its nodes.
    pub(super) fn add_element(&mut self, mut record: Record, tag: usize) -> Result<(), Error> {
        let Some(block) = self.blocks.last_mut() else { return Ok(()) };
        for _ in 0..block.cell.nodes {
            block.nodes.push(record.whole("the tag of a node")?);
        }
        block.tags.push(tag);
        block.lines.push(record.place());
        record.end()
    }

    /// Replaces the tags of nodes by their indices, and checks that the groups have elements.
    pub(super) fn finish(mut self, source: MshSource) -> Result<GmshFile, Error> {
        (self.file, self.last_line, self.form) = (source.file.into(), source.place(), source.form);
        let mut missing = None;
        for block in &mut self.blocks {
            let each = block.cell.nodes;
            for (index, node) in block.nodes.iter_mut().enumerate() {
                match self.places.get(node) {
                    Some(&place) => *node = place,
                    None => {
                        let element = index / each;
                        missing = missing.or(Some((block.lines[element], block.tags[element], *node)));
                    }
                }
            }
        }
        if let Some((line, element, node)) = missing {
            return Err(self.fault(line, format!("element {element} names node {node}, which does not exist")));
        }
        self.check_groups()?;
        Ok(self)
    }
}

/// Reads a count and rejects one larger than any possible body; memory is never allocated from a count alone.
pub(super) fn announced(record: &mut Record, of: &str) -> Result<usize, Error> {
    // A tetrahedral mesh has about six times as many elements as nodes.
    const MOST: usize = 10 * MAX_NODES;
    let count = record.whole(format_args!("the number of {of}"))?;
    if count > MOST {
        return Err(record.fault(format!("{count} {of} are announced, but at most {MOST} are allowed")));
    }
    Ok(count)
}

// The element types of Gmsh by number.
//
// # Source
// C. Geuzaine, J.-F. Remacle, *Gmsh Reference Manual*, chapter "Gmsh file formats", MSH file format, `elm-type`.

/// An element type of the format.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct CellType {
    /// Its number in the file.
    pub number: usize,
    /// Its name, in the plural.
    pub plural: &'static str,
    /// Dimension, 0 to 3.
    pub dimension: usize,
    pub nodes: usize,
}

const fn cell(number: usize, plural: &'static str, dimension: usize, nodes: usize) -> CellType {
    CellType { number, plural, dimension, nodes }
}

/// Every type of first and second order; types of higher order are not read.
static TYPES: [CellType; 19] = [
    cell(1, "two-node lines", 1, 2),
    cell(2, "three-node triangles", 2, 3),
    cell(3, "four-node quadrilaterals", 2, 4),
    cell(4, "four-node tetrahedra", 3, 4),
    cell(5, "eight-node bricks", 3, 8),
    cell(6, "six-node prisms", 3, 6),
    cell(7, "five-node pyramids", 3, 5),
    cell(8, "three-node lines", 1, 3),
    cell(9, "six-node triangles", 2, 6),
    cell(10, "nine-node quadrilaterals", 2, 9),
    cell(11, "ten-node tetrahedra", 3, 10),
    cell(12, "27-node bricks", 3, 27),
    cell(13, "18-node prisms", 3, 18),
    cell(14, "14-node pyramids", 3, 14),
    cell(15, "points", 0, 1),
    cell(16, "eight-node quadrilaterals", 2, 8),
    cell(17, "20-node bricks", 3, 20),
    cell(18, "15-node prisms", 3, 15),
    cell(19, "13-node pyramids", 3, 13),
];

/// The type of this number, if it is of first or second order.
pub(super) fn cell_type(number: usize) -> Option<&'static CellType> {
    TYPES.iter().find(|cell| cell.number == number)
}

/// The section `$PhysicalNames`, text in either form: a count, then `dimension tag "name"`.
pub(super) fn names(source: &mut MshSource, groups: &mut Vec<PhysicalGroup>) -> Result<(), Error> {
    let mut line = source.line(|| "the number of physical names")?;
    let count = line.whole("the number of physical names")?;
    line.end()?;
    for index in 1..=count {
        let mut line = source.line(|| format!("physical name {index} of {count}"))?;
        let dimension = line.whole("the dimension of a physical group")?;
        let tag = line.integer("the tag of a physical group")?.unsigned_abs();
        let name = quoted(&line)?;
        if dimension > 3 {
            return Err(
                line.fault(format!("the physical group `{name}` has dimension {dimension}; it must be at most 3"))
            );
        }
        if groups.iter().any(|group| (group.dimension, group.tag) == (dimension, tag)) {
            return Err(line.fault(format!("the physical group {tag} of dimension {dimension} is named twice")));
        }
        groups.push(PhysicalGroup { dimension, tag, name, line: line.place() });
    }
    source.end("PhysicalNames")
}

fn quoted(line: &Record) -> Result<String, Error> {
    let text = String::from_utf8_lossy(line.text());
    let name = text.split_once('"').and_then(|(_, rest)| rest.strip_suffix('"')).map(str::trim);
    match name {
        Some("") => Err(line.fault("the name of a physical group is empty")),
        Some(name) => Ok(name.into()),
        None => Err(line.fault(format!(
            "the name of a physical group must stand in quotes, but the line is `{}`",
            shortened(line.text())
        ))),
    }
}

impl GmshFile {
    /// Checks that every named group has elements: an empty group means a geometry that was not meshed.
    fn check_groups(&self) -> Result<(), Error> {
        let mut filled = HashSet::new();
        for block in &self.blocks {
            filled.extend(block.groups.iter().map(|&tag| (block.cell.dimension, tag)));
        }
        match self.groups.iter().find(|group| !filled.contains(&(group.dimension, group.tag))) {
            Some(PhysicalGroup { dimension, name, line, .. }) => {
                let message =
                    format!("the physical group `{name}` of dimension {dimension} has no elements in this file");
                Err(self.fault(*line, message))
            }
            None => Ok(()),
        }
    }

    /// The name of a group: its number if the file gives no name.
    pub(super) fn name_of(&self, dimension: usize, tag: u64) -> String {
        let group = self.groups.iter().find(|group| (group.dimension, group.tag) == (dimension, tag));
        group.map_or_else(|| tag.to_string(), |group| group.name.clone())
    }

    /// The dimensions and names of all groups that have elements, in the order of dimension and file.
    pub(super) fn names_in_use(&self) -> Vec<(usize, String)> {
        let mut names = Vec::new();
        for dimension in 0..=3 {
            for block in self.blocks_of(dimension) {
                for &tag in &block.groups {
                    let named = (dimension, self.name_of(dimension, tag));
                    if !names.contains(&named) {
                        names.push(named);
                    }
                }
            }
        }
        names
    }
}

/// The content of a file: nodes, elements of any type, physical groups.
#[derive(Clone, Debug, Default)]
pub struct GmshFile {
    pub(super) file: PathBuf,
    /// The form of the file. In binary form `line` here and below means a byte.
    pub(super) form: FileForm,
    /// In the order of the file, with their tags and lines.
    pub(super) nodes: Vec<[f64; 3]>,
    pub(super) node_tags: Vec<usize>,
    pub(super) node_lines: Vec<usize>,
    /// The index of each node by its tag.
    places: HashMap<usize, usize>,
    pub(super) blocks: Vec<ElementBlock>,
    pub(super) groups: Vec<PhysicalGroup>,
    pub(super) last_line: usize,
}

/// Elements of one type in the same physical groups.
#[derive(Clone, Debug)]
pub(super) struct ElementBlock {
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

impl ElementBlock {
    pub fn elements(&self) -> impl Iterator<Item = Element<'_>> {
        let nodes = self.nodes.chunks_exact(self.cell.nodes);
        let each = self.tags.iter().zip(&self.lines).zip(nodes);
        each.map(|((&tag, &line), nodes)| Element { cell: self.cell, tag, line, nodes })
    }
}

impl GmshFile {
    /// The blocks of elements of a dimension, in the order of the file.
    pub(super) fn blocks_of(&self, dimension: usize) -> impl Iterator<Item = &ElementBlock> {
        self.blocks.iter().filter(move |block| block.cell.dimension == dimension)
    }

    /// The highest dimension of elements.
    pub(super) fn highest(&self) -> Option<usize> {
        self.blocks.iter().map(|block| block.cell.dimension).max()
    }

    pub(super) fn fault(&self, line: usize, message: impl Into<String>) -> Error {
        self.form.fault(&self.file, line, message)
    }
}
