//! Guaranteed bounds of the contact force, of second order in the error.
//!
//! Let z be a displacement that is -1 towards the obstacle in the computed contact, `tau_z` a stress without load, free
//! of tractions outside the contact and with a pressure `p_z <= 0`, and `r = eps(z) - C^-1 tau_z`. The exact stress
//! lies in a ball about the mean `tau_m` of both stresses, with `|sigma - tau_m|^2 + S = rho^2`. Then
//!
//! ```text
//! F = (tau_m, r) + integral of p_z g + supports - l(z)
//!   + (sigma - tau_m, r) + integral of (-p_z) (g - u_n) + integral of (-p) (1 + z_n)
//! ```
//!
//! and the last two terms lie between 0 and `beta S`, if `1 + z_n <= beta (g - v_n)` and `-p_z <= beta (-p_tau)`,
//! coefficient by coefficient, with `S = integral of (-p) (g - v_n) + (-p_tau) (g - u_n) >= 0`. z and `tau_z` solve the
//! two problems with contact held.

use std::collections::BTreeSet;

use super::bound::{Bracket, Half};
use super::part_stress::PartStress;
use super::simplex::{Point, less, middle, work};
use super::stress::Stresses;
use super::system::{Block, CellNumbers, Row};
use crate::error::Error;
use signorini_fem::geometry::{midpoint, minus};
use signorini_fem::threads::{both, each};
use signorini_qp as qp;
use signorini_qp::{ContactSet, solve};

/// Values between 0 and -1 by less than this, and pressures below this share of the largest, are rounding.
const ROUNDING: f64 = 1e-12;

/// If forces can be brought into balance, values of the wrong sign up to this share of the largest are set to zero.
const ALMOST_RIGHT: f64 = 1e-3;

/// Trial caps of beta, over the beta at which its term would reach that of the ball.
const CAPS: [f64; 2] = [f64::INFINITY, 2.0];

/// Error of the solver of a pair, relative in energy: it counts by its product with the radius.
const OF_PAIR: f64 = 1e-4;

/// A gap that no displacement of order one closes.
const FAR: f64 = 1e3;

/// Largest number of rounds that change rows of the wrong sign.
const ROUNDS: usize = 12;

/// The matrices of the simplices, and the stresses without load, for every pair.
struct Blocks<'a> {
    displacement: Vec<Block>,
    stress: Vec<Block>,
    stresses: Stresses<'a>,
}

/// A stress with the values of its unknowns, and its force at each place.
type Pressed = (Vec<PartStress>, Vec<f64>, Vec<f64>);

/// A pair z, tau_z and the ratios of its rows.
struct Test {
    displacement: Vec<f64>,
    stress: Vec<PartStress>,
    /// The values of the unknowns of the stress.
    facets: Vec<f64>,
    /// The force at each place of the bracket, `<= 0`.
    pulls: Vec<f64>,
    /// For each row the ratio over its slack, and for each place the ratio over its pressure: the largest is beta.
    ratios: [Vec<f64>; 2],
}

