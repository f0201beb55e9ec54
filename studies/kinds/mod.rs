//! Seconds and iterations of every method on problems from other fields.
//!
//! A line of `ratios` follows each problem: the time of `auto` divided by that of our fastest method, and by that of
//! one linear solve by our own factor, without contact rows (`linear` among the methods). With `--peers` and petsc4py,
//! the line also has the ratios to the fastest solver of PETSc and to one linear solve of PETSc.

mod bodies;
mod growth;
mod noise;
mod peers;
mod problems;
mod unseen;

use std::path::{Path, PathBuf};
use std::time::Duration;

use growth::Times;
use peers::{Interpreter, Peer};
use problems::{KINDS, Kind};
use signorini::{ContactProblem, ContactSet, Error, Method, Scene, Settings, Solution, SparseMatrix, qp, solve};
use unseen::UNSEEN;

use crate::clock::timed;
use crate::process::Failure;

/// Seconds and iterations of every method on problems from other fields
#[derive(clap::Args)]
pub struct Options {
    /// Only the problems of these names
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Option<Vec<String>>,
    /// Methods among auto, mprgp, active-set, qp, penalty and linear
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "auto,mprgp,active-set")]
    methods: Vec<String>,
    /// Most seconds of each solve
    #[arg(long, value_name = "N", default_value_t = 60.0)]
    seconds: f64,
    /// Times of PETSc, if petsc4py is installed
    #[arg(long)]
    peers: bool,
    /// Problems to which nothing was fitted
    #[arg(long)]
    unseen: bool,
    /// The scenes of a folder, such as those that `reference/parts.py` writes
    #[arg(long, value_name = "FOLDER")]
    scenes: Option<PathBuf>,
    /// Print at the end a table with the times of `auto` and of the fastest method
    #[arg(long)]
    table: bool,
    /// Draw the seconds over the unknowns of the membranes into `membrane.svg` and `membrane.png`
    #[arg(long, value_name = "FOLDER")]
    plot: Option<PathBuf>,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let interpreter = if options.peers { Interpreter::find() } else { None };
    let tasks = match &options.scenes {
        Some(folder) => scenes(folder).map_err(|error| format!("{}: {error}", folder.display()))?,
        None if options.unseen => UNSEEN.into_iter().map(Task::from).collect(),
        None => KINDS.into_iter().map(Task::from).collect(),
    };
    println!(
        "{:16} {:10} {:>8} {:>8}  {:22} {:>9} {:>9} {:>9} {:>7} {:>7} {:>9}",
        "kind", "method", "unknowns", "rows", "by", "s", "factor s", "proof s", "its", "closed", "undecided"
    );
    let mut times = Vec::new();
    for task in tasks.iter().filter(|task| options.only.as_ref().is_none_or(|only| only.contains(&task.name))) {
        let found = measure(task, options, interpreter.as_ref());
        times.push(found.map_err(|error| format!("{}: {error}", task.name))?);
    }
    if options.table {
        print!("{}", growth::markdown(&times));
    }
    if let Some(folder) = &options.plot {
        growth::plot("membrane", &times).write(folder, "membrane")?;
    }
    Ok(())
}

/// A problem that is made only when it is solved.
struct Task {
    name: String,
    make: Box<dyn Fn() -> Result<ContactProblem, Error>>,
}

impl From<Kind> for Task {
    fn from(kind: Kind) -> Self {
        Task { name: kind.name.to_string(), make: Box::new(kind.make) }
    }
}

/// Returns the scenes of a folder, sorted by name.
fn scenes(folder: &Path) -> std::io::Result<Vec<Task>> {
    let entries = std::fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    let mut files: Vec<PathBuf> = entries.into_iter().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "json"));
    files.sort();
    let task = |file: PathBuf| Task {
        name: file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default(),
        make: Box::new(move || Ok(Scene::read(&file)?.build()?.problem().clone())),
    };
    Ok(files.into_iter().map(task).collect())
}

