//! Nodes and elements as version 2.2 writes them: one a line, the physical group among the tags of an element.

use super::content::{Content, announced};
use super::lines::Lines;
use crate::error::Error;

/// The section `$Nodes`: a count, then `tag x y z`.
pub(super) fn nodes(lines: &mut Lines, content: &mut Content) -> Result<(), Error> {
    let mut fields = lines.fields(|| "the number of nodes")?;
    let count = announced(&mut fields, "nodes")?;
    fields.end()?;
    for index in 1..=count {
        let mut fields = lines.fields(|| format!("node {index} of {count}"))?;
        let tag = fields.whole("the tag of a node")?;
        let at = [fields.finite("x")?, fields.finite("y")?, fields.finite("z")?];
        content.add_node(&fields, tag, at)?;
        fields.end()?;
    }
    lines.end("Nodes")
}

/// The section `$Elements`: a count, then `tag type number-of-tags physical-group ... node ...`.
pub(super) fn elements(lines: &mut Lines, content: &mut Content) -> Result<(), Error> {
    let mut fields = lines.fields(|| "the number of elements")?;
    let count = announced(&mut fields, "elements")?;
    fields.end()?;
    for index in 1..=count {
        let mut fields = lines.fields(|| format!("element {index} of {count}"))?;
        let tag = fields.whole("the tag of an element")?;
        let number = fields.whole("the type of an element")?;
        let tags = fields.whole("the number of tags")?;
        let mut groups = Vec::new();
        for place in 0..tags {
            let value = fields.integer("a tag of an element")?;
            // The first tag is the physical group, 0 for none; its sign is an orientation.
            if place == 0 && value != 0 {
                groups.push(value.unsigned_abs());
            }
        }
        content.begin_block(&fields, number, &groups)?;
        content.add_element(fields, tag)?;
    }
    lines.end("Elements")
}
