//! GOAL: a contact problem and the linear complementarity problem of its forces have one answer.
//!
//! CONDITIONS: every scene of `examples/` and of the pages at rest with at most 2,000 rows; random scenes of every
//! support, bodies that nothing but contact holds, and ties among them; random chains of springs.
//! REFERENCE: `solve`, which never forms the Delassus operator.

use std::path::{Path, PathBuf};

use signorini::lcp::{Lcp, solve_lcp};
use signorini::qp::{Error, Failure};
use signorini::{ContactProblem, Prepared, Scene, Settings, solve};
use support::bodies::{difference, largest};
use support::{axis_scenes, cases, key_scenes, pair_scenes, plane_scenes, random, seed, space_scenes};

/// Rows of the largest problem whose Delassus operator is solved here.
const MOST_ROWS: usize = 2_000;

/// Difference of forces and displacements, relative to the largest.
const TOLERANCE: f64 = 1e-9;

#[derive(Default, Debug)]
struct Seen {
    problems: usize,
    floating: usize,
    tied: usize,
    force: f64,
    displacement: f64,
}

impl Seen {
    /// Solves both problems and compares set, forces and displacement.
    fn compare(&mut self, name: &str, problem: &ContactProblem) {
        if problem.inequalities() > MOST_ROWS {
            return;
        }
        let start = std::time::Instant::now();
        let made = Prepared::new(problem, &Settings::default()).and_then(|prepared| prepared.delassus());
        let of_made = start.elapsed().as_secs_f64();
        let answer = match solve(problem, &Settings::default()) {
            Ok(answer) => answer,
            Err(error) => {
                println!("{name}: solve says {:.100}", error.to_string());
                return;
            }
        };
        let made = match made {
            Ok(made) => made,
            Err(error) => {
                println!("XX {name}: delassus {error:.200}");
                return;
            }
        };
        let lcp = Lcp::new(made.matrix.clone(), made.offset.clone(), made.lower.clone(), made.upper.clone()).unwrap();
        let start = std::time::Instant::now();
        let solution = match solve_lcp(&lcp, &Settings::default()) {
            Ok(s) => s,
            Err(error) => {
                println!("XX {name}: lcp {:.300}", error.to_string());
                return;
            }
        };
        let of_lcp = start.elapsed().as_secs_f64();
        let m = made.rows.len();
        let mut forces = vec![0.0; problem.inequalities()];
        for (&row, z) in made.rows.iter().zip(&solution.z) {
            if row < forces.len() {
                forces[row] = -z;
            }
        }
        let u = made.displacement(&solution.z).unwrap();
        let most = largest(&answer.multiplier);
        let force = difference(&forces, &answer.multiplier[..forces.len()]) / most.max(f64::MIN_POSITIVE);
        let moved = difference(&u, &answer.displacement) / largest(&answer.displacement).max(f64::MIN_POSITIVE);
        let wrong: Vec<_> = made
            .rows
            .iter()
            .zip(&solution.z)
            .filter(|(row, z)| answer.contact_set.contains(**row) != (**z > 0.0))
            .map(|(row, z)| (*row, *z / most, answer.multiplier[*row] / most))
            .take(4)
            .collect();
        println!(
            "{} {name}: n {} m {m} r {} eq {} force {force:.1e} u {moved:.1e} {wrong:?} {:?} {} {:.1} ms, {:.1} ms",
            if force > 1e-9 || moved > 1e-9 || !wrong.is_empty() { "XX" } else { "ok" },
            problem.dofs(),
            made.motions.len(),
            problem.equality_rows(),
            solution.class,
            solution.method,
            1e3 * of_made,
            1e3 * of_lcp
        );
    }
}

fn scenes_in(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            scenes_in(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "json") {
            found.push(path);
        }
    }
    found.sort();
}

#[test]
fn a_scene_and_the_complementarity_problem_of_its_forces_have_one_answer() {
    let (mut seen, mut files) = (Seen::default(), Vec::new());
    scenes_in(&support::root().join("examples"), &mut files);
    for file in files {
        let Ok(scene) = Scene::read(&file) else {
            println!("XX {file:?}");
            continue;
        };
        if scene.analysis.is_none() {
            seen.compare(file.file_name().unwrap().to_str().unwrap(), scene.build().unwrap().problem());
        }
    }
    let first = seed(1);
    for number in 0..cases(8, 200) {
        let seed = first + number;
        for (kind, make) in [
            ("plane", plane_scenes::scene as fn(u64) -> _),
            ("pair", pair_scenes::scene),
            ("key", key_scenes::scene),
            ("axis", axis_scenes::scene),
            ("space", space_scenes::scene),
        ] {
            let (scene, _) = make(seed);
            let Ok(model) = scene.build() else {
                println!("XX {kind}");
                continue;
            };
            seen.compare(&format!("{kind} {seed}"), model.problem());
        }
    }
    println!("{seen:?}");
}

#[test]
fn springs_and_the_complementarity_problem_of_their_forces_have_one_answer() {
    let mut seen = Seen::default();
    for seed in 0..40 {
        seen.compare(&format!("springs {seed}"), &random::springs(seed));
        seen.compare(&format!("stacked {seed}"), &random::stacked(seed));
    }
}
