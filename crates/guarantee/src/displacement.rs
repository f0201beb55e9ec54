//! Displacements that are quadratic on each simplex, in the basis of Bernstein: if the coefficients of a function on a
//! facet are below those of a bound, the function is below it everywhere.

use std::collections::BTreeMap;

use super::integration::{Sample, samples, samples_on_facet};
use super::mesh::{OuterFacet, Partner, SimplexMesh};
use super::problem::{ContinuumProblem, weighted_mean};
use super::simplex::{MOST_CORNERS, Point, Simplex, Tensor, Weights, corners_of_side, number_of_pair, pairs, work};
use super::stress::Place;
use super::system::{Affine, Block, CellNumbers, Row, add_springs};
use crate::error::Error;
use signorini_fem::geometry::{COORDINATES, midpoint};
use signorini_fem::threads::each;
use signorini_qp as qp;

#[derive(Debug)]
pub struct Displacements<'a> {
    problem: &'a ContinuumProblem,
    mesh: &'a SimplexMesh,
    /// The functions of each simplex, each along all axes.
    pub numbers: CellNumbers,
}

impl<'a> Displacements<'a> {
    pub fn new(problem: &'a ContinuumProblem, mesh: &'a SimplexMesh) -> Self {
        let (dimension, nodes) = (mesh.dimension, mesh.nodes.len());
        let functions = |cell: usize| {
            mesh.cell(cell).iter().copied().chain(mesh.edges_of(cell).iter().map(move |edge| nodes + edge))
        };
        let along_axes = |function: usize| dimension * function..dimension * (function + 1);
        let numbers = (0..mesh.count()).flat_map(functions).flat_map(along_axes).collect();
        let of_cell = dimension * (dimension + 1) * (dimension + 2) / 2;
        Displacements { problem, mesh, numbers: CellNumbers { of_cell, numbers } }
    }

    /// The places of the functions: a linear displacement has its values there as coefficients.
    pub fn places(&self) -> Vec<Point> {
        let nodes = &self.mesh.nodes;
        let middle = |&[a, b]: &[usize; 2]| midpoint(nodes[a], nodes[b]);
        nodes.iter().copied().chain(self.mesh.edges.iter().map(middle)).collect()
    }

    /// The functions on a facet: those of its corners, then those of their pairs.
    pub fn on_facet(&self, outer: &OuterFacet) -> Vec<usize> {
        let dimension = self.mesh.dimension;
        let numbers = self.numbers.of(outer.cell);
        local_functions(dimension, outer.local).map(|function| numbers[dimension * function] / dimension).collect()
    }

    /// The coefficients of a displacement on a facet along a vector.
    pub fn along(&self, values: &[f64], outer: &OuterFacet, vector: Point) -> Vec<f64> {
        let dimension = self.mesh.dimension;
        let along =
            |function: usize| (0..dimension).map(|axis| vector[axis] * values[dimension * function + axis]).sum();
        self.on_facet(outer).into_iter().map(along).collect()
    }

    /// The coefficients of a displacement on a facet towards an obstacle, less that of the obstacle.
    pub fn towards(&self, values: &[f64], outer: &OuterFacet, obstacle: usize) -> Vec<f64> {
        let (dimension, normal) = (self.mesh.dimension, self.problem.obstacles[obstacle].normal);
        let travel =
            self.problem.travel(obstacle, self.function_count()).map_or(0.0, |(travel, share)| share * values[travel]);
        let own = self.along(values, outer, normal).into_iter().map(|coefficient| coefficient + travel);
        match self.mesh.partner(outer.facet, obstacle) {
            None => own.collect(),
            Some(partner) => {
                let other = self.along(values, &partner.on, normal);
                own.zip(opposite_functions(dimension, partner)).map(|(own, function)| own - other[function]).collect()
            }
        }
    }

    /// The mean of a displacement towards an obstacle at a place, as in a row of the stress.
    pub fn mean_towards(&self, values: &[f64], place: &Place) -> f64 {
        weighted_mean(self.mesh.dimension, place.corner, &self.towards(values, &place.on, place.obstacle))
    }

    pub fn largest(&self, values: &[f64]) -> f64 {
        qp::largest(&values[..self.mesh.dimension * self.function_count()])
    }

    /// The unknown displacements: none is radial on the axis of revolution.
    pub fn unknowns(&self) -> Affine {
        let places = self.places();
        // On the axis there is no radial displacement.
        let on_axis = (0..places.len()).filter(|&place| self.problem.is_on_axis(places[place]));
        let held = on_axis.map(|place| (place, COORDINATES[0]));
        Affine::new(self.problem, self.mesh, &places, held, |outer| self.on_facet(outer))
    }

