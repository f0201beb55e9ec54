//! The stability table: problems with extreme data and known solutions, one column for each method.
//!
//! A cell is the number of right digits of a certified answer, or the error that refuses the problem, or `wrong`. The
//! column `QP raw` is Clarabel with its defaults on the unscaled data; there, the digits are those of the answers that
//! Clarabel calls solved. A `wrong` in any other column makes the study fail.

use support::extremes::cases;
use support::extremes::entry::{COLUMNS, Cell};

use crate::process::{Failure, no_faults};
use crate::table::{heading, row, table};

/// Right digits of every method at extreme data
#[derive(clap::Args)]
pub struct Options {
    /// Leave out bodies of more dofs
    #[arg(long, value_name = "DOFS", default_value_t = usize::MAX, hide_default_value = true)]
    most: usize,
}

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
        format!("{} | {} | {}", self.name, self.entries, texts.collect::<Vec<_>>().join(" | "))
    }
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let columns = COLUMNS.join(" | ");
    print!("{}", heading(&format!("extreme | | {columns}")));
    let (mut group, mut wrong) = ("", [0; COLUMNS.len()]);
    let mut groups: Vec<Group> = Vec::new();
    let entries = cases::entries(options.most)?;
    for entry in &entries {
        let cells = entry.row();
        let named = if entry.group == group { "" } else { entry.group };
        if entry.group != group {
            groups.push(Group { name: entry.group, entries: 0, cells: Default::default() });
        }
        group = entry.group;
        let texts: Vec<String> = cells.iter().map(Cell::to_string).collect();
        print!("{}", row(&format!("{named} | {} | {}", entry.label, texts.join(" | "))));
        wrong.iter_mut().zip(&cells).for_each(|(count, cell)| *count += usize::from(*cell == Cell::Wrong));
        if let Some(group) = groups.last_mut() {
            group.entries += 1;
            group.cells.iter_mut().zip(cells).for_each(|(all, cell)| all.push(cell));
        }
    }
    let lines: Vec<String> = groups.iter().map(Group::line).collect();
    println!("\n{}", table(&format!("extreme | entries | {columns}"), &lines));
    let others = wrong[1..].iter().sum::<usize>();
    println!("{} entries; wrong: {} by QP raw, {others} otherwise", entries.len(), wrong[0]);
    no_faults(others, "answers are wrong")
}
