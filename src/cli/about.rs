//! What a page says of where it comes from.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::file::{MOST_OF_TABLE, read_capped};
use crate::output::page::About;

/// The files of a problem directory, in the order in which they are hashed.
const PROBLEM_FILES: [&str; 4] = ["K.mtx", "f.mtx", "B.mtx", "g.mtx"];

/// The page of `command` on the scene file or problem directory `input`, which is hashed as it stands now, if there is a folder for
/// the page.
pub(super) fn about(title: &str, command: &'static str, input: &Path, out: Option<&PathBuf>, threads: usize) -> About {
    let name = input.file_name().map_or_else(|| "-".to_string(), |name| name.to_string_lossy().into_owned());
    About::new(title.to_string(), command, name, out.and_then(|_| hash_of(input)), threads)
}

/// SHA-256 in hexadecimal digits; none of what cannot be read twice, as standard input.
fn hash_of(input: &Path) -> Option<String> {
    let files = match input.is_dir() {
        true => PROBLEM_FILES.iter().map(|name| input.join(name)).collect(),
        false => vec![input.to_path_buf()],
    };
    let mut hash = hmac_sha256::Hash::new();
    for file in files {
        if !file.is_file() {
            return None;
        }
        hash.update(read_capped(&file, MOST_OF_TABLE).ok()?);
    }
    Some(hash.finalize().iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}
