//! How much memory a command may take.

/// Bytes of a size as `500MB` or `1.5GB`.
pub(super) fn parse_size(text: &str) -> Result<f64, String> {
    let form = "it must be a positive number with its unit, as 500MB or 1.5GB";
    let units = [("kB", 1e3), ("MB", 1e6), ("GB", 1e9), ("TB", 1e12)];
    let split = units.iter().find_map(|&(unit, bytes)| text.strip_suffix(unit).map(|number| (number, bytes)));
    let (number, bytes) = split.ok_or(form)?;
    match number.trim().parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number * bytes),
        _ => Err(form.to_string()),
    }
}

/// Bytes that the machine can give away, where it says so (on Linux); elsewhere there is no limit.
pub(super) fn available() -> f64 {
    let stated = std::fs::read_to_string("/proc/meminfo").ok();
    let line = stated.iter().flat_map(|text| text.lines()).find(|line| line.starts_with("MemAvailable:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1)).and_then(|number| number.parse::<f64>().ok());
    kilobytes.map_or(f64::INFINITY, |kilobytes| 1024.0 * kilobytes)
}
