//! Heights on a grid, bilinear in every cell: h = a + b t1 + c t2 + d t1 t2.

use crate::error::Error;
use crate::scene::schema::HeightMapSpec;
use crate::scene::{finite, number, wrong};

/// A cell is cut into so many strips to find the valleys of the distance over it: one cell has a handful at most.
const STRIPS: usize = 16;

/// Golden sections of a strip: they end at the square root of rounding, from where Newton's method goes on.
const SECTIONS: usize = 40;

/// Newton's method doubles eight digits in one step and has all in the next; the third is for safety.
const NEWTON_STEPS: usize = 3;

/// Unit normals closer than this are those of one smooth piece.
const SAME_NORMAL: f64 = 1e-12;

/// A grid of heights towards the obstacle.
#[derive(Debug)]
pub(super) struct HeightMap {
    lines: [Vec<f64>; 2],
    /// Row by row of the first lines.
    heights: Vec<f64>,
    names: [&'static str; 2],
    /// A place outside the rim by this counts as on it.
    beyond: f64,
}

/// Where a height map ends short of a place.
pub(super) struct Reach {
    pub field: &'static str,
    pub name: &'static str,
    pub range: (f64, f64),
    pub needed: f64,
}

/// The closest point of one cell, and the way to it.
struct Foot {
    at: [f64; 3],
    distance: f64,
}

impl HeightMap {
    /// Checks the grid at JSON path `path`; `names` are those of its coordinates, `sense` the one of the approach direction.
    pub fn new(
        spec: &HeightMapSpec,
        path: &str,
        names: [&'static str; 2],
        sense: f64,
        beyond: f64,
    ) -> Result<Self, Error> {
        for (field, lines) in [("x", &spec.x), ("y", &spec.y)] {
            check_lines(lines, &format!("{path}.{field}"))?;
        }
        let (rows, columns) = (spec.x.len(), spec.y.len());
        let count = |found: usize, expected: usize, what: &str, lines: &str| {
            format!("the array has {found} {what}, but there are {expected} grid lines in `{lines}`")
        };
        if spec.heights.len() != rows {
            return Err(wrong(format!("{path}.heights"), count(spec.heights.len(), rows, "rows", "x")));
        }
        let mut heights = Vec::with_capacity(rows * columns);
        for (i, row) in spec.heights.iter().enumerate() {
            if row.len() != columns {
                return Err(wrong(format!("{path}.heights[{i}]"), count(row.len(), columns, "entries", "y")));
            }
            for (j, &height) in row.iter().enumerate() {
                finite(format!("{path}.heights[{i}][{j}]"), height)?;
                heights.push(sense * height);
            }
        }
        Ok(HeightMap { lines: [spec.x.clone(), spec.y.clone()], heights, names, beyond })
    }

    /// The coordinate in which the map does not reach over a place, if there is one.
    pub fn beyond(&self, at: [f64; 2]) -> Option<Reach> {
        (0..2).find_map(|axis| {
            let range = self.range(axis);
            let inside = (range.0 - self.beyond..=range.1 + self.beyond).contains(&at[axis]);
            let (field, name, needed) = (["x", "y"][axis], self.names[axis], at[axis]);
            (!inside).then_some(Reach { field, name, range, needed })
        })
    }

    /// The height at a place, or `None` beyond the rim.
    pub fn height(&self, at: [f64; 2]) -> Option<f64> {
        self.beyond(at).is_none().then(|| {
            let [i, j] = [0, 1].map(|axis| self.cell_at(axis, at[axis]));
            self.patch(i, j).height(at)
        })
    }

    /// Unit normal into the obstacle at the closest point, and the distance along it; `None` beyond the rim.
    ///
    /// Cells farther away than the best so far are left out. In a cell the distance to the closest point of each ruling is
    /// searched in strips, the best strip by golden section, and what lies inside the cell is settled by Newton's
    /// method. The surface ends at its rim. A node equally close to several points takes their mean normal.
    pub fn closest(&self, node: [f64; 3], tolerance: f64) -> Option<([f64; 3], f64)> {
        let height = self.height([node[0], node[1]])?;
        let sense = if node[2] > height { -1.0 } else { 1.0 };
        let [home_i, home_j] = [0, 1].map(|axis| self.cell_at(axis, node[axis]));
        let mut feet = vec![self.patch(home_i, home_j).closest(node)];
        let reach = feet[0].distance + tolerance;
        let [near_i, near_j] = [0, 1].map(|axis| {
            let first = self.cell_at(axis, node[axis] - reach);
            first..=self.cell_at(axis, node[axis] + reach)
        });
        for i in near_i {
            for j in near_j.clone().filter(|&j| (i, j) != (home_i, home_j)) {
                let patch = self.patch(i, j);
                let best = feet.iter().fold(f64::INFINITY, |best: f64, foot| best.min(foot.distance));
                if patch.box_distance(node) <= best + tolerance {
                    feet.push(patch.closest(node));
                }
            }
        }
        let best = feet.iter().fold(f64::INFINITY, |best: f64, foot| best.min(foot.distance));
        let mut sum = [0.0; 3];
        for foot in feet.iter().filter(|foot| foot.distance <= best + tolerance) {
            let normal = self.normal(node, foot, sense, tolerance);
            sum = [0, 1, 2].map(|axis| sum[axis] + normal[axis]);
        }
        let length = dot(sum, sum).sqrt();
        let normal = sum.map(|part| part / length);
        let foot = feet.iter().min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        // Along its own normal the foot is as far as it is; along a mean normal the plane through it is farther.
        let own = self.normal(node, foot, sense, tolerance);
        let to_foot = [0, 1, 2].map(|axis| foot.at[axis] - node[axis]);
        Some((normal, dot(own, to_foot) / dot(own, normal)))
    }

    /// The normal at a foot: of the surface where it is smooth there or the node lies on it, else the way to the foot.
    fn normal(&self, node: [f64; 3], foot: &Foot, sense: f64, tolerance: f64) -> [f64; 3] {
        let near = [0, 1].map(|axis| {
            let cell = |at: f64| self.cell_at(axis, at);
            cell(foot.at[axis] - tolerance)..=cell(foot.at[axis] + tolerance)
        });
        let around: Vec<[f64; 3]> = near[0]
            .clone()
            .flat_map(|i| near[1].clone().map(move |j| (i, j)))
            .map(|(i, j)| self.patch(i, j).normal([foot.at[0], foot.at[1]]))
            .collect();
        let sum = around.iter().fold([0.0; 3], |sum, normal| [0, 1, 2].map(|axis| sum[axis] + normal[axis]));
        let length = dot(sum, sum).sqrt();
        let mean = sum.map(|part| part / length);
        let smooth = around.iter().all(|normal| (0..3).all(|axis| (normal[axis] - mean[axis]).abs() <= SAME_NORMAL));
        let on_rim = (0..2).any(|axis| {
            let (first, last) = self.range(axis);
            foot.at[axis] <= first || foot.at[axis] >= last
        });
        if foot.distance <= tolerance || (smooth && !on_rim) {
            return mean;
        }
        let way = [0, 1, 2].map(|axis| sense * (foot.at[axis] - node[axis]) / foot.distance);
        // On a smooth rim the foot may still be where the normal meets the surface: take the digits of the surface.
        let same = (0..3).all(|axis| (way[axis] - mean[axis]).abs() <= SAME_NORMAL.sqrt());
        if smooth && same { mean } else { way }
    }

    fn range(&self, axis: usize) -> (f64, f64) {
        let lines = &self.lines[axis];
        (lines[0], lines[lines.len() - 1])
    }

    /// The cell over a coordinate; beyond the rim the last one.
    fn cell_at(&self, axis: usize, at: f64) -> usize {
        let lines = &self.lines[axis];
        lines.partition_point(|&line| line <= at).saturating_sub(1).min(lines.len() - 2)
    }

    fn patch(&self, i: usize, j: usize) -> Patch {
        let columns = self.lines[1].len();
        let height = |i: usize, j: usize| self.heights[i * columns + j];
        Patch {
            low: [self.lines[0][i], self.lines[1][j]],
            size: [self.lines[0][i + 1] - self.lines[0][i], self.lines[1][j + 1] - self.lines[1][j]],
            corners: [height(i, j), height(i + 1, j), height(i, j + 1), height(i + 1, j + 1)],
        }
    }
}

/// One cell: heights at its corners (0, 0), (1, 0), (0, 1), (1, 1) in its own coordinates u, v from 0 to 1.
struct Patch {
    low: [f64; 2],
    size: [f64; 2],
    corners: [f64; 4],
}

impl Patch {
    fn point(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let [a, b, c, d] = self.corners;
        let height = (1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * c + u * d);
        [self.low[0] + u * self.size[0], self.low[1] + v * self.size[1], height]
    }

