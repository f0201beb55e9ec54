//! Many problems, each solved by itself, shared out among threads.

use crate::linear::{in_order, threads_of_machine};
use crate::settings::Settings;

/// The results of `solved` for each number below `count`, in their order, on the threads of `settings`; each solve has one of them.
pub fn each<T: Send>(count: usize, settings: &Settings, solved: impl Fn(usize, &Settings) -> T + Sync) -> Vec<T> {
    let of_one = Settings { threads: Some(1), ..settings.clone() };
    let numbers: Vec<usize> = (0..count).collect();
    let runs =
        numbers.chunks(count.div_ceil(settings.threads.unwrap_or_else(threads_of_machine).max(1)).max(1)).collect();
    let of_run = |run: &[usize]| -> Vec<T> { run.iter().map(|&number| solved(number, &of_one)).collect() };
    in_order(runs, of_run).into_iter().flatten().collect()
}
