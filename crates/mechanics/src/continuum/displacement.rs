//! Displacements that are quadratic on each simplex, in the basis of Bernstein: if the coefficients of a function on a facet are below
//! those of a bound, the function is below it everywhere.

use std::collections::BTreeMap;

use super::johnson_mercier::corners_of_side;
use super::mesh::{OuterFacet, SimplexMesh};
use super::problem::{ContinuumProblem, weighted_mean};
use super::simplex::{MOST_CORNERS, Point, Tensor, Weights, pairs, quadratic_rule, work};
use super::system::{Block, Numbers, Row, Unknowns};
use crate::error::Error;
use crate::fem::geometry::key;
use crate::fem::threads::each;
use signorini_qp as qp;

/// Displacements on a mesh.
#[derive(Debug)]
pub struct Displacements<'a> {
    problem: &'a ContinuumProblem,
    mesh: &'a SimplexMesh,
    /// The functions of each simplex, each along all axes.
    pub numbers: Numbers,
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
        Displacements { problem, mesh, numbers: Numbers::new(of_cell, numbers) }
    }

    /// Number of unknowns, free or held.
    fn count(&self) -> usize {
        self.mesh.dimension * (self.mesh.nodes.len() + self.mesh.edges.len())
    }

    /// The places of the functions: a linear displacement has its values there as coefficients.
    pub fn places(&self) -> Vec<Point> {
        let nodes = &self.mesh.nodes;
        let middle = |&[a, b]: &[usize; 2]| [0, 1, 2].map(|axis| (nodes[a][axis] + nodes[b][axis]) / 2.0);
        nodes.iter().copied().chain(self.mesh.edges.iter().map(middle)).collect()
    }

    /// The unknowns on a facet of the surface along an axis: those of its corners, then those of their pairs.
    pub fn on_facet(&self, outer: &OuterFacet, axis: usize) -> Vec<usize> {
        let (mesh, dimension) = (self.mesh, self.mesh.dimension);
        let corners: Vec<usize> = corners_of_side(dimension, outer.local).collect();
        let numbers = self.numbers.of(outer.cell);
        let place = |pair: [usize; 2]| {
            let pair = pair.map(|corner| corners[corner]);
            pairs(dimension + 1).position(|other| other == key(pair[0], pair[1])).unwrap_or(0)
        };
        debug_assert!(mesh.sides(outer.cell)[outer.local] == outer.facet);
        pairs(dimension).map(|pair| numbers[dimension * place(pair) + axis]).collect()
    }

    /// The mean of a displacement towards an obstacle on a facet of the surface with the weight of a corner, as in a row of the stress.
    pub fn approached(&self, coefficients: &[f64], outer: &OuterFacet, corner: usize, obstacle: usize) -> f64 {
        let facing = &self.problem.obstacles[obstacle];
        let functions = self.on_facet(outer, facing.axis);
        let on_facet: Vec<f64> = functions.into_iter().map(|function| coefficients[function]).collect();
        facing.sense * weighted_mean(self.mesh.dimension, corner, &on_facet)
    }

    /// The unknowns; those on held facets are prescribed.
    pub fn unknowns(&self) -> Unknowns {
        let mut held = vec![None; self.count()];
        for outer in self.mesh.surface() {
            for (axis, value) in self.problem.held(&outer) {
                self.on_facet(&outer, axis).into_iter().for_each(|function| held[function] = Some(value));
            }
        }
        Unknowns::new(held)
    }

    /// The rows that keep a displacement out of the obstacles, each function and obstacle once.
    ///
    /// # Errors
    /// [`qp::Error::Infeasible`] if a prescribed displacement leads into an obstacle.
    pub fn rows(&self, unknowns: &Unknowns) -> Result<Vec<Row>, Error> {
        let mut gaps: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        for (outer, number) in self.problem.facing(self.mesh) {
            let facing = &self.problem.obstacles[number];
            let Some(gap) = facing.surface.gap(&self.mesh.corners_of_facet(outer.facet)) else { continue };
            for (function, bound) in self.on_facet(&outer, facing.axis).into_iter().zip(gap.lower()) {
                let least = gaps.entry((number, function)).or_insert(f64::INFINITY);
                *least = least.min(bound);
            }
        }
        let mut rows = Vec::with_capacity(gaps.len());
        for ((number, unknown), gap) in gaps {
            let sense = self.problem.obstacles[number].sense;
            match unknowns.held[unknown] {
                Some(held) if sense * held > gap => {
                    let overlap = sense * held - gap;
                    let reason = format!("a support holds the boundary {overlap:.3e} inside obstacles[{number}]");
                    return Err(qp::Error::Infeasible { reason, rows: Vec::new(), weights: Vec::new(), overlap }.into());
                }
                Some(_) => {}
                None => rows.push(Row { unknown, sense, gap }),
            }
        }
        Ok(rows)
    }

    /// The stiffness of each simplex.
    pub fn blocks(&self) -> Vec<Block> {
        each(self.mesh.count(), |cell| self.stiffness(cell))
    }

    fn stiffness(&self, cell: usize) -> Block {
        let (simplex, dimension) = (self.mesh.simplex(cell), self.mesh.dimension);
        let weight = self.problem.thickness * simplex.size() / (dimension + 1) as f64;
        let (slopes, count) = (simplex.slopes(), self.numbers.of(cell).len());
        let mut block = vec![0.0; count * count];
        for at in quadratic_rule(dimension) {
            let strains: Vec<Tensor> = strains_of_functions(dimension, &slopes, at).collect();
            for (line, strain) in block.chunks_exact_mut(count).zip(&strains) {
                let stress = self.problem.stress(*strain);
                line.iter_mut().zip(&strains).for_each(|(entry, &strain)| *entry += weight * work(stress, strain));
            }
        }
        block
    }

    /// The work of the loads on each function.
    pub fn load(&self) -> Vec<f64> {
        let (problem, mesh, dimension) = (self.problem, self.mesh, self.mesh.dimension);
        let mut load = vec![0.0; self.count()];
        for (cell, numbers) in self.numbers.iter().enumerate() {
            // All functions have the same mean.
            let share = problem.thickness * mesh.simplex(cell).size() * dimension as f64 / numbers.len() as f64;
            let parts = numbers.iter().zip(problem.body_force.iter().take(dimension).cycle());
            parts.for_each(|(&number, force)| load[number] += share * force);
        }
        for outer in mesh.surface() {
            let condition = &problem.conditions[outer.condition];
            let (normal, size) = mesh.simplex(outer.cell).outward(outer.local);
            let (held, traction) = (condition.held, condition.pull(normal));
            for axis in (0..dimension).filter(|&axis| held[axis].is_none()) {
                let functions = self.on_facet(&outer, axis);
                let share = problem.thickness * size / functions.len() as f64;
                functions.into_iter().for_each(|function| load[function] += share * traction[axis]);
            }
        }
        load
    }

    /// The strain of a displacement at a point of a simplex, given in barycentric coordinates.
    pub fn strain(&self, coefficients: &[f64], cell: usize, at: Weights) -> Tensor {
        let (dimension, slopes) = (self.mesh.dimension, self.mesh.simplex(cell).slopes());
        let mut strain = [0.0; 6];
        for (&number, of_function) in self.numbers.of(cell).iter().zip(strains_of_functions(dimension, &slopes, at)) {
            strain.iter_mut().zip(of_function).for_each(|(sum, part)| *sum += coefficients[number] * part);
        }
        strain
    }
}

/// The strains of the functions at a point: `l_i^2` of the corners, then `2 l_i l_j` of the pairs, each along all axes.
fn strains_of_functions(dimension: usize, slopes: &[Point; MOST_CORNERS], at: Weights) -> impl Iterator<Item = Tensor> {
    let slope = move |[i, j]: [usize; 2]| -> Point {
        let twice = |axis: usize| 2.0 * (at[i] * slopes[j][axis] + at[j] * slopes[i][axis]);
        let along = |axis: usize| if i == j { twice(axis) / 2.0 } else { twice(axis) };
        [0, 1, 2].map(along)
    };
    pairs(dimension + 1).map(slope).flat_map(move |slope| (0..dimension).map(move |axis| strain_along(axis, slope)))
}

/// The strain of a displacement along an axis with this slope.
fn strain_along(axis: usize, [x, y, z]: Point) -> Tensor {
    match axis {
        0 => [x, 0.0, 0.0, y / 2.0, 0.0, z / 2.0],
        1 => [0.0, y, 0.0, x / 2.0, z / 2.0, 0.0],
        _ => [0.0, 0.0, z, 0.0, y / 2.0, x / 2.0],
    }
}
