//! How much a test does: the short form runs every time, the long form has more cases and random cases of a new seed.
//!
//! `SIGNORINI_LONG=fresh` asks for the long form, and `SIGNORINI_LONG=SEED` for that of a known seed.

use std::fs::File;
use std::hash::{BuildHasher, RandomState};
use std::io::Write;
use std::path::PathBuf;
use std::sync::LazyLock;

/// The seed of the long form, the same for all tests of a process; `None` in the short form.
static LONG: LazyLock<Option<u64>> =
    LazyLock::new(|| std::env::var("SIGNORINI_LONG").ok().map(|asked| asked_for(&asked)));

/// The seed that `asked` names. It has 32 bits: sums with numbers of cases do not overflow.
fn asked_for(asked: &str) -> u64 {
    match asked {
        "fresh" => RandomState::new().hash_one(()) >> 32,
        seed => seed.parse::<u32>().expect("SIGNORINI_LONG must be `fresh` or a seed below 2^32").into(),
    }
}

/// Returns `short`, or `long` in the long form.
pub fn cases<T>(short: T, long: T) -> T {
    if LONG.is_some() { long } else { short }
}

/// Returns the seed of random cases: `fixed`, or that of the long form. The latter is printed with the name of the
/// test, and kept in `long-seeds.txt` of the target directory.
///
/// # Panics
/// If the file cannot be written.
pub fn seed(fixed: u64) -> u64 {
    let Some(seed) = *LONG else { return fixed };
    let line = format!("{} SIGNORINI_LONG={seed}\n", std::thread::current().name().unwrap_or_default());
    print!("{line}");
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| crate::root().join("target"), PathBuf::from);
    let mut kept = File::options().create(true).append(true).open(target.join("long-seeds.txt")).unwrap();
    kept.write_all(line.as_bytes()).unwrap();
    seed
}
