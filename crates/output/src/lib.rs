//! Output of answers: reports as text, pictures (SVG, PNG, PDF), pages, `.vtu` files for ParaView, folders.
//!
//! ```
//! use signorini_output::{Plot, Quantity, Series, line_plots};
//!
//! let pressure = Series::new("pressure", vec![[0.0, 2.0], [1.0, 1.0], [2.0, 0.0]]);
//! let plot = Plot::new(Quantity::new("position", "mm"), Quantity::new("contact pressure", "MPa"), vec![pressure]);
//! assert!(line_plots("A wedge", &[plot]).svg().contains("contact pressure"));
//! ```
//!
//! Pictures and `.vtu` files take plain data (nodes, elements, values, labels) and know nothing of scenes, meshes or
//! methods; `view` alone takes them from a model and its answer. A picture is a [`Drawing`]: the same shapes are
//! written as SVG and painted as PNG with an embedded typeface, so that both show the same on every machine.

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]

mod draw;
mod file;
mod folder;
mod json;
mod page;
mod picture;
mod plots;
mod reports;
#[cfg(test)]
mod tests;
mod text;
mod view;

pub use draw::drawing::Drawing;
pub use file::{remove_files, remove_shown, write_atomically, write_files, write_streamed};
pub use folder::calculix::CalculixFiles;
pub use folder::gallery::{Pictures, Wanted};
pub use folder::modes::ModesShown;
pub use folder::motion::MotionFolder;
pub use folder::tables::of_model as tables_of_model;
pub use folder::vtu::{Array, Unstructured};
pub use page::About;
pub use plots::medium::Medium;
pub use plots::plot::{Plot, Series, line_plots};
pub use plots::ticks::{Quantity, Scale};
pub use reports::in_words::{InWords, Measured, rows_at_kink, tables_of_places};
pub use reports::motion_report::MotionReport;
#[doc(hidden)]
pub use reports::report::listed;
pub use reports::report::why_text;
pub use text::printable;
pub use view::along::Along;
