//! What a reader keeps of an answer: pictures (SVG and PNG) and `.vtu` files for ParaView.
//!
//! Everything here takes plain data (nodes, elements, values, labels) and knows nothing of scenes, meshes or methods.
//! A picture is a [`Drawing`]: its SVG text is the truth, the PNG is that text rasterised with an embedded typeface, so
//! that both show the same on every machine.

mod axes;
pub mod body;
mod colour;
mod colour_bar;
mod contour;
pub mod drawing;
pub mod file;
mod legend;
mod obstacle;
mod paint;
mod panels;
pub mod plot;
mod style;
pub mod ticks;
mod typeface;
pub mod vtu;

pub use body::{ContactPicture, ObstacleLine, common_limits, common_window};
pub use colour::Colour;
pub use drawing::{Anchor, Drawing, Paint};
pub use file::{write_atomically, write_picture};
pub use plot::{Plot, Series, line_plots};
pub use ticks::{Quantity, Scale};
pub use vtu::{Array, Unstructured};
