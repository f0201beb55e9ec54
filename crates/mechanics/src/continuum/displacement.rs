//! Displacements that are quadratic on each triangle, in the basis of Bernstein: if the coefficients of a function on an edge are below
//! those of a bound, the function is below it everywhere.

use std::collections::BTreeMap;

use super::problem::{PlaneProblem, Tensor, work};
use super::system::{Block, LOCAL, Row, Unknowns};
use super::triangulation::{MIDDLES, Point, Triangulation, distance, outward, slopes, twice_area};
use crate::error::Error;
use signorini_qp as qp;

/// Displacements on a mesh.
#[derive(Debug)]
pub struct Displacements<'a> {
    problem: &'a PlaneProblem,
    mesh: &'a Triangulation,
    /// The six functions of each triangle, along both axes.
    pub numbers: Vec<[usize; LOCAL]>,
}

impl<'a> Displacements<'a> {
    pub fn new(problem: &'a PlaneProblem, mesh: &'a Triangulation) -> Self {
        let numbers = (0..mesh.triangles.len()).map(|triangle| {
            let (nodes, sides) = (mesh.triangles[triangle], mesh.sides[triangle]);
            let mut numbers = [0; LOCAL];
            for (local, node) in nodes.into_iter().chain(sides.map(|edge| mesh.nodes.len() + edge)).enumerate() {
                (numbers[2 * local], numbers[2 * local + 1]) = (2 * node, 2 * node + 1);
            }
            numbers
        });
        Displacements { problem, mesh, numbers: numbers.collect() }
    }

    /// The three functions on an edge along an axis: those of its start, its middle and its end.
    pub fn on_edge(&self, edge: usize, axis: usize) -> [usize; 3] {
        let [a, b] = self.mesh.edges[edge];
        [a, self.mesh.nodes.len() + edge, b].map(|node| 2 * node + axis)
    }

    /// The unknowns; those on held sides are prescribed.
    pub fn unknowns(&self) -> Unknowns {
        let mut held = vec![None; 2 * (self.mesh.nodes.len() + self.mesh.edges.len())];
        for (_, _, edge, condition) in self.mesh.outline() {
            for (axis, value) in self.problem.conditions[condition].held.into_iter().enumerate() {
                if value.is_some() {
                    self.on_edge(edge, axis).into_iter().for_each(|function| held[function] = value);
                }
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
        for (edge, [from, to], number) in self.problem.facing(self.mesh) {
            let facing = &self.problem.obstacles[number];
            let Some(gap) = facing.surface.gap(from, to) else { continue };
            for (function, bound) in self.on_edge(edge, facing.axis).into_iter().zip(gap.lower()) {
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

    /// The functions of each triangle, with its stiffness.
    pub fn blocks(&self) -> impl Iterator<Item = (&[usize; LOCAL], Block)> + '_ {
        self.numbers.iter().enumerate().map(|(triangle, numbers)| (numbers, self.stiffness(triangle)))
    }

    fn stiffness(&self, triangle: usize) -> Block {
        let corners = self.mesh.corners(triangle);
        let weight = self.problem.thickness * twice_area(corners) / 6.0;
        let slopes = slopes(corners);
        let mut block = [[0.0; LOCAL]; LOCAL];
        for at in MIDDLES {
            let strains = strains_of_functions(&slopes, at);
            let stresses = strains.map(|strain| self.problem.stress(strain));
            for (line, stress) in block.iter_mut().zip(stresses) {
                line.iter_mut().zip(strains).for_each(|(entry, strain)| *entry += weight * work(stress, strain));
            }
        }
        block
    }

    /// The work of the loads on each function.
    pub fn load(&self) -> Vec<f64> {
        let (problem, mesh) = (self.problem, self.mesh);
        let mut load = vec![0.0; 2 * (mesh.nodes.len() + mesh.edges.len())];
        for (triangle, numbers) in self.numbers.iter().enumerate() {
            // All six functions have the same mean.
            let share = problem.thickness * twice_area(mesh.corners(triangle)) / 12.0;
            numbers
                .iter()
                .enumerate()
                .for_each(|(place, &number)| load[number] += share * problem.body_force[place % 2]);
        }
        for (triangle, local, edge, condition) in mesh.outline() {
            let condition = &problem.conditions[condition];
            let (held, traction) = (condition.held, condition.pull(outward(mesh.corners(triangle), local).0));
            let [from, to] = mesh.edges[edge].map(|node| mesh.nodes[node]);
            let share = problem.thickness * distance(from, to) / 3.0;
            for axis in (0..2).filter(|&axis| held[axis].is_none()) {
                self.on_edge(edge, axis).into_iter().for_each(|function| load[function] += share * traction[axis]);
            }
        }
        load
    }

    /// The strain of a displacement at a point of a triangle, given in barycentric coordinates.
    pub fn strain(&self, coefficients: &[f64], triangle: usize, at: [f64; 3]) -> Tensor {
        let functions = strains_of_functions(&slopes(self.mesh.corners(triangle)), at);
        let own = self.numbers[triangle].map(|number| coefficients[number]);
        let mut strain = [0.0; 3];
        for (value, of_function) in own.into_iter().zip(functions) {
            (0..3).for_each(|entry| strain[entry] += value * of_function[entry]);
        }
        strain
    }
}

/// The strains of the twelve functions at a point: `l_k^2` of the corners, then `2 l_i l_j` of the sides, each along x and y.
fn strains_of_functions(slopes: &[Point; 3], at: [f64; 3]) -> [Tensor; LOCAL] {
    let mut strains = [[0.0; 3]; LOCAL];
    for local in 0..3 {
        let (i, j) = ((local + 1) % 3, (local + 2) % 3);
        let of_corner = [0, 1].map(|axis| 2.0 * at[local] * slopes[local][axis]);
        let of_side = [0, 1].map(|axis| 2.0 * (at[i] * slopes[j][axis] + at[j] * slopes[i][axis]));
        for (function, [x, y]) in [(local, of_corner), (3 + local, of_side)] {
            strains[2 * function] = [x, 0.0, y / 2.0];
            strains[2 * function + 1] = [0.0, y, x / 2.0];
        }
    }
    strains
}
