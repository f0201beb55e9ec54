//! One random problem, its exact answer, and what each statement of the program about it is worth.

use std::io;
use std::path::Path;

use super::draw::problem;
use super::exact::case::Case;
use super::exact::dyadic::{Dyadic, dot, ratio, root_of_ratio};
use super::exact::measure::Errors;
use super::exact::problem::Exact;
use super::exact::solve::{Answer, Outcome};
use super::program::{Ending, Program, write};

/// The tolerance that the program is asked for, which is its default.
const TOLERANCE: f64 = 1e-9;

/// Largest condition of the equilibrated stiffness that is not hard.
const CONDITIONED: f64 = 1e8;

/// Largest forces of the classes benign, wall and hard, relative to `|u*|_K`.
const FORCES: [f64; 3] = [1e6, 1e10, 1e16];

/// What is difficult about a problem, by its data and its exact answer alone. F is the largest `|F_i| / sqrt(K_ii)`
/// over loads and contact forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// F is below 1e6 |u*|_K.
    Benign,
    /// F is below 1e10 |u*|_K: contact takes over a load.
    Wall,
    /// F is below 1e16 |u*|_K, or the condition is above 1e8.
    Hard,
    /// Doubles cannot hold u* and the forces together.
    Beyond,
    /// u* = 0.
    Rest,
}

impl Class {
    pub const ALL: [Class; 5] = [Class::Benign, Class::Wall, Class::Hard, Class::Beyond, Class::Rest];

    pub fn name(self) -> &'static str {
        match self {
            Class::Benign => "benign",
            Class::Wall => "load on wall",
            Class::Hard => "hard",
            Class::Beyond => "beyond",
            Class::Rest => "at rest",
        }
    }
}

/// Sorts of broken promises.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sort {
    /// A printed bound lies below the error.
    Bound,
    /// A certified answer is not right to the tolerance.
    Wrong,
    /// The exact answer of a problem that moves, rounded to doubles, is refused by `verify`.
    Exact,
    /// A refusal without the dof and the digits that doubles have left there.
    Mute,
    /// A right answer is refused that another program certifies.
    Lost,
}

impl Sort {
    pub const ALL: [Sort; 5] = [Sort::Bound, Sort::Wrong, Sort::Exact, Sort::Mute, Sort::Lost];

    pub fn name(self) -> &'static str {
        match self {
            Sort::Bound => "bound",
            Sort::Wrong => "wrong",
            Sort::Exact => "exact",
            Sort::Mute => "mute",
            Sort::Lost => "lost",
        }
    }
}

/// A broken promise: its sort, the statement and the truth.
#[derive(Clone, Debug)]
pub struct Fault {
    pub sort: Sort,
    pub detail: String,
    /// The answer in question: u and lambda.
    pub answer: Option<(Vec<f64>, Vec<f64>)>,
}

/// What a program did with a problem.
#[derive(Clone, Debug)]
pub struct Findings {
    pub is_certified: bool,
    pub is_right: bool,
    pub faults: Vec<Fault>,
}

/// A random problem of one class with its exact answer.
pub struct Trial {
    pub case: Case,
    pub class: Class,
    pub exact: Exact,
    answer: Answer,
}

impl Trial {
    pub fn draw(seed: u64, number: u64) -> Self {
        let case = problem(seed, number);
        let exact = Exact::new(&case);
        let Outcome::Solved(answer) = exact.outcome() else { panic!("{number} of seed {seed} has no answer") };
        let class = class(&case, &exact, &answer);
        Trial { case, class, exact, answer }
    }

    /// The exact answer, rounded to doubles.
    pub fn rounded(&self) -> (Vec<f64>, Vec<f64>) {
        self.exact.rounded(&self.case, &self.answer)
    }

