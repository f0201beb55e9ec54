//! One triangle: its normal, and its closest point to a node.

use crate::fem::geometry::{cross, distance, dot, length, minus, unit};

/// A triangle with a height below this share of its longest side is treated as its sides only: rounding turns its
/// normal by 1e-7, and no other choice moves a closest point by more.
const FLAT: f64 = 1e-9;

/// The closest part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Part {
    /// Its inside.
    Face,
    /// The inside of the side from this corner, 0 to 2, to the next.
    Side(usize),
    /// A corner, 0 to 2.
    Corner(usize),
}

/// The distance of a point from an edge of two corners, or from a face of three or four, cut into triangles, all in
/// length.
pub(crate) fn distance_from(corners: &[[f64; 3]], point: [f64; 3]) -> f64 {
    let last = corners.len() - 1;
    // An edge is a triangle without height.
    let triangles = (1..last.max(2)).map(|at| Triangle([corners[0], corners[at], corners[(at + 1).min(last)]]));
    triangles.map(|triangle| distance(triangle.closest(point).0, point)).fold(f64::INFINITY, f64::min)
}

/// The corners of a triangle, counterclockwise seen from outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle(pub [[f64; 3]; 3]);

impl Triangle {
    /// Normal to the outside; its length is twice the area.
    pub fn area_normal(&self) -> [f64; 3] {
        let [a, b, c] = self.0;
        cross(minus(b, a), minus(c, a))
    }

    /// Unit normal to the outside; zero for a flat triangle.
    pub fn normal(&self) -> [f64; 3] {
        let (normal, [a, b, c]) = (self.area_normal(), self.0);
        let longest = distance(a, b).max(distance(b, c)).max(distance(c, a));
        if length(normal) <= FLAT * longest * longest { [0.0; 3] } else { unit(normal) }
    }

    pub fn angle(&self, corner: usize) -> f64 {
        let [at, next, last] = [0, 1, 2].map(|step| self.0[(corner + step) % 3]);
        let (a, b) = (minus(next, at), minus(last, at));
        length(cross(a, b)).atan2(dot(a, b))
    }

    /// The closest point to `node`, and the part on which it lies.
    pub fn closest(&self, node: [f64; 3]) -> ([f64; 3], Part) {
        let [a, b, c] = self.0;
        let normal = self.normal();
        if normal != [0.0; 3] {
            let (to_node, ab, ac) = (minus(node, a), minus(b, a), minus(c, a));
            let area = dot(cross(ab, ac), normal);
            let (of_b, of_c) = (dot(cross(to_node, ac), normal) / area, dot(cross(ab, to_node), normal) / area);
            if of_b > 0.0 && of_c > 0.0 && of_b + of_c < 1.0 {
                return ([0, 1, 2].map(|axis| a[axis] + of_b * ab[axis] + of_c * ac[axis]), Part::Face);
            }
        }
        let sides = [0, 1, 2].map(|corner| {
            let (from, along) = (self.0[corner], minus(self.0[(corner + 1) % 3], self.0[corner]));
            let share = dot(minus(node, from), along) / dot(along, along);
            if share >= 1.0 {
                return (self.0[(corner + 1) % 3], Part::Corner((corner + 1) % 3));
            }
            // A side so short that its square is zero gives NaN as share.
            if share > 0.0 {
                return ([0, 1, 2].map(|axis| from[axis] + share * along[axis]), Part::Side(corner));
            }
            (from, Part::Corner(corner))
        });
        let far = |at: [f64; 3]| dot(minus(at, node), minus(at, node));
        let [first, second, third] = sides;
        let nearer = if far(second.0) < far(first.0) { second } else { first };
        if far(third.0) < far(nearer.0) { third } else { nearer }
    }
}