    /// The rows that keep a displacement out of the obstacles, each function and obstacle once: those with a free
    /// unknown, and then those that supports hold.
    pub fn rows(&self, unknowns: &Affine) -> Result<[Vec<Row>; 2], Error> {
        let mut gaps: BTreeMap<(usize, usize, Option<usize>), f64> = BTreeMap::new();
        let dimension = self.mesh.dimension;
        for (outer, number) in self.problem.facing(self.mesh) {
            let Some(gap) = self.problem.gap(self.mesh, outer.facet, number) else { continue };
            let partner = self.mesh.partner(outer.facet, number).map(|partner| {
                let functions = self.on_facet(&partner.on);
                opposite_functions(dimension, partner).map(move |function| functions[function])
            });
            let mut others = partner.into_iter().flatten();
            for (function, bound) in self.on_facet(&outer).into_iter().zip(gap.lower()) {
                let least = gaps.entry((number, function, others.next())).or_insert(f64::INFINITY);
                *least = least.min(bound);
            }
        }
        let (mut rows, mut held) = (Vec::with_capacity(gaps.len()), Vec::new());
        for ((number, function, other), gap) in gaps {
            let normal = self.problem.obstacles[number].normal;
            let travel = self.problem.travel(number, self.function_count());
            let row = Row::new((function, other), dimension, normal, travel, gap);
            let (free, prescribed) = unknowns.of_terms(&row.terms);
            match free.is_empty() {
                true if prescribed > gap => {
                    let overlap = prescribed - gap;
                    let reason = format!("a support holds the boundary {overlap:.3e} inside obstacles[{number}]");
                    return Err(qp::Error::Infeasible { reason, rows: Vec::new(), weights: Vec::new(), overlap }.into());
                }
                true => held.push(row),
                false => rows.push(row),
            }
        }
        Ok([rows, held])
    }

    /// Number of functions: of the corners, then of the edges.
    fn function_count(&self) -> usize {
        self.mesh.nodes.len() + self.mesh.edges.len()
    }

    /// The stiffness of each simplex.
    pub fn blocks(&self) -> Vec<Block> {
        let mut blocks = each(self.mesh.count(), |cell| self.stiffness(cell));
        let dimension = self.mesh.dimension;
        for outer in self.mesh.surface() {
            let springs = self.problem.springs(&outer);
            if springs.is_there() {
                let (normal, _) = self.mesh.simplex(outer.cell).outward(outer.local);
                let local: Vec<usize> = local_functions(dimension, outer.local).collect();
                let mut share = vec![vec![0.0; local.len()]; local.len()];
                for at in samples_on_facet(self.problem, &self.mesh.corners_of_facet(outer.facet)) {
                    let values: Vec<f64> = values_of_functions(dimension - 1, at.weights).collect();
                    for (line, one) in share.iter_mut().zip(&values) {
                        line.iter_mut().zip(&values).for_each(|(sum, other)| *sum += at.weight * one * other);
                    }
                }
                add_springs(&mut blocks[outer.cell], dimension, (&springs, normal), &local, &share);
            }
        }
        blocks
    }

    fn stiffness(&self, cell: usize) -> Block {
        let (simplex, count) = (self.mesh.simplex(cell), self.numbers.of(cell).len());
        let law = self.problem.law(self.mesh.origins[cell]);
        let mut block = vec![0.0; count * count];
        let mut strains: Vec<Tensor> = Vec::with_capacity(count);
        for sample in samples(self.problem, &simplex) {
            strains.clear();
            strains.extend(self.strains_of_functions(&simplex, sample.weights));
            for (first, &strain) in strains.iter().enumerate() {
                let mut stress = law.stress(strain).map(|part| sample.weight * part);
                if sample.extra != 0.0 {
                    let extra = law.stress_over_radius(strain);
                    stress.iter_mut().zip(extra).for_each(|(sum, part)| *sum += sample.extra * part);
                }
                let line = &mut block[count * first..count * (first + 1)];
                let entries = line.iter_mut().zip(&strains).skip(first);
                entries.for_each(|(entry, &other)| *entry += work(stress, other));
            }
        }
        for line in 1..count {
            (0..line).for_each(|column| block[count * line + column] = block[count * column + line]);
        }
        block
    }

    /// The work of loads, less that of the stress without strain, on each unknown.
    pub fn load(&self) -> Vec<f64> {
        let (problem, mesh, dimension) = (self.problem, self.mesh, self.mesh.dimension);
        let mut load = vec![0.0; dimension * self.function_count()];
        for (cell, numbers) in self.numbers.iter().enumerate() {
            let (medium, simplex) = (problem.medium(mesh.origins[cell]), mesh.simplex(cell));
            if medium.body_force == [0.0; 3] && medium.own_stress.is_none() {
                continue;
            }
            for Sample { weights, place, weight, .. } in samples(problem, &simplex) {
                let own = medium.own_stress(place);
                let values = values_of_functions(dimension, weights);
                let forces =
                    values.flat_map(|value| medium.body_force.iter().take(dimension).map(move |force| value * force));
                let strains = self.strains_of_functions(&simplex, weights);
                for ((&number, force), strain) in numbers.iter().zip(forces).zip(strains) {
                    load[number] += weight * (force - work(own, strain));
                }
            }
        }
        for outer in mesh.surface() {
            let (normal, size) = mesh.simplex(outer.cell).outward(outer.local);
            let (share, functions) = (problem.share_of_corner(size), self.on_facet(&outer));
            for (corner, at) in mesh.corners_of_facet(outer.facet).into_iter().enumerate() {
                let pull = problem.pull(outer.condition, normal, at);
                for (place, &function) in functions.iter().enumerate() {
                    let unit: Vec<f64> =
                        (0..functions.len()).map(|other| f64::from(u8::from(other == place))).collect();
                    let part = share * weighted_mean(dimension, corner, &unit);
                    (0..dimension).for_each(|axis| load[dimension * function + axis] += part * pull[axis]);
                }
            }
        }
        load.extend(problem.loads_of_motions());
        load
    }

