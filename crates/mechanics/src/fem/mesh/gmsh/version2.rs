//! Nodes and elements as version 2.2 writes them: one a record, the physical group among the tags of an element.

use super::content::{Content, announced};
use super::form::Form;
use super::record::Record;
use super::source::Source;
use crate::error::Error;

/// The section `$Nodes`: a count, which is text in either form, then `tag x y z`.
pub(super) fn nodes(source: &mut Source, content: &mut Content) -> Result<(), Error> {
    let mut line = source.line(|| "the number of nodes")?;
    let count = announced(&mut line, "nodes")?;
    line.end()?;
    for index in 1..=count {
        let mut record = source.record(|| format!("node {index} of {count}"))?;
        let tag = record.whole("the tag of a node")?;
        let at = [record.finite("x")?, record.finite("y")?, record.finite("z")?];
        content.add_node(&record, tag, at)?;
        record.end()?;
    }
    source.end("Nodes")
}

/// The section `$Elements`: a count, which is text in either form, then
/// `tag type number-of-tags physical-group ... node ...`; in binary form `type number-of-elements number-of-tags`
/// precedes elements of one type.
pub(super) fn elements(source: &mut Source, content: &mut Content) -> Result<(), Error> {
    let mut line = source.line(|| "the number of elements")?;
    let count = announced(&mut line, "elements")?;
    line.end()?;
    let mut alike = Alike::default();
    for index in 1..=count {
        if alike.left == 0 && matches!(source.form, Form::Binary { .. }) {
            alike = Alike::read(
                &mut source.record(|| format!("the type of element {index} of {count}"))?,
                count + 1 - index,
            )?;
        }
        let mut record = source.record(|| format!("element {index} of {count}"))?;
        let tag = record.whole("the tag of an element")?;
        if alike.left == 0 {
            alike = Alike { left: 1, number: record.code(TYPE)?, tags: record.whole(TAGS)? };
        }
        let mut groups = Vec::new();
        for place in 0..alike.tags {
            let value = record.integer("a tag of an element")?;
            // The first tag is the physical group, 0 for none; its sign is an orientation.
            if place == 0 && value != 0 {
                groups.push(value.unsigned_abs());
            }
        }
        content.begin_block(&record, alike.number, &groups)?;
        content.add_element(record, tag)?;
        alike.left -= 1;
    }
    source.end("Elements")
}

const TYPE: &str = "the type of an element";
const TAGS: &str = "the number of tags";

/// The type of a run of elements, and the number of elements still to come.
#[derive(Default)]
struct Alike {
    left: usize,
    number: usize,
    tags: usize,
}

impl Alike {
    /// The record before elements in binary form, which announces at most `most` elements.
    fn read(record: &mut Record, most: usize) -> Result<Self, Error> {
        let number = record.code(TYPE)?;
        let left = record.whole("the number of elements of one type")?;
        if left == 0 || left > most {
            let message =
                format!("the number of elements of one type is {left}; it must be 1 to {most}, which are left");
            return Err(record.fault(message));
        }
        Ok(Alike { left, number, tags: record.whole(TAGS)? })
    }
}
