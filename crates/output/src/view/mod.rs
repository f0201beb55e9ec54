//! What is shown of a model and of its answer, as plain data: each medium (page, picture, `.vtu`) renders it.

pub(crate) mod along;
// Only the output in the folders shows its sweeps.
pub(crate) mod curves;
pub(crate) mod field;
pub(crate) mod iterations;
pub(crate) mod limits;
pub(crate) mod magnified;
pub(crate) mod obstacle;
pub(crate) mod pressure;
pub(crate) mod words;
