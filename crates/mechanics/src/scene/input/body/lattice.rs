//! Structured meshes: products of axes, and lattices of cells whose points are mapped into place; the cells are cut
//! into elements.

use crate::error::Error;
use crate::fem::element::ReferenceElement;
use crate::fem::mesh::axis::{Lattice, half_steps};
use crate::fem::mesh::pieces::OF_HEXAHEDRON;
use crate::fem::mesh::{Boundary, ElementKind, Mesh};

/// The corners of a cell, in steps along x, y and z, in the order of a brick; the first four are those of a
/// quadrilateral, the first two those of a line.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// A quadrilateral cut into triangles along its diagonal from corner 0 to corner 2.
const OF_QUADRILATERAL: [[usize; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

/// Steps along an axis of a cell, from point to point: 2 if it has mid-sides, else 1.
pub(super) fn steps(reference: &ReferenceElement) -> usize {
    if reference.mid_sides.is_empty() { 1 } else { 2 }
}

/// The coordinates of points along an axis, from those of its cells.
pub(super) fn points(lines: &[f64], kind: ElementKind) -> Vec<f64> {
    if kind.is_quadratic() { half_steps(lines) } else { lines.to_vec() }
}

/// The nodes of the elements that a cell is cut into, or of the facets of a face with these corners: in steps from the
/// first corner of the cell.
fn cut(corners: &[usize], reference: &ReferenceElement) -> Vec<[usize; 3]> {
    let parts: Vec<Vec<usize>> = match (corners.len(), reference.corners) {
        (4, 3) => OF_QUADRILATERAL.map(|part| part.map(|local| corners[local]).to_vec()).to_vec(),
        (8, 4) => OF_HEXAHEDRON.map(|part| part.to_vec()).to_vec(),
        _ => vec![corners.to_vec()],
    };
    let mut nodes = Vec::new();
    for part in parts {
        nodes.extend(part.iter().map(|&corner| CORNERS[corner].map(|at| steps(reference) * at)));
        let sides = reference.mid_sides.iter().map(|ends| ends.map(|end| CORNERS[part[end]]));
        nodes.extend(sides.map(|[a, b]| [0, 1, 2].map(|axis| a[axis] + b[axis])));
    }
    nodes
}

/// The same of a whole cell.
fn cut_cell(kind: ElementKind) -> Vec<[usize; 3]> {
    cut(&[0, 1, 2, 3, 4, 5, 6, 7][..1 << kind.dimension()], kind.reference())
}

/// The places in a box of a lattice, those along the first axis first.
pub(super) fn places(low: [usize; 3], high: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let row = move |j: usize, k: usize| (low[0]..high[0]).map(move |i| [i, j, k]);
    (low[2]..high[2]).flat_map(move |k| (low[1]..high[1]).flat_map(move |j| row(j, k)))
}

/// A side of a product: its name, and the corners of a cell's face there, the first one being the lowest.
pub(super) type Side = (&'static str, &'static [usize]);

/// The mesh between the lines of one, two or three axes. Nodes are numbered along the first axis first, then along the
/// second.
pub(super) fn product(axes: &[&[f64]], kind: ElementKind, sides: &[Side]) -> Result<Mesh, Error> {
    let step = steps(kind.reference());
    let lines = [0, 1, 2].map(|axis| axes.get(axis).map_or(vec![0.0], |lines| points(lines, kind)));
    let ends = lines.each_ref().map(Vec::len);
    let cells = ends.map(|end| ((end - 1) / step).max(1));
    let point = |at: [usize; 3]| (at[2] * ends[1] + at[1]) * ends[0] + at[0];
    let between = |low: [usize; 3], high: [usize; 3], nodes: &[[usize; 3]]| {
        let count: usize = [0, 1, 2].map(|axis| high[axis] - low[axis]).iter().product();
        let mut connectivity = Vec::with_capacity(count * nodes.len());
        for cell in places(low, high) {
            let first = point(cell.map(|line| step * line));
            connectivity.extend(nodes.iter().map(|&at| first + point(at)));
        }
        connectivity
    };
    let mut connectivity = between([0; 3], cells, &cut_cell(kind));
    let side = |&(name, face): &Side| {
        let is_at = |axis: usize, end: usize| face.iter().all(|&corner| CORNERS[corner][axis] == end);
        let low = [0, 1, 2].map(|axis| if is_at(axis, 1) { cells[axis] - 1 } else { 0 });
        let high = [0, 1, 2].map(|axis| if is_at(axis, 0) { 1 } else { cells[axis] });
        Boundary::new(name, kind.facet(), between(low, high, &cut(face, kind.facet().reference())))
    };
    let mut boundaries: Vec<Boundary> = sides.iter().map(side).collect();
    // No element has the point in the middle of a quadratic quadrilateral.
    let mut number = vec![usize::MAX; ends.iter().product()];
    connectivity.iter().for_each(|&point| number[point] = 0);
    let mut nodes = Vec::new();
    for ([i, j, k], number) in places([0; 3], ends).zip(&mut number).filter(|(_, number)| **number == 0) {
        *number = nodes.len();
        nodes.push([lines[0][i], lines[1][j], lines[2][k]]);
    }
    let of_sides = boundaries.iter_mut().map(|boundary| &mut boundary.connectivity);
    of_sides.chain([&mut connectivity]).flatten().for_each(|node| *node = number[*node]);
    Ok(Mesh::new(nodes, kind, connectivity, boundaries)?)
}

/// The name of a point: four numbers, as those of its lines along the axes.
pub(super) type Key = [usize; 4];

/// Cells between points that are numbered when a cell first has them.
pub(super) struct LatticeCells {
    kind: ElementKind,
    nodes: Vec<[usize; 3]>,
    lattice: Lattice<Key>,
    connectivity: Vec<usize>,
}

impl LatticeCells {
    /// Without a cell; each will be cut into elements of a kind.
    pub fn of(kind: ElementKind) -> Self {
        LatticeCells { kind, nodes: cut_cell(kind), lattice: Lattice::default(), connectivity: Vec::new() }
    }

    /// Adds a cell with right-handed axes. `key` gives a point by its steps from the first corner.
    pub fn add(&mut self, key: impl Fn([usize; 3]) -> Key) {
        self.connectivity.extend(self.nodes.iter().map(|&at| self.lattice.node(key(at))));
    }

    /// The mesh of the cells with the points in place. A side has the points with a number at a position of their keys.
    pub fn mesh(self, place: impl Fn(Key) -> [f64; 3], sides: &[(&str, usize, usize)]) -> Result<Mesh, Error> {
        let keys = &self.lattice.keys;
        let nodes = keys.iter().map(|&key| place(key)).collect();
        let mesh = Mesh::new(nodes, self.kind, self.connectivity, Vec::new())?;
        let is_on = |position: usize, number: usize| move |node: usize| keys[node][position] == number;
        Ok(mesh.with_sides(sides.iter().map(|&(name, position, number)| (name, is_on(position, number)))))
    }
}
