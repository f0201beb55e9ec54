//! The one place that catches panics of libraries: only calls that solve and factorise are wrapped in it.
//!
//! The code of this crate does not panic on any input. For a library nobody can promise that, and a panic that crosses
//! it ends the caller's program too.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs `work`, a call of a library that changes nothing which outlives it; a panic is returned as its message.
///
/// # Errors
/// The message of the panic.
#[expect(clippy::disallowed_methods, reason = "the one place")]
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    // Data that `work` has left half done are dropped with it.
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| format!("it panicked: {}", message(&*panic)))
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let literal = panic.downcast_ref::<&str>().copied();
    literal.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("without a message")
}

#[cfg(test)]
mod tests {
    use super::guarded;

    #[test]
    fn a_panic_of_a_library_is_an_error_with_its_message() {
        assert_eq!(guarded(|| 1), Ok(1));
        let formatted: Result<(), String> = guarded(|| panic!("{} of {}", 1, 2));
        assert_eq!(formatted, Err("it panicked: 1 of 2".into()));
        let odd: Result<(), String> = guarded(|| std::panic::panic_any(7));
        assert_eq!(odd, Err("it panicked: without a message".into()));
        let beyond: Result<usize, String> = guarded(|| [1, 2, 3].get(7).copied().unwrap());
        assert!(beyond.unwrap_err().contains("None"));
    }
}
