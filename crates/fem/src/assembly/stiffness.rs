//! K = sum of the element stiffnesses, in the free dofs, assembled directly into the lower triangle in compressed
//! columns.

use std::ops::Range;

use super::element_stiffness::{Block, ElementStiffness};
use super::{DofMap, Frame, element_stiffness};
use crate::body::{ElasticBody, Strained};
use crate::element::{MAX_NODES, Tabulated};
use crate::error::Error;
use crate::geometry::{Around, Symmetric};
use crate::mesh::Mesh;
use crate::threads::{in_order, on_parts, parts};
use signorini_linear as linear;
use signorini_linear::{SparseMatrix, SymmetricMatrix};

/// The free dofs of one node: the number of the first, how many there are, and the axis of each: of the frame if the
/// node has one.
#[derive(Clone, Copy, Default)]
struct FreeAxes<'a> {
    first: usize,
    count: usize,
    axes: [usize; 3],
    frame: Option<&'a Frame>,
}

impl<'a> FreeAxes<'a> {
    fn of(node: usize, dimension: usize, dofs: &'a DofMap) -> Self {
        let mut free = FreeAxes { frame: dofs.frame(node), ..FreeAxes::default() };
        for axis in 0..dimension {
            if let Some(number) = dofs.number(dimension * node + axis) {
                if free.count == 0 {
                    free.first = number;
                }
                free.axes[free.count] = axis;
                free.count += 1;
            }
        }
        free
    }
}

/// The stiffness K of the free dofs (n x n), in force per length; only its lower triangle is ever built.
pub fn stiffness(body: &ElasticBody, dofs: &DofMap) -> Result<SymmetricMatrix, Error> {
    body.check_nodal("dof map", dofs.nodal_count())?;
    let (starts, rows) = lower_pattern(body.mesh(), dofs);
    let mut values = vec![0.0; rows.len()];
    let parts = parts(body.mesh().element_count());
    // A part has the columns of whole nodes.
    let first_node = |part: usize| match part == parts {
        true => body.mesh().nodes().len(),
        false => {
            let column = starts.partition_point(|&start| start < rows.len() / parts * part);
            dofs.free().get(column).map_or(0, |dof| dof / body.dimension())
        }
    };
    let nodes: Vec<usize> = (0..=parts).map(first_node).collect();
    let first_column = |&node: &usize| dofs.free().partition_point(|&dof| dof < node * body.dimension());
    let bounds: Vec<usize> = nodes.iter().map(|node| starts[first_column(node)]).collect();
    let congruent = Congruent::of(body);
    on_parts(&mut values, &bounds, |part, values| {
        let columns =
            Columns { starts: &starts, rows: &rows, nodes: nodes[part]..nodes[part + 1], first: bounds[part] };
        columns.add_elements(body, dofs, &congruent, values);
    });
    if let Some(entry) = values.iter().position(|value| !value.is_finite()) {
        let at = format!("row {}", rows[entry]);
        return Err(linear::Error::NotFinite { name: "stiffness", at, value: values[entry], allowed: "finite" }.into());
    }
    Ok(SymmetricMatrix::from_lower(SparseMatrix::from_parts(dofs.free().len(), starts, rows, values))?)
}

/// The columns of some nodes that follow each other.
struct Columns<'a> {
    starts: &'a [usize],
    rows: &'a [u32],
    nodes: Range<usize>,
    /// The place of their first entry.
    first: usize,
}

