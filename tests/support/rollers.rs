//! Scenes on inclined supports, and a solver to compare them with: Lagrange multipliers in the coordinate axes, in a
//! dense linear solve of `K u - N'r - B_c'lambda = f, N u = v, B_c u = g_c` over all dofs, without rotated frames.

use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};
use signorini::fem::{DofMap, stiffness};
use signorini::{Model, solve_qp};

use crate::bodies::{difference, largest};
use crate::scenes::built;

/// Rounding times the condition of the dense saddle-point system, below 1e5 here, with a margin.
const DENSE: f64 = 1e-10;

/// Rounding of a few operations on numbers of order one.
pub const ROUNDING: f64 = 1e-14;

/// A prescribed component `normal . u = value` of a node.
struct Component {
    node: usize,
    normal: Vec<f64>,
    value: f64,
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The components that a scene prescribes, read from its JSON; components of a node that depend on earlier ones are
/// left out.
fn components(scene: &Value, model: &Model) -> Vec<Component> {
    let (mesh, dimension) = (model.mesh(), model.mesh().dimension());
    let mut all: Vec<Component> = Vec::new();
    let mut add = |node: usize, normal: Vec<f64>, value: f64| {
        let mut rows: Vec<f64> = all.iter().filter(|other| other.node == node).flat_map(|c| c.normal.clone()).collect();
        rows.extend(&normal);
        let count = rows.len() / dimension;
        if DMatrix::from_row_slice(count, dimension, &rows).rank(1e-8) == count {
            all.push(Component { node, normal, value });
        }
    };
    let unit = |axis: usize| (0..dimension).map(|other| f64::from(u8::from(other == axis))).collect::<Vec<f64>>();
    if scene["model"] == "axisymmetric" {
        (0..mesh.nodes().len()).filter(|&n| mesh.nodes()[n][0] == 0.0).for_each(|node| add(node, unit(0), 0.0));
    }
    for support in scene["supports"].as_array().unwrap() {
        let nodes = match (&support["on"]["boundary"], &support["on"]["point"]) {
            (Value::String(name), _) => mesh.boundary(name).unwrap().nodes(),
            (_, at) => {
                let at: Vec<f64> = at.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
                vec![mesh.nodes().iter().position(|node| difference(&node[..dimension], &at) < 1e-12).unwrap()]
            }
        };
        for node in nodes {
            for (axis, name) in ["x", "y", "z"].iter().enumerate() {
                if let Some(value) = support[*name].as_f64() {
                    add(node, unit(axis), value);
                }
            }
            if let Some(normal) = support["normal"].as_array() {
                let normal: Vec<f64> = normal.iter().map(|part| part.as_f64().unwrap()).collect();
                let length = norm(&normal);
                add(node, normal.iter().map(|part| part / length).collect(), support["value"].as_f64().unwrap_or(0.0));
            }
        }
    }
    all
}

/// Solves a scene, and the same problem with Lagrange multipliers; compares displacement, contact forces and reactions.
#[track_caller]
pub fn check(scene: &Value) -> Model {
    let model = built(scene);
    let solution = solve_qp(model.problem()).unwrap();
    let held = components(scene, &model);
    let (dimension, count) = (model.mesh().dimension(), model.nodal_load().len());
    let closed: Vec<usize> = (0..model.rows().len()).filter(|&row| solution.multiplier[row] < 0.0).collect();
    let size = count + held.len() + closed.len();
    let (mut matrix, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
    let all = DofMap::new(vec![None; count]).unwrap();
    for (row, column, value) in stiffness(model.body(), &all).unwrap().lower().triplets() {
        (matrix[(row, column)], matrix[(column, row)]) = (value, value);
    }
    right.rows_mut(0, count).copy_from_slice(model.nodal_load());
    let of_supports = held.iter().map(|c| (c.node, c.normal.clone(), c.value));
    let of_rows = closed.iter().map(|&row| model.rows()[row].clone());
    let of_rows = of_rows.map(|row| (row.node, row.normal[..dimension].to_vec(), row.gap));
    for (place, (node, normal, value)) in of_supports.chain(of_rows).enumerate() {
        for (axis, part) in normal.iter().enumerate() {
            matrix[(count + place, dimension * node + axis)] = *part;
            matrix[(dimension * node + axis, count + place)] = -part;
        }
        right[count + place] = value;
    }
    let expected = matrix.full_piv_lu().solve(&right).unwrap();

    let nodal = model.nodal_displacement(&solution.displacement).unwrap();
    let off = difference(&nodal, expected.rows(0, count).as_slice());
    assert!(off < DENSE * largest(&nodal), "displacement: {off:e} of {:e}", largest(&nodal));
    let mut reactions = vec![0.0; count];
    for (place, component) in held.iter().enumerate() {
        for (axis, part) in component.normal.iter().enumerate() {
            reactions[dimension * component.node + axis] += part * expected[count + place];
        }
        let own = &nodal[dimension * component.node..dimension * (component.node + 1)];
        let off = dot(own, &component.normal) - component.value;
        assert!(off.abs() < ROUNDING, "node {} is not on its plane, by {off:e}", component.node);
    }
    let found = model.reactions(&solution.displacement, &solution.multiplier).unwrap();
    let scale = largest(&reactions);
    assert!(difference(&found, &reactions) < DENSE * scale, "reactions: {:e}", difference(&found, &reactions));
    for node in 0..model.mesh().nodes().len() {
        let normals: Vec<&Component> = held.iter().filter(|component| component.node == node).collect();
        let reaction = &found[dimension * node..dimension * (node + 1)];
        if let [one] = normals[..] {
            let along = dot(reaction, &one.normal);
            let across: Vec<f64> = reaction.iter().zip(&one.normal).map(|(part, n)| part - along * n).collect();
            assert!(norm(&across) < ROUNDING * scale, "the reaction of node {node} is not along its normal");
        }
    }
    for (place, &row) in closed.iter().enumerate() {
        let off = solution.multiplier[row] - expected[count + held.len() + place];
        assert!(off.abs() < DENSE * largest(&solution.multiplier), "row {row}: {off:e}");
    }
    let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
    assert!(balance < 1e-12, "balance {balance:e}");
    model
}

pub fn lines(divisions: usize) -> Value {
    json!({"points": [0, 1], "divisions": [divisions]})
}

pub fn square(model: &str, element: &str, supports: Value) -> Value {
    json!({
        "model": model,
        "body": {"rectangle": {"x": lines(4), "y": lines(3), "element": element}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": supports,
        "loads": [{"traction": {"boundary": "right", "value": [0.02, 0.01]}}, {"body-force": [0.01, 0.03]}],
        "obstacles": [{"boundary": "top", "approach": "+y", "rule": "closest-point",
                       "shape": {"parabola": {"apex": [0.6, 0.99], "radius": 2}}}],
    })
}

pub fn cube(element: &str, supports: Value) -> Value {
    json!({
        "model": "space",
        "body": {"box": {"x": lines(2), "y": lines(2), "z": lines(2), "element": element}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": supports,
        "loads": [{"traction": {"boundary": "right", "value": [0.02, 0.01, 0.01]}}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "closest-point",
                       "shape": {"sphere": {"apex": [0.6, 0.4, 0.98], "radius": 2}}}],
    })
}