    fn height(&self, at: [f64; 2]) -> f64 {
        self.point([0, 1].map(|axis| (at[axis] - self.low[axis]) / self.size[axis]))[2]
    }

    /// Derivatives of the height by u and v.
    fn slopes(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [a, b, c, d] = self.corners;
        [(1.0 - v) * (b - a) + v * (d - c), (1.0 - u) * (c - a) + u * (d - b)]
    }

    fn normal(&self, at: [f64; 2]) -> [f64; 3] {
        let own = [0, 1].map(|axis| (at[axis] - self.low[axis]) / self.size[axis]);
        let slopes = self.slopes(own);
        let normal = [-slopes[0] / self.size[0], -slopes[1] / self.size[1], 1.0];
        let length = dot(normal, normal).sqrt();
        normal.map(|part| part / length)
    }

    /// Distance to the box around the cell.
    fn box_distance(&self, node: [f64; 3]) -> f64 {
        let low = self.corners.iter().fold(f64::INFINITY, |low: f64, &height| low.min(height));
        let high = self.corners.iter().fold(f64::NEG_INFINITY, |high: f64, &height| high.max(height));
        let outside = |at: f64, low: f64, high: f64| (low - at).max(at - high).max(0.0);
        let across = [0, 1].map(|axis| outside(node[axis], self.low[axis], self.low[axis] + self.size[axis]));
        across[0].hypot(across[1]).hypot(outside(node[2], low, high))
    }

