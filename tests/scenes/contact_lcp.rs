//! GOAL: a contact problem and the linear complementarity problem of its forces have one answer.
//!
//! CONDITIONS: every scene of `examples/` at rest with at most 2,000 rows, which the tutorials use; random scenes in
//! the plane, about an axis and in space, with ties and with bodies that only contact holds; random chains of springs.
//! REFERENCE: `solve`, which never forms the Delassus operator; one answer by hand.

use std::path::{Path, PathBuf};

use signorini::lcp::{Lcp, solve_lcp};
use signorini::qp::{Error, LinearError, Method, read_vector};
use signorini::{ContactProblem, Prepared, Scene, Settings, SparseMatrix, solve};
use support::bodies::{difference, largest};
use support::problems::of_entries;
use support::program::{Desk, Problem, example};
use support::{axis_scenes, cases, key_scenes, pair_scenes, plane_scenes, random, seed, space_scenes};

/// Rows of the largest problem whose Delassus operator is solved here.
const MOST_ROWS: usize = 2_000;

/// Difference of forces and of displacements, relative to the largest.
const TOLERANCE: f64 = 1e-9;

/// The same of the displacements of random scenes: a slender body on as few springs as it has motions bends so far that
/// most of it cancels. One of 2,349 reached 1.0e-9, all others 2e-10.
const RANDOM: f64 = 1e-8;

/// The tolerance of displacements, the largest differences, and the numbers of problems: all, with motions, with
/// equalities.
#[derive(Debug)]
struct Seen {
    tolerance: f64,
    problems: usize,
    floating: usize,
    tied: usize,
    force: f64,
    displacement: f64,
}

impl Seen {
    fn within(tolerance: f64) -> Self {
        Seen { tolerance, problems: 0, floating: 0, tied: 0, force: 0.0, displacement: 0.0 }
    }

    /// Solves both problems, and compares the closed rows, the forces and the displacement.
    fn compare(&mut self, name: &str, problem: &ContactProblem) {
        if problem.inequalities() > MOST_ROWS {
            return;
        }
        let Ok(answer) = solve(problem, &Settings::default()) else { return };
        let made = Prepared::new(problem, &Settings::default()).and_then(|prepared| prepared.delassus());
        let made = made.unwrap_or_else(|error| panic!("{name}: {error}"));
        let m = made.rows.len();
        assert!(made.rows.iter().all(|&row| problem.gap()[row].is_finite()), "{name}");
        let compliance: Vec<_> = made.matrix.triplets().filter(|entry| entry.0 < m && entry.1 < m).collect();
        let compliance = SparseMatrix::from_triplets(m, m, &compliance).unwrap();
        assert_eq!(compliance, compliance.transposed(), "{name}: W is not symmetric to the last bit");
        let (lower, upper) = (made.lower.clone(), made.upper.clone());
        let lcp = Lcp::new(made.matrix.clone(), made.offset.clone(), lower, upper).unwrap();
        let x = solve_lcp(&lcp, &Settings::default()).unwrap_or_else(|error| panic!("{name}: {error:.200}")).z;
        let mut forces = vec![0.0; problem.rows()];
        made.rows.iter().zip(&x).for_each(|(&row, z)| forces[row] = -z);
        let most = largest(&answer.multiplier).max(f64::MIN_POSITIVE);
        let is_weak = |row: usize| forces[row].abs().max(answer.multiplier[row].abs()) <= TOLERANCE * most;
        for &row in made.rows.iter().filter(|&&row| !is_weak(row)) {
            assert_eq!(forces[row] < 0.0, answer.contact_set.contains(row), "{name}: row {row}");
        }
        let count = problem.inequalities();
        let force = difference(&forces[..count], &answer.multiplier[..count]) / most;
        let size = largest(&answer.displacement).max(f64::MIN_POSITIVE);
        let moved = difference(&made.displacement(&x).unwrap(), &answer.displacement) / size;
        assert!(force <= TOLERANCE && moved <= self.tolerance, "{name}: force {force:.1e}, displacement {moved:.1e}");
        self.problems += 1;
        self.floating += usize::from(!made.motions.is_empty());
        self.tied += usize::from(problem.equality_rows() > 0);
        (self.force, self.displacement) = (self.force.max(force), self.displacement.max(moved));
    }
}

fn scenes_in(folder: &Path, found: &mut Vec<PathBuf>) {
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        match path.extension().is_some_and(|ending| ending == "json") {
            true => found.push(path),
            false if path.is_dir() => scenes_in(&path, found),
            false => {}
        }
    }
}

#[test]
fn a_scene_of_the_examples_and_the_complementarity_problem_of_its_forces_have_one_answer() {
    let (mut seen, mut files) = (Seen::within(TOLERANCE), Vec::new());
    scenes_in(&support::root().join("examples"), &mut files);
    for file in files {
        let scene = Scene::read(&file).unwrap();
        if scene.analysis.is_none() {
            seen.compare(file.to_str().unwrap(), scene.build().unwrap().problem());
        }
    }
    println!("{seen:?}");
    assert!(seen.problems >= 14 && seen.floating >= 5, "{seen:?}");
}

