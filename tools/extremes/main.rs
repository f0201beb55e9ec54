//! Prints the stability table: problems with extreme data and known solutions, one column for each method.
//!
//! `cargo run --release --example extremes`; `-- --most DOFS` leaves out larger bodies. A cell is the number of right
//! digits of a certified answer, or the error that refuses the problem, or `wrong`. The column `QP raw` is Clarabel
//! with its defaults on the unscaled data; there, the digits are those of the answers that Clarabel calls solved. A
//! `wrong` in any other column makes the command fail.

use std::process::ExitCode;

use support::extremes::cases;
use support::extremes::entry::{COLUMNS, Cell};

/// The results of all entries of one kind, column by column.
struct Group {
    name: &'static str,
    entries: usize,
    cells: [Vec<Cell>; COLUMNS.len()],
}

impl Group {
    /// Returns one line: the smallest and the largest number of digits, and the numbers of refused and wrong answers.
    fn line(&self) -> String {
        let texts = self.cells.iter().map(|cells| {
            let digits =
                cells.iter().filter_map(|cell| if let Cell::Digits(digits) = cell { Some(digits) } else { None });
            let mut parts = Vec::new();
            match (digits.clone().min(), digits.max()) {
                (Some(least), Some(most)) if least == most => parts.push(least.to_string()),
                (Some(least), Some(most)) => parts.push(format!("{least}-{most}")),
                _ => {}
            }
            let refused = cells.iter().filter(|cell| matches!(cell, Cell::Refused(_))).count();
            let wrong = cells.iter().filter(|cell| **cell == Cell::Wrong).count();
            let counted = [(refused, "refused"), (wrong, "**wrong**")];
            parts.extend(counted.iter().filter(|(count, _)| *count > 0).map(|(count, word)| format!("{count} {word}")));
            if parts.is_empty() { "-".to_string() } else { parts.join(", ") }
        });
        format!("| {} | {} | {} |", self.name, self.entries, texts.collect::<Vec<_>>().join(" | "))
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let most = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => usize::MAX,
        ["--most", dofs] if dofs.parse::<usize>().is_ok() => dofs.parse().unwrap_or(usize::MAX),
        _ => {
            eprintln!("usage: extremes [--most DOFS]");
            return ExitCode::from(2);
        }
    };
    let entries = match cases::entries(most) {
        Ok(entries) => entries,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::FAILURE;
        }
    };
    println!("| extreme | | {} |\n|---|---|{}", COLUMNS.join(" | "), "---|".repeat(COLUMNS.len()));
    let (mut group, mut wrong) = ("", [0; COLUMNS.len()]);
    let mut groups: Vec<Group> = Vec::new();
    for entry in &entries {
        let cells = entry.row();
        let named = if entry.group == group { "" } else { entry.group };
        if entry.group != group {
            groups.push(Group { name: entry.group, entries: 0, cells: Default::default() });
        }
        group = entry.group;
        let texts: Vec<String> = cells.iter().map(Cell::to_string).collect();
        println!("| {named} | {} | {} |", entry.label, texts.join(" | "));
        if let Some(group) = groups.last_mut() {
            group.entries += 1;
            group.cells.iter_mut().zip(&cells).for_each(|(all, cell)| all.push(cell.clone()));
        }
        wrong.iter_mut().zip(&cells).for_each(|(count, cell)| *count += usize::from(*cell == Cell::Wrong));
    }
    println!("\n| extreme | entries | {} |\n|---|---|{}", COLUMNS.join(" | "), "---|".repeat(COLUMNS.len()));
    groups.iter().for_each(|group| println!("{}", group.line()));
    println!(
        "\n{} entries; wrong: {} by QP raw, {} otherwise",
        entries.len(),
        wrong[0],
        wrong[1..].iter().sum::<usize>()
    );
    if wrong[1..].iter().all(|&count| count == 0) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
