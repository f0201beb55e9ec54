//! `report.html`: one file that shows a question and its answer in any browser, and loads nothing else.
//!
//! A page is data first: `model::Page` is serialised as JSON into the file, beside it one block of packed arrays (`packed`), and the
//! scripts of this folder draw these data. The numbers are those of the JSON report, which the page contains unchanged.

mod about;
mod along;
mod body;
mod html;
mod model;
mod motion;
mod packed;
mod plots;
mod question;
mod rows;
mod search;
mod state;
mod sweep;
mod write;

pub(crate) use about::About;
pub(crate) use motion::MotionFrames;
pub(crate) use write::{
    write_answer_page, write_comparison_page, write_motion_page, write_problem_page, write_sweep_page,
    write_total_error_page, write_tradeoff_page,
};
