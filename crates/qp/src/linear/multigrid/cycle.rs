//! One V-cycle through a hierarchy.

use super::face::FaceLevels;
use super::hierarchy::Hierarchy;
use super::operator::Operator;
use crate::linear::Spare;
use crate::linear::real::Real;

impl<T: Real> Hierarchy<T> {
    /// Approximately `A^-1` of a force, by one V-cycle, in the given face; a vector of `work`.
    pub fn cycle(&self, force: &[f64], face: Option<&FaceLevels<T>>, work: &Spare<f64>) -> Vec<f64> {
        let mut rest = self.spare.zeros(self.nodes.size * self.nodes.count);
        let exponent = self.nodes.gather(force, &mut rest);
        if let Some(face) = face {
            face.held.project_force(&mut rest);
        }
        let moved = self.descend(0, rest, face);
        let mut displacement = work.take(force.len());
        self.nodes.scatter(&moved, self.shift - exponent, &mut displacement);
        self.spare.give(moved);
        displacement
    }

    /// The unknowns of a level under the forces `rest`.
    pub(super) fn descend(&self, depth: usize, mut rest: Vec<T>, face: Option<&FaceLevels<T>>) -> Vec<T> {
        let Some(level) = self.levels.get(depth) else {
            let force: Vec<f64> = rest.iter().map(|value| value.double()).collect();
            let coarsest = face.map_or(&*self.coarsest, |face| &face.coarsest);
            let mut x: Vec<T> = coarsest.solve(&force).into_iter().map(T::of).collect();
            if let Some(held) = face.filter(|_| depth == 0).map(|face| &face.held) {
                held.project(&mut x);
            }
            return x;
        };
        let operator = Operator {
            matrix: &level.matrix,
            held: face.filter(|_| depth == 0).map(|face| &face.held),
            change: face.and_then(|face| face.changes.get(depth.wrapping_sub(1))),
            threads: self.threads,
            spare: &self.spare,
        };
        let smoother = face.and_then(|face| face.smoother(depth)).unwrap_or(&level.smoother);
        let mut x = self.spare.zeros(rest.len());
        let step = smoother.smooth(&operator, &mut x, &mut rest);
        operator.subtract_product(&step, &mut rest);
        self.spare.give(step);
        let restricted = level.prolongator.transposed_mul(&rest, self.threads, &self.spare);
        let correction = self.descend(depth + 1, restricted, face);
        let mut moved = self.spare.take(rest.len());
        level.prolongator.mul_into(&correction, &mut moved, self.threads);
        self.spare.give(correction);
        operator.project(&mut moved);
        operator.add(&moved, &mut x);
        operator.subtract_product(&moved, &mut rest);
        let step = smoother.smooth(&operator, &mut x, &mut rest);
        [moved, rest, step].into_iter().for_each(|vector| self.spare.give(vector));
        x
    }
}
