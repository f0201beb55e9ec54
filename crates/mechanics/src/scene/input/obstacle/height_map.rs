//! Heights on a grid, bilinear in every cell: h = a + b t1 + c t2 + d t1 t2.

use std::iter;
use std::ops::RangeInclusive;

use super::patch::{CellFoot, PAIRS, Patch, extent, gap_to};
use super::row::ObstacleRow;
use super::shape::{Geometry, ObstacleShape, ObstacleSite};
use super::surface::{Axes, Surface, across};
use crate::error::Error;
use crate::fem::geometry::{dot, minus, plus};
use crate::scene::input::entry::{PLACE_TOLERANCE, finite, number, wrong};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Feet closer together than this, relative to the body's size, are one point: neighbouring cells share their edges,
/// and the accuracy of a search is the square root of rounding.
const SAME_FOOT: f64 = 1e-6;

/// Unit normals closer than this belong to one smooth piece.
const SAME_NORMAL: f64 = 1e-12;

/// Heights on a grid over the two coordinates perpendicular to the approach direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeightMapSpec {
    /// Grid lines of the first coordinate perpendicular to the approach direction (x, or y if that direction is along
    /// x): at least two, increasing, from the first candidate to the last or beyond.
    #[schemars(extend("minItems" = 2))]
    pub x: Vec<f64>,
    /// Grid lines of the second coordinate perpendicular to it (z, or y if the approach direction is along z),
    /// likewise.
    #[schemars(extend("minItems" = 2))]
    pub y: Vec<f64>,
    /// `heights[i][j]`: the surface's coordinate along the axis of the approach direction over `x[i]`, `y[j]`.
    #[schemars(extend("minItems" = 2))]
    pub heights: Vec<Vec<f64>>,
}

impl ObstacleShape for HeightMapSpec {
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let map = HeightMap::new(self, site)?;
        let [first, second] = across(site.approach);
        site.check_reach("height map", &[("x", first, map.range(0)), ("y", second, map.range(1))])?;
        Ok(Geometry::rigid(site, map))
    }
}

/// A grid of heights towards the obstacle.
#[derive(Debug)]
struct HeightMap {
    lines: [Vec<f64>; 2],
    /// Row by row, one row per line of the first coordinate.
    heights: Vec<f64>,
    axes: Axes,
    /// The body's size.
    size: f64,
    rounding: f64,
}

impl HeightMap {
    /// Checks the grid.
    fn new(spec: &HeightMapSpec, site: &ObstacleSite) -> Result<Self, Error> {
        let (_, sense) = site.approach.axis();
        for (field, lines) in [("x", &spec.x), ("y", &spec.y)] {
            check_lines(lines, &site.field(field))?;
        }
        let (rows, columns) = (spec.x.len(), spec.y.len());
        let count = |found: usize, expected: usize, what: &str, lines: &str| {
            format!("the array has {found} {what}, but there are {expected} grid lines in `{lines}`")
        };
        if spec.heights.len() != rows {
            return Err(wrong(site.field("heights"), count(spec.heights.len(), rows, "rows", "x")));
        }
        let mut heights = Vec::with_capacity(rows * columns);
        for (i, row) in spec.heights.iter().enumerate() {
            if row.len() != columns {
                return Err(wrong(format!("{}.heights[{i}]", site.path), count(row.len(), columns, "entries", "y")));
            }
            for (j, &height) in row.iter().enumerate() {
                finite(format!("{}.heights[{i}][{j}]", site.path), height)?;
                heights.push(sense * height);
            }
        }
        let (lines, axes) = ([spec.x.clone(), spec.y.clone()], Axes::new(site.approach, [0.0; 3]));
        Ok(HeightMap { lines, heights, axes, size: site.body.mesh().size(), rounding: site.rounding() })
    }

    /// The height at a place, or `None` beyond the rim.
    fn height(&self, at: [f64; 2]) -> Option<f64> {
        let is_over = (0..2).all(|axis| {
            let (first, last) = self.reach(axis);
            (first..=last).contains(&at[axis])
        });
        is_over.then(|| {
            let [i, j] = [0, 1].map(|axis| self.cell_at(axis, at[axis]));
            self.patch(i, j).height(at)
        })
    }

