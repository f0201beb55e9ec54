//! The files of an answer to a deck, in the form of CalculiX: `NAME.frd` with fields, `NAME.dat` with tables,
//! `NAME.sta` with the steps.
//!
//! # Source
//! G. Dhondt, *CalculiX CrunchiX User's Manual*, and K. Wittig, *CalculiX GraphiX User's Manual*, version 2.20, chapter
//! "Result Format"; files that CalculiX 2.20 wrote of the same decks.

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

/// The answers to the steps of a deck, with what the deck asks for, to be written as the files of CalculiX.
pub struct CalculixFiles<'a>(Vec<Content<'a>>);

/// The endings of the files of a run; `frd` is the last one to be written.
const ENDINGS: [&str; 3] = ["dat", "sta", "frd"];

impl<'a> CalculixFiles<'a> {
    /// The files of the answers to the steps of a deck, in their order.
    ///
    /// # Errors
    /// [`Error::Fem`] if the mesh of an answer does not come from a deck.
    pub fn new(steps: &'a [(Answer, Requests)]) -> Result<Self, Error> {
        steps
            .iter()
            .map(|(answer, requests)| Content::new(answer, requests))
            .collect::<Result<_, _>>()
            .map(CalculixFiles)
    }

    /// Removes `NAME.dat`, `NAME.sta` and `NAME.frd` of an earlier run; `stem` is NAME with its folder.
    ///
    /// # Errors
    /// [`qp::LinearError::File`](signorini_qp::LinearError::File) if a file stays.
    pub fn remove(stem: &Path) -> Result<(), Error> {
        let folder = stem.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let name = stem.file_name().unwrap_or_default().to_string_lossy();
        let names = ENDINGS.map(|ending| format!("{name}.{ending}"));
        remove_files(folder, &names.each_ref().map(String::as_str))
    }

    /// Writes `NAME.dat`, `NAME.sta` and at last `NAME.frd`, each as a whole or not at all; `stem` is NAME with its
    /// folder.
    ///
    /// # Errors
    /// [`qp::LinearError::File`](signorini_qp::LinearError::File) if the system refuses,
    /// [`qp::LinearError::NotFinite`](signorini_qp::LinearError::NotFinite) for a value that the form cannot hold, and
    /// those of the recovery of stresses.
    pub fn write(&self, stem: &Path) -> Result<(), Error> {
        let mut tables = Vec::with_capacity(self.0.len());
        let mut fields = Vec::with_capacity(self.0.len());
        for step in &self.0 {
            tables.push((dat::tables(step)?, step.requests.time));
            fields.push(Fields::of(step)?);
        }
        let write = |ending: &str, contents: &dyn Fn(&mut dyn Write) -> io::Result<()>| {
            streamed_atomically(&with_ending(stem, ending), contents)
        };
        write(ENDINGS[0], &|out| {
            let mut all = tables.iter().flat_map(|(tables, time)| tables.iter().map(move |table| (table, *time)));
            all.try_for_each(|(table, time)| table.write(out, time))
        })?;
        write(ENDINGS[1], &|out| sta::write(out, self.0.iter().map(|step| step.requests)))?;
        write(ENDINGS[2], &|out| {
            let mut written = 0;
            fields.first().map_or(Ok(()), |first| first.write_mesh(out))?;
            fields.iter().try_for_each(|step| step.write(out, &mut written))?;
            writeln!(out, " 9999")
        })
    }

    /// What the deck asks for and the files do not have, each with its place if it is known: `PEEQ`,
    /// `*SECTION PRINT (line 7)`.
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
