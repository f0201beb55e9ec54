//! The memory that a command may take.

/// Bytes of a size as `500MB` or `1.5GB`.
pub(super) fn parse_size(text: &str) -> Result<f64, String> {
    let form = "it must be a positive number with its unit, such as 500MB or 1.5GB";
    let units = [("kB", 1e3), ("MB", 1e6), ("GB", 1e9), ("TB", 1e12)];
    let split = units.iter().find_map(|&(unit, bytes)| text.strip_suffix(unit).map(|number| (number, bytes)));
    let (number, bytes) = split.ok_or(form)?;
    match number.trim().parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number * bytes),
        _ => Err(form.to_string()),
    }
}
