//! K = sum of the stiffnesses of elements and springs, in the unknowns, assembled directly into the lower triangle in
//! compressed columns.

use std::ops::Range;

use super::dofs::ByOne;
use super::element_stiffness::ElementStiffness;
use super::{DofMap, Springs, element_stiffness};
use crate::body::ElasticBody;
use crate::element::MAX_NODES;
use crate::error::Error;
use crate::geometry::{Around, dot};
use crate::mesh::Mesh;
use crate::threads::{on_parts, parts};
use signorini_linear as linear;
use signorini_linear::{SparseMatrix, SymmetricMatrix};

/// The free dofs of one plain node: the number of the first, how many there are, and the axis of each.
#[derive(Clone, Copy, Default)]
struct FreeAxes {
    first: usize,
    count: usize,
    axes: [usize; 3],
}

impl FreeAxes {
    fn of(node: usize, dimension: usize, dofs: &DofMap) -> Self {
        let mut free = FreeAxes::default();
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

/// The stiffness K of the unknowns (n x n), in force per length; only its lower triangle is ever built.
pub fn stiffness(body: &ElasticBody, dofs: &DofMap) -> Result<SymmetricMatrix, Error> {
    stiffness_on(body, dofs, &[])
}

/// The stiffness K of the unknowns (n x n) of a body on springs, in force per length.
#[doc(hidden)]
pub fn stiffness_on(body: &ElasticBody, dofs: &DofMap, springs: &[Springs]) -> Result<SymmetricMatrix, Error> {
    body.check_nodal("dof map", dofs.nodal_count())?;
    let pattern = Pattern::of(body.mesh(), dofs, springs);
    let (starts, rows) = pattern.lower();
    let mut values = vec![0.0; rows.len()];
    let parts = parts(body.mesh().element_count());
    // A part has the columns of whole groups.
    let first_group = |part: usize| match part == parts {
        true => pattern.groups(),
        false => {
            let column = starts.partition_point(|&start| start < rows.len() / parts * part);
            dofs.free().get(column).map_or(body.mesh().nodes().len(), |dof| dof / body.dimension())
        }
    };
    let groups: Vec<usize> = (0..=parts).map(first_group).collect();
    let bounds: Vec<usize> = groups.iter().map(|&group| starts[pattern.first[group]]).collect();
    let congruent = Congruent::of(body);
    on_parts(&mut values, &bounds, |part, values| {
        let range = groups[part]..groups[part + 1];
        let unknowns = pattern.first[range.start]..pattern.first[range.end];
        let columns = Columns { starts: &starts, rows: &rows, range, unknowns, first: bounds[part] };
        columns.add_elements(body, dofs, &congruent, values);
    });
    let (range, unknowns) = (0..pattern.groups(), 0..dofs.count());
    let all = Columns { starts: &starts, rows: &rows, range, unknowns, first: 0 };
    let moved_by = |node: usize| dofs.displaced_by(node, body.dimension());
    for (a, b, block) in springs.iter().flat_map(|springs| &springs.pairs) {
        all.add_block((&moved_by(*a), &moved_by(*b)), |i, j| block[i][j], &mut values);
    }
    if let Some(entry) = values.iter().position(|value| !value.is_finite()) {
        let at = format!("row {}", rows[entry]);
        return Err(linear::Error::NotFinite { name: "stiffness", at, value: values[entry], allowed: "finite" }.into());
    }
    Ok(SymmetricMatrix::from_lower(SparseMatrix::from_parts(dofs.count(), starts, rows, values))?)
}

/// The columns of some groups that follow each other.
struct Columns<'a> {
    starts: &'a [usize],
    rows: &'a [u32],
    range: Range<usize>,
    unknowns: Range<usize>,
    /// The place of their first entry.
    first: usize,
}

impl Columns<'_> {
    /// Adds the elements around these groups, in their order.
    fn add_elements(&self, body: &ElasticBody, dofs: &DofMap, congruent: &Congruent, values: &mut [f64]) {
        let tables = body.tabulated();
        let is_here = |node: &usize| self.range.contains(node) || dofs.group_of(*node).is_some();
        let mut last: Option<(u32, ElementStiffness)> = None;
        for (element, nodes) in body.mesh().elements().enumerate() {
            if !nodes.iter().any(is_here) {
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
            match dofs.all_plain() || nodes.iter().all(|&node| dofs.is_plain(node)) {
                true => self.add_element(nodes, dofs, body.dimension(), &stiffness, values),
                false => {
                    let moved_by = |&node: &usize| dofs.displaced_by(node, body.dimension());
                    let moved_by: Vec<_> = nodes.iter().map(moved_by).collect();
                    for (a, of_a) in moved_by.iter().enumerate() {
                        for (b, of_b) in moved_by.iter().enumerate() {
                            let block = stiffness.block(a.max(b), a.min(b));
                            let entry = |i: usize, j: usize| if a < b { block[j][i] } else { block[i][j] };
                            self.add_block((of_a, of_b), entry, values);
                        }
                    }
                }
            }
            last = Some((representative, stiffness));
        }
    }

    /// Adds the block of two nodes to the entries of the unknowns that move them.
    fn add_block(
        &self,
        (of_rows, of_columns): (&[ByOne], &[ByOne]),
        block: impl Fn(usize, usize) -> f64,
        values: &mut [f64],
    ) {
        for &(column, by_one) in of_columns.iter().filter(|of| self.unknowns.contains(&of.0)) {
            let below = || of_rows.iter().filter(|of| of.0 >= column);
            if below().next().is_none() {
                continue;
            }
            let force = [0, 1, 2].map(|i| (0..3).map(|j| block(i, j) * by_one[j]).sum::<f64>());
            let of_column = self.starts[column]..self.starts[column + 1];
            let mut place = of_column.start;
            for &(row, along) in below() {
                // Most rows follow the one before.
                if place + 1 < of_column.end && self.rows[place + 1] == row as u32 {
                    place += 1;
                } else {
                    let Ok(found) = self.rows[of_column.clone()].binary_search(&(row as u32)) else { continue };
                    place = of_column.start + found;
                }
                values[place - self.first] += dot(along, force);
            }
        }
    }

    /// Adds an element with plain nodes alone.
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
                if row.count == 0 || column.count == 0 || !self.range.contains(&nodes[a].min(nodes[b])) {
                    continue;
                }
                let of_first = &rows[starts[column.first]..starts[column.first + 1]];
                let Ok(place) = of_first.binary_search(&(row.first as u32)) else { continue };
                let block = element.block(a, b);
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

/// No group has visited this one yet.
const NEVER: u32 = u32::MAX;

/// The cells that couple unknowns: elements, then springs; and the groups of unknowns that move together with a node:
/// the free dofs of each node, then the motions that some nodes follow.
///
/// A mesh has so few nodes that their numbers, and those of the cells around them, fit 32 bits.
pub(super) struct Pattern<'a> {
    mesh: &'a Mesh,
    dofs: &'a DofMap,
    /// The nodes that each spring between nodes couples.
    springs: Vec<Vec<usize>>,
    around: Around,
    /// The first unknown of each group, and the end: those of a group follow each other.
    first: Vec<usize>,
}

/// The groups around one group after another.
struct Neighbours<'a> {
    pattern: &'a Pattern<'a>,
    /// The group that has visited each group last.
    seen: Vec<u32>,
    found: Vec<usize>,
}

