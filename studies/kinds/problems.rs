//! Problems from other fields as matrices: many rows, two-sided bounds, separate parts, rotations.

use super::bodies::{blocks_apart, cube, graded_cube, slab};
use super::noise::noise;
use signorini::{ContactProblem, Error};
use support::floors::{bounds, membrane, plate, problem};

/// A problem and its name.
#[derive(Clone, Copy)]
pub struct Kind {
    pub name: &'static str,
    pub make: fn() -> Result<ContactProblem, Error>,
}

/// All problems; within a kind, small ones come first.
pub const KINDS: [Kind; 19] = [
    Kind { name: "membrane 127", make: || membrane(127) },
    Kind { name: "membrane 255", make: || membrane(255) },
    Kind { name: "membrane 511", make: || membrane(511) },
    Kind { name: "membrane 1023", make: || membrane(1023) },
    Kind { name: "Poisson 24^3", make: || poisson(24) },
    Kind { name: "torsion", make: || torsion(100) },
    Kind { name: "image graph", make: || image_graph(100) },
    Kind { name: "journal bearing", make: || journal_bearing(198) },
    Kind { name: "separate bodies", make: || separate_bodies(1000) },
    Kind { name: "blocks apart", make: || blocks_apart(40, 10) },
    Kind { name: "frame", make: || frame(100) },
    Kind { name: "plate", make: || plate(100) },
    Kind { name: "Poisson 40^3", make: || poisson(40) },
    Kind { name: "torsion 256", make: || torsion(256) },
    Kind { name: "free slab", make: || slab(30, 0.01) },
    Kind { name: "slab", make: || slab(30, -0.01) },
    Kind { name: "block", make: || cube(32) },
    Kind { name: "graded block 40", make: || graded_cube(38, 40.0) },
    Kind { name: "graded block 160", make: || graded_cube(38, 160.0) },
];

/// A Poisson problem by seven points on a cube with `n` unknowns along an edge, pressed onto a bowl below every
/// unknown.
fn poisson(n: usize) -> Result<ContactProblem, Error> {
    let h = 1.0 / (n + 1) as f64;
    let at = |i: usize, j: usize, k: usize| (k * n + j) * n + i;
    let (mut entries, mut lower) = (Vec::new(), Vec::new());
    for k in 0..n {
        for j in 0..n {
            for i in 0..n {
                let own = at(i, j, k);
                entries.push((own, own, 6.0 * h));
                let near = [(i + 1, j, k), (i, j + 1, k), (i, j, k + 1)];
                for (a, b, c) in near.into_iter().filter(|&(a, b, c)| a < n && b < n && c < n) {
                    entries.push((at(a, b, c), own, -h));
                }
                let away = |i: usize| ((i + 1) as f64 * h - 0.5).powi(2);
                lower.push((own, -0.1 - 0.5 * (away(i) + away(j) + away(k))));
            }
        }
    }
    problem(n.pow(3), &entries, vec![-10.0 * h.powi(3); n.pow(3)], bounds(n.pow(3), &lower, &[])?)
}

/// Elastic-plastic torsion of a square bar by five points: |u| is at most the distance to the boundary.
fn torsion(n: usize) -> Result<ContactProblem, Error> {
    let h = 1.0 / (n + 1) as f64;
    let to_wall = |i: usize| (i + 1).min(n - i) as f64 * h;
    let upper: Vec<_> = (0..n * n).map(|own| (own, to_wall(own % n).min(to_wall(own / n)))).collect();
    let lower: Vec<_> = upper.iter().map(|&(own, distance)| (own, -distance)).collect();
    let entries = five_points(n, |_| [1.0; 2], 0.0);
    problem(n * n, &entries, vec![5.0 * h * h; n * n], bounds(n * n, &lower, &upper)?)
}

/// The entries of a sheet by five points on a square, fixed at its sides. `of` gives the conductivity of each cell
/// along x and y; `more` is added to the diagonal.
pub fn five_points(n: usize, of: impl Fn([usize; 2]) -> [f64; 2], more: f64) -> Vec<(usize, usize, f64)> {
    let (mut diagonal, mut entries) = (vec![more; n * n], Vec::new());
    for own in 0..n * n {
        let [i, j] = [own % n, own / n];
        let [along_x, along_y] = of([i, j]);
        let mut link = |other: Option<usize>, value: f64| {
            diagonal[own] += value;
            if let Some(other) = other {
                diagonal[other] += value;
                entries.push((other, own, -value));
            }
        };
        link((i + 1 < n).then_some(own + 1), along_x);
        link((j + 1 < n).then_some(own + n), along_y);
        diagonal[own] += if i == 0 { along_x } else { 0.0 } + if j == 0 { along_y } else { 0.0 };
    }
    entries.extend(diagonal.iter().enumerate().map(|(dof, &value)| (dof, dof, value)));
    entries
}

