//! Compares the stability table with the kept one: no entry may lose more than a digit, be refused with another error,
//! or become wrong.
//!
//! `BLESS=1 cargo test --test numerics extremes` writes `tests/extremes.txt` again.

use std::fs;
use std::path::Path;

use support::extremes::cases;
use support::extremes::entry::{COLUMNS, Cell};

/// Larger bodies are left to the command, because they take half a minute.
const MOST_DOFS: usize = 10_000;

/// Number of digits by which machines may differ.
const TO_AND_FRO: u32 = 1;

#[test]
fn no_entry_of_the_stability_table_is_worse_than_the_kept_one() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/extremes.txt");
    let kept = fs::read_to_string(&file).unwrap_or_default();
    let (mut found, mut worse, mut wrong_raw) = (String::new(), Vec::new(), 0);
    let entries = cases::entries(MOST_DOFS).unwrap();
    assert!(entries.len() >= 150);
    for (number, entry) in entries.iter().enumerate() {
        let cells = entry.row();
        let name = format!("{}, {}", entry.group, entry.label);
        let texts: Vec<String> = cells.iter().map(Cell::to_string).collect();
        found += &format!("{name}: {}\n", texts.join(" | "));
        let line = kept.lines().nth(number).unwrap_or_default();
        let before = line.strip_prefix(&format!("{name}: ")).unwrap_or_default();
        let before: Vec<&str> = before.split(" | ").collect();
        for (column, cell) in cells.iter().enumerate() {
            let raw = column == 0;
            // The project makes no promise about the failures of the unscaled method.
            wrong_raw += usize::from(raw && *cell == Cell::Wrong);
            if *cell == Cell::Wrong && !raw {
                worse.push(format!("{name}, {}: a wrong answer", COLUMNS[column]));
            }
            let was = before.get(column).copied().unwrap_or("nothing");
            let stays = match (cell, was.parse::<u32>()) {
                (Cell::Digits(digits), Ok(was)) => digits + TO_AND_FRO >= was,
                _ => cell.to_string() == was,
            };
            if !stays && !raw {
                worse.push(format!("{name}, {}: {cell}, before {was}", COLUMNS[column]));
            }
        }
    }
    assert!(wrong_raw >= 10, "without scaling only {wrong_raw} entries are wrong");
    if std::env::var_os("BLESS").is_some() {
        fs::write(&file, found).unwrap();
        return;
    }
    assert_eq!(kept.lines().count(), entries.len(), "entries were added or left out");
    assert!(worse.is_empty(), "\n{}", worse.join("\n"));
}
