//! Physical groups: names for sets of elements.

use std::collections::HashSet;

use super::file::{GmshFile, PhysicalGroup};
use super::record::Record;
use super::source::{Source, shortened};
use crate::error::Error;

/// The section `$PhysicalNames`, text in either form: a count, then `dimension tag "name"`.
pub(super) fn names(source: &mut Source, groups: &mut Vec<PhysicalGroup>) -> Result<(), Error> {
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
    pub(super) fn check_groups(&self) -> Result<(), Error> {
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
            for block in self.blocks.iter().filter(|block| block.cell.dimension == dimension) {
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
