//! Helpers of the measuring programs: a program runs itself once for every case, so that the memory of each case is
//! measured alone.

use std::process::{Command, ExitCode, Stdio};

use serde_json::Value;

pub type Failure = Box<dyn std::error::Error>;

/// Runs the program with its arguments, and prints an error as one line on standard error.
pub fn ended(run: impl FnOnce(&[&str]) -> Result<(), Failure>) -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments.iter().map(String::as_str).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Returns the argument that follows `name`.
pub fn option<'a>(words: &[&'a str], name: &str) -> Option<&'a str> {
    words.iter().position(|word| *word == name).and_then(|place| words.get(place + 1)).copied()
}

/// Runs this program with `arguments` in a new process, and returns the JSON that it prints.
pub fn child(arguments: &[&str]) -> Result<Value, Failure> {
    let output = Command::new(std::env::current_exe()?).args(arguments).stderr(Stdio::inherit()).output()?;
    if !output.status.success() {
        return Err(format!("{arguments:?} failed").into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Returns the peak memory of this process in bytes, or `None` if the system does not report it.
pub fn peak_bytes() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes * 1024.0)
}
