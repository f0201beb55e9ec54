//! Decks of blocks: nodes, elements and faces as CalculiX numbers them.

use std::collections::HashMap;
use std::fmt::Write;

/// The corners of each face, S1 to S4 or S6, and the ends of each mid-side: the numbering of CalculiX, from 1.
struct Cell {
    corners: usize,
    faces: &'static [&'static [usize]],
    mid_sides: &'static [[usize; 2]],
}

const TETRAHEDRON: Cell = Cell {
    corners: 4,
    faces: &[&[1, 2, 3], &[1, 4, 2], &[2, 4, 3], &[3, 4, 1]],
    mid_sides: &[[1, 2], [2, 3], [3, 1], [1, 4], [2, 4], [3, 4]],
};

const BRICK: Cell = Cell {
    corners: 8,
    faces: &[&[1, 2, 3, 4], &[5, 8, 7, 6], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 8, 4], &[4, 8, 5, 1]],
    mid_sides: &[[1, 2], [2, 3], [3, 4], [4, 1], [5, 6], [6, 7], [7, 8], [8, 5], [1, 5], [2, 6], [3, 7], [4, 8]],
};

const TRIANGLE: Cell = Cell { corners: 3, faces: &[&[1, 2], &[2, 3], &[3, 1]], mid_sides: &[[1, 2], [2, 3], [3, 1]] };

const QUADRILATERAL: Cell =
    Cell { corners: 4, faces: &[&[1, 2], &[2, 3], &[3, 4], &[4, 1]], mid_sides: &[[1, 2], [2, 3], [3, 4], [4, 1]] };

/// Six tetrahedra around the diagonal of a brick.
const IN_BRICK: [[usize; 4]; 6] = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];

/// A block of elements of one type.
pub struct Block {
    /// Its type, as `C3D10`.
    pub element: &'static str,
    /// Smallest and largest coordinates.
    pub low: [f64; 3],
    pub high: [f64; 3],
    /// Cells along x, y, z; along z 0 in the plane.
    pub cells: [usize; 3],
    /// The numbers of its nodes and elements follow this one.
    pub after: usize,
}

/// Nodes with their numbers, elements with the numbers of their nodes.
pub struct Mesh {
    pub nodes: Vec<(usize, [f64; 3])>,
    pub elements: Vec<(usize, Vec<usize>)>,
    element: &'static str,
    cell: &'static Cell,
}

impl Block {
    /// Its nodes and elements.
    ///
    /// # Panics
    /// For an element of another name.
    pub fn mesh(&self) -> Mesh {
        let is_plane = !self.element.starts_with("C3D");
        let count: usize = self.element[3..].trim_end_matches(['I', 'R']).parse().unwrap();
        let cell: &'static Cell = match (is_plane, count) {
            (true, 3 | 6) => &TRIANGLE,
            (true, _) => &QUADRILATERAL,
            (false, 4 | 10) => &TETRAHEDRON,
            (false, _) => &BRICK,
        };
        let [nx, ny, nz] = self.cells;
        let mut nodes = Vec::new();
        let mut numbers = HashMap::new();
        for (k, j, i) in lattice([nx + 1, ny + 1, nz + 1]) {
            let at = [0, 1, 2].map(|axis| {
                let (step, cells) = ([i, j, k][axis] as f64, self.cells[axis].max(1) as f64);
                self.low[axis] + (self.high[axis] - self.low[axis]) * step / cells
            });
            nodes.push((self.after + nodes.len() + 1, at));
            numbers.insert([i, j, k], nodes.len() - 1);
        }
        let mut elements = Vec::new();
        let mut middles: HashMap<[usize; 2], usize> = HashMap::new();
        for (k, j, i) in lattice([nx, ny, nz.max(1)]) {
            let around = |k: usize| [[i, j, k], [i + 1, j, k], [i + 1, j + 1, k], [i, j + 1, k]].map(|at| numbers[&at]);
            let (below, above) = (around(k), if is_plane { around(k) } else { around(k + 1) });
            let brick: Vec<usize> = below.into_iter().chain(above).collect();
            let parts: Vec<Vec<usize>> = match cell.corners {
                3 => vec![vec![brick[0], brick[1], brick[2]], vec![brick[0], brick[2], brick[3]]],
                4 if is_plane => vec![below.to_vec()],
                4 => IN_BRICK.iter().map(|part| part.map(|corner| brick[corner]).to_vec()).collect(),
                _ => vec![brick],
            };
            for mut own in parts {
                if count > cell.corners {
                    for ends in cell.mid_sides {
                        let [a, b] = ends.map(|end| own[end - 1]);
                        let place = *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                            let at = [0, 1, 2].map(|axis| f64::midpoint(nodes[a].1[axis], nodes[b].1[axis]));
                            nodes.push((self.after + nodes.len() + 1, at));
                            nodes.len() - 1
                        });
                        own.push(place);
                    }
                }
                let number = self.after + elements.len() + 1;
                elements.push((number, own.into_iter().map(|place| nodes[place].0).collect()));
            }
        }
        Mesh { nodes, elements, element: self.element, cell }
    }
}

/// All `(k, j, i)`, `i` fastest.
fn lattice([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (k, j, i))))
}

impl Mesh {
    /// The cards *NODE and *ELEMENT; all elements are in the set `set`. Long elements go on in a second line.
    pub fn cards(&self, set: &str) -> String {
        let mut text = String::from("*NODE, NSET=ALL\n");
        for (number, [x, y, z]) in &self.nodes {
            let _ = writeln!(text, "{number}, {x:e}, {y:e}, {z:e}");
        }
        let _ = writeln!(text, "*ELEMENT, TYPE={}, ELSET={set}", self.element);
        for (number, nodes) in &self.elements {
            let words: Vec<String> = std::iter::once(number).chain(nodes).map(usize::to_string).collect();
            let lines: Vec<String> = words.chunks(11).map(|line| line.join(", ")).collect();
            let _ = writeln!(text, "{}", lines.join(",\n"));
        }
        text
    }

    /// A card *NSET of the nodes at these places.
    pub fn set(&self, name: &str, is_in: impl Fn([f64; 3]) -> bool) -> String {
        let own = self.nodes.iter().filter(|(_, at)| is_in(*at)).map(|(number, _)| format!("{number},\n"));
        format!("*NSET, NSET={name}\n{}", own.collect::<String>())
    }

    /// The elements and faces, from 1, with all corners at these places.
    pub fn faces(&self, is_in: impl Fn([f64; 3]) -> bool) -> Vec<(usize, usize)> {
        let at: HashMap<usize, [f64; 3]> = self.nodes.iter().copied().collect();
        let of_element = |(number, nodes): &(usize, Vec<usize>)| {
            let own = |face: &&[usize]| face.iter().all(|corner| is_in(at[&nodes[corner - 1]]));
            let faces = self.cell.faces.iter().enumerate().filter(|(_, face)| own(face));
            faces.map(|(face, _)| (*number, face + 1)).collect::<Vec<_>>()
        };
        self.elements.iter().flat_map(of_element).collect()
    }

    /// A card *SURFACE of the faces with all corners at these places.
    pub fn surface(&self, name: &str, is_in: impl Fn([f64; 3]) -> bool) -> String {
        let faces = self.faces(is_in).into_iter().map(|(element, face)| format!("{element}, S{face}\n"));
        format!("*SURFACE, NAME={name}\n{}", faces.collect::<String>())
    }
}
