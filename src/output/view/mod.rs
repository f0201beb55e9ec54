//! What is shown of a model and of its answer, as plain data: each medium (page, picture, `.vtu`) renders it.

#[cfg(feature = "cli")]
pub(crate) mod along;
// Only the output in the folders shows its sweeps.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) mod curves;
pub(crate) mod field;
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) mod iterations;
pub(crate) mod limits;
pub(crate) mod magnified;
pub(crate) mod obstacle;
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) mod pressure;
pub(crate) mod words;
