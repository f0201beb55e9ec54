//! The stiffness of one element, block by block; the forces that hold elements in a displacement.

use std::ops::Range;

use crate::body::{BodyElement, ElasticBody, Integration, LocalPoint, Strained};
use crate::element::{Cell, Tabulated};
use crate::error::Error;
use crate::geometry::{Symmetric, turned};
use crate::material::{Lame, Matrices, Stiffness};
use crate::threads::in_order;

/// The stiffness of an element of `body`; `table` has its shape functions at the quadrature points of the formulation.
pub fn element_stiffness(body: &ElasticBody, element: &BodyElement, table: &Tabulated) -> ElementStiffness {
    let blocks = match &element.phase.law.stiffness {
        &Stiffness::Isotropic(lame) => isotropic_stiffness(body, lame, table, element),
        Stiffness::General(matrices) => general_stiffness(body, matrices, table, &element.cell),
    };
    ElementStiffness::of(blocks)
}

/// The stiffness of an isotropic element.
///
/// In a body of revolution d_a has the hoop part N_a/r along r, which adds the term `2 mu h_a h_b`, h = N/r. With mean
/// dilatation d is replaced by its mean over the element.
fn isotropic_stiffness(body: &ElasticBody, lame: Lame, table: &Tabulated, element: &BodyElement) -> Vec<Block> {
    let cell = &element.cell;
    let nodes = table.reference.nodes.len();
    let dilatation = match element.phase.integration {
        Integration::MeanDilatation => Dilatation::Mean,
        Integration::Standard if body.formulation().is_axisymmetric() => Dilatation::Revolved,
        Integration::Standard => Dilatation::Trace,
    };
    // Gradients are per unit of the cell and determinants in powers of the unit: this is the remaining power.
    let scale = cell.unit().powi(table.reference.dimension as i32 - 2);
    let mut products = vec![[[0.0; 3]; 3]; pair(nodes, 0)];
    let mut radial = if dilatation == Dilatation::Trace { Radial::of(0) } else { Radial::of(nodes) };
    for at in &table.points {
        let point = body.point(cell, at);
        let weight = point.weight * scale;
        for a in 0..nodes {
            let g = point.gradients[a];
            let weighted = [g[0] * weight, g[1] * weight, g[2] * weight];
            for b in 0..=a {
                let (block, other) = (&mut products[pair(a, b)], &point.gradients[b]);
                for i in 0..3 {
                    for j in 0..3 {
                        block[i][j] += weighted[i] * other[j];
                    }
                }
            }
        }
        if dilatation != Dilatation::Trace {
            radial.add(&point, nodes, weight);
        }
    }
    for a in 0..nodes {
        for b in 0..=a {
            let place = pair(a, b);
            let g = products[place];
            let squares = radial.squares.get(place).copied().unwrap_or(0.0);
            let dilatation = radial.dilatation(dilatation, (a, b), g);
            finish(&mut products[place], lame, &dilatation, squares);
        }
    }
    products
}

/// Computes the stiffness of a pair of nodes from the integral of grad N_a grad N_b, that of the dilatations, and that
/// of h_a h_b.
#[inline]
fn finish(block: &mut Block, Lame { lambda, mu }: Lame, dilatation: &Block, squares: f64) {
    let g = *block;
    let shear = mu * (g[0][0] + g[1][1] + g[2][2]);
    for i in 0..3 {
        for j in 0..3 {
            block[i][j] = lambda * dilatation[i][j] + mu * g[j][i];
        }
        block[i][i] += shear;
    }
    block[0][0] += 2.0 * mu * squares;
}

/// The form of the dilatation d_a of a unit displacement.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Dilatation {
    /// grad N_a.
    Trace,
    /// With the hoop part N_a/r along r.
    Revolved,
    /// Its mean over the element, the hoop part included.
    Mean,
}

/// Integrals that only revolved elements and mean dilatation need.
struct Radial {
    volume: f64,
    /// Of the dilatation of a unit displacement of each node along each axis.
    dilatation: Vec<[f64; 3]>,
    /// Of h_a h_b.
    squares: Vec<f64>,
    /// Of h_a grad N_b.
    rows: Vec<[f64; 2]>,
    /// Of grad N_a h_b.
    columns: Vec<[f64; 2]>,
}

