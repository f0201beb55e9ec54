//! Loads for which a problem is solvable, unbounded, in balance or at a vertex.

use super::Draws;
use super::rows::{Rows, dot};

/// A load on the stiffness K: one that moves the body by about 1, with or without forces along its rows; or a random
/// load; or zero.
pub fn load(draws: &mut Draws, stiffness: &[Vec<f64>], rows: &Rows, point: &[f64], at_vertex: bool) -> Vec<f64> {
    let n = point.len();
    let by_moving = |moved: &[f64]| stiffness.iter().map(|line| dot(line, moved)).collect::<Vec<f64>>();
    let moved: Vec<f64> = match draws.below(3) {
        0 => (0..n).map(|_| f64::from(draws.between(-8, 8)) / 4.0).collect(),
        1 => (0..n).map(|_| 2.0 * draws.signed()).collect(),
        _ => {
            // Some of the dofs move far more than the others.
            let far = draws.pick(&[1.0, 1.0, 1024.0, 1048576.0]);
            (0..n).map(|_| draws.signed() * if draws.one_in(2) { far } else { 1.0 }).collect()
        }
    };
    if at_vertex {
        return pressed(draws, by_moving(point), stiffness, rows);
    }
    match draws.below(8) {
        0 => vec![0.0; n],
        1 | 2 => {
            let size = |dof: usize| if stiffness[dof][dof] > 0.0 { stiffness[dof][dof].sqrt() } else { 1.0 };
            (0..n).map(|dof| 4.0 * draws.signed() * size(dof)).collect()
        }
        3 | 4 => by_moving(&moved),
        _ => pressed(draws, by_moving(&moved), stiffness, rows),
    }
}

/// The load plus forces along some of the rows, each about as large as the stiffness of its dofs.
fn pressed(draws: &mut Draws, mut load: Vec<f64>, stiffness: &[Vec<f64>], rows: &Rows) -> Vec<f64> {
    for row in &rows.contact {
        if draws.one_in(3) {
            continue;
        }
        let softest = (0..row.len()).filter(|&dof| row[dof] != 0.0 && stiffness[dof][dof] > 0.0);
        let softest = softest.map(|dof| stiffness[dof][dof]).fold(f64::INFINITY, f64::min);
        let force = draws.short(-3, 2) * if softest.is_finite() { 2.0_f64.powf(softest.log2().round()) } else { 1.0 };
        load.iter_mut().zip(row).for_each(|(f, b)| *f += force * b);
    }
    load
}
