//! `cargo bench`: the steps of a contact solve on small blocks, compared with one Cholesky factorisation of the same
//! stiffness. `cargo run --release --example contact_cost` prints the ratios on large blocks.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use signorini::qp::Cholesky;
use signorini::{Method, Model, Prepared, Settings, solve};

#[path = "../tools/contact_cost/case.rs"]
mod case;

const CASES: [&str; 3] = ["Q4 64", "Q4 128", "Hex8 12"];

fn main() {
    divan::main();
}

fn model(name: &str) -> Model {
    case::Case::named(name).unwrap().model().unwrap()
}

fn active_set() -> Settings {
    Settings::with_method(Method::ActiveSet)
}

/// The gap of the block in the next step, larger by a tenth.
fn next_gap(model: &Model) -> Vec<f64> {
    model.problem().gap().iter().map(|gap| gap + case::FIRST_GAP / 10.0).collect()
}

#[divan::bench(args = CASES)]
fn assembly(bencher: Bencher, name: &str) {
    bencher.bench(|| model(black_box(name)));
}

#[divan::bench(args = CASES)]
fn linear_solve(bencher: Bencher, name: &str) {
    let model = model(name);
    let problem = model.problem();
    let dofs = ItemsCount::new(case::Case::named(name).unwrap().dofs());
    bencher.counter(dofs).bench(|| Cholesky::of(problem.stiffness()).unwrap().solve(problem.load()));
}

#[divan::bench(args = CASES)]
fn contact_active_set(bencher: Bencher, name: &str) {
    let model = model(name);
    bencher.bench(|| solve(model.problem(), &active_set()).unwrap());
}

#[divan::bench(args = CASES)]
fn contact_qp(bencher: Bencher, name: &str) {
    let model = model(name);
    bencher.bench(|| solve(model.problem(), &Settings::default()).unwrap());
}

#[divan::bench(args = CASES)]
fn next_gap_forces(bencher: Bencher, name: &str) {
    let model = model(name);
    let prepared = Prepared::new(model.problem(), &active_set()).unwrap();
    let warm = prepared.starting_from(prepared.solve(model.problem().gap()).unwrap().contact_set);
    bencher.with_inputs(|| next_gap(&model)).bench_values(|gap| warm.boundary(&gap).unwrap().contact_force());
}

#[divan::bench(args = CASES)]
fn next_gap_displacement(bencher: Bencher, name: &str) {
    let model = model(name);
    let prepared = Prepared::new(model.problem(), &active_set()).unwrap();
    let warm = prepared.starting_from(prepared.solve(model.problem().gap()).unwrap().contact_set);
    bencher.with_inputs(|| next_gap(&model)).bench_values(|gap| warm.solve(&gap).unwrap());
}

#[divan::bench(args = CASES)]
fn exact_path(bencher: Bencher, name: &str) {
    let model = model(name);
    let prepared = Prepared::new(model.problem(), &active_set()).unwrap();
    let to = next_gap(&model);
    bencher.bench(|| prepared.path(model.problem().gap(), &to).unwrap().corners());
}
