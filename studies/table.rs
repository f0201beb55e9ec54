//! Tables in Markdown, and the folders in which they are kept. Bars separate the cells of a row.

use std::path::Path;

use signorini::Error;
use signorini::output::write_files;

/// The heading of a table, with the line below it.
pub fn heading(cells: &str) -> String {
    format!("{}|{}\n", row(cells), "---|".repeat(cells.split('|').count()))
}

pub fn row(cells: &str) -> String {
    format!("| {cells} |\n")
}

/// A table as a whole.
pub fn table(cells: &str, rows: &[String]) -> String {
    heading(cells) + &rows.iter().map(|cells| row(cells)).collect::<String>()
}

/// The same table as comma-separated values.
pub fn csv(cells: &str, rows: &[String]) -> String {
    let quoted = |row: &str| row.split(" | ").map(|cell| format!("\"{cell}\"")).collect::<Vec<_>>().join(",") + "\n";
    [cells].into_iter().chain(rows.iter().map(String::as_str)).map(quoted).collect()
}

/// Prints a text, and writes it with other files into the folder, if there is one.
pub fn show(text: &str, folder: Option<&Path>, name: &str, others: &[(String, String)]) -> Result<(), Error> {
    print!("{text}");
    let Some(folder) = folder else { return Ok(()) };
    let files = others.iter().map(|(name, text)| (name.as_str(), text.clone()));
    write_files(folder, &files.chain([(name, text.to_string())]).collect::<Vec<_>>()).map(drop)
}