impl Radial {
    /// Zeros for an element with this number of nodes.
    fn of(nodes: usize) -> Self {
        let pairs = pair(nodes, 0);
        Radial {
            volume: 0.0,
            dilatation: vec![[0.0; 3]; nodes],
            squares: vec![0.0; pairs],
            rows: vec![[0.0; 2]; pairs],
            columns: vec![[0.0; 2]; pairs],
        }
    }

    /// Adds a quadrature point.
    #[inline]
    fn add(&mut self, point: &LocalPoint, nodes: usize, weight: f64) {
        self.volume += weight;
        for a in 0..nodes {
            let (g, h) = (point.gradients[a], point.hoop[a] * weight);
            for (sum, slope) in self.dilatation[a].iter_mut().zip(g) {
                *sum += weight * slope;
            }
            self.dilatation[a][0] += h;
            for b in 0..=a {
                let (other, h_other) = (point.gradients[b], point.hoop[b]);
                let place = pair(a, b);
                self.squares[place] += h * h_other;
                for axis in 0..2 {
                    self.rows[place][axis] += h * other[axis];
                    self.columns[place][axis] += weight * g[axis] * h_other;
                }
            }
        }
    }

    /// The integral of d_a d_b; `g` is the integral of grad N_a grad N_b.
    #[inline]
    fn dilatation(&self, of: Dilatation, (a, b): (usize, usize), g: Block) -> Block {
        let place = pair(a, b);
        let mut dilatation = g;
        match of {
            Dilatation::Trace => {}
            Dilatation::Mean => {
                for (i, row) in dilatation.iter_mut().enumerate() {
                    for (j, entry) in row.iter_mut().enumerate() {
                        *entry = self.dilatation[a][i] * (self.dilatation[b][j] / self.volume);
                    }
                }
            }
            Dilatation::Revolved => {
                dilatation[0][0] += self.squares[place];
                for (axis, row) in dilatation.iter_mut().enumerate().take(2) {
                    row[0] += self.columns[place][axis];
                }
                for (entry, part) in dilatation[0].iter_mut().zip(self.rows[place]) {
                    *entry += part;
                }
            }
        }
        dilatation
    }
}

// The stiffness of one element of any material: `K_ab = sum_q w B_a' C B_b`, B_a the engineering strains of a unit
// displacement of node a along each axis.

/// The blocks of all pairs of nodes, for the stiffness C. Where its axes turn, strains are turned into them.
pub(super) fn general_stiffness(body: &ElasticBody, matrices: &Matrices, table: &Tabulated, cell: &Cell) -> Vec<Block> {
    let nodes = table.reference.nodes.len();
    // Gradients are per unit of the cell and determinants in powers of the unit: this is the remaining power.
    let scale = cell.unit().powi(table.reference.dimension as i32 - 2);
    let mut blocks = vec![[[0.0; 3]; 3]; pair(nodes, 0)];
    for at in &table.points {
        let point = body.point(cell, at);
        let weight = point.weight * scale;
        let mut strains: Vec<[Symmetric; 3]> = (0..nodes).map(|node| unit_strains(&point, node)).collect();
        if let Some(axes) = matrices.axes(|| cell.place(&at.shape)) {
            strains.iter_mut().flatten().for_each(|strain| *strain = along(*strain, &axes));
        }
        for (a, of_a) in strains.iter().enumerate() {
            let stresses = of_a.map(|strain| {
                let stress =
                    matrices.stiffness.map(|row| row.iter().zip(strain).map(|(entry, part)| entry * part).sum::<f64>());
                stress.map(|component| weight * component)
            });
            for (b, of_b) in strains.iter().enumerate().take(a + 1) {
                let block = &mut blocks[pair(a, b)];
                for (row, stress) in block.iter_mut().zip(&stresses) {
                    for (entry, strain) in row.iter_mut().zip(of_b) {
                        *entry += stress.iter().zip(strain).map(|(stress, part)| stress * part).sum::<f64>();
                    }
                }
            }
        }
    }
    blocks
}