impl Neighbours<'_> {
    /// The groups with the same or a larger number that share a cell with a group, unsorted.
    fn of(&mut self, group: usize) -> &mut [usize] {
        self.found.clear();
        for &cell in self.pattern.around.at(group) {
            for &node in self.pattern.cell(cell as usize) {
                let other = self.pattern.group(node);
                if other >= group && self.seen[other] != group as u32 {
                    self.seen[other] = group as u32;
                    self.found.push(other);
                }
            }
        }
        &mut self.found
    }
}

impl<'a> Pattern<'a> {
    pub fn of(mesh: &'a Mesh, dofs: &'a DofMap, springs: &[Springs]) -> Self {
        let springs = springs.iter().map(|springs| springs.coupled(dofs)).collect();
        let (nodes, dimension) = (mesh.nodes().len(), mesh.dimension());
        let mut first = Vec::with_capacity(nodes + dofs.groups() + 1);
        let mut next = 0;
        for node in 0..nodes {
            first.push(next);
            next += (dimension * node..dimension * (node + 1)).filter(|&dof| dofs.number(dof).is_some()).count();
        }
        first.extend((0..dofs.groups()).map(|group| dofs.motions(group).start));
        first.push((0..dofs.groups()).next_back().map_or(next, |last| dofs.motions(last).end));
        let mut pattern = Pattern { mesh, dofs, springs, around: Around::default(), first };
        let of_cell = |cell: usize| pattern.cell(cell).iter().map(|&node| pattern.group(node));
        let cells = mesh.element_count() + pattern.springs.len();
        pattern.around = Around::new(pattern.groups(), (0..cells).map(of_cell));
        pattern
    }

