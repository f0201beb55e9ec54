//! Problems of kinds to which the cost model was not fitted.

use super::bodies::{bar, jelly, soft_layer};
use super::noise::noise;
use super::problems::{Kind, five_points};
use signorini::{ContactProblem, Error};
use support::floors::{bounds, problem};

/// All kinds.
pub const UNSEEN: [Kind; 10] = [
    Kind { name: "anisotropic", make: || sheet(150, |_| [1.0, 0.01], 0.0) },
    Kind { name: "heat step", make: || sheet(200, |_| [1.0, 1.0], 10.0) },
    Kind { name: "checkerboard", make: || sheet(160, checkerboard, 0.0) },
    Kind { name: "random network", make: || network(12_000, 3) },
    Kind { name: "beam on soil", make: || beam_on_soil(10_000) },
    Kind { name: "truss", make: || truss(90) },
    Kind { name: "lattice in space", make: || lattice(18) },
    Kind { name: "long bar", make: || bar(160) },
    Kind { name: "soft layer", make: || soft_layer(220) },
    Kind { name: "jelly", make: || jelly(20) },
];

/// A conductivity on tiles of eight by eight cells; every other tile is a thousand times as stiff.
fn checkerboard(cell: [usize; 2]) -> [f64; 2] {
    if (cell[0] / 8 + cell[1] / 8).is_multiple_of(2) { [1.0; 2] } else { [1e3; 2] }
}

/// A sheet above a wavy floor, with `mass` added to its diagonal.
fn sheet(n: usize, of: impl Fn([usize; 2]) -> [f64; 2], mass: f64) -> Result<ContactProblem, Error> {
    let h = 1.0 / (n + 1) as f64;
    let floor = |own: usize| {
        let (x, y) = ((own % n + 1) as f64 * h, (own / n + 1) as f64 * h);
        -0.03 - 0.02 * (12.0 * x).sin() * (9.0 * y).cos()
    };
    let lower: Vec<_> = (0..n * n).map(|own| (own, floor(own))).collect();
    problem(n * n, &five_points(n, of, mass * h * h), vec![-h * h; n * n], bounds(n * n, &lower, &[])?)
}

/// A network that cannot be drawn in a plane: every node is connected to its neighbour and to `ties` others, near and
/// far, and lies between two walls.
fn network(knots: usize, ties: usize) -> Result<ContactProblem, Error> {
    let mut diagonal = vec![0.01; knots];
    let mut entries = Vec::new();
    for own in 1..knots {
        let far = |tie: usize| (own as f64 * (1.0 - noise(own * 7 + tie).powi(4))) as usize;
        let mut others: Vec<usize> = (0..ties).map(|tie| far(tie).min(own - 1)).chain([own - 1]).collect();
        others.sort_unstable();
        others.dedup();
        for other in others {
            let value = 0.5 + noise(own ^ other);
            diagonal[own] += value;
            diagonal[other] += value;
            entries.push((own, other, -value));
        }
    }
    entries.extend(diagonal.iter().enumerate().map(|(dof, &value)| (dof, dof, value)));
    let load = (0..knots).map(|dof| noise(5 * dof) - 0.5).collect();
    let walls = |sign: f64| (0..knots).map(|dof| (dof, sign * (0.02 + 0.05 * noise(3 * dof)))).collect::<Vec<_>>();
    problem(knots, &entries, load, bounds(knots, &walls(-1.0), &walls(1.0))?)
}

