//! The sections of a file, of any name: `$Name ... $EndName`.

use std::path::Path;

use super::content::Content;
use super::file::GmshFile;
use super::form::{ByteOrder, Form, Version};
use super::source::{Source, shortened};
use super::{groups, version2, version4};
use crate::error::Error;

/// Error for a file without a mesh header; it quotes no content, which may be private.
const NO_MESH: &str = "this is not a mesh of Gmsh: the section `$MeshFormat`, with the version, must begin here";

/// The sections that are read; each appears once in a file.
const ONCE: [&str; 5] = ["MeshFormat", "PhysicalNames", "Entities", "Nodes", "Elements"];

/// Reads all sections; sections without nodes, elements or groups are skipped.
pub(super) fn read(file: &Path, content: &[u8]) -> Result<GmshFile, Error> {
    let mut source = Source::new(file, content);
    let mut content = Content::default();
    let mut entities = version4::Entities::new();
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
            (b"PhysicalNames", _) => groups::names(&mut source, &mut content.groups)?,
            (b"Entities", Some(Version::V4)) => version4::entities(&mut source, &mut entities)?,
            (b"Nodes", Some(Version::V4)) => version4::nodes(&mut source, &mut content)?,
            (b"Elements", Some(Version::V4)) => version4::elements(&mut source, &entities, &mut content)?,
            (b"Nodes", _) => version2::nodes(&mut source, &mut content)?,
            (b"Elements", _) => version2::elements(&mut source, &mut content)?,
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
fn format(source: &mut Source) -> Result<Version, Error> {
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
            source.form = Form::Binary { order, version, sections: vec![(0, begin)] };
        }
        other => return Err(line.fault(format!("the file type is {other}; it must be 0 for ASCII or 1 for binary"))),
    }
    source.end("MeshFormat")?;
    Ok(version)
}

/// The byte order in which the int 1 is written.
fn byte_order(source: &mut Source) -> Result<ByteOrder, Error> {
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