    /// The normal at a foot: of the surface if it is smooth there or the node lies on it, else the direction to the
    /// foot.
    fn normal(&self, node: [f64; 3], foot: &CellFoot, sense: f64) -> [f64; 3] {
        let tolerance = self.rounding;
        let around: Vec<[f64; 3]> = self
            .cells_within(tolerance, foot.at)
            .map(|(i, j)| self.patch(i, j).normal([foot.at[0], foot.at[1]]))
            .collect();
        let mean = mean_direction(&around);
        let smooth = around.iter().all(|normal| (0..3).all(|axis| (normal[axis] - mean[axis]).abs() <= SAME_NORMAL));
        let on_rim = (0..2).any(|axis| {
            let (first, last) = self.range(axis);
            foot.at[axis] <= first || foot.at[axis] >= last
        });
        if foot.distance <= tolerance || (smooth && !on_rim) {
            return mean;
        }
        let way = [0, 1, 2].map(|axis| sense * (foot.at[axis] - node[axis]) / foot.distance);
        // On a smooth rim the foot may still be a normal foot: the normal of the surface then has more correct digits.
        let same = (0..3).all(|axis| (way[axis] - mean[axis]).abs() <= SAME_NORMAL.sqrt());
        if smooth && same { mean } else { way }
    }

    fn range(&self, axis: usize) -> (f64, f64) {
        let lines = &self.lines[axis];
        (lines[0], lines[lines.len() - 1])
    }

    /// The range, and the tolerance of a place beyond it.
    fn reach(&self, axis: usize) -> (f64, f64) {
        let ((first, last), rim) = (self.range(axis), PLACE_TOLERANCE * self.size);
        (first - rim, last + rim)
    }

    /// The cell over a coordinate; beyond the rim the outermost cell.
    fn cell_at(&self, axis: usize, at: f64) -> usize {
        let lines = &self.lines[axis];
        lines.partition_point(|&line| line <= at).saturating_sub(1).min(lines.len() - 2)
    }

