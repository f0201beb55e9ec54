//! Nodes and elements as version 4.1 writes them: in blocks, one for each entity of the geometry; the physical groups
//! belong to the entities.

use std::collections::HashMap;

use super::content::{Content, announced};
use super::lines::Lines;
use crate::error::Error;

/// The physical groups of an entity, by its dimension and tag.
pub(super) type Entities = HashMap<(usize, i64), Vec<u64>>;

/// The section `$Entities`: four counts, then `tag box number-of-groups group ...`, points first, then curves, surfaces
/// and volumes.
pub(super) fn entities(lines: &mut Lines, entities: &mut Entities) -> Result<(), Error> {
    const NAMES: [&str; 4] = ["points", "curves", "surfaces", "volumes"];
    let mut fields = lines.fields(|| "the numbers of points, curves, surfaces and volumes")?;
    let mut counts = [0; 4];
    for (count, name) in counts.iter_mut().zip(NAMES) {
        *count = announced(&mut fields, name)?;
    }
    fields.end()?;
    for (dimension, (count, name)) in counts.into_iter().zip(NAMES).enumerate() {
        for index in 1..=count {
            let mut fields = lines.fields(|| format!("number {index} of {count} {name}"))?;
            let tag = fields.integer("the tag of an entity")?;
            // A point has its place, the others their box.
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                fields.finite("a coordinate of an entity")?;
            }
            let mut groups = Vec::new();
            for _ in 0..fields.whole("the number of physical groups")? {
                // The sign of a group is an orientation.
                groups.push(fields.integer("a physical group")?.unsigned_abs());
            }
            // What bounds the entity follows, and is of no use here.
            if entities.insert((dimension, tag), groups).is_some() {
                return Err(fields.fault(format!("entity {tag} of dimension {dimension} is given twice")));
            }
        }
    }
    lines.end("Entities")
}

/// The section `$Nodes`: in every block first all tags, then all coordinates.
pub(super) fn nodes(lines: &mut Lines, content: &mut Content) -> Result<(), Error> {
    let mut fields = lines.fields(|| "the number of node blocks")?;
    let blocks = announced(&mut fields, "blocks")?;
    let count = announced(&mut fields, "nodes")?;
    let mut read = 0;
    let counted = fields;
    for block in 1..=blocks {
        let mut fields = lines.fields(|| format!("node block {block} of {blocks}"))?;
        fields.integer("the dimension of the entity")?;
        fields.integer("the tag of the entity")?;
        fields.integer("the sign for parametric coordinates")?;
        let here = announced(&mut fields, "nodes in the block")?;
        fields.end()?;
        let mut tags = Vec::new();
        for index in 1..=here {
            let mut fields = lines.fields(|| format!("the tag of node {index} of {here} in the block"))?;
            tags.push(fields.whole("the tag of a node")?);
            fields.end()?;
        }
        for tag in tags {
            // Parametric coordinates may follow, and are of no use here.
            let mut fields = lines.fields(|| format!("the coordinates of node {tag}"))?;
            let at = [fields.finite("x")?, fields.finite("y")?, fields.finite("z")?];
            content.add_node(&fields, tag, at)?;
        }
        read += here;
    }
    if read != count {
        return Err(counted.fault(format!("{count} nodes are announced, but the blocks hold {read}")));
    }
    lines.end("Nodes")
}

/// The section `$Elements`: in every block `tag node ...`.
pub(super) fn elements(lines: &mut Lines, entities: &Entities, content: &mut Content) -> Result<(), Error> {
    let mut fields = lines.fields(|| "the number of element blocks")?;
    let blocks = announced(&mut fields, "blocks")?;
    let count = announced(&mut fields, "elements")?;
    let mut read = 0;
    let counted = fields;
    for block in 1..=blocks {
        let mut fields = lines.fields(|| format!("element block {block} of {blocks}"))?;
        let dimension = fields.whole("the dimension of the entity")?;
        let entity = fields.integer("the tag of the entity")?;
        let number = fields.whole("the type of the elements")?;
        let here = announced(&mut fields, "elements in the block")?;
        let groups = match entities.get(&(dimension, entity)) {
            Some(groups) => groups.as_slice(),
            // A file without geometry has no entities at all, and so no groups.
            None if entities.is_empty() => &[],
            None => {
                return Err(
                    fields.fault(format!("there is no entity {entity} of dimension {dimension} in `$Entities`"))
                );
            }
        };
        content.begin_block(&fields, number, groups)?;
        fields.end()?;
        for index in 1..=here {
            let mut fields = lines.fields(|| format!("element {index} of {here} in the block"))?;
            let tag = fields.whole("the tag of an element")?;
            content.add_element(fields, tag)?;
        }
        read += here;
    }
    if read != count {
        return Err(counted.fault(format!("{count} elements are announced, but the blocks hold {read}")));
    }
    lines.end("Elements")
}
