//! Seconds and iterations of every method on problems of other fields:
//! `cargo run --release --example kinds [-- --only NAME,NAME] [--methods auto,mprgp] [--seconds N] [--peers]`.
//!
//! A line of `ratios` follows each kind: the time of `auto` over that of our fastest method, and, with `--peers` and petsc4py, over
//! that of PETSc's fastest and of one linear solve there.

mod bodies;
mod floors;
mod peers;
mod problems;

use std::process::ExitCode;
use std::time::{Duration, Instant};

use peers::{Interpreter, Peer};
use problems::KINDS;
use signorini::{ContactSet, Error, Method, Settings, Solution, solve};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let option = |name: &str, otherwise: &str| -> String {
        let place = arguments.iter().position(|word| word == name);
        place.and_then(|place| arguments.get(place + 1)).map_or_else(|| otherwise.to_string(), String::clone)
    };
    let only = option("--only", "");
    let most: f64 = option("--seconds", "60").parse().unwrap_or(60.0);
    let names = option("--methods", "auto,mprgp,active-set");
    let methods = [Method::Auto, Method::Mprgp, Method::ActiveSet, Method::qp(), Method::penalty()];
    let interpreter = if arguments.iter().any(|word| word == "--peers") { Interpreter::find() } else { None };
    println!(
        "{:16} {:10} {:>8} {:>8}  {:22} {:>9} {:>9} {:>7} {:>7} {:>9}",
        "kind", "method", "unknowns", "rows", "by", "s", "factor s", "its", "closed", "undecided"
    );
    for kind in KINDS.iter().filter(|kind| only.is_empty() || only.split(',').any(|name| name == kind.name)) {
        let problem = match (kind.make)() {
            Ok(problem) => problem,
            Err(error) => {
                eprintln!("{}: {error}", kind.name);
                return ExitCode::FAILURE;
            }
        };
        let mut reference: Option<ContactSet> = None;
        let mut certified: Vec<(Method, f64)> = Vec::new();
        for method in methods.into_iter().filter(|method| names.split(',').any(|name| name == method.name())) {
            for proof in [false, true] {
                let mut settings = Settings::within(Duration::from_secs_f64(most));
                settings.method = method;
                settings.prove = proof;
                let clock = Instant::now();
                let found = solve(&problem, &settings);
                let seconds = clock.elapsed().as_secs_f64();
                let name = if proof { format!("{}+proof", method.name()) } else { method.name().to_string() };
                let start = format!("{:16} {name:10}", kind.name);
                match &found {
                    Ok(solution) => {
                        print_answer(&start, solution, seconds, "", &mut reference);
                        if proof {
                            certified.push((method, seconds));
                        }
                    }
                    Err(Error::NotCertified { solution, condition, value, .. }) => {
                        let remark = format!("NOT certified: {condition} {value:.1e}");
                        print_answer(&start, solution, seconds, &remark, &mut reference);
                    }
                    Err(error) => println!("{start} {seconds:>9.3} {error}"),
                }
            }
        }
        let found = match interpreter.as_ref().map(|interpreter| peers::peers(interpreter, &problem)).transpose() {
            Ok(found) => found.unwrap_or_default(),
            Err(error) => {
                eprintln!("{}: {error}", kind.name);
                return ExitCode::FAILURE;
            }
        };
        print_ratios(kind.name, &certified, &found);
    }
    ExitCode::SUCCESS
}

/// The seconds of PETSc, and the time of `auto`, certified and proven, over that of others.
fn print_ratios(kind: &str, certified: &[(Method, f64)], peers: &[Peer]) {
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
    let ratios = [ratio("best method", own), ratio("PETSc", with_bounds), ratio("PETSc linear", linear)].concat();
    if !ratios.is_empty() {
        println!("{kind:16} ratios of auto to:{ratios}");
    }
}

/// The rest of the line of an answer; its set is compared with the first one found of its problem.
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
