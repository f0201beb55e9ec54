//! Bodies that several tests share: distorted meshes, scenes from JSON, and linear solves on them.

use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};
use signorini::ContactProblem;
use signorini::fem::{self, ElasticBody, ElementKind, Formulation, Material, Mesh};
use signorini::qp::Cholesky;
use signorini::scene::rectangle;

const STRAIN: Formulation = Formulation::PlaneStrain { thickness: 0.5 };
const STRESS: Formulation = Formulation::PlaneStress { thickness: 0.5 };

/// All element kinds of the plane, each in plane strain and in plane stress.
pub const VARIANTS: [(ElementKind, Formulation); 8] = [
    (ElementKind::T3, STRAIN),
    (ElementKind::T3, STRESS),
    (ElementKind::T6, STRAIN),
    (ElementKind::T6, STRESS),
    (ElementKind::Q4, STRAIN),
    (ElementKind::Q4, STRESS),
    (ElementKind::Q8, STRAIN),
    (ElementKind::Q8, STRESS),
];

/// A 2 x 1 rectangle of 4 x 3 cells whose inner corners are moved by up to a fifth of a cell; mid-side nodes stay in
/// the middle of their side.
pub fn distorted(kind: ElementKind) -> Mesh {
    distort(&rectangle(&[0.0, 0.5, 1.0, 1.5, 2.0], &[0.0, 0.3, 0.7, 1.0], kind).unwrap(), [0.1, 0.06, 0.0])
}

/// The mesh with inner nodes moved by up to `reach` along each axis; in the plane, mid-side nodes are put in the middle
/// of their side.
pub fn distort(regular: &Mesh, reach: [f64; 3]) -> Mesh {
    let (low, high) = regular.extent();
    let dimension = regular.dimension();
    let move_inner = |(index, &at): (usize, &[f64; 3])| {
        let inner = (0..dimension).all(|axis| at[axis] > low[axis] && at[axis] < high[axis]);
        let index = index as f64;
        let shift = [(index * 1.7).sin(), (index * 2.3).cos(), (index * 3.1).sin()];
        if inner { [0, 1, 2].map(|axis| at[axis] + reach[axis] * shift[axis]) } else { at }
    };
    let mut nodes: Vec<[f64; 3]> = regular.nodes().iter().enumerate().map(move_inner).collect();
    let kind = regular.kind_of(0);
    if kind.is_quadratic() && dimension == 2 {
        for element in regular.elements() {
            for side in 0..kind.corners() {
                let (a, b) = (nodes[element[side]], nodes[element[(side + 1) % kind.corners()]]);
                nodes[element[kind.corners() + side]] = [0, 1, 2].map(|axis| (a[axis] + b[axis]) / 2.0);
            }
        }
    }
    let connectivity = regular.elements().flatten().copied().collect();
    Mesh::new(nodes, kind, connectivity, regular.boundaries().to_vec()).unwrap()
}

/// The distorted body with E = 7, nu = 0.3 and a thickness of 0.5.
pub fn distorted_body(kind: ElementKind, formulation: Formulation) -> ElasticBody {
    ElasticBody::new(distorted(kind), Material::new(7.0, 0.3).unwrap(), formulation).unwrap()
}

/// The nodal displacement of a field in the plane.
pub fn nodal(mesh: &Mesh, field: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
    mesh.nodes().iter().flat_map(|&[x, y, _]| field([x, y])).collect()
}

/// The nodal displacement of a field in any dimension.
pub fn nodal_of(mesh: &Mesh, field: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    mesh.nodes().iter().flat_map(|&at| field(at).into_iter().take(mesh.dimension())).collect()
}

/// Solves the body under a nodal load, with the displacement prescribed at the dofs for which `held` returns `true`.
pub fn solve_held(body: &ElasticBody, field: &[f64], held: impl Fn(usize) -> bool, load: &[f64]) -> Vec<f64> {
    let prescribed: Vec<Option<f64>> = (0..field.len()).map(|dof| held(dof).then_some(field[dof])).collect();
    let dofs = fem::DofMap::new(prescribed).unwrap();
    let lifted = dofs.expand(&vec![0.0; dofs.free().len()]).unwrap();
    let lifted_force = fem::internal_force(body, &lifted).unwrap();
    let right: Vec<f64> = load.iter().zip(&lifted_force).map(|(a, b)| a - b).collect();
    let stiffness = fem::stiffness(body, &dofs).unwrap();
    let free = Cholesky::of(&stiffness).unwrap().solve(&dofs.restrict(&right).unwrap());
    dofs.expand(&free).unwrap()
}

/// The largest difference of two vectors of the same length.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// The largest magnitude of the entries of a vector.
pub fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// A clamped unit square of `n` x `n` Q4 cells; its top faces the given obstacles in +y.
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

/// A unit cube of n x n x n Hex8, clamped below, under a sphere of radius 2 that starts `gap` above its top.
pub fn clamped_block(n: usize, gap: f64) -> Value {
    let axis = json!({"points": [0, 1], "divisions": [n]});
    json!({
        "model": "space",
        "body": {"box": {"x": axis, "y": axis, "z": axis, "element": "hex8"}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "approach",
                       "shape": {"sphere": {"apex": [0.5, 0.5, 1], "radius": 2}}}],
        "gap": gap
    })
}

/// A unit cube of 4 x 4 x 4 Hex8, clamped below, under an obstacle of this rule and shape.
pub fn cube_under(rule: &str, shape: Value, gap: f64) -> Value {
    let axis = json!({"points": [0, 1], "divisions": [4]});
    json!({
        "model": "space",
        "body": {"box": {"x": axis, "y": axis, "z": axis, "element": "hex8"}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": rule, "shape": shape}],
        "gap": gap
    })
}

/// Displacement and multipliers if the given rows are closed and the others open, by one dense linear solve:
/// `K u - B_c' lambda = f, B_c u = g_c`. The signs are not checked.
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
