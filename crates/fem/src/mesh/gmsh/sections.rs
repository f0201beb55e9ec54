//! The sections of a file, of any name, `$Name ... $EndName`, and nodes and elements as each version writes them.

use std::collections::HashMap;
use std::path::Path;

use super::content::{self, GmshFile, announced};
use super::record::{ByteOrder, FileForm, MshSource, Record, Version, shortened};
use crate::error::Error;

/// Error for a file without a mesh header; it quotes no content, which may be private.
const NO_MESH: &str = "this is not a mesh of Gmsh: the section `$MeshFormat`, with the version, must begin here";

/// The sections that are read; each appears once in a file.
const ONCE: [&str; 5] = ["MeshFormat", "PhysicalNames", "Entities", "Nodes", "Elements"];

/// Reads all sections; sections without nodes, elements or groups are skipped.
pub(super) fn read(file: &Path, content: &[u8]) -> Result<GmshFile, Error> {
    let mut source = MshSource::new(file, content);
    let mut content = GmshFile::default();
    let mut entities = Entities::new();
    let mut version = None;
    let mut seen: Vec<&[u8]> = Vec::new();
    while let Some(line) = source.section() {
        let Some(name) = line.strip_prefix(b"$").map(<[u8]>::trim_ascii) else {
            if version.is_none() {
                return Err(source.fault(NO_MESH));
            }
            let message = format!("`{}` stands where a section, as `$MeshFormat`, should begin", shortened(line));
            return Err(source.fault(message));
        };
        if name == b"Comments" {
            source.skip(name)?;
            continue;
        }
        if seen.contains(&name) && ONCE.iter().any(|once| once.as_bytes() == name) {
            return Err(source.fault(format!("there is a second section `${}`", shortened(name))));
        }
        if name != b"MeshFormat" && version.is_none() {
            return Err(source.fault(NO_MESH));
        }
        match (name, version) {
            (b"MeshFormat", _) => version = Some(format(&mut source)?),
            (b"PhysicalNames", _) => content::names(&mut source, &mut content.groups)?,
            (b"Entities", Some(Version::V4)) => read_entities(&mut source, &mut entities)?,
            (b"Nodes", Some(Version::V4)) => nodes_of_version4(&mut source, &mut content)?,
            (b"Elements", Some(Version::V4)) => elements_of_version4(&mut source, &entities, &mut content)?,
            (b"Nodes", _) => nodes_of_version2(&mut source, &mut content)?,
            (b"Elements", _) => elements_of_version2(&mut source, &mut content)?,
            (b"ParametricNodes", _) => {
                let message = "the section $ParametricNodes is not read; save the mesh without parametric coordinates (in Gmsh, `Mesh.SaveParametric = 0`)";
                return Err(source.fault(message));
            }
            (b"PartitionedEntities", _) => {
                return Err(source.fault("the mesh is partitioned; save it in one part"));
            }
            _ => source.skip(name)?,
        }
        seen.push(name);
    }
    for name in ["MeshFormat", "Nodes", "Elements"] {
        if !seen.contains(&name.as_bytes()) {
            return Err(source.fault(format!("the file ends without a section `${name}`")));
        }
    }
    content.finish(source)
}

/// The section `$MeshFormat`: `version file-type data-size`, in binary form then the int 1.
fn format(source: &mut MshSource) -> Result<Version, Error> {
    let begin = source.place();
    let mut line = source.line(|| "the version of the format")?;
    let number = line.finite("the version of the format")?;
    let form = line.whole("the file type, 0 for ASCII or 1 for binary,")?;
    let version = if number == 4.1 {
        Version::V4
    } else if number == 2.2 {
        Version::V2
    } else {
        let message = format!(
            "version {number} of the format is not supported; save the mesh in version 4.1 or 2.2 (in Gmsh, \
             `Mesh.MshFileVersion = 4.1`)"
        );
        return Err(line.fault(message));
    };
    match form {
        0 => {}
        1 => {
            let size = line.whole("the data size")?;
            if size != 8 {
                return Err(line.fault(format!("the data size is {size}; in a binary file it must be 8 bytes")));
            }
            line.end()?;
            let order = byte_order(source)?;
            source.form = FileForm::Binary { order, version, sections: vec![(0, begin)] };
        }
        other => return Err(line.fault(format!("the file type is {other}; it must be 0 for ASCII or 1 for binary"))),
    }
    source.end("MeshFormat")?;
    Ok(version)
}

/// The byte order in which the int 1 is written.
fn byte_order(source: &mut MshSource) -> Result<ByteOrder, Error> {
    match source.take() {
        Some([1, 0, 0, 0]) => Ok(ByteOrder::Little),
        Some([0, 0, 0, 1]) => Ok(ByteOrder::Big),
        Some([a, b, c, d]) => {
            let message = format!(
                "the bytes after this line are {a:02x} {b:02x} {c:02x} {d:02x}; in a binary file they must be 01 00 \
                 00 00 or 00 00 00 01, the number 1, which shows the byte order"
            );
            Err(source.fault(message))
        }
        None => Err(source.fault(
            "the file ends after this line; in a binary file the number 1 must follow, which shows the byte order",
        )),
    }
}

/// The physical groups of an entity, by its dimension and tag.
type Entities = HashMap<(usize, i64), Vec<u64>>;

/// The section `$Entities`: four counts, then `tag box number-of-groups group ...`, points first, then curves, surfaces
/// and volumes.
fn read_entities(source: &mut MshSource, entities: &mut Entities) -> Result<(), Error> {
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
fn nodes_of_version4(source: &mut MshSource, content: &mut GmshFile) -> Result<(), Error> {
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
fn elements_of_version4(source: &mut MshSource, entities: &Entities, content: &mut GmshFile) -> Result<(), Error> {
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

/// The section `$Nodes`: a count, which is text in either form, then `tag x y z`.
fn nodes_of_version2(source: &mut MshSource, content: &mut GmshFile) -> Result<(), Error> {
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
fn elements_of_version2(source: &mut MshSource, content: &mut GmshFile) -> Result<(), Error> {
    let mut line = source.line(|| "the number of elements")?;
    let count = announced(&mut line, "elements")?;
    line.end()?;
    let mut alike = Alike::default();
    for index in 1..=count {
        if alike.left == 0 && matches!(source.form, FileForm::Binary { .. }) {
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