    /// Writes the problem into a directory, lets each program solve it and verify its exact answer, and compares the
    /// first one with the others.
    pub fn run(&self, programs: &[Program], directory: &Path) -> io::Result<Vec<Findings>> {
        write(directory, &self.case.problem().map_err(io::Error::other)?)?;
        let mut findings = Vec::new();
        for program in programs {
            let mut of_program = self.judged(&program.solve(directory)?);
            let (u, lambda) = self.rounded();
            let verified = program.verify(directory, &u, &lambda)?;
            if self.class != Class::Rest && !verified.is_certified() {
                let detail = format!("verify refuses the exact answer: {}", summary(&verified));
                of_program.faults.push(Fault { sort: Sort::Exact, detail, answer: verified.answer });
            }
            findings.push(of_program);
        }
        std::fs::remove_dir_all(directory)?;
        if let [first, others @ ..] = &mut findings[..]
            && !first.is_certified
            && others.iter().any(|other| other.is_certified && other.is_right)
        {
            let detail = "refused, but another program certifies a right answer".to_string();
            first.faults.push(Fault { sort: Sort::Lost, detail, answer: None });
        }
        Ok(findings)
    }

    /// Compares a solve with the exact answer.
    pub fn judged(&self, ending: &Ending) -> Findings {
        let is_certified = ending.is_certified();
        let mut faults = Vec::new();
        let mut found = |sort, detail| faults.push(Fault { sort, detail, answer: ending.answer.clone() });
        let mut is_right = false;
        let finite = ending.answer.as_ref().filter(|answer| answer.0.iter().chain(&answer.1).all(|x| x.is_finite()));
        if let Some((u, _)) = finite {
            let errors = Errors { case: &self.case, exact: &self.exact, answer: &self.answer };
            let whole = errors.whole(u);
            let (relative, absolute) = (ending.number("energy_error_bound"), ending.number("energy_error"));
            if let Some(bound) = relative.filter(|&bound| !whole.is_within(bound)) {
                found(Sort::Bound, format!("printed {bound:.3e} of |u|_K, but it is {:.3e}", whole.value()));
            } else if let Some(bound) = absolute.filter(|&bound| !errors.is_within(u, bound)) {
                found(Sort::Bound, format!("printed E = {bound:.3e}, but the relative error is {:.3e}", whole.value()));
            }
            // At rest the program states E alone; then the forces must hide the motion.
            let hides = absolute.is_some_and(|bound| errors.is_within(u, bound)) && self.class >= Class::Hard;
            is_right = errors.is_right(u, TOLERANCE) || (ending.is_at_rest() && hides);
            if is_certified && !is_right {
                found(Sort::Wrong, format!("certified, but the error is {:.3e} of |u|_K", whole.value()));
            }
        } else if is_certified {
            found(Sort::Wrong, "certified without an answer in finite numbers".to_string());
        }
        let names = ending.number("worst_dof").is_some() && ending.number("digits_left").is_some();
        if !(is_certified || ending.code == 4 && names) {
            found(Sort::Mute, format!("refused without dof or digits: {}", summary(ending)));
        }
        Findings { is_certified, is_right, faults }
    }
}

/// Exit code, status and tolerance met, or the sentence of an error.
fn summary(ending: &Ending) -> String {
    let said = if ending.sentence.is_empty() { String::new() } else { format!(": {}", ending.sentence) };
    let met = ending.number("met_tolerance").map_or(String::new(), |met| format!(", met {met:.1e}"));
    format!("exit {}, status {}{met}{said}", ending.code, ending.report["status"])
}

fn class(case: &Case, exact: &Exact, answer: &Answer) -> Class {
    let u = &answer.displacement;
    if u.iter().all(Dyadic::is_zero) {
        return Class::Rest;
    }
    let energy = u.iter().zip(&exact.stiffness).map(|(u, line)| u * &dot(line, &answer.displacement));
    let energy = energy.fold(Dyadic::ZERO, |sum, part| &sum + &part);
    let size = root_of_ratio(&energy, &(&answer.denominator * &answer.denominator));
    let of_dof = |dof: usize| {
        let pressed = dot(exact.contact.iter().map(|row| &row[dof]), &answer.force);
        let force = ratio(&pressed, &answer.denominator).abs().max(case.load[dof].abs());
        force / case.stiffness[dof][dof].sqrt()
    };
    let forces = (0..case.dofs()).map(of_dof).fold(0.0, f64::max) / size;
    let (low, high) = case.equilibrated_spectrum();
    let is_conditioned = high < CONDITIONED * low;
    match forces {
        _ if is_conditioned && forces < FORCES[0] => Class::Benign,
        _ if is_conditioned && forces < FORCES[1] => Class::Wall,
        _ if forces < FORCES[2] => Class::Hard,
        _ => Class::Beyond,
    }
}
