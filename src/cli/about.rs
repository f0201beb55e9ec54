//! The origin of a page, as the page states it.

use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::output::About;
use crate::qp::file::open_regular;

/// The files of a problem directory in either form, in the order of hashing.
const PROBLEM_FILES: [&[&str]; 2] =
    [&["K.mtx", "f.mtx", "B.mtx", "g.mtx"], &["K.petsc", "f.petsc", "B.petsc", "g.petsc", "free.petsc"]];

/// Bytes that are hashed at a time.
const PIECE: usize = 1 << 20;

/// The page of `command` on the scene file or problem directory `input`. If there is a folder for the page, the present
/// content of `input` is hashed.
pub(super) fn about(
    title: &str,
    command: &'static str,
    input: &Path,
    out: Option<&PathBuf>,
    threads: Option<usize>,
) -> About {
    let name = input.file_name().map_or_else(|| "-".to_string(), |name| name.to_string_lossy().into_owned());
    About::new(title.to_string(), command, name, out.and_then(|_| hash_of(input)), threads)
}

/// SHA-256 in hexadecimal digits; `None` for an input that cannot be read twice, as standard input.
fn hash_of(input: &Path) -> Option<String> {
    let files = match input.is_dir() {
        true => PROBLEM_FILES.iter().map(|names| names.iter().map(|name| input.join(name)).collect()).collect(),
        false => vec![vec![input.to_path_buf()]],
    };
    let files: Vec<PathBuf> = files.into_iter().find(|files: &Vec<PathBuf>| files.iter().all(|file| file.is_file()))?;
    let (mut hash, mut piece) = (hmac_sha256::Hash::new(), vec![0; PIECE]);
    for file in files {
        let (mut file, _) = open_regular(&file).ok()?;
        loop {
            match file.read(&mut piece).ok()? {
                0 => break,
                read => hash.update(&piece[..read]),
            }
        }
    }
    Some(hash.finalize().iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}
