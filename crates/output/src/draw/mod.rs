//! A drawing: shapes in the plane, written as SVG and painted as PNG and PDF with an embedded typeface.

pub(crate) mod animation;
pub(crate) mod colour;
pub(crate) mod drawing;
pub(crate) mod paint;
mod pdf;
mod raster;
mod shape;
mod svg;
pub(crate) mod typeface;