/// Engineering strains along axes.
fn along([xx, yy, zz, xy, yz, zx]: Symmetric, axes: &[[f64; 3]; 3]) -> Symmetric {
    let [xx, yy, zz, xy, yz, zx] = turned([xx, yy, zz, xy / 2.0, yz / 2.0, zx / 2.0], axes);
    [xx, yy, zz, 2.0 * xy, 2.0 * yz, 2.0 * zx]
}

/// The engineering strains of a unit displacement of a node along x, y and z.
fn unit_strains(point: &LocalPoint, node: usize) -> [Symmetric; 3] {
    let [x, y, z] = point.gradients[node];
    [[x, 0.0, point.hoop[node], y, 0.0, z], [0.0, y, 0.0, x, z, 0.0], [0.0, 0.0, z, 0.0, y, x]]
}

/// A block for a pair of nodes: row axis, column axis.
pub(super) type Block = [[f64; 3]; 3];

/// The stiffness of one element, in force per length: a block for every pair of its nodes.
#[derive(Clone, Debug)]
pub struct ElementStiffness {
    blocks: Vec<Block>,
}

impl ElementStiffness {
    /// From the blocks of nodes a >= b, pair by pair.
    pub(super) fn of(blocks: Vec<Block>) -> Self {
        ElementStiffness { blocks }
    }

    /// The block of local nodes `a >= b`: entry `[i][j]` is the force on `a` along axis i per displacement of `b` along
    /// axis j. The block of (b, a) is its transpose.
    #[inline]
    pub fn block(&self, a: usize, b: usize) -> &Block {
        &self.blocks[pair(a, b)]
    }
}

/// The index of nodes a >= b among the pairs of an element.
#[inline]
pub(super) fn pair(a: usize, b: usize) -> usize {
    a * (a + 1) / 2 + b
}

/// The nodal forces (length `dim * n_nodes`, in force) that hold the body in the nodal displacement `displacement`
/// (length `dim * n_nodes`, order `[u_x0, u_y0, u_x1, ...]`, in length).
///
/// Computed from the strains, element by element: a rigid translation gives exactly zero. Exceptions: a radial
/// translation of a body of revolution is not rigid, and temperatures and initial stresses give a stress without
/// strain.
pub fn internal_force(body: &ElasticBody, displacement: &[f64]) -> Result<Vec<f64>, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let tables = body.tabulated();
    let mut force = vec![0.0; displacement.len()];
    let of_run = |run: Range<usize>| {
        let mut forces = Vec::new();
        for element in run.clone().filter_map(|index| body.element(index)) {
            let first = forces.len();
            forces.resize(first + element.nodes.len(), [0.0; 3]);
            let strained = body.strained(&tables, displacement, &element);
            of_cell(&strained, tables.at(element.kind), &mut forces[first..], |_| {});
        }
        (run, forces)
    };
    in_order(body.mesh().element_count(), of_run, |(run, forces)| add_to_nodes(body, run, &forces, &mut force));
    Ok(force)
}

/// Adds the forces on the nodes of an element to `forces`; `seen` takes the stress at each quadrature point, in order.
#[inline]
pub fn of_cell(strained: &Strained, table: &Tabulated, forces: &mut [[f64; 3]], mut seen: impl FnMut(&Symmetric)) {
    for at in &table.points {
        let point = strained.displaced(at);
        let stress = strained.stress(at, &point);
        point.add_forces(at, &stress, forces);
        seen(&stress);
    }
    let scale = strained.unit_of_force();
    forces.iter_mut().flatten().for_each(|component| *component *= scale);
}

/// Adds the forces on the nodes of some elements, one element after another, to those of the body.
pub fn add_to_nodes(body: &ElasticBody, elements: Range<usize>, forces: &[[f64; 3]], sum: &mut [f64]) {
    let dimension = body.dimension();
    let nodes = elements.flat_map(|index| body.mesh().element(index));
    for (&node, force) in nodes.zip(forces) {
        let of_node = &mut sum[dimension * node..dimension * (node + 1)];
        of_node.iter_mut().zip(force).for_each(|(sum, component)| *sum += component);
    }
}
