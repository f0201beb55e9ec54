//! Above each table of measured figures a line says when they were printed, at which commit, and by which command.

use std::collections::BTreeMap;
use std::process::Command;

use crate::documents::{documents, read};
use crate::sources::root;

/// Words in the head of a table of figures: units of time and memory, and what was measured.
const HEADS: [&str; 11] =
    ["s", "ms", "seconds", "microseconds", "MB", "GB", "memory", "printed", "figure", "drawn", "time"];

/// Units that follow a measured number.
const UNITS: [&str; 8] = ["s", "ms", "min", "seconds", "microseconds", "kB", "MB", "GB"];

/// Tables that look like figures and are none: their document, their first cell, and the reason.
const NO_FIGURES: [(&str, &str, &str); 2] = [
    ("docs/python.md", "promise", "what tests hold, with a limit of 0.2 s"),
    ("docs/verification.md", "stage", "which tests run, and which are left out because they take 4 s"),
];

/// A table of a document: the line of its head, from 1, and the text before it.
struct Table<'a> {
    line: usize,
    above: &'a str,
    rows: Vec<Vec<String>>,
}

/// The cells of a row, without code, links and formulas.
fn cells(row: &str) -> Vec<String> {
    let plain: String = row.replace("\\|", "").split('`').step_by(2).collect();
    plain.trim().trim_matches('|').split('|').map(|cell| cell.trim().to_string()).collect()
}

/// The tables of a document.
fn tables(text: &str) -> Vec<Table<'_>> {
    let lines: Vec<&str> = text.lines().collect();
    let is_rule = |line: &&&str| line.starts_with('|') && line.chars().all(|letter| "|-: ".contains(letter));
    let starts = lines.iter().enumerate().filter(|(_, line)| is_rule(line)).map(|(at, _)| at - 1);
    // A bar inside code must be escaped.
    let bars = |row: &str| row.replace("\\|", "").matches('|').count();
    let table = |start: usize| {
        let rows = lines[start..].iter().take_while(|line| line.starts_with('|')).map(|row| {
            assert_eq!(bars(row), bars(lines[start]), "{row} has another number of cells than its head");
            cells(row)
        });
        let above = lines[..start].iter().rev().find(|line| !line.is_empty()).copied().unwrap_or_default();
        Table { line: start + 1, above, rows: rows.collect() }
    };
    starts.map(table).collect()
}

/// Returns `true` if a cell begins with a number.
fn is_number(cell: &str) -> bool {
    cell.trim_start_matches(['-', '+', '<', ' ']).starts_with(|first: char| first.is_ascii_digit())
}

/// Returns `true` if a number and a unit of time or memory follow each other in a cell.
fn is_measured(cell: &str) -> bool {
    let words: Vec<&str> = cell.split_whitespace().map(|word| word.trim_matches([',', ';', '(', ')', ':'])).collect();
    words.windows(2).any(|pair| is_number(pair[0]) && UNITS.contains(&pair[1]))
}

impl Table<'_> {
    /// A table of figures has a unit of time or memory in its head or beside a number, or two columns in which at least
    /// half of the cells begin with a number.
    fn has_figures(&self) -> bool {
        let (head, body) = (&self.rows[0], &self.rows[2..]);
        let words = head.iter().flat_map(|cell| cell.split([' ', ',', ';', '[', ']']));
        let numbers = |column: &usize| {
            let is_one = |row: &&Vec<String>| row.get(*column).is_some_and(|cell| is_number(cell));
            2 * body.iter().filter(is_one).count() >= body.len()
        };
        words.into_iter().any(|word| HEADS.contains(&word))
            || body.iter().flatten().any(|cell| is_measured(cell))
            || (0..head.len()).filter(numbers).count() >= 2
    }
}

