//! The two forms of a file, and how each states a position in it.

use std::path::Path;

use crate::error::Error;
use signorini_linear as linear;

/// The form in which the numbers of a file are written.
#[derive(Clone, Debug)]
pub(super) enum Form {
    /// As words in lines. A position is a line, from 1.
    Text,
    /// As bytes. A position is a byte, from 0.
    Binary {
        order: ByteOrder,
        version: Version,
        /// The byte at which each section begins, and its line: a line ends at every byte 10, as in an editor.
        sections: Vec<(usize, usize)>,
    },
}

/// The byte order of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// The versions of the format that are read; each has its width of tags and counts in binary form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    /// 2.2: four bytes, signed.
    V2,
    /// 4.1: eight bytes, unsigned.
    V4,
}

impl Form {
    /// An error at a position: with its line, or with its byte and the line in which the section begins.
    pub fn fault(&self, file: &Path, place: usize, message: impl Into<String>) -> Error {
        let (line, message) = match self {
            Form::Text => (place, message.into()),
            Form::Binary { sections, .. } => {
                let begun = sections.partition_point(|(begin, _)| *begin <= place);
                let line = sections[..begun].last().map_or(1, |(_, line)| *line);
                (line, format!("at byte {place}: {}", message.into()))
            }
        };
        linear::Error::FileSyntax { file: file.into(), line, message }.into()
    }
}
