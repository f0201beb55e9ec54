//! Answers shown: text, JSON, pictures, files.

mod report;

pub use report::{UnitNames, compare_json, compare_text, solve_json, solve_text};
