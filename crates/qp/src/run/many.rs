//! Many problems, each solved by itself, shared out among threads.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::linear::{in_order, threads_of_machine};
use crate::settings::Settings;

/// The results of `solved` for each number below `count`, in their order, on the threads of `settings`; each solve has
/// one of them. A thread takes the next number when it is free.
pub fn each<T: Send>(count: usize, settings: &Settings, solved: impl Fn(usize, &Settings) -> T + Sync) -> Vec<T> {
    let of_one = Settings { threads: Some(1), ..settings.clone() };
    let threads = settings.threads.unwrap_or_else(threads_of_machine).clamp(1, count.max(1));
    let next = AtomicUsize::new(0);
    let of_thread = |()| -> Vec<(usize, T)> {
        let numbers =
            std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed)).take_while(|&number| number < count);
        numbers.map(|number| (number, solved(number, &of_one))).collect()
    };
    let mut all: Vec<(usize, T)> = in_order(vec![(); threads], of_thread).into_iter().flatten().collect();
    all.sort_unstable_by_key(|of| of.0);
    all.into_iter().map(|of| of.1).collect()
}