/// The dates of a line such as ``*Printed on 2026-11-28 at commit 45d3925 by `COMMAND`.*``, each with its commit.
/// `None` if the line has another form.
fn runs(line: &str) -> Option<Vec<(String, String)>> {
    let text = line.strip_prefix('*')?.strip_suffix(".*")?;
    let (text, between, has_command) = match text.strip_prefix("Printed on ") {
        Some(text) => (text, " at commit ", true),
        None => (text.strip_prefix("Committed on ")?, " in ", false),
    };
    let (text, command) = text.split_once(" by `").map_or((text, None), |(text, command)| (text, Some(command)));
    let command = command.map(|command| command.strip_suffix('`'));
    let run = |text: &str| {
        let (date, commit) = text.split_once(between)?;
        let is_date = date.split('-').map(str::len).eq([4, 2, 2]) && date.replace('-', "").parse::<u32>().is_ok();
        let is_commit = commit.len() >= 7 && commit.chars().all(|digit| digit.is_ascii_hexdigit());
        (is_date && is_commit).then(|| (date.to_string(), commit.to_string()))
    };
    let runs: Option<Vec<_>> = text.split(" to ").map(run).collect();
    runs.filter(|_| if has_command { matches!(command, Some(Some(_))) } else { command.is_none() })
}

/// The dates of all commits before this one, by their names; `None` where the history is not there.
fn history() -> Option<BTreeMap<String, String>> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).current_dir(root()).output().ok()?;
        String::from_utf8(output.stdout).ok().filter(|_| output.status.success())
    };
    git(&["rev-parse", "--is-shallow-repository"]).filter(|is_shallow| is_shallow.trim() == "false")?;
    let log = git(&["log", "--format=%H %cs"])?;
    Some(log.lines().filter_map(|line| line.split_once(' ')).map(|(name, date)| (name.into(), date.into())).collect())
}

#[test]
fn a_line_above_each_table_of_figures_names_date_and_commit() {
    let history = history();
    let (mut wrong, mut tables_of_figures) = (Vec::new(), 0);
    for name in documents() {
        let text = read(&name);
        for table in tables(&text).into_iter().filter(Table::has_figures) {
            if NO_FIGURES.iter().any(|(page, cell, _)| *page == name && *cell == table.rows[0][0]) {
                continue;
            }
            tables_of_figures += 1;
            let place = format!("{name}:{}", table.line);
            let Some(runs) = runs(table.above) else {
                wrong.push(format!(
                    "{place}: no line says when these figures were printed: {}",
                    table.rows[0].join(" | ")
                ));
                continue;
            };
            for (date, commit) in runs {
                let found = history.as_ref().map(|all| all.range(commit.clone()..).next());
                let is_known = found.is_none_or(|found| {
                    found.is_some_and(|(name, committed)| name.starts_with(&commit) && *committed <= date)
                });
                wrong.extend((!is_known).then(|| format!("{place}: {commit} is no commit of {date}")));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(tables_of_figures > 40, "{tables_of_figures} tables");
}

#[test]
fn a_table_of_figures_and_the_line_above_it_are_known_by_their_form() {
    let has_figures = |rows: &str| tables(&format!("text\n\n{rows}\n"))[0].has_figures();
    for figures in [
        "| case | seconds |\n|---|---|\n| one | 1.0 |",
        "| page | file |\n|---|---|\n| one | 1.5 MB |",
        "| case | force | error |\n|---|---|---|\n| one | 2.5 | 1e-9 |\n| two | 3 | - |",
    ] {
        assert!(has_figures(figures), "{figures}");
    }
    for words in
        ["| key | meaning |\n|---|---|\n| a | 3 of them |", "| option | result |\n|---|---|\n| `-t 2 s` | an end |"]
    {
        assert!(!has_figures(words), "{words}");
    }
    let run = |date: &str, commit: &str| (date.to_string(), commit.to_string());
    let one = run("2026-11-28", "45d3925");
    assert_eq!(runs("*Printed on 2026-11-28 at commit 45d3925 by `a b`.*"), Some(vec![one.clone()]));
    let two = "*Committed on 2026-11-21 in 9dc7d64 to 2026-11-28 in 45d3925.*";
    assert_eq!(runs(two), Some(vec![run("2026-11-21", "9dc7d64"), one]));
    for wrong in [
        "Printed on 2026-11-28 at commit 45d3925 by `a`.",
        "*Printed on 2026-11-28 at commit 45d3925.*",
        "*Printed in November at commit 45d3925 by `a`.*",
        "*Committed on 2026-11-28 in main.*",
        "text",
    ] {
        assert_eq!(runs(wrong), None, "{wrong}");
    }
}
