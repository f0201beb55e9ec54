//! The sections of a file, whichever they are: `$Name ... $EndName`.

use std::path::Path;

use super::content::Content;
use super::file::GmshFile;
use super::lines::{Lines, shortened};
use super::{groups, version2, version4};
use crate::error::Error;

/// The versions of the format that are read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    V2,
    V4,
}

/// Error for a file without a mesh header; it quotes no content, which may be private.
const NO_MESH: &str = "it is no mesh of Gmsh: a section `$MeshFormat` should begin here, which tells the version";

/// Reads all sections; those that say nothing about nodes, elements and groups are passed over.
pub(super) fn read(file: &Path, text: &str) -> Result<GmshFile, Error> {
    // Some editors put a byte order mark in front.
    let mut lines = Lines::new(file, text.strip_prefix('\u{feff}').unwrap_or(text));
    let mut content = Content::default();
    let mut entities = version4::Entities::new();
    let mut version = None;
    let mut seen: Vec<&str> = Vec::new();
    while let Some(line) = lines.next() {
        let Some(name) = line.strip_prefix('$').map(str::trim) else {
            if version.is_none() {
                return Err(lines.fault(NO_MESH));
            }
            let message = format!("`{}` stands where a section, as `$MeshFormat`, should begin", shortened(line));
            return Err(lines.fault(message));
        };
        if name == "Comments" {
            lines.skip(name)?;
            continue;
        }
        if seen.contains(&name) && ["MeshFormat", "PhysicalNames", "Entities", "Nodes", "Elements"].contains(&name) {
            return Err(lines.fault(format!("there is a second section `${name}`")));
        }
        if name != "MeshFormat" && version.is_none() {
            return Err(lines.fault(NO_MESH));
        }
        match (name, version) {
            ("MeshFormat", _) => version = Some(format(&mut lines)?),
            ("PhysicalNames", _) => groups::names(&mut lines, &mut content.groups)?,
            ("Entities", Some(Version::V4)) => version4::entities(&mut lines, &mut entities)?,
            ("Nodes", Some(Version::V4)) => version4::nodes(&mut lines, &mut content)?,
            ("Elements", Some(Version::V4)) => version4::elements(&mut lines, &entities, &mut content)?,
            ("Nodes", _) => version2::nodes(&mut lines, &mut content)?,
            ("Elements", _) => version2::elements(&mut lines, &mut content)?,
            ("PartitionedEntities", _) => {
                return Err(lines.fault("the mesh is partitioned; save it in one part"));
            }
            _ => lines.skip(name)?,
        }
        seen.push(name);
    }
    for name in ["MeshFormat", "Nodes", "Elements"] {
        if !seen.contains(&name) {
            return Err(lines.fault(format!("the file ends without a section `${name}`")));
        }
    }
    content.finish(file, lines.line())
}

/// The section `$MeshFormat`: `version file-type data-size`.
fn format(lines: &mut Lines) -> Result<Version, Error> {
    let mut fields = lines.fields(|| "the version of the format")?;
    let number = fields.finite("the version of the format")?;
    let binary = fields.whole("the file type, 0 for ASCII,")?;
    let version = if number == 4.1 {
        Version::V4
    } else if number == 2.2 {
        Version::V2
    } else {
        let message = format!(
            "version {number} of the format is not read; versions 4.1 and 2.2 are (in Gmsh, `Mesh.MshFileVersion = 4.1`)"
        );
        return Err(fields.fault(message));
    };
    if binary != 0 {
        return Err(fields.fault("the file is binary; save it as ASCII (in Gmsh, `Mesh.Binary = 0`)"));
    }
    lines.end("MeshFormat")?;
    Ok(version)
}