    /// Number of groups.
    fn groups(&self) -> usize {
        self.mesh.nodes().len() + self.dofs.groups()
    }

    fn cell(&self, cell: usize) -> &[usize] {
        let springs = || &*self.springs[cell - self.mesh.element_count()];
        if cell < self.mesh.element_count() { self.mesh.element(cell) } else { springs() }
    }

    /// The group of unknowns that move a node, or its coefficient.
    #[inline]
    fn group(&self, node: usize) -> usize {
        match self.dofs.groups() {
            0 => node,
            _ => self.dofs.group_of(node).map_or(node, |group| self.mesh.nodes().len() + group),
        }
    }

    /// The unknowns of a group.
    #[inline]
    fn unknowns(&self, group: usize) -> Range<usize> {
        self.first[group]..self.first[group + 1]
    }

    /// Column starts and sorted rows of the lower triangle in the unknowns.
    pub fn lower(&self) -> (Vec<usize>, Vec<u32>) {
        let count = self.groups();
        let neighbours = || Neighbours { pattern: self, seen: vec![NEVER; count], found: Vec::new() };
        let parts = parts(count);
        let groups: Vec<usize> = (0..=parts).map(|part| count * part / parts).collect();
        // The entries of the first column of each group.
        let mut lengths = vec![0_u32; count];
        on_parts(&mut lengths, &groups, |part, lengths| {
            let mut neighbours = neighbours();
            for (group, length) in (groups[part]..).zip(lengths) {
                if !self.unknowns(group).is_empty() {
                    *length = neighbours.of(group).iter().map(|&other| self.unknowns(other).len() as u32).sum();
                }
            }
        });
        let (mut starts, mut entries, mut bounds) = (Vec::with_capacity(self.dofs.count() + 1), 0, Vec::new());
        starts.push(0);
        for (group, &length) in lengths.iter().enumerate() {
            if groups.get(bounds.len()) == Some(&group) {
                bounds.push(entries);
            }
            for column in 0..self.unknowns(group).len() {
                entries += length as usize - column;
                starts.push(entries);
            }
        }
        bounds.push(entries);
        // Unknowns that move no node have no entry.
        starts.resize(self.dofs.count() + 1, entries);
        let mut rows = vec![0_u32; entries];
        on_parts(&mut rows, &bounds, |part, rows| {
            let (mut neighbours, mut rest) = (neighbours(), rows.iter_mut());
            for group in groups[part]..groups[part + 1] {
                let own = self.unknowns(group).len();
                if own > 0 {
                    let around = neighbours.of(group);
                    around.sort_unstable();
                    for column in 0..own {
                        let of_column = around.iter().flat_map(|&other| self.unknowns(other)).skip(column);
                        of_column.zip(rest.by_ref()).for_each(|(row, place)| *place = row as u32);
                    }
                }
            }
        });
        (starts, rows)
    }
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