    /// The closest u on the ruling at v, a segment.
    fn on_ruling(&self, node: [f64; 3], v: f64) -> [f64; 2] {
        let start = self.point([0.0, v]);
        let along = [self.size[0], self.slopes([0.0, v])[0]];
        let to_node = [node[0] - start[0], node[2] - start[2]];
        let u = (to_node[0] * along[0] + to_node[1] * along[1]) / (along[0] * along[0] + along[1] * along[1]);
        [u.clamp(0.0, 1.0), v]
    }

    fn distance(&self, node: [f64; 3], own: [f64; 2]) -> f64 {
        let [x, y, z] = self.point(own);
        (x - node[0]).hypot(y - node[1]).hypot(z - node[2])
    }

    fn closest(&self, node: [f64; 3]) -> Foot {
        let at_v = |v: f64| self.distance(node, self.on_ruling(node, v));
        let strip = |index: usize| index as f64 / STRIPS as f64;
        let best = (0..=STRIPS).min_by(|&a, &b| at_v(strip(a)).total_cmp(&at_v(strip(b)))).unwrap_or(0);
        let (mut low, mut high) = (strip(best.saturating_sub(1)), strip((best + 1).min(STRIPS)));
        let golden = (5_f64.sqrt() - 1.0) / 2.0;
        for _ in 0..SECTIONS {
            let (left, right) = (high - golden * (high - low), low + golden * (high - low));
            if at_v(left) < at_v(right) { high = right } else { low = left }
        }
        let mut own = self.on_ruling(node, (low + high) / 2.0);
        for v in [strip(best), 0.0, 1.0] {
            if at_v(v) <= self.distance(node, own) {
                own = self.on_ruling(node, v);
            }
        }
        own = self.settled(node, own);
        Foot { at: self.point(own), distance: self.distance(node, own) }
    }

    /// Newton's method on the gradient of half the squared distance, while it stays inside and comes no farther away.
    fn settled(&self, node: [f64; 3], start: [f64; 2]) -> [f64; 2] {
        let [a, b, c, d] = self.corners;
        let twist = a - b - c + d;
        let mut own = start;
        for _ in 0..NEWTON_STEPS {
            let (at, [hu, hv]) = (self.point(own), self.slopes(own));
            let rest = [0, 1, 2].map(|axis| at[axis] - node[axis]);
            let gradient = [rest[0] * self.size[0] + rest[2] * hu, rest[1] * self.size[1] + rest[2] * hv];
            let (uu, vv) = (self.size[0].powi(2) + hu * hu, self.size[1].powi(2) + hv * hv);
            let uv = hu * hv + rest[2] * twist;
            let determinant = uu * vv - uv * uv;
            let step = [
                (vv * gradient[0] - uv * gradient[1]) / determinant,
                (uu * gradient[1] - uv * gradient[0]) / determinant,
            ];
            let next = [own[0] - step[0], own[1] - step[1]];
            let inside = next.iter().all(|part| (0.0..=1.0).contains(part));
            let slack = 4.0 * f64::EPSILON * self.distance(node, own);
            if !inside || self.distance(node, next) > self.distance(node, own) + slack {
                break;
            }
            own = next;
        }
        own
    }
}

fn check_lines(lines: &[f64], path: &str) -> Result<(), Error> {
    if lines.len() < 2 {
        let found = lines.len();
        return Err(wrong(path, format!("a height map needs at least two grid lines, but there are {found}")));
    }
    for (index, &line) in lines.iter().enumerate() {
        finite(format!("{path}[{index}]"), line)?;
        if let Some(&before) = index.checked_sub(1).and_then(|index| lines.get(index)).filter(|&&before| line <= before)
        {
            let (this, before) = (number(line), number(before));
            let message = format!("{this} does not lie beyond {before}, the one before; the grid lines must increase");
            return Err(wrong(format!("{path}[{index}]"), message));
        }
    }
    Ok(())
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
