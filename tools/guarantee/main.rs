//! Searches for violations of the guaranteed bound on the total error:
//! `cargo run --release --example guarantee [SCENES [LEVELS]]`.
//!
//! Each random plane scene is solved on its own mesh and on finer ones. All intervals of the energy and of the force must
//! overlap, and the distance of each answer to the finest one must not exceed its bound. In addition, one column for every
//! ten scenes is solved; its energy and force are known in closed form. The exit code is 1 if a guarantee is violated.

use support::plane_scenes::{ELEMENTS, Shown, of_column, shown};

fn main() -> std::process::ExitCode {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let (Some(scenes), Some(levels)) = (numbers.next().unwrap_or(Ok(300)).ok(), numbers.next().unwrap_or(Ok(6)).ok())
    else {
        eprintln!("usage: guarantee [SCENES [LEVELS]]");
        return std::process::ExitCode::from(2);
    };
    let (mut all, mut refused, mut meshes): (Vec<Shown>, Vec<String>, usize) = (Vec::new(), Vec::new(), 0);
    for seed in 1..=scenes {
        match shown(seed, levels as usize) {
            Ok(one) => {
                meshes += levels as usize + 1;
                one.violations.iter().for_each(|violation| println!("{violation}"));
                all.push(one);
            }
            Err(error) => refused.push(format!("seed {seed}: {error}")),
        }
    }
    refused.iter().for_each(|refusal| println!("refused: {refusal}"));
    let violations: usize = all.iter().map(|one| one.violations.len()).sum();
    println!("{} scenes, {meshes} meshes, {} refused, {violations} violations", all.len(), refused.len());
    let of_displacement = all.iter().flat_map(|one| one.of_displacement.iter().copied()).collect();
    println!("bound / error of v, median: {}", median(of_displacement));
    for element in ELEMENTS {
        let own = all.iter().filter(|one| one.element == element).filter_map(|one| one.of_own).collect();
        println!("bound / error of the own mesh, {element}, median: {}", median(own));
    }
    let of_force = all.iter().flat_map(|one| one.of_force.iter().copied()).collect();
    println!("half width of the force / bound, both relative, median: {}", median(of_force));
    let mut of_columns = 0;
    for seed in 1..=scenes.div_ceil(10) {
        let broken = of_column(seed, 1).unwrap_or_else(|error| vec![format!("column {seed} is refused: {error}")]);
        broken.iter().for_each(|violation| println!("{violation}"));
        of_columns += broken.len();
    }
    println!("{} columns with exact energy and force, {of_columns} violations", scenes.div_ceil(10));
    std::process::ExitCode::from(u8::from(violations + of_columns > 0))
}

/// Returns the median, the extremes and the number of the values as text.
fn median(mut values: Vec<f64>) -> String {
    values.sort_by(f64::total_cmp);
    match (values.first(), values.get(values.len() / 2), values.last()) {
        (Some(least), Some(middle), Some(most)) => {
            format!("{middle:.2}, from {least:.2} to {most:.2}, of {}", values.len())
        }
        _ => "none".to_string(),
    }
}