/// Solves a problem by each of the methods, without and with the proof, and prints the results.
fn measure(task: &Task, options: &Options, interpreter: Option<&Interpreter>) -> Result<Times, Failure> {
    let problem = (task.make)()?;
    let mut reference: Option<ContactSet> = None;
    let mut certified: Vec<(Method, f64)> = Vec::new();
    let mut way_of_auto = String::new();
    let is_asked = |asked: &str| options.methods.iter().any(|name| name == asked);
    let methods = [Method::Auto, Method::Mprgp, Method::ActiveSet, Method::qp(), Method::penalty()];
    for method in methods.into_iter().filter(|method| is_asked(method.name())) {
        for proof in [false, true] {
            let mut settings = Settings::within(Duration::from_secs_f64(options.seconds));
            settings.method = method;
            settings.prove = proof;
            let (found, seconds) = timed(|| solve(&problem, &settings));
            let name = if proof { format!("{}+proof", method.name()) } else { method.name().to_string() };
            let start = format!("{:16} {name:10}", task.name);
            match &found {
                Ok(solution) => {
                    print_answer(&start, solution, seconds, "", &mut reference);
                    if proof {
                        certified.push((method, seconds));
                        if method == Method::Auto {
                            way_of_auto.clone_from(&solution.method);
                        }
                    }
                }
                Err(qp::Error::NotCertified { solution, condition, value, .. }) => {
                    let remark = format!("NOT certified: {condition} {value:.1e}");
                    print_answer(&start, solution, seconds, &remark, &mut reference);
                }
                Err(error) => println!("{start} {seconds:>9.3} {error}"),
            }
        }
    }
    let linear = if is_asked("linear") { linear_solve(&problem, options.seconds)? } else { f64::INFINITY };
    let found = interpreter.map(|interpreter| peers::peers(interpreter, &problem)).transpose()?.unwrap_or_default();
    print_ratios(&task.name, &certified, linear, &found);
    let of_methods = certified.iter().map(|(method, seconds)| (method.name().to_string(), *seconds));
    let of_peers = found.iter().map(|peer| (format!("PETSc {}", peer.name), peer.seconds));
    let of_solvers = of_methods.chain(of_peers).collect();
    let (kind, unknowns, rows) = (task.name.clone(), problem.dofs(), problem.rows());
    Ok(Times { kind, unknowns, rows, way_of_auto, of_solvers })
}

/// Returns the seconds of the same problem without contact rows, solved by a factor; infinite if it does not end in
/// time.
fn linear_solve(problem: &ContactProblem, most: f64) -> Result<f64, Error> {
    let no_rows = SparseMatrix::from_triplets(0, problem.dofs(), &[])?;
    let free = ContactProblem::new(problem.stiffness().clone(), problem.load().to_vec(), no_rows, Vec::new())?;
    let mut settings = Settings::within(Duration::from_secs_f64(most));
    settings.method = Method::ActiveSet;
    let (solved, seconds) = timed(|| solve(&free, &settings));
    Ok(if solved.is_ok() { seconds } else { f64::INFINITY })
}

/// Prints the seconds of PETSc, and the ratios of the time of `auto`, certified and proven, to the times of the others.
fn print_ratios(kind: &str, certified: &[(Method, f64)], own_linear: f64, peers: &[Peer]) {
    for Peer { name, seconds, iterations, closed } in peers {
        println!("{kind:16} petsc {name:7} {:>31} {seconds:>19.3} {:>19} {iterations:>7} {closed:>7}", "", "");
    }
    let Some(auto) = certified.iter().find(|(method, _)| *method == Method::Auto).map(|entry| entry.1) else { return };
    let least = |seconds: &mut dyn Iterator<Item = f64>| seconds.fold(f64::INFINITY, f64::min);
    let ratio = |of: &str, seconds: f64| {
        if seconds.is_finite() { format!("  {of} {:.2}", auto / seconds) } else { String::new() }
    };
    let own = if certified.len() > 1 { least(&mut certified.iter().map(|entry| entry.1)) } else { f64::INFINITY };
    let with_bounds = least(&mut peers.iter().filter(|peer| peer.name != "linear").map(|peer| peer.seconds));
    let linear = least(&mut peers.iter().filter(|peer| peer.name == "linear").map(|peer| peer.seconds));
    let ratios = [("best method", own), ("linear", own_linear), ("PETSc", with_bounds), ("PETSc linear", linear)];
    let ratios: String = ratios.into_iter().map(|(of, seconds)| ratio(of, seconds)).collect();
    if !ratios.is_empty() {
        println!("{kind:16} ratios of auto to:{ratios}");
    }
}

/// Prints the line of an answer. Its contact set is compared with the first one found for the same problem.
fn print_answer(start: &str, solution: &Solution, seconds: f64, remark: &str, reference: &mut Option<ContactSet>) {
    let mut remark = remark.to_string();
    let undecided = solution.proven.as_ref().map_or(-1, |proven| proven.undecided().count() as i64);
    if *reference.get_or_insert_with(|| solution.contact_set.clone()) != solution.contact_set {
        remark.push_str(" OTHER SET");
    }
    for attempt in &solution.attempts {
        remark.push_str(&format!(" [{} {:.2} s: {}]", attempt.method, attempt.seconds, attempt.reason));
    }
    println!(
        "{start} {:>8} {:>8}  {:22} {seconds:>9.3} {:>9.3} {:>9.3} {:>7} {:>7} {undecided:>9}  bound {:.1e} {remark}",
        solution.displacement.len(),
        solution.multiplier.len(),
        solution.method,
        solution.seconds.factor,
        solution.seconds.proof,
        solution.iterations,
        solution.contact_set.count(),
        solution.certificate.energy_error_bound,
    );
}
