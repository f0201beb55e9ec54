//! Output of answers: reports as text and JSON, pictures (SVG and PNG), `.vtu` files for ParaView, problem files.
//!
//! Pictures and `.vtu` files take plain data (nodes, elements, values, labels) and know nothing of scenes, meshes or
//! methods; `gallery` alone fills them from a model and its answer. A picture is a [`Drawing`]: the
//! same shapes are written as SVG and painted as PNG with an embedded typeface, so that both show the same on every machine.

mod animation;
pub(crate) mod arrows;
mod axes;
mod beside;
pub(crate) mod body;
mod certificate;
mod colour;
mod colour_bar;
mod contour;
pub(crate) mod drawing;
#[cfg(feature = "cli")]
mod estimated_error;
mod fields;
pub(crate) mod file;
// The output of the program in its folders; a motion needs only its fields and the scene of a picture.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) mod gallery;
mod inset;
// Only the output in the folders shows them.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
mod iterations;
mod json;
mod legend;
mod magnified;
mod mark;
pub(crate) mod medium;
#[cfg(feature = "cli")]
mod mesh_series;
mod motion;
mod motion_report;
mod motion_table;
mod motion_tradeoff;
#[cfg(feature = "cli")]
mod msh;
mod obstacle;
#[cfg(feature = "cli")]
pub(crate) mod page;
mod paint;
mod panels;
mod pdf;
mod plan;
mod plane_scene;
pub(crate) mod plot;
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
mod pressure;
#[cfg(feature = "cli")]
mod problem_sweep;
mod raster;
mod report;
#[cfg(feature = "cli")]
mod set_up;
mod shape;
mod singular;
mod space;
mod space_scene;
mod style;
mod svg;
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) mod tables;
mod text;
pub(crate) mod ticks;
#[cfg(feature = "cli")]
mod total_error;
mod tradeoff;
mod tradeoff_plot;
mod typeface;
pub(crate) mod vtu;

pub(crate) use body::{ContactPicture, common_window};
pub use drawing::Drawing;
#[cfg(feature = "cli")]
pub(crate) use estimated_error::{estimated_error_text, estimated_meshes_picture, write_estimated_error};
#[cfg(feature = "cli")]
pub(crate) use file::make_folder;
pub(crate) use file::{write_atomically, write_streamed};
pub use file::{write_files, write_picture};
#[cfg(feature = "cli")]
pub(crate) use json::compact_json;
#[cfg(feature = "cli")]
pub(crate) use json::report_json;
pub use motion::MotionFolder;
pub use motion_report::MotionReport;
#[cfg(feature = "cli")]
pub(crate) use motion_tradeoff::motion_tradeoff_plot_for;
pub use motion_tradeoff::{motion_tradeoff_csv, motion_tradeoff_plot, motion_tradeoff_text};
pub use plot::{Plot, Series, line_plots};
#[cfg(feature = "cli")]
pub(crate) use problem_sweep::{draw_problem_sweep, problem_sweep_text, write_points};
#[cfg(feature = "cli")]
pub(crate) use report::why_text;
pub use report::{compare_text, solve_text, sweep_text, verify_text};
#[cfg(feature = "cli")]
pub(crate) use set_up::set_up_picture;
#[cfg(feature = "cli")]
pub(crate) use text::printable;
pub use ticks::{Quantity, Scale};
#[cfg(feature = "cli")]
pub(crate) use total_error::{meshes_picture, total_error_text, write_total_error};
pub use tradeoff::{tradeoff_csv, tradeoff_text};
pub use tradeoff_plot::tradeoff_plot;
#[cfg(feature = "cli")]
pub(crate) use tradeoff_plot::{total_error_plot, tradeoff_plot_for};
pub use vtu::{Array, Unstructured};
