//! What the program prints about random problems, compared with exact arithmetic: it runs as a user runs it, and its
//! words, its displacement and its bounds are read from what it writes.

pub mod draw;
pub mod program;
pub mod trial;

use super::exact;
