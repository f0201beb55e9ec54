//! Bodies that several tests share: distorted meshes, scenes from JSON, and linear solves on them.
#![allow(dead_code)]

use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};
use signorini::material::{Material, PlaneState};
use signorini::mesh::{ElementKind, Mesh, rectangle};
use signorini::sparse::Cholesky;
use signorini::{ContactProblem, Model, Scene, assembly, body::ElasticBody};

/// Both elements in both plane states.
pub const VARIANTS: [(ElementKind, PlaneState); 4] = [
    (ElementKind::T3, PlaneState::PlaneStrain),
    (ElementKind::T3, PlaneState::PlaneStress),
    (ElementKind::Q4, PlaneState::PlaneStrain),
    (ElementKind::Q4, PlaneState::PlaneStress),
];

/// A 2 x 1 rectangle of 4 x 3 cells whose inner nodes are moved by up to a fifth of a cell.
pub fn distorted(kind: ElementKind) -> Mesh {
    let regular = rectangle(&[0.0, 0.5, 1.0, 1.5, 2.0], &[0.0, 0.3, 0.7, 1.0], kind).unwrap();
    let move_inner = |(index, &[x, y]): (usize, &[f64; 2])| {
        let inner = x > 0.0 && x < 2.0 && y > 0.0 && y < 1.0;
        let (a, b) = ((index as f64 * 1.7).sin(), (index as f64 * 2.3).cos());
        if inner { [x + 0.1 * a, y + 0.06 * b] } else { [x, y] }
    };
    let nodes = regular.nodes().iter().enumerate().map(move_inner).collect();
    let connectivity = regular.elements().flatten().copied().collect();
    Mesh::new(nodes, kind, connectivity, regular.boundaries().to_vec()).unwrap()
}

/// The distorted body with E = 7, nu = 0.3 and a thickness of 0.5.
pub fn distorted_body(kind: ElementKind, state: PlaneState) -> ElasticBody {
    ElasticBody::new(distorted(kind), Material::new(7.0, 0.3, state).unwrap(), 0.5).unwrap()
}

/// The nodal displacement of a field.
pub fn nodal(mesh: &Mesh, field: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
    mesh.nodes().iter().flat_map(|&at| field(at)).collect()
}

/// Solves the body with the displacement prescribed where `held` says so, under a nodal load.
pub fn solve_held(body: &ElasticBody, field: &[f64], held: impl Fn(usize) -> bool, load: &[f64]) -> Vec<f64> {
    let prescribed: Vec<Option<f64>> = (0..field.len()).map(|dof| held(dof).then_some(field[dof])).collect();
    let dofs = assembly::DofMap::new(prescribed).unwrap();
    let lifted = dofs.expand(&vec![0.0; dofs.free().len()]).unwrap();
    let lifted_force = assembly::internal_force(body, &lifted).unwrap();
    let right: Vec<f64> = load.iter().zip(&lifted_force).map(|(a, b)| a - b).collect();
    let stiffness = assembly::stiffness(body, &dofs).unwrap();
    let free = Cholesky::of(&stiffness).unwrap().solve(&dofs.restrict(&right).unwrap());
    dofs.expand(&free).unwrap()
}

/// The largest difference of two vectors of the same length.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// The largest magnitude.
pub fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// A clamped unit square of `n` x `n` Q4, its top facing the given obstacles in +y.
pub fn clamped_square(n: usize, obstacles: Value, gap: f64) -> Value {
    json!({
        "body": {"rectangle": {
            "x": {"points": [0, 1], "divisions": [n]}, "y": {"points": [0, 1], "divisions": [n]}, "element": "q4"}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": obstacles,
        "gap": gap
    })
}

/// Builds a scene that is known to be right.
pub fn built(scene: &Value) -> Model {
    Scene::from_json(&scene.to_string(), "scene").unwrap().build().unwrap()
}

/// Displacement and multipliers when the given rows are closed and the others open, by one dense linear solve:
/// `K u - B_c' lambda = f, B_c u = g_c`. Signs are whatever they come out.
pub fn solve_with_closed_rows(problem: &ContactProblem, closed: &[usize]) -> (Vec<f64>, Vec<f64>) {
    let (n, m) = (problem.dofs(), closed.len());
    let mut matrix = DMatrix::zeros(n + m, n + m);
    for (row, column, value) in problem.stiffness().lower().triplets() {
        matrix[(row, column)] = value;
        matrix[(column, row)] = value;
    }
    let mut right = DVector::zeros(n + m);
    right.rows_mut(0, n).copy_from_slice(problem.load());
    for (row, column, value) in problem.contact().triplets() {
        if let Some(place) = closed.iter().position(|&c| c == row) {
            matrix[(n + place, column)] = value;
            matrix[(column, n + place)] = -value;
            right[n + place] = problem.gap()[row];
        }
    }
    let solution = matrix.full_piv_lu().solve(&right).unwrap();
    let mut multiplier = vec![0.0; problem.rows()];
    closed.iter().enumerate().for_each(|(place, &row)| multiplier[row] = solution[n + place]);
    (solution.rows(0, n).iter().copied().collect(), multiplier)
}
