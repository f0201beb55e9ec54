//! Seconds and iterations of every method on problems of other fields:
//! `cargo run --release --example kinds [-- --only NAME,NAME] [--methods auto,mprgp] [--seconds N]`.

mod bodies;
mod floors;
mod problems;

use std::process::ExitCode;
use std::time::{Duration, Instant};

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
                    Ok(solution) => print_answer(&start, solution, seconds, "", &mut reference),
                    Err(Error::NotCertified { solution, condition, value, .. }) => {
                        let remark = format!("NOT certified: {condition} {value:.1e}");
                        print_answer(&start, solution, seconds, &remark, &mut reference);
                    }
                    Err(error) => println!("{start} {seconds:>9.3} {error}"),
                }
            }
        }
    }
    ExitCode::SUCCESS
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