    /// The strain of a displacement at a point of a simplex, given in barycentric coordinates.
    pub fn strain(&self, coefficients: &[f64], cell: usize, at: Weights) -> Tensor {
        let (simplex, dimension) = (self.mesh.simplex(cell), self.mesh.dimension);
        // With the coefficients c_ij the displacement is the sum of l_j d_j / 2, and its gradient that of d_j times the
        // slope of l_j, with d_j = 2 sum of l_i c_ij.
        let mut along = [[0.0; 3]; MOST_CORNERS];
        for (pair, numbers) in pairs(dimension + 1).zip(self.numbers.of(cell).chunks_exact(dimension)) {
            let [i, j] = pair;
            for (axis, &number) in numbers.iter().enumerate() {
                let twice = 2.0 * coefficients[number];
                along[j][axis] += at[i] * twice;
                along[i][axis] += if i == j { 0.0 } else { at[j] * twice };
            }
        }
        let mut gradient = [[0.0; 3]; 3];
        for (along, slope) in along.iter().zip(simplex.slopes()).take(dimension + 1) {
            for (line, part) in gradient.iter_mut().zip(along) {
                line.iter_mut().zip(slope).for_each(|(entry, slope)| *entry += part * slope);
            }
        }
        let shear = |i: usize, j: usize| (gradient[i][j] + gradient[j][i]) / 2.0;
        let mut hoop = gradient[2][2];
        if self.problem.is_axisymmetric {
            // A radial displacement stretches the circle about the axis.
            let radial: f64 = along.iter().zip(at).map(|(along, weight)| weight * along[0] / 2.0).sum();
            hoop += radial / simplex.at(at)[0];
        }
        [gradient[0][0], gradient[1][1], hoop, shear(0, 1), shear(1, 2), shear(2, 0)]
    }

    /// The strains of the functions at a point: `l_i^2` of the corners, then `2 l_i l_j` of the pairs, each along all
    /// axes.
    fn strains_of_functions(&self, simplex: &Simplex, at: Weights) -> impl Iterator<Item = Tensor> + use<> {
        let (dimension, slopes) = (self.mesh.dimension, simplex.slopes());
        let over_radius = if self.problem.is_axisymmetric { 1.0 / simplex.at(at)[0] } else { 0.0 };
        let slope = move |[i, j]: [usize; 2]| -> Point {
            let twice = |axis: usize| 2.0 * (at[i] * slopes[j][axis] + at[j] * slopes[i][axis]);
            let along = |axis: usize| if i == j { twice(axis) / 2.0 } else { twice(axis) };
            [0, 1, 2].map(along)
        };
        pairs(dimension + 1).map(slope).zip(values_of_functions(dimension, at)).flat_map(move |(slope, value)| {
            (0..dimension).map(move |axis| {
                let mut strain = strain_along(axis, slope);
                // A radial displacement stretches the circle about the axis.
                strain[2] += if axis == 0 { value * over_radius } else { 0.0 };
                strain
            })
        })
    }
}

/// The values at a point of the functions of a simplex of this dimension, or of a facet.
pub fn values_of_functions(dimension: usize, at: Weights) -> impl Iterator<Item = f64> {
    pairs(dimension + 1).map(move |[i, j]| at[i] * at[j] * if i == j { 1.0 } else { 2.0 })
}

/// The functions of a simplex on the side opposite to a corner: those of its corners, then those of their pairs.
fn local_functions(dimension: usize, side: usize) -> impl Iterator<Item = usize> {
    let corners: Vec<usize> = corners_of_side(dimension, side).collect();
    pairs(dimension).map(move |pair| {
        let [i, j] = pair.map(|corner| corners[corner]);
        number_of_pair(dimension + 1, i, j)
    })
}

/// For each function on a facet the number of the one on the opposite facet.
fn opposite_functions(dimension: usize, partner: &Partner) -> impl Iterator<Item = usize> + use<> {
    let corners = partner.corners;
    pairs(dimension).map(move |pair| {
        let [i, j] = pair.map(|corner| corners[corner]);
        number_of_pair(dimension, i, j)
    })
}

/// The strain of a displacement along an axis with this slope.
fn strain_along(axis: usize, [x, y, z]: Point) -> Tensor {
    match axis {
        0 => [x, 0.0, 0.0, y / 2.0, 0.0, z / 2.0],
        1 => [0.0, y, 0.0, x / 2.0, z / 2.0, 0.0],
        _ => [0.0, 0.0, z, 0.0, y / 2.0, x / 2.0],
    }
}
