//! A scene in motion: its mass and damping, loads and supports that change in time, points that are watched.

pub(crate) mod dynamics;
mod loads_in_time;
mod moving_supports;
pub(crate) mod watched;
