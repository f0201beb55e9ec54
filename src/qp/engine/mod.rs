//! Engines: a problem prepared once, and solved for many loads and gaps. One has a factor of the stiffness, the other a
//! multigrid hierarchy.

mod boundary;
mod factored;
mod found;
mod loading;
pub(super) mod multigrid;
mod path;
mod preparation;
mod reduction;
mod refinement;
mod stepping;

pub use boundary::BoundarySolution;
pub use factored::Prepared;
pub use multigrid::Iterative;
pub use path::Path;