#[test]
fn a_random_scene_and_the_complementarity_problem_of_its_forces_have_one_answer() {
    type Make = fn(u64) -> (Scene, &'static str);
    let makers: [Make; 5] =
        [plane_scenes::scene, pair_scenes::scene, key_scenes::scene, axis_scenes::scene, space_scenes::scene];
    let (mut seen, first) = (Seen::within(RANDOM), seed(1));
    for seed in (0..cases(12, 200)).map(|number| first.wrapping_add(number)) {
        for (kind, make) in makers.iter().enumerate() {
            let Ok(model) = make(seed).0.build() else { continue };
            let (name, problem) = (format!("kind {kind}, seed {seed}"), model.problem());
            seen.compare(&name, problem);
            if problem.equality_rows() == 0 {
                // A body that floats is then known to do so within the rounding of its stiffness only.
                let (stiffness, contact) = (problem.stiffness().clone(), problem.contact().clone());
                let bare = ContactProblem::new(stiffness, problem.load().to_vec(), contact, problem.gap().to_vec());
                seen.compare(&format!("{name}, without modes"), &bare.unwrap());
            }
        }
        seen.compare(&format!("springs {seed}"), &random::springs(seed));
        seen.compare(&format!("stacked {seed}"), &random::stacked(seed));
    }
    println!("{seen:?}");
    assert!(seen.problems > 60 && seen.floating > 5 && seen.tied > 0, "{seen:?}");
}

/// Two dofs with a spring of 1 between them, under the forces 1 and 2, and nothing else but a wall at 1/2.
fn floating() -> ContactProblem {
    let spring = [(0, 0, 1.0), (1, 0, -1.0), (1, 1, 1.0)];
    of_entries(&spring, vec![1.0, 2.0], &[(0, 0, 1.0), (1, 1, 1.0)], vec![f64::INFINITY, 0.5])
}

#[test]
fn a_floating_body_has_its_motion_as_an_unknown_without_bounds() {
    let made = Prepared::new(&floating(), &Settings::default()).unwrap().delassus().unwrap();
    assert_eq!((&made.rows[..], &made.motions[..]), (&[1][..], &[vec![1.0, 1.0]][..]));
    assert_eq!((&made.lower[..], &made.upper[..]), (&[0.0, f64::NEG_INFINITY][..], &[f64::INFINITY; 2][..]));
    // The wall takes both forces. It stops its dof at 1/2, and the force of 1 moves the other away by 1.
    let x = solve_lcp(
        &Lcp::new(made.matrix.clone(), made.offset.clone(), made.lower.clone(), made.upper.clone()).unwrap(),
        &Settings::default(),
    );
    let x = x.unwrap().z;
    assert!((x[0] - 3.0).abs() < 1e-14 && difference(&made.displacement(&x).unwrap(), &[1.5, 0.5]) < 1e-14, "{x:?}");
    assert!(matches!(made.displacement(&[1.0]), Err(Error::Linear(LinearError::Length { found: 1, expected: 2, .. }))));
    assert!(matches!(made.displacement(&[1.0, f64::NAN]), Err(Error::Linear(LinearError::NotFinite { .. }))));
}

#[test]
fn a_delassus_operator_that_does_not_fit_is_refused_before_it_is_made() {
    let dofs = 20_000;
    let chain = (0..dofs).flat_map(|dof| [(dof, dof, 2.0), (dof + 1, dof, -1.0)]);
    let chain: Vec<_> = chain.filter(|entry| entry.0 < dofs).collect();
    let rows: Vec<_> = (0..dofs).map(|dof| (dof, dof, 1.0)).collect();
    let problem = of_entries(&chain, vec![1.0; dofs], &rows, vec![1.0; dofs]);
    let mut settings = Settings::with_method(Method::ActiveSet);
    settings.memory = Some(2e9);
    let refused = Prepared::new(&problem, &settings).unwrap().delassus();
    assert!(matches!(refused, Err(Error::TooLarge { bytes, .. }) if bytes > 2e10), "{refused:.300?}");
}

#[test]
fn the_exported_files_are_the_complementarity_problem() {
    let desk = Desk::new();
    let vector = |name: &str| read_vector(&desk.path(name)).unwrap();
    desk.problem("p", &Problem::right());
    let done = desk.run(&["export", "p", "lcp", "--format", "lcp"]).ends_with(0);
    assert_eq!(
        done.stdout,
        "lcp: M.mtx, q.mtx, rows.mtx with 1 unknowns z = -lambda of the rows in rows.mtx, from 0\n"
    );
    // K^-1 f = (1, 1), and a unit force moves its dof by 2/3.
    let matrix = std::fs::read_to_string(desk.path("lcp/M.mtx")).unwrap();
    let (head, entry) = matrix.trim().rsplit_once(' ').unwrap();
    assert!(head.ends_with("general\n1 1 1\n1 1") && (entry.parse::<f64>().unwrap() - 2.0 / 3.0).abs() < 1e-15);
    assert!((vector("lcp/q.mtx")[0] + 0.9).abs() < 1e-15 && vector("lcp/rows.mtx") == [0.0]);
    assert!(!desk.path("lcp/lower.mtx").exists());
    // A force presses the obstacle of this scene, which has no stiffness of its own.
    desk.run(&["export", &example("block"), "b", "--format", "lcp"]).ends_with(0);
    let (lower, count) = (std::fs::read_to_string(desk.path("b/lower.mtx")).unwrap(), vector("b/rows.mtx").len());
    let bounds: Vec<f64> = lower.lines().skip(2).map(|bound| bound.parse().unwrap()).collect();
    assert_eq!(bounds, [vec![0.0; count], vec![f64::NEG_INFINITY]].concat());
    for name in ["b/M.mtx", "b/R.mtx", "b/upper.mtx", "b/rows.csv", "b/dofs.csv"] {
        assert!(desk.path(name).exists(), "{name}");
    }
    desk.run(&["export", "p", "q"]).ends_with(1);
}