/// A beam on springs above a floor, with a deflection and a rotation per node; some loads lift it.
fn beam_on_soil(nodes: usize) -> Result<ContactProblem, Error> {
    let dofs = 2 * nodes;
    let beam = [[12.0, 6.0, -12.0, 6.0], [6.0, 4.0, -6.0, 2.0], [-12.0, -6.0, 12.0, -6.0], [6.0, 2.0, -6.0, 4.0]];
    let mut entries: Vec<(usize, usize, f64)> = (0..nodes).map(|node| (2 * node, 2 * node, 1e-4)).collect();
    for node in 0..nodes - 1 {
        let element = (0..4).flat_map(|i| (0..=i).map(move |j| (2 * node + i, 2 * node + j, beam[i][j])));
        entries.extend(element);
    }
    let load = |dof: usize| if dof.is_multiple_of(2) { 1e-4 * (noise(dof / 40) - 0.6) } else { 0.0 };
    let lower: Vec<_> = (0..nodes).map(|node| (2 * node, -0.1)).collect();
    problem(dofs, &entries, (0..dofs).map(load).collect(), bounds(dofs, &lower, &[])?)
}

/// A plane truss of squares with both diagonals, fixed at its left side, with a slope below its lower nodes.
fn truss(n: usize) -> Result<ContactProblem, Error> {
    let dofs = 2 * n * n;
    let mut entries = Vec::new();
    let mut tie = |a: usize, b: usize, along: [f64; 2], stiffness: f64| {
        for (i, j) in [(0, 0), (1, 0), (1, 1)] {
            let value = stiffness * along[i] * along[j];
            entries.extend([(2 * a + i, 2 * a + j, value), (2 * b + i, 2 * b + j, value)]);
        }
        let (high, low) = (a.max(b), a.min(b));
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            entries.push((2 * high + i, 2 * low + j, -stiffness * along[i] * along[j]));
        }
    };
    let slant = 0.5_f64.sqrt();
    for j in 0..n {
        for i in 0..n {
            let own = j * n + i;
            let stiffness = 0.2 + noise(own);
            if i + 1 < n {
                tie(own, own + 1, [1.0, 0.0], stiffness);
            }
            if j + 1 < n {
                tie(own, own + n, [0.0, 1.0], stiffness);
            }
            if i + 1 < n && j + 1 < n {
                tie(own, own + n + 1, [slant, slant], 0.5 * stiffness);
                tie(own + 1, own + n, [-slant, slant], 0.5 * stiffness);
            }
        }
    }
    entries.extend((0..n).flat_map(|j| [2 * j * n, 2 * j * n + 1]).map(|dof| (dof, dof, 10.0)));
    let load = (0..dofs).map(|dof| if dof % 2 == 1 { -1e-4 } else { 0.0 }).collect();
    let lower: Vec<_> = (0..n).map(|i| (2 * i + 1, -0.05 - 1e-3 * i as f64)).collect();
    problem(dofs, &entries, load, bounds(dofs, &lower, &[])?)
}

/// A lattice of nodes in space with three displacements each; longitudinal and transverse springs connect neighbours,
/// and a floor lies below every node.
fn lattice(n: usize) -> Result<ContactProblem, Error> {
    let dofs = 3 * n.pow(3);
    let at = |i: usize, j: usize, k: usize| (k * n + j) * n + i;
    let (mut entries, mut lower) = (Vec::new(), Vec::new());
    for place in 0..n.pow(3) {
        let (i, j, k) = (place % n, place / n % n, place / n / n);
        for (axis, next) in [(i + 1, j, k), (i, j + 1, k), (i, j, k + 1)].into_iter().enumerate() {
            let is_inside = next.0 < n && next.1 < n && next.2 < n;
            for direction in 0..3 {
                let value = if direction == axis { 1.0 } else { 0.3 };
                let own = 3 * place + direction;
                entries.push((own, own, value));
                if is_inside {
                    let other = 3 * at(next.0, next.1, next.2) + direction;
                    entries.extend([(other, other, value), (other, own, -value)]);
                }
            }
        }
        lower.push((3 * place + 2, -0.2 * (1.0 + k as f64 / n as f64)));
    }
    let load = (0..dofs).map(|dof| if dof % 3 == 2 { -0.01 } else { 0.0 }).collect();
    problem(dofs, &entries, load, bounds(dofs, &lower, &[])?)
}
