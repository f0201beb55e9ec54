//! The two forms of a file, and how each tells a place in it.

use std::path::Path;

use crate::error::Error;

/// How the numbers of a file are written.
#[derive(Clone, Debug)]
pub(super) enum Form {
    /// As words in lines. A place is a line, from 1.
    Text,
    /// As bytes. A place is a byte, from 0.
    Binary {
        order: ByteOrder,
        tags: TagWidth,
        /// The place at which each section begins, and its line: a line ends at every byte 10, as in an editor.
        sections: Vec<(usize, usize)>,
    },
}

/// Which byte of a number comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// How wide tags and counts are in binary form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TagWidth {
    /// Four bytes with a sign, as in version 2.2.
    Int,
    /// Eight bytes without a sign, as in version 4.1.
    Size,
}

impl Form {
    /// A fault at a place: of its line, or of its byte and the line in which the section begins.
    pub fn fault(&self, file: &Path, place: usize, message: impl Into<String>) -> Error {
        let (line, message) = match self {
            Form::Text => (place, message.into()),
            Form::Binary { sections, .. } => {
                let begun = sections.partition_point(|(begin, _)| *begin <= place);
                let line = sections[..begun].last().map_or(1, |(_, line)| *line);
                (line, format!("at byte {place}: {}", message.into()))
            }
        };
        Error::FileSyntax { file: file.into(), line, message }
    }
}
