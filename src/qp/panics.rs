//! The one place that catches panics of libraries: only calls that solve and factorise are wrapped in it.
//!
//! The code of this crate does not panic on any input. For a library nobody can promise that, and a panic that crosses it ends
//! the caller's program too.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs `work`, a call of a library that changes nothing which outlives it; a panic is returned as its message.
///
/// ```
/// use signorini::internals::guarded;
///
/// assert_eq!(guarded(|| 2 + 2), Ok(4));
/// assert_eq!(guarded(|| -> i32 { panic!("no more") }), Err("it panicked: no more".to_string()));
/// ```
///
/// # Errors
/// The message of the panic.
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    // Data that `work` has left half done are dropped with it.
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| format!("it panicked: {}", message(&*panic)))
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let literal = panic.downcast_ref::<&str>().copied();
    literal.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("without a message")
}
