//! Warnings: models that can be solved but may mislead, and answers to be read with care, with a remedy.

use std::fmt;

use serde::Serialize;

/// A fact about a scene or an answer that a reader should know, certified or not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// The name of the kind of warning, the same in every version.
    pub code: &'static str,
    /// The fact with its numbers, its likely cause, and a remedy.
    pub message: String,
}

impl Warning {
    #[doc(hidden)]
    pub fn new(code: &'static str, message: impl Into<String>) -> Self {
        Warning { code, message: message.into() }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.message)
    }
}
