//! The files of an answer to a deck, in the form of CalculiX: `NAME.frd` with fields, `NAME.dat` with tables, `NAME.sta` with the step.
//!
//! # Source
//! G. Dhondt, *CalculiX CrunchiX User's Manual*, and K. Wittig, *CalculiX GraphiX User's Manual*, version 2.20, chapter "Result Format";
//! files that CalculiX 2.20 wrote of the same decks.

mod content;
mod dat;
mod frd;
mod numbers;
mod sta;

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::file::{remove_files, streamed_atomically};
use content::Content;
use frd::Fields;
use signorini_mechanics::Error;
use signorini_mechanics::scene::{Answer, Requests};

/// An answer to a deck, with what the deck asks for, to be written as the files of CalculiX.
pub struct CalculixFiles<'a>(Content<'a>);

/// The endings of the files of a run; `frd` is the last one to be written.
const ENDINGS: [&str; 3] = ["dat", "sta", "frd"];

impl<'a> CalculixFiles<'a> {
    /// The files of an answer to a deck.
    ///
    /// # Errors
    /// [`Error::Mesh`] if the mesh of the answer does not come from a deck.
    pub fn new(answer: &'a Answer, requests: &'a Requests) -> Result<Self, Error> {
        Content::new(answer, requests).map(CalculixFiles)
    }

    /// Removes `NAME.dat`, `NAME.sta` and `NAME.frd` of an earlier run; `stem` is NAME with its folder.
    ///
    /// # Errors
    /// [`qp::Error::File`](signorini_qp::Error::File) if a file stays.
    pub fn remove(stem: &Path) -> Result<(), Error> {
        let folder = stem.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let name = stem.file_name().unwrap_or_default().to_string_lossy();
        let names = ENDINGS.map(|ending| format!("{name}.{ending}"));
        remove_files(folder, &names.each_ref().map(String::as_str))
    }

    /// Writes `NAME.dat`, `NAME.sta` and at last `NAME.frd`, each as a whole or not at all; `stem` is NAME with its folder.
    ///
    /// # Errors
    /// [`qp::Error::File`](signorini_qp::Error::File) if the system refuses, [`qp::Error::NotFinite`](signorini_qp::Error::NotFinite) for a
    /// value that the form cannot hold, and those of the recovery of stresses.
    pub fn write(&self, stem: &Path) -> Result<(), Error> {
        let (tables, fields, time) = (dat::tables(&self.0)?, Fields::of(&self.0)?, self.0.requests.time);
        let write = |ending: &str, contents: &dyn Fn(&mut dyn Write) -> io::Result<()>| {
            streamed_atomically(&with_ending(stem, ending), contents)
        };
        write(ENDINGS[0], &|out| tables.iter().try_for_each(|table| table.write(out, time)))?;
        write(ENDINGS[1], &|out| sta::write(out, time))?;
        write(ENDINGS[2], &|out| fields.write(out))
    }

    /// What the deck asks for and the files do not have, each with its place if it is known: `PEEQ`, `*SECTION PRINT (line 7)`.
    pub fn not_given(requests: &Requests) -> Vec<String> {
        let fields = requests.fields.iter().filter(|label| !frd::GIVEN.contains(&label.as_str())).cloned();
        let tables = requests.tables.iter().filter(|table| !dat::is_given(table));
        let tables = tables.map(|table| format!("{} ({})", table.label, table.place));
        fields.chain(tables).chain(requests.others.iter().cloned()).collect()
    }
}

fn with_ending(stem: &Path, ending: &str) -> PathBuf {
    let mut name = OsString::from(stem);
    name.push(format!(".{ending}"));
    name.into()
}