/// The graph of an image: edges with weights from 1e-3 to 1e3, weak springs to noisy values, and bounds 0 and 1.
fn image_graph(n: usize) -> Result<ContactProblem, Error> {
    let dofs = n * n;
    let mut diagonal = vec![1e-2; dofs];
    let mut entries = Vec::new();
    for own in 0..dofs {
        let neighbours = [(own % n + 1 < n).then_some(own + 1), (own + n < dofs).then_some(own + n)];
        for (side, other) in neighbours.into_iter().enumerate().filter_map(|(side, other)| Some((side, other?))) {
            let weight = 10.0_f64.powf(6.0 * noise(2 * own + side) - 3.0);
            entries.push((other, own, -weight));
            diagonal[own] += weight;
            diagonal[other] += weight;
        }
    }
    entries.extend(diagonal.iter().enumerate().map(|(dof, &value)| (dof, dof, value)));
    let load = (0..dofs).map(|dof| 4.0 * noise(7 * dof + 3) - 1.5).collect();
    let both: Vec<(usize, f64)> = (0..dofs).map(|dof| (dof, 0.0)).collect();
    let ones: Vec<(usize, f64)> = (0..dofs).map(|dof| (dof, 1.0)).collect();
    problem(dofs, &entries, load, bounds(dofs, &both, &ones)?)
}

/// Pressure u >= 0 in a journal bearing of eccentricity 0.1 and length 20, by five points with the coefficient (1 + e
/// cos x)^3.
fn journal_bearing(n: usize) -> Result<ContactProblem, Error> {
    let (eccentricity, height) = (0.1, 10.0);
    let (hx, hy) = (2.0 * std::f64::consts::PI / (n + 1) as f64, 2.0 * height / (n + 1) as f64);
    let film = |x: f64| (1.0 + eccentricity * x.cos()).powi(3);
    let (mut entries, mut load) = (Vec::new(), Vec::new());
    for j in 0..n {
        for i in 0..n {
            let (own, x) = (j * n + i, (i + 1) as f64 * hx);
            let (left, right) = (film(x - 0.5 * hx) * hy / hx, film(x + 0.5 * hx) * hy / hx);
            let across = film(x) * hx / hy;
            entries.push((own, own, left + right + 2.0 * across));
            if i + 1 < n {
                entries.push((own + 1, own, -right));
            }
            if j + 1 < n {
                entries.push((own + n, own, -across));
            }
            load.push(eccentricity * x.sin() * hx * hy);
        }
    }
    let lower: Vec<(usize, f64)> = (0..n * n).map(|dof| (dof, 0.0)).collect();
    problem(n * n, &entries, load, bounds(n * n, &lower, &[])?)
}

/// Uncoupled chains of ten dofs with three rows each, whose stiffnesses differ by up to four orders of magnitude.
fn separate_bodies(count: usize) -> Result<ContactProblem, Error> {
    let (mut entries, mut load, mut lower) = (Vec::new(), Vec::new(), Vec::new());
    for body in 0..count {
        let stiffness = 10.0_f64.powf(4.0 * noise(body));
        for place in 0..10 {
            let own = 10 * body + place;
            entries.push((own, own, (if place == 9 { 1.0 } else { 2.0 }) * stiffness));
            if place < 9 {
                entries.push((own + 1, own, -stiffness));
            }
            load.push(stiffness * (noise(11 * own) - 0.6));
            if place % 3 == 2 {
                lower.push((own, -noise(13 * own)));
            }
        }
    }
    problem(10 * count, &entries, load, bounds(10 * count, &lower, &[])?)
}

/// `n` beams of `n` nodes side by side, with a deflection and a rotation per node, springs between the beams, and a
/// floor below every node.
fn frame(n: usize) -> Result<ContactProblem, Error> {
    let dofs = 2 * n * n;
    let mut entries: Vec<(usize, usize, f64)> = Vec::new();
    let mut add = |dofs: &[usize], block: &[&[f64]]| {
        for (i, &row) in dofs.iter().enumerate() {
            for (j, &column) in dofs.iter().enumerate().filter(|entry| *entry.1 <= row) {
                entries.push((row, column, block[i][j]));
            }
        }
    };
    let beam: [&[f64]; 4] =
        [&[12.0, 6.0, -12.0, 6.0], &[6.0, 4.0, -6.0, 2.0], &[-12.0, -6.0, 12.0, -6.0], &[6.0, 2.0, -6.0, 4.0]];
    for line in 0..n {
        for node in 0..n {
            let own = 2 * (line * n + node);
            if node + 1 < n {
                add(&[own, own + 1, own + 2, own + 3], &beam);
            }
            if line + 1 < n {
                add(&[own, own + 2 * n], &[&[1e-3, -1e-3], &[-1e-3, 1e-3]]);
            }
            if node == 0 {
                add(&[own, own + 1], &[&[1e3, 0.0], &[0.0, 1e3]]);
            }
            if node + 1 == n {
                add(&[own], &[&[1e3]]);
            }
        }
    }
    let load = (0..dofs).map(|dof| if dof % 2 == 0 { -1e-3 * (1.0 + noise(dof)) } else { 0.0 }).collect();
    let lower: Vec<(usize, f64)> = (0..n * n).map(|node| (2 * node, -1.0 - 4.0 * noise(3 * node / n))).collect();
    problem(dofs, &entries, load, bounds(dofs, &lower, &[])?)
}
