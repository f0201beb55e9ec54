//! Output of answers: reports as text and JSON, pictures (SVG and PNG), `.vtu` files for ParaView, problem files.
//!
//! Pictures and `.vtu` files take plain data (nodes, elements, values, labels) and know nothing of scenes, meshes or
//! methods; `view` alone takes them from a model and its answer. A picture is a [`Drawing`]: the
//! same shapes are written as SVG and painted as PNG with an embedded typeface, so that both show the same on every machine.

pub(crate) mod draw;
pub(crate) mod file;
pub(crate) mod folder;
mod json;
#[cfg(feature = "cli")]
pub(crate) mod page;
pub(crate) mod picture;
pub(crate) mod plots;
mod reports;
mod text;
pub(crate) mod view;

pub use draw::drawing::Drawing;
#[cfg(feature = "cli")]
pub(crate) use file::{make_folder, remove_files, write_atomically, write_streamed};
pub use file::{write_files, write_picture};
#[cfg(feature = "cli")]
pub(crate) use folder::estimated_error::{estimated_error_text, estimated_meshes_picture, write_estimated_error};
pub use folder::motion::MotionFolder;
#[cfg(feature = "cli")]
pub(crate) use folder::problem_sweep::{draw_problem_sweep, problem_sweep_text, write_points};
#[cfg(feature = "cli")]
pub(crate) use folder::total_error::{meshes_picture, total_error_text, write_total_error};
pub use folder::vtu::{Array, Unstructured};
#[cfg(feature = "cli")]
pub(crate) use folder::{gallery, tables};
#[cfg(feature = "cli")]
pub(crate) use json::compact_json;
#[cfg(feature = "cli")]
pub(crate) use json::report_json;
#[cfg(feature = "cli")]
pub(crate) use picture::set_up::set_up_picture;
#[cfg(feature = "cli")]
pub(crate) use plots::medium;
pub use plots::plot::{Plot, Series, line_plots};
pub use plots::ticks::{Quantity, Scale};
pub use reports::motion_report::MotionReport;
#[cfg(feature = "cli")]
pub(crate) use reports::motion_tradeoff::motion_tradeoff_plot_for;
pub use reports::motion_tradeoff::{motion_tradeoff_csv, motion_tradeoff_plot, motion_tradeoff_text};
#[cfg(feature = "cli")]
pub(crate) use reports::report::why_text;
pub use reports::report::{compare_text, solve_text, sweep_text, verify_text};
pub use reports::tradeoff::{tradeoff_csv, tradeoff_text};
pub use reports::tradeoff_plot::tradeoff_plot;
#[cfg(feature = "cli")]
pub(crate) use reports::tradeoff_plot::{total_error_plot, tradeoff_plot_for};
#[cfg(feature = "cli")]
pub(crate) use text::printable;
#[cfg(feature = "cli")]
pub(crate) use view::along::Along;
#[cfg(feature = "cli")]
pub(crate) use view::curves::{estimated_plot, guaranteed_plot};
