//! A scene in motion: its mass and damping, loads and supports that change in time, points that are watched.

pub(crate) mod dynamics;
pub(crate) mod moving_supports;
