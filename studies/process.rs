//! How a study fails, and how it measures the memory of a case alone: in a process of its own.

use std::process::{Command, Stdio};

use serde_json::Value;

pub type Failure = Box<dyn std::error::Error>;

/// Fails if there are faults.
pub fn no_faults(faults: usize, what: &str) -> Result<(), Failure> {
    if faults == 0 { Ok(()) } else { Err(format!("{faults} {what}").into()) }
}

/// Runs this program with these words in a new process, and returns the JSON that it prints.
pub fn child(words: &[&str]) -> Result<Value, Failure> {
    let output = Command::new(std::env::current_exe()?).args(words).stderr(Stdio::inherit()).output()?;
    if !output.status.success() {
        return Err(format!("{words:?} failed").into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Returns the memory of this process in bytes, and its peak, or `None` if the system does not report it.
pub fn memory_bytes() -> Option<[f64; 2]> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let entry = |key: &str| -> Option<f64> {
        let line = text.lines().find(|line| line.starts_with(key))?;
        Some(1024.0 * line.split_whitespace().nth(1)?.parse::<f64>().ok()?)
    };
    Some([entry("VmRSS")?, entry("VmHWM")?])
}

/// Returns the peak memory of this process in bytes.
pub fn peak_bytes() -> Option<f64> {
    memory_bytes().map(|[_, peak]| peak)
}
