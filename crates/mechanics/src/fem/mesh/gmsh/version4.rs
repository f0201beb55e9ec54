//! Nodes and elements as version 4.1 writes them: in blocks, one for each entity of the geometry; the physical groups
//! belong to the entities.

use std::collections::HashMap;

use super::content::{Content, announced};
use super::record::Record;
use super::source::Source;
use crate::error::Error;

/// The physical groups of an entity, by its dimension and tag.
pub(super) type Entities = HashMap<(usize, i64), Vec<u64>>;

/// The section `$Entities`: four counts, then `tag box number-of-groups group ...`, points first, then curves, surfaces
/// and volumes.
pub(super) fn entities(source: &mut Source, entities: &mut Entities) -> Result<(), Error> {
    const NAMES: [&str; 4] = ["points", "curves", "surfaces", "volumes"];
    let mut record = source.record(|| "the numbers of points, curves, surfaces and volumes")?;
    let mut counts = [0; 4];
    for (count, name) in counts.iter_mut().zip(NAMES) {
        *count = announced(&mut record, name)?;
    }
    record.end()?;
    for (dimension, (count, name)) in counts.into_iter().zip(NAMES).enumerate() {
        for index in 1..=count {
            let mut record = source.record(|| format!("number {index} of {count} {name}"))?;
            let tag = record.integer("the tag of an entity")?;
            // A point has its coordinates, the other entities their box.
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                record.finite("a coordinate of an entity")?;
            }
            let mut groups = Vec::new();
            for _ in 0..record.whole("the number of physical groups")? {
                // The sign of a group is an orientation.
                groups.push(record.integer("a physical group")?.unsigned_abs());
            }
            // The boundary of the entity is not used.
            if dimension > 0 {
                for _ in 0..record.whole("the number of bounding entities")? {
                    record.integer("a bounding entity")?;
                }
            }
            if entities.insert((dimension, tag), groups).is_some() {
                return Err(record.fault(format!("entity {tag} of dimension {dimension} is given twice")));
            }
        }
    }
    source.end("Entities")
}

/// The section `$Nodes`: in every block first all tags, then all coordinates.
pub(super) fn nodes(source: &mut Source, content: &mut Content) -> Result<(), Error> {
    let mut record = source.record(|| "the number of node blocks")?;
    let counted = record.place();
    let (blocks, count) = counts(&mut record, "nodes")?;
    let mut read = 0;
    for block in 1..=blocks {
        let mut record = source.record(|| format!("node block {block} of {blocks}"))?;
        let dimension = dimension(&mut record)?;
        record.integer("the tag of the entity")?;
        let parameters = match record.code("the sign for parametric coordinates")? {
            0 => 0,
            1 => dimension,
            other => {
                return Err(record.fault(format!("the sign for parametric coordinates is {other}; it must be 0 or 1")));
            }
        };
        let here = announced(&mut record, "nodes in the block")?;
        record.end()?;
        let mut tags = Vec::new();
        for index in 1..=here {
            let mut record = source.record(|| format!("the tag of node {index} of {here} in the block"))?;
            tags.push(record.whole("the tag of a node")?);
            record.end()?;
        }
        for tag in tags {
            let mut record = source.record(|| format!("the coordinates of node {tag}"))?;
            let at = [record.finite("x")?, record.finite("y")?, record.finite("z")?];
            // Not used.
            for _ in 0..parameters {
                record.finite("a parametric coordinate")?;
            }
            content.add_node(&record, tag, at)?;
        }
        read += here;
    }
    if read != count {
        return Err(source.fault_at(counted, format!("{count} nodes are announced, but the blocks hold {read}")));
    }
    source.end("Nodes")
}

/// The section `$Elements`: in every block `tag node ...`.
pub(super) fn elements(source: &mut Source, entities: &Entities, content: &mut Content) -> Result<(), Error> {
    let mut record = source.record(|| "the number of element blocks")?;
    let counted = record.place();
    let (blocks, count) = counts(&mut record, "elements")?;
    let mut read = 0;
    for block in 1..=blocks {
        let mut record = source.record(|| format!("element block {block} of {blocks}"))?;
        let dimension = dimension(&mut record)?;
        let entity = record.integer("the tag of the entity")?;
        let number = record.code("the type of the elements")?;
        let here = announced(&mut record, "elements in the block")?;
        let groups = match entities.get(&(dimension, entity)) {
            Some(groups) => groups.as_slice(),
            // A file without geometry has no entities, and so no groups.
            None if entities.is_empty() => &[],
            None => {
                return Err(
                    record.fault(format!("there is no entity {entity} of dimension {dimension} in `$Entities`"))
                );
            }
        };
        content.begin_block(&record, number, groups)?;
        record.end()?;
        for index in 1..=here {
            let mut record = source.record(|| format!("element {index} of {here} in the block"))?;
            let tag = record.whole("the tag of an element")?;
            content.add_element(record, tag)?;
        }
        read += here;
    }
    if read != count {
        return Err(source.fault_at(counted, format!("{count} elements are announced, but the blocks hold {read}")));
    }
    source.end("Elements")
}

/// The start of a section of blocks: their number, the total number of `what`, the lowest and the highest tag.
fn counts(record: &mut Record, what: &str) -> Result<(usize, usize), Error> {
    let counts = (announced(record, "blocks")?, announced(record, what)?);
    // Tags may have gaps.
    record.whole("the lowest tag")?;
    record.whole("the highest tag")?;
    Ok(counts)
}

fn dimension(record: &mut Record) -> Result<usize, Error> {
    match record.code("the dimension of the entity")? {
        dimension @ 0..=3 => Ok(dimension),
        other => Err(record.fault(format!("the dimension of the entity is {other}; it must be at most 3"))),
    }
}
