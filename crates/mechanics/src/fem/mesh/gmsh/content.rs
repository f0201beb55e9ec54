//! The content that both versions fill: nodes by tag, elements in blocks.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::cells::cell_type;
use super::file::{Block, GmshFile, PhysicalGroup};
use super::record::Record;
use super::source::Source;
use crate::error::Error;
use crate::fem::mesh::MAX_NODES;

/// The content of a file while it is read.
#[derive(Default)]
pub(super) struct Content {
    nodes: Vec<[f64; 3]>,
    node_tags: Vec<usize>,
    node_lines: Vec<usize>,
    places: HashMap<usize, usize>,
    blocks: Vec<Block>,
    pub groups: Vec<PhysicalGroup>,
}

impl Content {
    /// Adds the node `tag`, which is in `record`.
    pub fn add_node(&mut self, record: &Record, tag: usize, at: [f64; 3]) -> Result<(), Error> {
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
    pub fn begin_block(&mut self, record: &Record, number: usize, groups: &[u64]) -> Result<(), Error> {
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
        self.blocks.push(Block { cell, groups, tags: Vec::new(), lines: Vec::new(), nodes: Vec::new() });
        Ok(())
    }

    /// Adds the element `tag` to the last block; the rest of `record` is its nodes.
    pub fn add_element(&mut self, mut record: Record, tag: usize) -> Result<(), Error> {
        let Some(block) = self.blocks.last_mut() else { return Ok(()) };
        for _ in 0..block.cell.nodes {
            block.nodes.push(record.whole("the tag of a node")?);
        }
        block.tags.push(tag);
        block.lines.push(record.place());
        record.end()
    }

    /// Replaces the tags of nodes by their indices, and checks that the groups have elements.
    pub fn finish(self, source: Source) -> Result<GmshFile, Error> {
        let Content { nodes, node_tags, node_lines, places, blocks, groups } = self;
        let (file, last_line, form) = (source.file.into(), source.place(), source.form);
        let mut content = GmshFile { file, form, nodes, node_tags, node_lines, blocks, groups, last_line };
        let mut missing = None;
        for block in &mut content.blocks {
            let each = block.cell.nodes;
            for (index, node) in block.nodes.iter_mut().enumerate() {
                match places.get(node) {
                    Some(&place) => *node = place,
                    None => {
                        let element = index / each;
                        missing = missing.or(Some((block.lines[element], block.tags[element], *node)));
                    }
                }
            }
        }
        if let Some((line, element, node)) = missing {
            return Err(content.fault(line, format!("element {element} names node {node}, which does not exist")));
        }
        content.check_groups()?;
        Ok(content)
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
