//! The folders in which problems are written, and the seed of those who name none.

use std::fs;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use signorini::ContactProblem;
use signorini::qp::format_vector;
use support::oracles::promises::program::write;

/// Makes a folder for the files of a problem, in memory if the system has such a place.
pub fn desk() -> std::io::Result<tempfile::TempDir> {
    let memory = Path::new("/dev/shm");
    if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }
}

/// Writes a problem directory, with an answer if there is one, and a text about it.
pub fn save(
    folder: &Path,
    problem: &ContactProblem,
    answer: Option<&(Vec<f64>, Vec<f64>)>,
    text: &str,
) -> std::io::Result<()> {
    write(folder, problem)?;
    if let Some((u, lambda)) = answer {
        fs::write(folder.join("u.mtx"), format_vector(u))?;
        fs::write(folder.join("lambda.mtx"), format_vector(lambda))?;
    }
    fs::write(folder.join("README.txt"), text)
}

/// A seed by the clock.
pub fn seed() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |since| since.as_nanos() as u64 % 1_000_000_007)
}
