//! `report.html`: one file that shows a question and its answer in any browser, and loads nothing else.
//!
//! A page is data first: `model::Page` is serialised as JSON into the file, beside it one block of packed arrays
//! (`packed`), and the scripts of this folder draw these data. The numbers are those of the JSON report, which the page
//! contains unchanged.

mod about;
mod along;
mod body;
mod html;
mod model;
mod modes;
mod motion;
mod packed;
mod plots;
mod question;
mod rows;
mod search;
mod state;
mod sweep;
mod write;

pub use about::About;
pub(crate) use motion::MotionFrames;
pub(crate) use write::write_motion_page;