impl Bracket<'_> {
    /// Bounds on the sum of the contact forces, in force: the forces that press the obstacles, if all are pressed.
    /// `None` if obstacles come from several directions, if only some are pressed, if the boundary that touches them is
    /// a rigid face, or if no bound was found. An interval with a half-width of `enough` times the force of
    /// the displacement is not made narrower by another pair.
    pub fn force_interval(&self, enough: f64) -> Result<Option<[f64; 2]>, Error> {
        if let Some(pressed) = self.problem.pressing_force() {
            return Ok(Some([pressed; 2]));
        }
        let corners: BTreeSet<_> = self.places.iter().map(|place| (place.on.facet, place.corner)).collect();
        if !self.problem.has_one_direction() || corners.len() != self.places.len() || self.is_at_rest() {
            return Ok(None);
        }
        let has_own_terms = |side: &Half| side.rows.iter().all(|row| side.unknowns.own_term(row).is_some());
        if !has_own_terms(&self.primal) || !has_own_terms(&self.dual) {
            return Ok(None);
        }
        let closed = &self.primal.solution.contact_set;
        let mut bonded: Vec<bool> = (0..self.primal.rows.len()).map(|row| closed.contains(row)).collect();
        let mut pressed: Vec<bool> = (0..self.places.len()).map(|row| self.pulls[row] < 0.0).collect();
        let unloaded = self.problem.unloaded();
        let blocks = Blocks {
            displacement: self.displacements.blocks(),
            stress: self.stresses.blocks(),
            stresses: Stresses::new(&unloaded, self.mesh)?,
        };
        let mut last: Option<Test> = None;
        let (mut interval, mut scale): (Option<[f64; 2]>, f64) = (None, 0.0);
        for cap in CAPS {
            if let Some(test) = &last {
                let most = cap * scale;
                if test.ratios.iter().flatten().all(|&ratio| ratio <= most) {
                    continue;
                }
                bonded.iter_mut().zip(&test.ratios[0]).for_each(|(bonded, &ratio)| *bonded |= ratio > most);
                pressed.iter_mut().zip(&test.ratios[1]).for_each(|(pressed, &ratio)| *pressed &= ratio <= most);
            }
            let Some(test) = self.test(&mut bonded, &mut pressed, &blocks)? else { break };
            let (found, natural) = self.interval(&test);
            scale = if last.is_none() { natural } else { scale };
            if found.iter().all(|bound| bound.is_finite()) {
                let [low, high] = interval.unwrap_or([0.0, f64::INFINITY]);
                let [low, high] = [low.max(found[0]), high.min(found[1])];
                interval = Some([low, high]);
                if high - low <= 2.0 * enough * self.force() {
                    break;
                }
            }
            last = Some(test);
        }
        // If only rounding is left, the ends may be exchanged; the defect is the rounding of all forces and loads.
        Ok(interval.map(|[low, high]| {
            let loads: f64 = self.displacements.load().iter().map(|load| load.abs()).sum();
            let rounding = self.defect * low.abs().max(high.abs()).max(loads);
            [low.min(high) - rounding, low.max(high) + rounding]
        }))
    }

    /// The interval of a pair, and the beta at which its term would reach that of the ball.
    fn interval(&self, test: &Test) -> ([f64; 2], f64) {
        // The square of the rest of the pair, its product with the mean stress, and by as much the polynomial for a
        // power of a radius may change such products.
        let of_cell = |cell: usize| {
            self.sums(cell, &self.rule(), |k, at| {
                let strain = self.strain(&test.displacement, cell, k, at.weights);
                let stress = self.stress_of(&test.stress, cell, k, at.weights);
                let own = self.strain(&self.primal.values, cell, k, at.weights);
                let elastic = self.elastic_stress(cell, k, at.weights);
                let law = self.law(cell);
                let rest = less(strain, law.compliance(stress));
                let mut base = at.weight * work(middle(law.stress(own), elastic), rest);
                if at.extra != 0.0 {
                    let extra = law.over_radius(own, strain) - work(elastic, law.compliance(stress));
                    base += at.extra * extra / 2.0;
                }
                let changes = [(strain, stress), (own, elastic)].map(|(a, b)| self.by_polynomial(cell, at, a, b));
                [self.square_of_rest(cell, at, strain, stress), base, changes[0], changes[1]]
            })
        };
        let of_cells = each(self.mesh.count(), of_cell);
        let [mut square, mut base, mut of_test, mut of_bracket] =
            [0, 1, 2, 3].map(|part| of_cells.iter().map(|cell| cell[part]).sum::<f64>());
        let of_pair = self.on_springs(&test.displacement, &test.facets);
        for (pair, own) in of_pair.zip(self.on_springs(&self.primal.values, &self.dual.values)) {
            let (weight, extra) = (own.at.weight, own.at.extra);
            square += pair.square_of_rest();
            base += weight * own.product(midpoint(own.moved, own.balanced), minus(pair.moved, pair.balanced))
                - extra * own.product(own.balanced, pair.balanced) / 2.0;
            of_test += extra * own.product(pair.balanced, pair.balanced);
            of_bracket += extra * own.product(own.balanced, own.balanced);
        }
        let by_polynomial = (of_test * of_bracket).sqrt() / 2.0;
        base += self.work_of_reactions(&test.stress, &self.forces_without_load(&test.facets, &test.pulls));
        let load = self.displacements.load();
        base -= test.displacement.iter().zip(&load).map(|(value, load)| value * load).sum::<f64>();
        let [mut low, mut high] = [base; 2];
        for (place, (&pull, row)) in self.places.iter().zip(test.pulls.iter().zip(&self.dual.rows)) {
            let gap = self.problem.gap(self.mesh, place.on.facet, place.obstacle);
            low += pull * row.gap;
            high += pull * (row.gap - gap.map_or(0.0, |gap| gap.below + gap.above));
        }
        let (length, radius) = (square.sqrt(), self.square_of_radius().max(0.0).sqrt());
        let beta = test.ratios.iter().flatten().fold(0.0, |beta: f64, &ratio| beta.max(ratio));
        let most = most_within(radius, length, beta);
        ([low - radius * length - by_polynomial, high + most + by_polynomial], length / (2.0 * radius))
    }

    /// The pair with these rows held; rows of the wrong sign are bonded or released until every row has the right sign.
    fn test(&self, bonded: &mut [bool], pressed: &mut [bool], blocks: &Blocks) -> Result<Option<Test>, Error> {
        let (displacement, stress) = both(
            || self.bonded_displacement(bonded, &blocks.displacement),
            || self.bonded_stress(pressed, &blocks.stress, &blocks.stresses),
        );
        let (Some(displacement), Some((stress, facets, pulls))) = (displacement?, stress?) else { return Ok(None) };
        let (primal, values) = (&self.primal, &self.primal.values);
        let of_row = |row: &Row| over(1.0 + row.value(&displacement), row.gap - row.value(values));
        let mut of_rows: Vec<f64> = primal.rows.iter().map(of_row).collect();
        // Places that a support holds do not move in the test, and may be touched.
        of_rows.extend(self.held_rows.iter().map(|row| over(1.0, row.gap - row.value(values))));
        let of_place = |(pull, own): (&f64, &f64)| if *pull < 0.0 { pull / own } else { 0.0 };
        let of_places = pulls.iter().zip(&self.pulls).map(of_place).collect();
        Ok(Some(Test { displacement, stress, facets, pulls, ratios: [of_rows, of_places] }))
    }

    /// The displacement -1 at bonded rows, without load; rows below -1 are bonded too, and those that are only a little
    /// below it are moved there.
    fn bonded_displacement(&self, bonded: &mut [bool], blocks: &[Block]) -> Result<Option<Vec<f64>>, Error> {
        let (rows, places) = (&self.primal.rows, self.displacements.places());
        for _ in 0..ROUNDS {
            let of_mesh = (&self.displacements.numbers, blocks, &places[..]);
            let Some(mut values) = self.held(&self.primal, bonded, of_mesh)? else { return Ok(None) };
            let open = |row: usize| 1.0 + rows[row].value(&values);
            let wrong: Vec<usize> =
                (0..bonded.len()).filter(|&row| open(row) < -self.allowed_sign() && !bonded[row]).collect();
            if wrong.is_empty() {
                for (row, bonded) in rows.iter().zip(bonded.iter()) {
                    if *bonded || row.value(&values) < -1.0 {
                        self.primal.unknowns.move_to(&mut values, row, -1.0);
                    }
                }
                return Ok(Some(values));
            }
            wrong.into_iter().for_each(|row| bonded[row] = true);
        }
        Ok(None)
    }

    /// The stress under facets held at -1 where pressed, without load, and its forces there; places with a pulling
    /// force are released.
    fn bonded_stress(
        &self,
        pressed: &mut [bool],
        blocks: &[Block],
        stresses: &Stresses,
    ) -> Result<Option<Pressed>, Error> {
        let places = self.stresses.places();
        for _ in 0..ROUNDS {
            let of_mesh = (&self.stresses.numbers, blocks, &places[..]);
            let Some(values) = self.held(&self.dual, pressed, of_mesh)? else { return Ok(None) };
            let stress = stresses.stresses(&values);
            let mut pulls = self.pulls_of(&stress, &values);
            // The force for a displacement of one of a body as wide as high, for comparison: a body that nothing holds
            // moves without force.
            let volume: f64 = (0..self.mesh.count()).map(|cell| self.volume(cell)).sum();
            let depth = self.problem.thickness * if self.mesh.dimension == 2 { 1.0 } else { volume.cbrt() };
            let unit = self.problem.stiffest() * depth;
            let largest = qp::largest(&pulls);
            let allowed = f64::max(self.allowed_sign() * largest, ROUNDING * unit);
            let wrong: Vec<usize> = (0..pressed.len()).filter(|&row| pressed[row] && pulls[row] > allowed).collect();
            if wrong.is_empty() {
                for (pull, pressed) in pulls.iter_mut().zip(pressed.iter()) {
                    *pull = if *pressed { pull.min(0.0) } else { 0.0 };
                }
                let answer = (&self.dual.unknowns, &values[..]);
                let balance = self.balance.as_ref();
                let balanced = balance.and_then(|balance| balance.stress(stresses, answer, &self.places, &pulls));
                return Ok(Some((balanced.unwrap_or(stress), values, pulls)));
            }
            wrong.into_iter().for_each(|row| pressed[row] = false);
        }
        Ok(None)
    }

    /// The size, over the largest, of a value of the wrong sign that is not worth another solve.
    fn allowed_sign(&self) -> f64 {
        if self.balance.is_some() { ALMOST_RIGHT } else { ROUNDING }
    }

    /// All values with supports at zero, under no load, with these rows at -1 towards the obstacle; `None` if they were
    /// not found. If the data of the bracket serve again, rows that would pull go beyond -1, as in contact.
    fn held(
        &self,
        side: &Half,
        rows: &[bool],
        (numbers, blocks, places): (&CellNumbers, &[Block], &[Point]),
    ) -> Result<Option<Vec<f64>>, Error> {
        let (unknowns, found) = match &side.prepared {
            Some(prepared) => {
                let settings = self.settings.clone().with_accuracy(OF_PAIR);
                let gaps: Vec<f64> = rows.iter().map(|held| if *held { -1.0 } else { FAR }).collect();
                let closed: ContactSet = rows.iter().copied().collect();
                let prepared = prepared.with_settings(&settings)?.with_load(vec![0.0; side.unknowns.free])?;
                (side.unknowns.with_held(std::iter::empty(), 0.0), prepared.starting_from(closed).solve(&gaps))
            }
            None => {
                let chosen = side.rows.iter().zip(rows).filter(|row| *row.1).map(|row| row.0);
                let Some(unknowns) = side.unknowns.with_held(chosen, -1.0) else { return Ok(None) };
                let load = vec![0.0; unknowns.count()];
                let posed = unknowns.problem(self.mesh.dimension, numbers, blocks, &load, &[], places)?;
                // In space a hierarchy may be the only way.
                let linear = (self.mesh.dimension == 2).then(|| posed.linear_displacement(&self.settings));
                if let Some(Ok(free)) = linear {
                    return Ok(Some(unknowns.expanded(&free)));
                }
                (Some(unknowns), solve(&posed, &self.settings))
            }
        };
        let free = match found {
            Ok(solution) => solution.displacement,
            Err(qp::Error::NotCertified { solution, .. }) => solution.displacement,
            Err(_) => return Ok(None),
        };
        Ok(unknowns.map(|unknowns| unknowns.expanded(&free)))
    }

    /// The force of a stress without load at each place, along the obstacle.
    fn pulls_of(&self, stress: &[PartStress], facets: &[f64]) -> Vec<f64> {
        let [forces, _] = self.forces_on_facets(stress);
        let of_springs = self.forces_without_load(facets, &[]);
        let left: Vec<f64> = forces.iter().zip(of_springs).map(|(force, of_springs)| force - of_springs).collect();
        let along = self.dual.unknowns.gathered(&left);
        let of_row =
            |row| self.dual.unknowns.own_term(row).map_or(0.0, |(free, coefficient)| along[free] / coefficient);
        self.dual.rows.iter().map(of_row).collect()
    }

    /// The forces along the unknowns of the stress from springs and obstacles.
    fn forces_without_load(&self, facets: &[f64], pulls: &[f64]) -> Vec<f64> {
        let all = self.stresses.given_forces(facets, &self.places, pulls);
        let rest = vec![0.0; facets.len()];
        let of_load = self.stresses.given_forces(&rest, &[], &[]);
        all.iter().zip(of_load).map(|(all, load)| all - load).collect()
    }

    /// The force of the displacement: the sum of its multipliers, `>= 0`.
    pub fn force(&self) -> f64 {
        -self.primal.solution.multiplier.iter().sum::<f64>()
    }
}

