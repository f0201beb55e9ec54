//! What a command leaves, and what it says on the way.

use std::io::{self, IsTerminal, Write};

use crate::error::Error;

/// How a command ended, as an exit code; a usage error is 2, from the argument parser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    Certified = 0,
    BadInput = 1,
    NoSolution = 3,
    NotCertified = 4,
}

/// What a command leaves: the text for standard output, how it ended, and what is drawn once the text is out.
pub(super) struct Outcome {
    pub text: String,
    pub ending: Ending,
    pub pictures: Option<Pictures>,
}

/// Fields and pictures take their time, and nobody should have to wait for numbers because of them.
pub(super) type Pictures = Box<dyn FnOnce() -> Result<(), Error>>;

/// Takes the line of a terminal that is being written back.
pub(super) const ERASED: &str = "\r\x1b[K";

/// Writes to standard error, on a terminal in place of the line of progress; where it is closed there is nobody to tell.
pub(super) fn warn(text: &str) {
    if text.is_empty() {
        return;
    }
    let erased = if io::stderr().is_terminal() { ERASED } else { "" };
    let _ = io::stderr().write_all(format!("{erased}{text}").as_bytes());
}

impl Outcome {
    pub fn certified(text: String) -> Self {
        Outcome::judged(text, true)
    }

    /// Certified or not, with that exit code.
    pub fn judged(text: String, certified: bool) -> Self {
        let ending = if certified { Ending::Certified } else { Ending::NotCertified };
        Outcome { text, ending, pictures: None }
    }

    pub fn with_pictures(self, pictures: impl FnOnce() -> Result<(), Error> + 'static) -> Self {
        Outcome { pictures: Some(Box::new(pictures)), ..self }
    }
}
