//! A request to end, and whether the work has seen it.

use std::sync::atomic::{AtomicBool, Ordering};

/// A request from any thread that work ends, which the work acknowledges.
#[derive(Debug, Default)]
pub(super) struct Cancellation {
    requested: AtomicBool,
    acknowledged: AtomicBool,
}

impl Cancellation {
    pub fn request(&self) {
        self.requested.store(true, Ordering::SeqCst);
    }

    pub fn is_requested(&self) -> bool {
        self.requested.load(Ordering::SeqCst)
    }

    pub fn acknowledge(&self) {
        self.acknowledged.store(true, Ordering::SeqCst);
    }

    pub fn is_acknowledged(&self) -> bool {
        self.acknowledged.load(Ordering::SeqCst)
    }
}
