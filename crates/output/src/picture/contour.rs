//! Outlines of the regions in which a nodal field exceeds a level, to be painted one over the other.
//!
//! The field is linear on triangles: an element with more than three corners is a fan of triangles around its centre,
//! which carries the mean of the corners. Inside the region `value >= level` two neighbours see the same piece of their
//! common edge, so the outline consists of the level line within the triangles and of pieces of the boundary of the
//! mesh. Only these are written, which keeps a picture small however fine the mesh is.

use std::collections::HashMap;

/// A corner of a triangle: its position in the picture and its value.
type Corner = ([f64; 2], f64);

/// A mesh with a value at every node, ready to be cut at any level.
pub(crate) struct Field {
    triangles: Vec<[Corner; 3]>,
    boundary: Vec<[Corner; 2]>,
}

impl Field {
    /// Collects the elements with a finite position and a finite value at every node; `node` gives both.
    pub fn new(elements: &[Vec<usize>], node: impl Fn(usize) -> Option<Corner>) -> Self {
        let mut field = Field { triangles: Vec::new(), boundary: Vec::new() };
        // A directed edge lies on the boundary of the mesh if no neighbour has it in the other direction.
        let mut edges: Vec<([usize; 2], i32)> = Vec::with_capacity(4 * elements.len());
        for element in elements {
            let Some(mut corners) = element.iter().map(|&index| node(index)).collect::<Option<Vec<Corner>>>() else {
                continue;
            };
            if corners.len() < 3 {
                continue;
            }
            let mut indices = element.clone();
            if doubled_area(&corners) < 0.0 {
                corners.reverse();
                indices.reverse();
            }
            for (k, &from) in indices.iter().enumerate() {
                let to = indices[(k + 1) % indices.len()];
                edges.push(if from < to { ([from, to], 1) } else { ([to, from], -1) });
            }
            field.add(&corners);
        }
        edges.sort_unstable();
        for same in edges.chunk_by(|a, b| a.0 == b.0) {
            let (edge, way) = (same[0].0, same.iter().map(|edge| edge.1).sum::<i32>());
            if let (true, Some(low), Some(high)) = (way != 0, node(edge[0]), node(edge[1])) {
                field.boundary.push(if way > 0 { [low, high] } else { [high, low] });
            }
        }
        field
    }

    fn add(&mut self, corners: &[Corner]) {
        if let &[a, b, c] = corners {
            self.triangles.push([a, b, c]);
            return;
        }
        let share = 1.0 / corners.len() as f64;
        let mean = |part: &dyn Fn(&Corner) -> f64| corners.iter().map(|corner| part(corner) * share).sum::<f64>();
        let centre = ([mean(&|corner| corner.0[0]), mean(&|corner| corner.0[1])], mean(&|corner| corner.1));
        for (k, &corner) in corners.iter().enumerate() {
            self.triangles.push([corner, corners[(k + 1) % corners.len()], centre]);
        }
    }

    /// Outlines of the region with a field of at least `level`; of the whole mesh for minus infinity.
    pub fn at_least(&self, level: f64) -> Vec<Vec<[f64; 2]>> {
        let mut pieces = Vec::new();
        for triangle in &self.triangles {
            let inside = triangle.map(|corner| corner.1 >= level);
            if inside == [inside[0]; 3] {
                continue;
            }
            // Exactly one corner differs from the two others.
            for k in 0..3 {
                let (here, next, last) = (k, (k + 1) % 3, (k + 2) % 3);
                if inside[here] != inside[next] && inside[here] != inside[last] {
                    let [leaving, entering] =
                        [next, last].map(|other| crossing(triangle[here], triangle[other], level));
                    pieces.push(if inside[here] { [leaving, entering] } else { [entering, leaving] });
                }
            }
        }
        for &[from, to] in &self.boundary {
            match (from.1 >= level, to.1 >= level) {
                (true, true) => pieces.push([from.0, to.0]),
                (true, false) => pieces.push([from.0, crossing(from, to, level)]),
                (false, true) => pieces.push([crossing(from, to, level), to.0]),
                (false, false) => {}
            }
        }
        chained(&pieces)
    }
}

/// The point of an edge with the value `level`; the same point for both orders of its ends.
fn crossing(a: Corner, b: Corner, level: f64) -> [f64; 2] {
    let (low, high) = if a.1 < b.1 { (a, b) } else { (b, a) };
    // Halves, so that a difference of huge values does not overflow.
    let part = ((0.5 * level - 0.5 * low.1) / (0.5 * high.1 - 0.5 * low.1)).clamp(0.0, 1.0);
    [0, 1].map(|axis| low.0[axis] + part * (high.0[axis] - low.0[axis]))
}

fn doubled_area(corners: &[Corner]) -> f64 {
    let origin = corners[0].0;
    let relative: Vec<[f64; 2]> =
        corners.iter().map(|corner| [corner.0[0] - origin[0], corner.0[1] - origin[1]]).collect();
    relative.windows(2).map(|pair| pair[0][0] * pair[1][1] - pair[0][1] * pair[1][0]).sum()
}

