//! Closed surfaces of triangles, and the files that contain them.

use std::collections::HashMap;
use std::fmt::Write;

/// Vertices, and triangles that are counterclockwise seen from outside.
#[derive(Clone, Debug)]
pub struct Triangles {
    pub vertices: Vec<[f64; 3]>,
    pub corners: Vec<[usize; 3]>,
}

impl Triangles {
    /// A sphere about the origin: an icosahedron, every triangle divided into four, `times` times: 20 x 4^times
    /// triangles.
    pub fn sphere(radius: f64, times: usize) -> Self {
        let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
        let mut vertices = Vec::new();
        for (axis, turned) in [(0, 1), (1, 2), (2, 0)] {
            for [a, b] in [[-1.0, golden], [1.0, golden], [-1.0, -golden], [1.0, -golden]] {
                let mut at = [0.0; 3];
                (at[axis], at[turned]) = (a, b);
                vertices.push(at);
            }
        }
        let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>();
        let joined = |a: usize, b: usize| (apart(vertices[a], vertices[b]) - 4.0).abs() < 1e-9;
        let mut corners = Vec::new();
        for a in 0..12 {
            for b in a + 1..12 {
                for c in b + 1..12 {
                    if joined(a, b) && joined(b, c) && joined(c, a) {
                        let [p, q, r] = [a, b, c].map(|corner| vertices[corner]);
                        let volume = p[0] * (q[1] * r[2] - q[2] * r[1])
                            + p[1] * (q[2] * r[0] - q[0] * r[2])
                            + p[2] * (q[0] * r[1] - q[1] * r[0]);
                        corners.push(if volume > 0.0 { [a, b, c] } else { [a, c, b] });
                    }
                }
            }
        }
        for _ in 0..times {
            let mut middles = HashMap::new();
            let mut finer = Vec::with_capacity(4 * corners.len());
            for [a, b, c] in corners {
                let [d, e, f] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
                    *middles.entry((from.min(to), from.max(to))).or_insert_with(|| {
                        vertices.push([0, 1, 2].map(|axis| vertices[from][axis] + vertices[to][axis]));
                        vertices.len() - 1
                    })
                });
                // Each new vertex is moved radially onto the sphere through the old ones.
                for new in [d, e, f] {
                    let length = apart(vertices[new], [0.0; 3]).sqrt();
                    vertices[new] = vertices[new].map(|part| part * (golden * golden + 1.0).sqrt() / length);
                }
                finer.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
            }
            corners = finer;
        }
        let own = (golden * golden + 1.0).sqrt();
        Triangles { vertices: vertices.into_iter().map(|at| at.map(|part| part * radius / own)).collect(), corners }
    }

    /// A box between two corners.
    pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Self {
        let vertices =
            (0..8).map(|corner| [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] }));
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let corners = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Triangles { vertices: vertices.collect(), corners }
    }

    /// A torus about z through the origin.
    pub fn torus(major: f64, minor: f64, around: usize, across: usize) -> Self {
        let turn = |index: usize, of: usize| 2.0 * std::f64::consts::PI * index as f64 / of as f64;
        let mut vertices = Vec::new();
        let mut corners = Vec::new();
        for i in 0..around {
            for j in 0..across {
                let (a, b) = (turn(i, around), turn(j, across));
                let radius = major + minor * b.cos();
                vertices.push([radius * a.cos(), radius * a.sin(), minor * b.sin()]);
                let at = |i: usize, j: usize| i % around * across + j % across;
                let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                corners.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
            }
        }
        Triangles { vertices, corners }
    }

    /// The same surface with every vertex moved.
    pub fn moved(mut self, to: impl FnMut([f64; 3]) -> [f64; 3]) -> Self {
        self.vertices = self.vertices.into_iter().map(to).collect();
        self
    }

    /// Both surfaces together, side by side or intersecting.
    pub fn and(mut self, other: Triangles) -> Self {
        let first = self.vertices.len();
        self.vertices.extend(other.vertices);
        self.corners.extend(other.corners.into_iter().map(|corners| corners.map(|corner| corner + first)));
        self
    }

    pub fn triangle(&self, index: usize) -> [[f64; 3]; 3] {
        self.corners[index].map(|corner| self.vertices[corner])
    }

    /// A binary STL; its coordinates are rounded to single precision.
    pub fn binary_stl(&self) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        bytes.extend((self.corners.len() as u32).to_le_bytes());
        for index in 0..self.corners.len() {
            bytes.extend([0; 12]);
            for corner in self.triangle(index) {
                corner.iter().for_each(|&part| bytes.extend((part as f32).to_le_bytes()));
            }
            bytes.extend([0; 2]);
        }
        bytes
    }

    /// The surface after rounding to the single precision of a binary STL.
    pub fn single(self) -> Self {
        self.moved(|at| at.map(|part| f64::from(part as f32)))
    }

    pub fn ascii_stl(&self) -> String {
        let mut text = String::from("solid surface\n");
        for index in 0..self.corners.len() {
            text.push_str("  facet normal 0 0 0\n    outer loop\n");
            for [x, y, z] in self.triangle(index) {
                writeln!(text, "      vertex {x:e} {y:e} {z:e}").unwrap();
            }
            text.push_str("    endloop\n  endfacet\n");
        }
        text + "endsolid surface\n"
    }

    pub fn obj(&self) -> String {
        let mut text = String::from("# a surface\no surface\n");
        for [x, y, z] in &self.vertices {
            writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
        }
        text.push_str("vn 0 0 1\n");
        for [a, b, c] in &self.corners {
            writeln!(text, "f {}//1 {}//1 {}//1", a + 1, b + 1, c + 1).unwrap();
        }
        text
    }
}