impl Columns<'_> {
    /// Adds the elements around these nodes, in their order.
    fn add_elements(&self, body: &ElasticBody, dofs: &DofMap, congruent: &Congruent, values: &mut [f64]) {
        let tables = body.tabulated();
        let mut last: Option<(u32, ElementStiffness)> = None;
        for (element, nodes) in body.mesh().elements().enumerate() {
            if !nodes.iter().any(|node| self.nodes.contains(node)) {
                continue;
            }
            let representative = congruent.representative(element);
            let stiffness = match last.take() {
                Some((of, stiffness)) if of == representative => stiffness,
                _ => {
                    let Some(placed) = body.element(representative as usize) else { continue };
                    element_stiffness(body, &placed, tables.at(placed.kind))
                }
            };
            match dofs.basis.is_nodal() {
                true => self.add_element(nodes, dofs, body.dimension(), &stiffness, values),
                false => {
                    let mut changed = stiffness.clone();
                    dofs.basis.change(nodes, &mut changed);
                    self.add_element(nodes, dofs, body.dimension(), &changed, values);
                }
            }
            last = Some((representative, stiffness));
        }
    }

    fn add_element(
        &self,
        nodes: &[usize],
        dofs: &DofMap,
        dimension: usize,
        element: &ElementStiffness,
        values: &mut [f64],
    ) {
        let Columns { starts, rows, first, .. } = *self;
        let mut free = [FreeAxes::default(); MAX_NODES];
        for (of_node, &node) in free.iter_mut().zip(nodes) {
            *of_node = FreeAxes::of(node, dimension, dofs);
        }
        for a in 0..nodes.len() {
            for b in 0..=a {
                // The lower triangle has the later node as its row; free dofs are numbered in the order of the nodes.
                let mirrored = nodes[a] < nodes[b];
                let (row, column) = if mirrored { (&free[b], &free[a]) } else { (&free[a], &free[b]) };
                if row.count == 0 || column.count == 0 || !self.nodes.contains(&nodes[a].min(nodes[b])) {
                    continue;
                }
                let of_first = &rows[starts[column.first]..starts[column.first + 1]];
                let Ok(place) = of_first.binary_search(&(row.first as u32)) else { continue };
                let turned;
                let block = match (free[a].frame, free[b].frame) {
                    (None, None) => element.block(a, b),
                    frames => {
                        turned = turn(element.block(a, b), frames.0, frames.1);
                        &turned
                    }
                };
                for (j, &along) in column.axes[..column.count].iter().enumerate() {
                    // Each column of a node starts one row further down; rows of one node follow each other.
                    let start = starts[column.first + j] - first + place;
                    let skipped = if a == b { j } else { 0 };
                    for i in skipped..row.count {
                        let axis = row.axes[i];
                        let value = if mirrored { block[along][axis] } else { block[axis][along] };
                        values[start + i - j] += value;
                    }
                }
            }
        }
    }
}

/// T_a K_ab T_b'; the rows of T are the axes of a frame.
fn turn(block: &Block, of_rows: Option<&Frame>, of_columns: Option<&Frame>) -> Block {
    let mut turned = *block;
    if let Some(frame) = of_columns {
        turned.iter_mut().for_each(|row| frame.turn_in(row));
    }
    if let Some(frame) = of_rows {
        for j in 0..3 {
            let mut column = turned.map(|row| row[j]);
            frame.turn_in(&mut column);
            turned.iter_mut().zip(column).for_each(|(row, entry)| row[j] = entry);
        }
    }
    turned
}

/// No node has visited this one yet.
const NEVER: u32 = u32::MAX;

/// The nodes around one node after another.
struct Neighbours<'a> {
    mesh: &'a Mesh,
    around: &'a Around,
    /// The node that has visited each node last.
    seen: Vec<u32>,
    found: Vec<usize>,
}

impl Neighbours<'_> {
    /// The nodes with the same or a larger number that share an element with a node, unsorted.
    fn of(&mut self, node: usize) -> &mut [usize] {
        self.found.clear();
        for &element in self.around.at(node) {
            for &other in self.mesh.element(element as usize) {
                if other >= node && self.seen[other] != node as u32 {
                    self.seen[other] = node as u32;
                    self.found.push(other);
                }
            }
        }
        &mut self.found
    }
}

/// Column starts and sorted rows of the lower triangle in the free dofs.
///
/// A mesh has so few nodes that their numbers, and those of the elements around them, fit 32 bits.
pub(super) fn lower_pattern(mesh: &Mesh, dofs: &DofMap) -> (Vec<usize>, Vec<u32>) {
    let (dimension, count) = (mesh.dimension(), mesh.nodes().len());
    let of_elements = (0..mesh.element_count()).map(|element| mesh.element(element).iter().copied());
    let around = Around::new(count, of_elements);
    let neighbours = || Neighbours { mesh, around: &around, seen: vec![NEVER; count], found: Vec::new() };
    let free_axes = |node: usize| (dimension * node..dimension * (node + 1)).filter_map(|dof| dofs.number(dof));
    let parts = parts(count);
    let nodes: Vec<usize> = (0..=parts).map(|part| count * part / parts).collect();
    // The entries of the first column of each node.
    let mut lengths = vec![0_u32; count];
    on_parts(&mut lengths, &nodes, |part, lengths| {
        let mut neighbours = neighbours();
        for (node, length) in (nodes[part]..).zip(lengths) {
            if free_axes(node).next().is_some() {
                *length = neighbours.of(node).iter().map(|&other| free_axes(other).count() as u32).sum();
            }
        }
    });
    let (mut starts, mut entries, mut bounds) = (Vec::with_capacity(dofs.free().len() + 1), 0, Vec::new());
    starts.push(0);
    for (node, &length) in lengths.iter().enumerate() {
        if nodes.get(bounds.len()) == Some(&node) {
            bounds.push(entries);
        }
        for column in 0..free_axes(node).count() {
            entries += length as usize - column;
            starts.push(entries);
        }
    }
    bounds.push(entries);
    let mut rows = vec![0_u32; entries];
    on_parts(&mut rows, &bounds, |part, rows| {
        let (mut neighbours, mut rest) = (neighbours(), rows.iter_mut());
        for node in nodes[part]..nodes[part + 1] {
            let own = free_axes(node).count();
            if own > 0 {
                let around = neighbours.of(node);
                around.sort_unstable();
                for column in 0..own {
                    let of_column = around.iter().flat_map(|&other| free_axes(other)).skip(column);
                    of_column.zip(rest.by_ref()).for_each(|(row, place)| *place = row as u32);
                }
            }
        }
    });
    (starts, rows)
}