/// Joins directed pieces to closed lines; ends that agree to a hundredth of a pixel are one point.
fn chained(pieces: &[[[f64; 2]; 2]]) -> Vec<Vec<[f64; 2]>> {
    let key = |point: [f64; 2]| point.map(|coordinate| (coordinate * 100.0).round() as i64);
    let mut leaving: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    for (index, piece) in pieces.iter().enumerate() {
        if key(piece[0]) != key(piece[1]) {
            leaving.entry(key(piece[0])).or_default().push(index);
        }
    }
    let mut loops = Vec::new();
    for first in pieces {
        let mut points = Vec::new();
        let mut at = key(first[0]);
        while let Some(index) = leaving.get_mut(&at).and_then(Vec::pop) {
            points.push(pieces[index][0]);
            at = key(pieces[index][1]);
        }
        let points = without_straight(points);
        if points.len() > 2 {
            loops.push(points);
        }
    }
    loops
}

/// Leaves out points that lie on the straight line through their neighbours.
fn without_straight(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    /// Invisible distance from the line in pixels.
    const STRAIGHT: f64 = 0.02;
    let mut kept: Vec<[f64; 2]> = Vec::with_capacity(points.len());
    for (k, &point) in points.iter().enumerate() {
        let (Some(&before), after) = (kept.last(), points[(k + 1) % points.len()]) else {
            kept.push(point);
            continue;
        };
        let (along, across) =
            ([after[0] - before[0], after[1] - before[1]], [point[0] - before[0], point[1] - before[1]]);
        let length = along[0].hypot(along[1]);
        let ahead = along[0] * across[0] + along[1] * across[1];
        let aside = (along[0] * across[1] - along[1] * across[0]).abs();
        // A spike that turns back is not a straight line.
        if !(aside <= STRAIGHT * length && ahead >= 0.0 && ahead <= length * length && length > 0.0) {
            kept.push(point);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The square `[0, 100]²` in `n x n` quadrilaterals, every second one split into triangles, clockwise ones among
    /// them.
    fn square(n: usize) -> (Vec<[f64; 2]>, Vec<Vec<usize>>) {
        let at = |k: usize| 100.0 * k as f64 / n as f64;
        let nodes = (0..=n).flat_map(|j| (0..=n).map(move |i| [at(i), at(j)])).collect();
        let mut elements = Vec::new();
        for corner in (0..n).flat_map(|j| (0..n).map(move |i| j * (n + 1) + i)) {
            let [a, b, c, d] = [corner, corner + 1, corner + n + 2, corner + n + 1];
            match corner % 3 {
                0 => elements.push(vec![a, b, c, d]),
                1 => elements.push(vec![a, d, c, b]),
                _ => elements.extend([vec![a, b, c], vec![c, a, d]]),
            }
        }
        (nodes, elements)
    }

    fn area(loops: &[Vec<[f64; 2]>]) -> f64 {
        let doubled = |points: &Vec<[f64; 2]>| -> f64 {
            (0..points.len())
                .map(|k| (points[k], points[(k + 1) % points.len()]))
                .map(|(from, to)| from[0] * to[1] - from[1] * to[0])
                .sum()
        };
        loops.iter().map(doubled).sum::<f64>() / 2.0
    }

    #[test]
    fn region_above_a_level_of_a_linear_field_has_the_area_of_its_formula() {
        let (nodes, elements) = square(9);
        let field = Field::new(&elements, |node| Some((nodes[node], nodes[node][0])));
        for level in [0.0, 3.0, 100.0 / 3.0, 50.0, 99.0] {
            let outlines = field.at_least(level);
            assert_eq!(outlines.len(), 1, "level {level}");
            assert!((area(&outlines) - 100.0 * (100.0 - level)).abs() < 3.0, "level {level}: {}", area(&outlines));
        }
        assert!(field.at_least(100.1).is_empty());
    }

    #[test]
    fn region_around_a_peak_is_a_disc_and_its_complement_has_a_hole() {
        let (nodes, elements) = square(60);
        let distance = |node: usize| (nodes[node][0] - 50.0).hypot(nodes[node][1] - 50.0);
        let disc = std::f64::consts::PI * 30.0f64.powi(2);
        let peak = Field::new(&elements, |node| Some((nodes[node], -distance(node)))).at_least(-30.0);
        assert!((area(&peak) - disc).abs() < 0.005 * disc, "{}", area(&peak));
        let valley = Field::new(&elements, |node| Some((nodes[node], distance(node)))).at_least(30.0);
        assert_eq!(valley.len(), 2);
        assert!((area(&valley) - (1e4 - disc)).abs() < 0.005 * disc, "{}", area(&valley));
    }

    #[test]
    fn outline_of_a_rectangle_has_four_corners_however_fine_its_mesh_is() {
        for n in [1, 7, 40] {
            let (nodes, elements) = square(n);
            let outline = Field::new(&elements, |node| Some((nodes[node], 0.0))).at_least(f64::NEG_INFINITY);
            assert_eq!(outline.iter().map(Vec::len).collect::<Vec<_>>(), [4], "n = {n}");
        }
    }
}
