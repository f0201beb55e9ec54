//! Searches for violations of the guaranteed bound on the total error:
//! `cargo run --release --example guarantee [-- [--space | --keys | --axis | --pairs] [SCENES [LEVELS]]]`.
//!
//! Each random scene, in the plane, there with more keys or of several bodies, about an axis or in space, is solved on
//! its own mesh and on finer ones. All intervals of the energy and of the force must overlap, and the distance of each
//! answer to the finest one must not exceed its bound. In addition, one column for every ten scenes is solved; its
//! energy and force are known in closed form. The exit code is 1 if a guarantee is violated.

use signorini::Scene;
use support::brackets::{Column, Shown, of_column, shown};
use support::{axis_scenes, key_scenes, pair_scenes, plane_scenes, space_scenes};

/// The scenes of a dimension: those of a seed, the columns, the names of their elements, how many times smaller the
/// last bound must be for an error to be known, and how far the energies of a column may be apart.
type Scenes = (fn(u64) -> (Scene, &'static str), fn(u64) -> Column, [&'static str; 4], f64, f64);

fn main() -> std::process::ExitCode {
    let mut words = std::env::args().skip(1).peekable();
    let (scene, column, elements, clear, width): Scenes = match words.next_if(|word| word.starts_with("--")).as_deref()
    {
        Some("--space") => {
            (space_scenes::scene, space_scenes::column, space_scenes::ELEMENTS, space_scenes::CLEAR, 0.0)
        }
        Some("--axis") => (
            axis_scenes::scene,
            axis_scenes::column,
            plane_scenes::ELEMENTS,
            plane_scenes::CLEAR,
            axis_scenes::OF_POLYNOMIAL,
        ),
        Some("--pairs") => (pair_scenes::scene, pair_scenes::column, plane_scenes::ELEMENTS, plane_scenes::CLEAR, 0.0),
        Some("--keys") => (key_scenes::scene, plane_scenes::column, plane_scenes::ELEMENTS, plane_scenes::CLEAR, 0.0),
        Some(_) => return usage(),
        None => (plane_scenes::scene, plane_scenes::column, plane_scenes::ELEMENTS, plane_scenes::CLEAR, 0.0),
    };
    let mut numbers = words.map(|text| text.parse::<u64>());
    let (Some(scenes), Some(levels)) = (numbers.next().unwrap_or(Ok(300)).ok(), numbers.next().unwrap_or(Ok(6)).ok())
    else {
        return usage();
    };
    let (mut all, mut refused, mut meshes): (Vec<Shown>, Vec<String>, usize) = (Vec::new(), Vec::new(), 0);
    for seed in 1..=scenes {
        match shown(scene(seed), levels as usize, clear) {
            Ok(one) => {
                meshes += levels as usize + 1;
                one.violations.iter().for_each(|violation| println!("seed {seed}, {violation}"));
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
    for element in elements {
        let own = all.iter().filter(|one| one.element == element).filter_map(|one| one.of_own).collect();
        println!("bound / error of the own mesh, {element}, median: {}", median(own));
    }
    let of_force = all.iter().flat_map(|one| one.of_force.iter().copied()).collect();
    println!("half width of the force / bound, both relative, median: {}", median(of_force));
    let mut of_columns = 0;
    for seed in 1..=scenes.div_ceil(10) {
        let broken = of_column(column(seed), 1, width)
            .unwrap_or_else(|error| vec![format!("column {seed} is refused: {error}")]);
        broken.iter().for_each(|violation| println!("seed {seed}, {violation}"));
        of_columns += broken.len();
    }
    println!("{} columns with exact energy and force, {of_columns} violations", scenes.div_ceil(10));
    std::process::ExitCode::from(u8::from(violations + of_columns > 0))
}

fn usage() -> std::process::ExitCode {
    eprintln!("usage: guarantee [--space | --keys | --axis | --pairs] [SCENES [LEVELS]]");
    std::process::ExitCode::from(2)
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
