//! Runs a binary of the program in a folder, and reads what it prints and writes.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use signorini::ContactProblem;
use signorini::qp::{format_vector, read_vector};

/// A binary of the program.
#[derive(Clone, Debug)]
pub struct Program(pub PathBuf);

/// What a run printed and wrote.
#[derive(Clone, Debug)]
pub struct Ending {
    /// The exit code; -1 if a signal ended the run.
    pub code: i32,
    /// The report; null if there is none.
    pub report: Value,
    /// u and lambda; `None` if the run wrote none.
    pub answer: Option<(Vec<f64>, Vec<f64>)>,
    /// The last line of standard error.
    pub sentence: String,
}

impl Ending {
    pub fn is_certified(&self) -> bool {
        self.code == 0 && self.report["status"] == "certified"
    }

    /// A number of the certificate; `None` if it is not printed, or infinite.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.report["certificate"][name].as_f64()
    }

    pub fn is_at_rest(&self) -> bool {
        self.report["certificate"]["at_rest"] == true
    }
}

/// Writes the four files of a problem into a directory.
pub fn write(directory: &Path, problem: &ContactProblem) -> io::Result<()> {
    fs::create_dir_all(directory)?;
    problem.files()[..4].iter().try_for_each(|file| fs::write(directory.join(file.name), file.text()))
}

impl Program {
    fn run(&self, arguments: &[&OsStr]) -> io::Result<Ending> {
        let output = Command::new(&self.0).args(arguments).stdin(Stdio::null()).output()?;
        let said = String::from_utf8_lossy(&output.stderr);
        Ok(Ending {
            code: output.status.code().unwrap_or(-1),
            report: serde_json::from_slice(&output.stdout).unwrap_or_default(),
            answer: None,
            sentence: said.lines().last().unwrap_or_default().to_string(),
        })
    }

    /// Solves the problem of a directory.
    pub fn solve(&self, directory: &Path) -> io::Result<Ending> {
        let out = directory.join("out");
        if out.exists() {
            fs::remove_dir_all(&out)?;
        }
        let options = ["--format", "json", "--pictures", "none", "--out"].map(OsStr::new);
        let arguments = [&["solve".as_ref(), directory.as_os_str()], &options[..], &[out.as_os_str()]].concat();
        let mut ending = self.run(&arguments)?;
        let vector = |name: &str| read_vector(&out.join(name)).ok();
        ending.answer = vector("u.mtx").zip(vector("lambda.mtx"));
        Ok(ending)
    }

    /// Verifies an answer to the problem of a directory.
    pub fn verify(&self, directory: &Path, displacement: &[f64], multiplier: &[f64]) -> io::Result<Ending> {
        let (u, lambda) = (directory.join("u.mtx"), directory.join("lambda.mtx"));
        fs::write(&u, format_vector(displacement))?;
        fs::write(&lambda, format_vector(multiplier))?;
        let words = ["verify", "--format", "json", "--displacement"].map(OsStr::new);
        let files = [u.as_os_str(), "--multiplier".as_ref(), lambda.as_os_str(), directory.as_os_str()];
        let mut ending = self.run(&[&words[..], &files].concat())?;
        ending.answer = Some((displacement.to_vec(), multiplier.to_vec()));
        Ok(ending)
    }
}
