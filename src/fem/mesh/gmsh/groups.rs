//! Physical groups: names for sets of elements.

use std::collections::HashSet;

use super::file::{GmshFile, PhysicalGroup};
use super::lines::{Fields, Lines};
use crate::error::Error;

/// The section `$PhysicalNames`: a count, then `dimension tag "name"`.
pub(super) fn names(lines: &mut Lines, groups: &mut Vec<PhysicalGroup>) -> Result<(), Error> {
    let mut fields = lines.fields(|| "the number of physical names")?;
    let count = fields.whole("the number of physical names")?;
    fields.end()?;
    for index in 1..=count {
        let mut fields = lines.fields(|| format!("physical name {index} of {count}"))?;
        let dimension = fields.whole("the dimension of a physical group")?;
        let tag = fields.integer("the tag of a physical group")?.unsigned_abs();
        let name = quoted(&fields)?;
        if dimension > 3 {
            return Err(
                fields.fault(format!("the physical group `{name}` has dimension {dimension}; at most 3 is one"))
            );
        }
        if groups.iter().any(|group| (group.dimension, group.tag) == (dimension, tag)) {
            return Err(fields.fault(format!("the physical group {tag} of dimension {dimension} is named twice")));
        }
        groups.push(PhysicalGroup { dimension, tag, name, line: fields.line() });
    }
    lines.end("PhysicalNames")
}

fn quoted(fields: &Fields) -> Result<String, Error> {
    let text = fields.text();
    let name = text.split_once('"').and_then(|(_, rest)| rest.strip_suffix('"')).map(str::trim);
    match name {
        Some("") => Err(fields.fault("the name of a physical group is empty")),
        Some(name) => Ok(name.into()),
        None => {
            Err(fields.fault(format!("the name of a physical group must stand in quotes, but the line is `{text}`")))
        }
    }
}

impl GmshFile {
    /// Every named group has elements: a group that is empty is a geometry that was not meshed.
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

    /// The name of a group: its number, where the file gives none.
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
