//! The stability table: problems at the extremes with known answers, method by method.
//!
//! `cargo run --release --example extremes`; `-- --most DOFS` leaves out larger bodies. A cell is the number of right
//! digits of a certified answer (of `QP raw`, Clarabel by its defaults on the data as they are: of what it calls solved),
//! or the error that refuses the problem, or `wrong`, which fails the command outside `QP raw`.

mod cases;
mod entry;

use std::process::ExitCode;

use entry::{COLUMNS, Cell};

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
    for entry in &entries {
        let cells = entry.row();
        let named = if entry.group == group { "" } else { entry.group };
        group = entry.group;
        let texts: Vec<String> = cells.iter().map(Cell::to_string).collect();
        println!("| {named} | {} | {} |", entry.label, texts.join(" | "));
        wrong.iter_mut().zip(&cells).for_each(|(count, cell)| *count += usize::from(*cell == Cell::Wrong));
    }
    println!(
        "\n{} entries; wrong: {} by QP raw, {} otherwise",
        entries.len(),
        wrong[0],
        wrong[1..].iter().sum::<usize>()
    );
    if wrong[1..].iter().all(|&count| count == 0) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
