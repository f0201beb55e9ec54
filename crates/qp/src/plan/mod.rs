//! All decisions of a solve. [`Ladder::of`] says what will be tried, in order, and why, before anything is solved;
//! [`Ladder::next`] says what follows after what was found. `run` carries it out and decides nothing.
//!
//! ```text
//! elimination   pairs of rows that are equalities eliminated, the rest by a ladder of its own
//! pieces        uncoupled parts, each by a ladder of its own
//! with a factor method -> existence, if it met a free motion -> continuation, if unsettled -> dual, if unsettled
//!                 -> refinement and repair, while they gain -> dual, if it falls short -> refinement and repair
//!               the active set after a shortcut; the same on all dofs after a condensation
//! multigrid     MPRGP -> MPRGP to a smaller tolerance, while it settles
//! at the end    existence, if that is in doubt -> proximal steps, if there is an answer -> uniqueness
//! ```
//!
//! [`Method::Auto`] chooses between factor and multigrid by the estimates of `cost` (`choice`); the other one follows
//! if the first is refused or falls short. The layout of a factor (`layout`), and the method on it, are chosen once its
//! pattern is analysed.

mod attempt;
mod choice;
mod history;
mod ladder;
mod layout;
mod nearly_linear;
mod words;

pub(super) use attempt::{Attempt, PATIENCE};
pub(super) use choice::is_bounded_by_factor;
pub use history::{Answered, Best, Ended, History, Record};
pub(super) use history::{From, Means, Step, Tried};
pub(super) use ladder::{Door, Ladder};
pub(super) use layout::Layout;