    /// The cells over the square around a place.
    fn cells_within(&self, distance: f64, at: [f64; 3]) -> impl Iterator<Item = (usize, usize)> {
        let [rows, columns]: [RangeInclusive<usize>; 2] =
            [0, 1].map(|axis| self.cell_at(axis, at[axis] - distance)..=self.cell_at(axis, at[axis] + distance));
        rows.flat_map(move |i| columns.clone().map(move |j| (i, j)))
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

impl Surface for HeightMap {
    fn gap(&self, node: [f64; 3], shift: f64) -> Option<f64> {
        let [t1, t2, towards] = self.axes.local(node, shift);
        Some(self.height([t1, t2])? - towards)
    }

    /// Cells farther away than the best so far are left out. The surface ends at its rim. A node equally close to
    /// several points, to within rounding, takes their mean normal.
    fn closest(&self, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let (node, tolerance) = (self.axes.local(node, shift), self.rounding);
        let Some(height) = self.height([node[0], node[1]]) else { return Ok(None) };
        let sense = if node[2] > height { -1.0 } else { 1.0 };
        let home @ [i, j] = [0, 1].map(|axis| self.cell_at(axis, node[axis]));
        let best = |feet: &[CellFoot]| feet.iter().fold(f64::INFINITY, |best: f64, foot| best.min(foot.distance));
        let mut feet = self.patch(i, j).feet(node);
        let reach = best(&feet) + tolerance;
        for (i, j) in self.cells_within(reach, node).filter(|&(i, j)| [i, j] != home) {
            let patch = self.patch(i, j);
            if patch.box_distance(node) <= best(&feet) + tolerance {
                feet.extend(patch.feet(node));
            }
        }
        let nearest = best(&feet);
        feet.retain(|foot| foot.distance <= nearest + tolerance);
        // A foot inside a cell is more accurate than the foot on an edge next to it.
        feet.sort_by_key(|foot| foot.on_edge);
        let mut apart: Vec<CellFoot> = Vec::new();
        for foot in feet {
            let is_beside = |other: &CellFoot| norm(minus(other.at, foot.at)) <= SAME_FOOT * self.size;
            if !apart.iter().any(is_beside) {
                apart.push(foot);
            }
        }
        let normals: Vec<[f64; 3]> = apart.iter().map(|foot| self.normal(node, foot, sense)).collect();
        let normal = mean_direction(&normals);
        // Along its own normal the foot is at its distance; along a mean normal the plane through the foot is farther
        // away.
        let row = apart.first().zip(normals.first()).map(|(foot, &own)| ObstacleRow {
            normal: self.axes.global(normal),
            gap: dot(own, minus(foot.at, node)) / dot(own, normal),
        });
        Ok(row)
    }

    /// The bilinear function through the corners of the rectangle around the triangle. Between grid lines its distance
    /// from the map is bilinear, too, and so largest where lines cross. Over a triangle that reaches beyond the rim it
    /// is the lowest height.
    fn gap_over(&self, corners: [[f64; 3]; 3], shift: f64) -> Option<([f64; 6], [f64; 2])> {
        let local = corners.map(|corner| self.axes.local(corner, shift));
        let places = local.map(|[t1, t2, _]| [t1, t2]);
        let around = [0, 1].map(|axis| extent(places.map(|place| place[axis])));
        let within = [0, 1].map(|axis| {
            let ([low, high], (first, last)) = (around[axis], self.reach(axis));
            [low.max(first), high.min(last)]
        });
        if within.iter().any(|[low, high]| low > high) {
            return None;
        }
        let lines = [0, 1].map(|axis| {
            let [low, high] = within[axis];
            let inside = self.lines[axis].iter().copied().filter(move |&line| low < line && line < high);
            iter::once(low).chain(inside).chain([high])
        });
        let crossings = lines[0].clone().flat_map(|x| lines[1].clone().map(move |y| [x, y]));
        if within != around {
            let lowest = crossings.filter_map(|at| self.height(at)).fold(f64::INFINITY, f64::min);
            return Some((gap_to([lowest; 6], local), [0.0, f64::INFINITY]));
        }
        let [[left, right], [front, back]] = within;
        let corner = |x: f64, y: f64| self.height([x, y]);
        let whole = Patch {
            low: [left, front],
            // Across a rectangle without width all heights are equal.
            size: within.map(|[low, high]| if high > low { high - low } else { 1.0 }),
            corners: [corner(left, front)?, corner(right, front)?, corner(left, back)?, corner(right, back)?],
        };
        let mut off = [0.0_f64; 2];
        for at in crossings {
            let above = self.height(at)? - whole.height(at);
            off = [off[0].max(-above), off[1].max(above)];
        }
        let height = |i: usize, j: usize| whole.height([places[i][0], places[j][1]]);
        Some((gap_to(PAIRS.map(|[i, j]| (height(i, j) + height(j, i)) / 2.0), local), off))
    }
}

/// The mean of unit vectors, of length 1.
fn mean_direction(vectors: &[[f64; 3]]) -> [f64; 3] {
    let sum = vectors.iter().copied().fold([0.0; 3], plus);
    let length = norm(sum);
    sum.map(|part| part / length)
}

fn norm(vector: [f64; 3]) -> f64 {
    dot(vector, vector).sqrt()
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

#[cfg(test)]
mod tests {
    use super::super::oracle::{ROUNDING, Random, checked, triangles};
    use super::*;
    use crate::scene::input::schema::model::Approach;

    /// Over [-2, 2] x [-1.5, 1.5], with random heights.
    fn map(random: &mut Random) -> HeightMap {
        let lines = [vec![-2.0, -1.1, -0.2, 0.0, 0.7, 2.0], vec![-1.5, 0.1, 0.3, 1.5]];
        let heights = (0..24).map(|_| random.between(-0.5, 0.5)).collect();
        HeightMap { lines, heights, axes: Axes::new(Approach::PlusZ, [0.0; 3]), size: 4.0, rounding: 0.0 }
    }

    #[test]
    fn the_gap_to_a_height_map_over_any_triangle_stays_within_its_enclosure() {
        let mut random = Random(1);
        let map = map(&mut random);
        let (mut whole, mut part, mut none) = (0, 0, 0);
        for corners in triangles(&mut random) {
            match checked(&map, corners, 0.2, &mut random) {
                Some([_, above]) if above.is_finite() => whole += 1,
                Some(_) => part += 1,
                None => none += 1,
            }
        }
        assert!(whole > 100 && part > 20 && none > 20, "{whole} {part} {none}");
    }

    #[test]
    fn the_enclosure_in_one_cell_of_a_height_map_is_exact() {
        let mut random = Random(2);
        let map = map(&mut random);
        for _ in 0..100 {
            let corners =
                [0, 1, 2].map(|_| [random.between(0.0, 0.7), random.between(0.3, 1.5), random.between(-1.0, 1.0)]);
            let [below, above] = checked(&map, corners, 0.0, &mut random).unwrap();
            assert!(below.max(above) <= ROUNDING, "{corners:?}: {below} {above}");
        }
    }
}
