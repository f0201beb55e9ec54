//! Searches for violations of the guaranteed bound on the total error.
//!
//! Each random scene is solved on its own mesh and on finer ones. All intervals of the energy and of the force must
//! overlap, and the distance of each answer to the finest one must not exceed its bound. In addition, one column for
//! every ten scenes is solved; its energy and force are known in closed form.

use clap::Args;
use signorini::Scene;
use support::brackets::{Column, Shown, of_column, shown};
use support::{axis_scenes, key_scenes, pair_scenes, plane_scenes, space_scenes};

use crate::process::{Failure, no_faults};

/// Guaranteed bounds beside answers on finer meshes, in the plane unless another kind is asked for
#[derive(Args)]
pub struct Options {
    /// Scenes in space
    #[arg(long, group = "kind")]
    space: bool,
    /// Scenes in the plane with more keys
    #[arg(long, group = "kind")]
    keys: bool,
    /// Scenes about an axis
    #[arg(long, group = "kind")]
    axis: bool,
    /// Scenes of several bodies
    #[arg(long, group = "kind")]
    pairs: bool,
    #[arg(default_value_t = 300)]
    scenes: u64,
    #[arg(default_value_t = 6)]
    levels: usize,
}

/// The scene and the column of a seed, and how far the energies of a column may be apart.
type Scenes = (fn(u64) -> (Scene, &'static str), fn(u64) -> Column, f64);

pub fn run(options: &Options) -> Result<(), Failure> {
    let (scene, column, width): Scenes = match options {
        Options { space: true, .. } => (space_scenes::scene, space_scenes::column, 0.0),
        Options { axis: true, .. } => (axis_scenes::scene, axis_scenes::column, axis_scenes::OF_POLYNOMIAL),
        Options { pairs: true, .. } => (pair_scenes::scene, pair_scenes::column, 0.0),
        Options { keys: true, .. } => (key_scenes::scene, plane_scenes::column, 0.0),
        _ => (plane_scenes::scene, plane_scenes::column, 0.0),
    };
    // The names of the elements, and how many times smaller the last bound must be for an error to be known.
    let (elements, clear) = match options.space {
        true => (space_scenes::ELEMENTS, space_scenes::CLEAR),
        false => (plane_scenes::ELEMENTS, plane_scenes::CLEAR),
    };
    let (scenes, levels) = (options.scenes, options.levels);
    let (mut all, mut refused, mut meshes): (Vec<Shown>, Vec<String>, usize) = (Vec::new(), Vec::new(), 0);
    for seed in 1..=scenes {
        match shown(scene(seed), levels, clear) {
            Ok(one) => {
                meshes += levels + 1;
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
    no_faults(violations + of_columns, "guarantees are violated")
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
