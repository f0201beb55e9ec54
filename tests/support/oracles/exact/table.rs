//! Counts the faults for each kind of stiffness and each kind of rows.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::judge::Sort;
use super::trial::{Report, Trial};

/// Largest share of the problems of one kind that may be refused, and of those without an answer that may be missed;
/// one is always allowed.
const RARE: f64 = 1e-3;

/// The problems of one kind.
#[derive(Clone, Debug, Default)]
struct Line {
    problems: usize,
    /// Number of problems of each exact verdict.
    verdicts: BTreeMap<&'static str, usize>,
    /// Number of problems that must be certified, and number that must be found to have no answer.
    fair: usize,
    other: usize,
    /// Number of problems with a fault of each sort.
    faults: BTreeMap<Sort, usize>,
    worst_factor: f64,
    longest: f64,
}

impl Line {
    fn add(&mut self, report: &Report) {
        self.problems += 1;
        *self.verdicts.entry(report.verdict).or_default() += 1;
        self.fair += usize::from(report.is_fair);
        self.other += usize::from(report.verdict != "solved" && !report.is_borderline);
        for sort in Sort::ALL {
            let is_at_fault = report.faults.iter().any(|fault| fault.sort == sort);
            *self.faults.entry(sort).or_default() += usize::from(is_at_fault);
        }
        self.worst_factor = report.faults.iter().fold(self.worst_factor, |worst, fault| worst.max(fault.factor));
        self.longest = self.longest.max(report.longest);
    }

    fn count(&self, sort: Sort) -> usize {
        self.faults.get(&sort).copied().unwrap_or(0)
    }

    fn of(&self, sort: Sort) -> usize {
        match sort {
            Sort::Refused => self.fair,
            Sort::Hard => self.verdicts.get("solved").map_or(0, |solved| solved - self.fair),
            _ => self.other,
        }
    }

    /// Returns `true` if a sort of fault is more frequent than allowed.
    fn exceeds(&self, sort: Sort) -> bool {
        let count = self.count(sort);
        match sort {
            Sort::Hard => false,
            Sort::Refused | Sort::Missed => count > 1 && count as f64 > RARE * self.of(sort) as f64,
            _ => count > 0,
        }
    }

    fn row(&self, name: &str) -> String {
        let verdict = |name| self.verdicts.get(name).copied().unwrap_or(0);
        let share = |sort| match self.of(sort) {
            0 => "-".to_string(),
            of => format!("{} ({:.2} %)", self.count(sort), 100.0 * self.count(sort) as f64 / of as f64),
        };
        let worst = if self.worst_factor > 0.0 { format!(" ({:.1e})", self.worst_factor) } else { String::new() };
        format!(
            "{name:<18}{:>7}{:>7}{:>6}{:>6}{:>6}{:>6} |{:>18}{:>8}{:>7}{:>7}{:>9}{:>10}{:>7}{:>6} |{:>16}{:>16}{:>16}{:>9.1}",
            self.problems,
            verdict("solved"),
            verdict("under-held"),
            verdict("infeasible"),
            verdict("unbounded"),
            verdict("not-convex"),
            format!("{}{worst}", self.count(Sort::Bound)),
            self.count(Sort::Rounded),
            self.count(Sort::Proof),
            self.count(Sort::Claim),
            self.count(Sort::Evidence),
            self.count(Sort::Certified),
            self.count(Sort::Panic),
            self.count(Sort::Slow),
            share(Sort::Refused),
            share(Sort::Missed),
            share(Sort::Hard),
            1e3 * self.longest
        )
    }
}

/// The counts of a run of exact trials, by stiffness and by rows.
#[derive(Clone, Debug, Default)]
pub struct Table {
    kinds: BTreeMap<&'static str, Line>,
    rows: BTreeMap<&'static str, Line>,
    all: Line,
}

impl Table {
    pub fn add(&mut self, trial: &Trial, report: &Report) {
        self.kinds.entry(trial.kind).or_default().add(report);
        self.rows.entry(trial.rows).or_default().add(report);
        self.all.add(report);
    }

    pub fn count(&self, sort: Sort) -> usize {
        self.all.count(sort)
    }

    /// The forbidden faults that occurred, in words.
    pub fn failures(&self) -> Vec<String> {
        let forbidden = Sort::ALL.into_iter().filter(|sort| sort.is_forbidden() && self.count(*sort) > 0);
        let mut failures: Vec<String> = forbidden
            .map(|sort| format!("{} problems with a fault of the sort `{}`", self.count(sort), sort.name()))
            .collect();
        failures.extend(self.frequent());
        failures
    }

    /// The kinds of stiffness for which too many problems are refused or missed.
    pub fn frequent(&self) -> Vec<String> {
        let mut frequent = Vec::new();
        for (name, line) in &self.kinds {
            for sort in [Sort::Refused, Sort::Missed].into_iter().filter(|&sort| line.exceeds(sort)) {
                let (count, of) = (line.count(sort), line.of(sort));
                frequent.push(format!("{count} of {of} problems {} with the stiffness `{name}`", sort.name()));
            }
        }
        frequent
    }

    pub fn text(&self) -> String {
        let mut text = String::new();
        let head = format!(
            "{:>7}{:>7}{:>6}{:>6}{:>6}{:>6} |{:>18}{:>8}{:>7}{:>7}{:>9}{:>10}{:>7}{:>6} |{:>16}{:>16}{:>16}{:>9}",
            "problem",
            "solved",
            "under",
            "infea",
            "unbou",
            "indef",
            "bound (factor)",
            "rounded",
            "proof",
            "claim",
            "evidence",
            "certified",
            "panic",
            "slow",
            "refused",
            "missed",
            "hard",
            "ms"
        );
        for (title, lines) in [("stiffness", &self.kinds), ("rows", &self.rows)] {
            // Writing into a String cannot fail.
            let _ = writeln!(text, "{title:<18}{head}");
            for (name, line) in lines {
                let _ = writeln!(text, "{}", line.row(name));
            }
            text.push('\n');
        }
        let _ = writeln!(text, "{}", self.all.row("all"));
        text
    }
}