/// The largest `x length + beta (radius^2 - x^2)` over x from zero to the radius.
fn most_within(radius: f64, length: f64, beta: f64) -> f64 {
    if length >= 2.0 * beta * radius {
        radius * length
    } else {
        beta * radius * radius + length * length / (4.0 * beta)
    }
}

/// A ratio with a displacement of order one as numerator: zero if that is rounding, infinite if only the denominator is
/// zero.
fn over(value: f64, size: f64) -> f64 {
    if value <= ROUNDING { 0.0 } else { value / size.max(0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of x; the function is quadratic, so that they miss its maximum by at most their square.
    const STEPS: usize = 1000;

    #[test]
    fn the_part_of_the_interval_that_the_ball_allows_is_the_maximum_over_the_ball() {
        for radius in [0.3, 1.0, 40.0] {
            // Lengths on both sides of `2 beta radius`, where the maximum leaves the end of the interval.
            for share in [0.0, 0.1, 0.9, 1.1, 1.9, 1.999, 2.0, 2.001, 3.0, 1e3] {
                for beta in [0.0, 0.2, 5.0] {
                    let length = if beta == 0.0 { share } else { share * beta * radius };
                    let value = |step: usize| {
                        let x = radius * step as f64 / STEPS as f64;
                        x * length + beta * (radius - x) * (radius + x)
                    };
                    let sampled = (0..=STEPS).map(value).fold(0.0, f64::max);
                    let most = most_within(radius, length, beta);
                    let missed = 1e-12 * most + beta * (radius / STEPS as f64).powi(2);
                    assert!(
                        (0.0..=missed).contains(&(most - sampled + 1e-15 * most)),
                        "{radius} {length} {beta}: {most} {sampled}"
                    );
                }
            }
        }
    }
}
