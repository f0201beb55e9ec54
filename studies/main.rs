//! The studies: what measures the crate, and the long forms of tests.
//!
//! `cargo run --release --example studies -- NAME ...` runs one; `-- help` lists them, `-- NAME --help` lists options.
#![forbid(unsafe_code)]

mod accuracy_cost;
mod assembly_speed;
mod block;
mod clock;
mod contact_cost;
mod derivatives;
mod dynamic_cost;
mod extremes;
mod fuzz;
mod guarantee;
mod impact;
mod kinds;
mod linear;
mod modes;
mod mortar_speed;
mod multigrid;
mod process;
mod random;
mod small_problems;
mod surface_speed;
mod table;
mod three_faces;
mod verification;

use std::process::ExitCode;

use clap::Parser;

/// Measurements, and long forms of tests.
#[derive(Parser)]
#[command(name = "studies", rename_all = "snake_case")]
enum Study {
    AccuracyCost(accuracy_cost::Options),
    AssemblySpeed(assembly_speed::Options),
    ContactCost(contact_cost::Options),
    Derivatives(derivatives::Options),
    DynamicCost(dynamic_cost::Options),
    Extremes(extremes::Options),
    Fuzz(fuzz::Options),
    Guarantee(guarantee::Options),
    Impact(impact::Options),
    Kinds(kinds::Options),
    Modes(modes::Options),
    /// Seconds for the rows between two surfaces in space of 10,000 facets each, whose meshes do not match
    MortarSpeed,
    Multigrid(multigrid::Options),
    /// Microseconds of small problems, and seconds of many of them at once
    SmallProblems,
    /// Seconds to read a surface of a million triangles, and to find the closest points of 50,000 places
    SurfaceSpeed,
    ThreeFaces(three_faces::Options),
    Verification(verification::Options),
}

fn main() -> ExitCode {
    let ended = match Study::parse() {
        Study::AccuracyCost(options) => accuracy_cost::run(&options),
        Study::AssemblySpeed(options) => assembly_speed::run(&options),
        Study::ContactCost(options) => contact_cost::run(&options),
        Study::Derivatives(options) => derivatives::run(&options),
        Study::DynamicCost(options) => dynamic_cost::run(&options),
        Study::Extremes(options) => extremes::run(&options),
        Study::Fuzz(options) => fuzz::run(&options),
        Study::Guarantee(options) => guarantee::run(&options),
        Study::Impact(options) => impact::run(&options),
        Study::Kinds(options) => kinds::run(&options),
        Study::Modes(options) => modes::run(&options),
        Study::MortarSpeed => mortar_speed::run(),
        Study::Multigrid(options) => multigrid::run(&options),
        Study::SmallProblems => small_problems::run(),
        Study::SurfaceSpeed => surface_speed::run(),
        Study::ThreeFaces(options) => three_faces::run(&options),
        Study::Verification(options) => verification::run(&options),
    };
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
