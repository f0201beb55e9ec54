//! The origin of a page: command, input, version and machine.

use serde::Serialize;

/// The data that a reader needs to reproduce the page.
#[derive(Clone, Debug, Serialize)]
pub struct About {
    /// The title of the page, as text without markup.
    pub title: String,
    /// The command, as `solve`.
    pub command: &'static str,
    /// The name of the scene file or problem directory, without its folder.
    pub input: String,
    /// SHA-256 of the scene file, or of K.mtx, f.mtx, B.mtx and g.mtx one after another, in hexadecimal digits; `None`
    /// for standard input.
    pub sha256: Option<String>,
    /// The number of threads that was asked for; `None` if the program chose it.
    pub threads: Option<usize>,
    /// Version of the program.
    pub version: &'static str,
    /// Operating system and processor, as `linux x86_64`.
    pub machine: String,
}

impl About {
    /// Version and machine are those of this program.
    pub fn new(
        title: String,
        command: &'static str,
        input: String,
        sha256: Option<String>,
        threads: Option<usize>,
    ) -> Self {
        let machine = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
        About { title, command, input, sha256, threads, version: env!("CARGO_PKG_VERSION"), machine }
    }
}
