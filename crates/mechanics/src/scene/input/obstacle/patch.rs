//! One bilinear cell of a height map: its closest points to a node.

use crate::fem::geometry::{dot, minus};
/// Number of strips of a cell in which local minima of the distance are searched; a cell has only a few minima.
const STRIPS: usize = 16;

/// Golden sections of a strip: they reach the square root of rounding; from there Newton's method continues.
const SECTIONS: usize = 40;

/// Newton's method reaches eight correct digits in one step and all digits in the next; the third is for safety.
const NEWTON_STEPS: usize = 3;

/// A longer step, in the cell's own coordinates, does not come from the rounding of a search: the distance has no
/// curvature there, and the result of the search is used.
const LONG_STEP: f64 = 1e-3;

/// A search that ends at an edge is within this distance of the edge, in the cell's own coordinates.
const AT_EDGE: f64 = 1e-7;

/// A point of a cell that is closer to a node than its neighbourhood in the cell.
pub(super) struct CellFoot {
    pub at: [f64; 3],
    pub distance: f64,
    /// `true` if it was found on an edge of the cell.
    pub on_edge: bool,
}

/// One cell: heights at its corners (0, 0), (1, 0), (0, 1), (1, 1) in its own coordinates u, v from 0 to 1.
pub(super) struct Patch {
    pub low: [f64; 2],
    pub size: [f64; 2],
    pub corners: [f64; 4],
}

impl Patch {
    fn point(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let [a, b, c, d] = self.corners;
        let height = (1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * c + u * d);
        [self.low[0] + u * self.size[0], self.low[1] + v * self.size[1], height]
    }

    pub fn height(&self, at: [f64; 2]) -> f64 {
        self.point([0, 1].map(|axis| (at[axis] - self.low[axis]) / self.size[axis]))[2]
    }

    /// Derivatives of the height with respect to u and v.
    fn slopes(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [a, b, c, d] = self.corners;
        [(1.0 - v) * (b - a) + v * (d - c), (1.0 - u) * (c - a) + u * (d - b)]
    }

    pub fn normal(&self, at: [f64; 2]) -> [f64; 3] {
        let own = [0, 1].map(|axis| (at[axis] - self.low[axis]) / self.size[axis]);
        let slopes = self.slopes(own);
        let normal = [-slopes[0] / self.size[0], -slopes[1] / self.size[1], 1.0];
        let length = dot(normal, normal).sqrt();
        normal.map(|part| part / length)
    }

    /// Distance to the box around the cell.
    pub fn box_distance(&self, node: [f64; 3]) -> f64 {
        let low = self.corners.iter().fold(f64::INFINITY, |low: f64, &height| low.min(height));
        let high = self.corners.iter().fold(f64::NEG_INFINITY, |high: f64, &height| high.max(height));
        let outside = |at: f64, low: f64, high: f64| (low - at).max(at - high).max(0.0);
        let across = [0, 1].map(|axis| outside(node[axis], self.low[axis], self.low[axis] + self.size[axis]));
        across[0].hypot(across[1]).hypot(outside(node[2], low, high))
    }

    /// The closest u on the ruling at v, a segment.
    fn on_ruling(&self, node: [f64; 3], v: f64) -> [f64; 2] {
        let [low, high] = [[0.0, v], [1.0, v]];
        [self.along_segment(node, low, high), v]
    }

    /// The closest place on the straight line on the surface between two places in the cell's coordinates, as a share
    /// from 0 to 1.
    fn along_segment(&self, node: [f64; 3], from: [f64; 2], to: [f64; 2]) -> f64 {
        let (start, end) = (self.point(from), self.point(to));
        let along = minus(end, start);
        let to_node = minus(node, start);
        (dot(to_node, along) / dot(along, along)).clamp(0.0, 1.0)
    }

    fn foot(&self, node: [f64; 3], own: [f64; 2]) -> CellFoot {
        let at = self.point(own);
        let way = minus(at, node);
        CellFoot { at, distance: way[0].hypot(way[1]).hypot(way[2]), on_edge: false }
    }

    /// The closest points of the four edges, and all points inside the cell that are closer than their neighbourhood.
    ///
    /// The edges are straight. Inside, the distance to the closest point of each ruling is searched in strips: every
    /// local minimum by golden section, then by Newton's method.
    pub fn feet(&self, node: [f64; 3]) -> Vec<CellFoot> {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut feet: Vec<CellFoot> = (0..4)
            .map(|edge| {
                let (from, to) = (corners[edge], corners[(edge + 1) % 4]);
                let t = self.along_segment(node, from, to);
                let own = [0, 1].map(|axis| (1.0 - t) * from[axis] + t * to[axis]);
                CellFoot { on_edge: true, ..self.foot(node, own) }
            })
            .collect();
        let at_v = |v: f64| self.foot(node, self.on_ruling(node, v)).distance;
        let strip = |index: usize| index as f64 / STRIPS as f64;
        let sampled: Vec<f64> = (0..=STRIPS).map(|index| at_v(strip(index))).collect();
        for index in 0..=STRIPS {
            let (before, after) = (index.saturating_sub(1), (index + 1).min(STRIPS));
            if sampled[index] > sampled[before] || sampled[index] > sampled[after] {
                continue;
            }
            let (mut low, mut high) = (strip(before), strip(after));
            let golden = (5_f64.sqrt() - 1.0) / 2.0;
            for _ in 0..SECTIONS {
                let (a, b) = (high - golden * (high - low), low + golden * (high - low));
                if at_v(a) < at_v(b) { high = b } else { low = a }
            }
            let found = self.on_ruling(node, (low + high) / 2.0);
            feet.extend(self.settled(node, found).map(|own| self.foot(node, own)));
        }
        feet
    }

