//! Plots: quantities with units along axes, lines and marks, legends and bars of colours.

pub(crate) mod axes;
mod beside;
pub(crate) mod colour_bar;
pub(crate) mod legend;
pub(crate) mod medium;
pub(crate) mod plot;
pub(crate) mod style;
pub(crate) mod ticks;
