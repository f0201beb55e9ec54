//! A problem prepared once, and solved for many gaps, loads and starts, by the same loop as a single solve.

mod boundary;
mod delassus;
mod path;
mod reuse;

pub use delassus::Delassus;
pub use path::Path;
pub(crate) use path::between;
pub use reuse::Prepared;