    /// Newton's method on the gradient of half the squared distance, as long as the distance does not grow; `None` if
    /// the foot lies on an edge.
    fn settled(&self, node: [f64; 3], start: [f64; 2]) -> Option<[f64; 2]> {
        let [a, b, c, d] = self.corners;
        let twist = a - b - c + d;
        let distance = |own: [f64; 2]| self.foot(node, own).distance;
        // A distance is as accurate as the coordinates from which it is computed, however short it is.
        let far = [0, 1].map(|axis| self.low[axis] + self.size[axis]);
        let coordinates = node.iter().chain(&self.low).chain(&far).chain(&self.corners);
        let slack = 4.0 * f64::EPSILON * coordinates.fold(0.0_f64, |largest, part| largest.max(part.abs()));
        let mut own = start;
        for _ in 0..NEWTON_STEPS {
            let (at, [hu, hv]) = (self.point(own), self.slopes(own));
            let rest = minus(at, node);
            let gradient = [rest[0] * self.size[0] + rest[2] * hu, rest[1] * self.size[1] + rest[2] * hv];
            let (uu, vv) = (self.size[0].powi(2) + hu * hu, self.size[1].powi(2) + hv * hv);
            let uv = hu * hv + rest[2] * twist;
            let determinant = uu * vv - uv * uv;
            let step = [
                (vv * gradient[0] - uv * gradient[1]) / determinant,
                (uu * gradient[1] - uv * gradient[0]) / determinant,
            ];
            let (next, length) = ([own[0] - step[0], own[1] - step[1]], step[0].hypot(step[1]));
            // If the determinant is zero, the step is NaN or infinite.
            if length.is_nan() || length > LONG_STEP {
                let inside = own.iter().all(|part| (AT_EDGE..=1.0 - AT_EDGE).contains(part));
                return inside.then_some(own);
            }
            if !next.iter().all(|part| (0.0..=1.0).contains(part)) {
                return None;
            }
            if distance(next) > distance(own) + slack {
                break;
            }
            own = next;
        }
        Some(own)
    }
}

/// The pairs of corners of the six coefficients.
pub(super) const PAIRS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];

/// A function on a triangle of which nothing is known: its largest distances `[below, above]` from zero are infinite.
pub(super) const NOT_ENCLOSED: ([f64; 6], [f64; 2]) = ([0.0; 6], [f64::INFINITY; 2]);

/// The coefficients of the linear function with these values at the corners.
pub(super) fn linear(values: [f64; 3]) -> [f64; 6] {
    PAIRS.map(|[i, j]| (values[i] + values[j]) / 2.0)
}

/// The coefficients of the gap over a triangle with its corners at `[t1, t2, towards]` from those of the heights.
pub(super) fn gap_to(mut heights: [f64; 6], corners: [[f64; 3]; 3]) -> [f64; 6] {
    let towards = linear(corners.map(|[_, _, towards]| towards));
    heights.iter_mut().zip(towards).for_each(|(height, towards)| *height -= towards);
    heights
}

/// The least and the largest of the values at the corners.
pub(super) fn extent([a, b, c]: [f64; 3]) -> [f64; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// The distance of the origin from a triangle in the plane, corners `[x, y]` in any order; zero inside.
pub(super) fn distance_of_origin(corners: [[f64; 2]; 3]) -> f64 {
    let edges = [[0, 1], [1, 2], [2, 0]].map(|ends| ends.map(|corner| corners[corner]));
    let turns = edges.map(|[[ax, ay], [bx, by]]| ax * by - ay * bx);
    if turns.iter().all(|&turn| turn > 0.0) || turns.iter().all(|&turn| turn < 0.0) {
        return 0.0;
    }
    let distance = |[[ax, ay], [bx, by]]: [[f64; 2]; 2]| {
        let [x, y] = [bx - ax, by - ay];
        let square = x * x + y * y;
        let share = if square > 0.0 { (-(ax * x + ay * y) / square).clamp(0.0, 1.0) } else { 0.0 };
        (ax + share * x).hypot(ay + share * y)
    };
    edges.into_iter().map(distance).fold(f64::INFINITY, f64::min)
}
