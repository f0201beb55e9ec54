//! Counts the broken promises of each program in each class.

use support::oracles::promises::program::Program;
use support::oracles::promises::trial::{Class, Findings, Sort};

/// Problems of one class: certified ones, and those with a fault of each sort.
#[derive(Clone, Copy, Default)]
struct Counts {
    certified: usize,
    faults: [usize; Sort::ALL.len()],
}

/// The counts of a run of promises, by class and program.
pub struct Table {
    problems: [usize; Class::ALL.len()],
    /// For each program, for each class.
    counts: Vec<[Counts; Class::ALL.len()]>,
}

impl Table {
    pub fn new(programs: usize) -> Self {
        Table { problems: [0; Class::ALL.len()], counts: vec![[Counts::default(); Class::ALL.len()]; programs] }
    }

    pub fn add(&mut self, class: Class, findings: &[Findings]) {
        self.problems[class as usize] += 1;
        for (counts, found) in self.counts.iter_mut().zip(findings) {
            let counts = &mut counts[class as usize];
            counts.certified += usize::from(found.is_certified);
            for sort in Sort::ALL {
                counts.faults[sort as usize] += usize::from(found.faults.iter().any(|fault| fault.sort == sort));
            }
        }
    }

    /// The number of faults of the first program.
    pub fn faults(&self) -> usize {
        self.counts[0].iter().flat_map(|counts| counts.faults).sum()
    }

    /// One row for each class; for each program the certified problems and those with a fault of each sort.
    pub fn text(&self, programs: &[Program]) -> String {
        let mut text = format!("{:21}", "");
        programs.iter().for_each(|program| text += &format!(" | {:<50}", program.0.display().to_string()));
        text += &format!("\n{:<13}{:>8}", "class", "problems");
        let names: String = Sort::ALL.iter().map(|sort| format!("{:>8}", sort.name())).collect();
        programs.iter().for_each(|_| text += &format!(" | {:>10}{names}", "certified"));
        for class in Class::ALL {
            text += &format!("\n{:<13}{:>8}", class.name(), self.problems[class as usize]);
            for counts in self.counts.iter().map(|counts| counts[class as usize]) {
                let faults: String = counts.faults.iter().map(|count| format!("{count:>8}")).collect();
                text += &format!(" | {:>10}{faults}", counts.certified);
            }
        }
        text
    }
}
