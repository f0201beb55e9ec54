//! Answers shown: reports as text and JSON, pictures (SVG and PNG), `.vtu` files for ParaView, problem files.
//!
//! Pictures and `.vtu` files take plain data (nodes, elements, values, labels) and know nothing of scenes, meshes or
//! methods; `gallery` alone fills them from a model and its answer. A picture is a [`Drawing`]: the
//! same shapes are written as SVG and painted as PNG with an embedded typeface, so that both show the same on every machine.

mod animation;
mod axes;
pub(crate) mod body;
mod colour;
mod colour_bar;
mod contour;
pub(crate) mod drawing;
pub(crate) mod file;
pub(crate) mod gallery;
mod legend;
mod mark;
mod motion;
mod motion_report;
mod motion_tradeoff;
mod obstacle;
mod paint;
mod panels;
pub(crate) mod plot;
mod raster;
mod report;
mod shape;
mod style;
mod svg;
pub(crate) mod ticks;
mod tradeoff;
mod typeface;
pub(crate) mod vtu;

pub use animation::animate;
pub use body::{ContactPicture, ObstacleLine, common_limits, common_window};
pub use colour::Colour;
pub use drawing::{Anchor, Drawing, Paint};
pub use file::{write_atomically, write_files, write_picture};
pub use motion::MotionFolder;
pub use motion_report::{MotionSeconds, motion_is_certified, motion_json, motion_text};
pub use motion_tradeoff::{motion_tradeoff_csv, motion_tradeoff_json, motion_tradeoff_plot, motion_tradeoff_text};
pub use plot::{Plot, Series, line_plots};
pub use report::{
    UnitNames, compare_json, compare_text, printable, solve_json, solve_text, sweep_json, sweep_text, verify_json,
    verify_text,
};
pub use ticks::{Quantity, Scale};
pub use tradeoff::{tradeoff_csv, tradeoff_json, tradeoff_plot, tradeoff_text};
pub use vtu::{Array, Unstructured};
