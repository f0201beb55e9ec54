//! Motions that a problem declares as those of a rigid body.

use crate::linear::{across, extend, norm};
use crate::problem::ContactProblem;

/// A direction is a rigid-body mode if it differs from one by less than this share of its length: null vectors of
/// rounded entries have about ten digits.
const RIGID: f64 = 1e-6;

/// Returns `true` if a displacement, of one body, is one of the rigid-body modes that the problem declares. `bodies`
/// gives the body of each dof.
pub(super) fn is_rigid(problem: &ContactProblem, displacement: &[f64], bodies: &[usize]) -> bool {
    let Some(modes) = problem.near_null() else { return false };
    let body = bodies[place_of_largest(displacement)];
    let own = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(bodies).filter(|entry| *entry.1 == body).map(|entry| *entry.0).collect()
    };
    let mut directions: Vec<Vec<f64>> = Vec::new();
    for mode in modes.vectors() {
        extend(&mut directions, own(mode), RIGID);
    }
    let elsewhere = displacement.iter().zip(bodies).filter(|entry| *entry.1 != body).map(|entry| entry.0.abs());
    let left = norm(&across(&directions, own(displacement))) + elsewhere.sum::<f64>();
    left <= RIGID * norm(displacement)
}

pub(super) fn place_of_largest(values: &[f64]) -> usize {
    let by_size = |a: &(usize, &f64), b: &(usize, &f64)| a.1.abs().total_cmp(&b.1.abs());
    values.iter().enumerate().max_by(by_size).map_or(0, |entry| entry.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::multigrid::NearNullSpace;

    #[test]
    fn a_motion_is_rigid_if_it_is_one_of_those_declared_on_its_own_body() {
        // Two bodies of three dofs on a line, with a translation and a rotation of the whole space.
        let problem = ContactProblem::of_entries(&[(0, 0, 1.0)], &[0.0; 6], &[], &[]);
        let bodies = [0, 0, 0, 1, 1, 1];
        let translation = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        assert!(!is_rigid(&problem, &translation, &bodies));
        let modes = vec![vec![1.0; 6], vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0]];
        let problem = problem.with_near_null(NearNullSpace::new(modes, 6).unwrap()).unwrap();
        assert!(is_rigid(&problem, &translation, &bodies));
        assert!(is_rigid(&problem, &[0.0, 0.0, 0.0, -1.0, 1.0, 3.0], &bodies));
        // A bend, and motions of both bodies.
        assert!(!is_rigid(&problem, &[1.0, 0.0, 1.0, 0.0, 0.0, 0.0], &bodies));
        assert!(!is_rigid(&problem, &[1.0; 6], &bodies));
        let nearly = |share: f64| [1.0, 1.0 + share, 1.0, 0.0, 0.0, 0.0];
        assert!(is_rigid(&problem, &nearly(RIGID), &bodies) && !is_rigid(&problem, &nearly(1e2 * RIGID), &bodies));
    }
}