/// Coordinates are known to this many units in the last place: they are products and sums of the numbers of a scene.
const COORDINATE_ULPS: f64 = 4.0;

/// For each element one before it, or itself, whose stiffness it has to the rounding of coordinates.
pub(super) struct Congruent {
    representative: Vec<u32>,
}

impl Congruent {
    /// Compares each element with the representative of the element before it. Elements of a body of revolution, or
    /// with axes that turn, have their own stiffness each.
    pub fn of(body: &ElasticBody) -> Self {
        let has_turning_axes = body.phases().iter().any(|phase| phase.law.turns());
        let is_alone = body.formulation().is_axisymmetric() || has_turning_axes;
        let mut last = 0;
        let mut representative_of = |element: usize| {
            if is_alone || !are_congruent(body, last, element) {
                last = element;
            }
            last as u32
        };
        Congruent { representative: (0..body.mesh().element_count()).map(&mut representative_of).collect() }
    }

    /// The element whose stiffness `element` has.
    pub fn representative(&self, element: usize) -> u32 {
        self.representative[element]
    }
}

/// Returns `true` if one element is the other one moved by a translation.
fn are_congruent(body: &ElasticBody, one: usize, other: usize) -> bool {
    let mesh = body.mesh();
    let of_one_kind =
        mesh.kind_of(one) == mesh.kind_of(other) && std::ptr::eq(body.phase_of(one), body.phase_of(other));
    let mut pairs =
        mesh.element(one).iter().zip(mesh.element(other)).map(|pair| (mesh.nodes()[*pair.0], mesh.nodes()[*pair.1]));
    let Some(first) = pairs.next().filter(|_| of_one_kind) else { return false };
    pairs.all(|(one, other)| {
        (0..3).all(|axis| {
            let [a, b, c, d] = [one[axis], first.0[axis], other[axis], first.1[axis]];
            let size = a.abs().max(b.abs()).max(c.abs()).max(d.abs());
            ((a - b) - (c - d)).abs() <= COORDINATE_ULPS * f64::EPSILON * size
        })
    })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::ElementKind;
    use crate::formulation::Formulation;
    use crate::material::Material;
    use crate::mesh::Mesh;

    /// The representatives of a row of unit squares whose corners lie at `place(x, y)`.
    fn representatives(formulation: Formulation, place: impl Fn(f64, f64) -> [f64; 2]) -> Vec<u32> {
        let node = |index: usize| place((index / 2) as f64, (index % 2) as f64);
        let nodes = (0..12).map(|index| [node(index)[0], node(index)[1], 0.0]).collect();
        let connectivity = (0..5).flat_map(|cell| [0, 2, 3, 1].map(|corner| 2 * cell + corner)).collect();
        let bilinear = ElementKind::ALL.into_iter().find(|kind| kind.dimension() == 2 && kind.nodes() == 4).unwrap();
        let mesh = Mesh::new(nodes, bilinear, connectivity, Vec::new()).unwrap();
        let body = ElasticBody::new(mesh, Material::new(1.0, 0.3).unwrap(), formulation).unwrap();
        let soft = Material::new(0.5, 0.3).unwrap();
        let body = body.with_material(&[4], soft).unwrap();
        Congruent::of(&body).representative
    }

    #[test]
    fn cells_of_a_lattice_have_one_stiffness_and_others_their_own() {
        let plane = || Formulation::PlaneStrain { thickness: 1.0 };
        // A tenth is no binary number: cells differ by rounding.
        assert_eq!(representatives(plane(), |x, y| [0.1 * x + 3.0, 0.1 * y]), [0, 0, 0, 0, 4]);
        let stretched = |x: f64, y: f64| [x + if x > 2.5 { 1e-9 } else { 0.0 }, y];
        assert_eq!(representatives(plane(), stretched), [0, 0, 2, 3, 4]);
        let around_the_axis = Formulation::Axisymmetric;
        assert_eq!(representatives(around_the_axis, |x, y| [x, y]), [0, 1, 2, 3, 4]);
    }
}
