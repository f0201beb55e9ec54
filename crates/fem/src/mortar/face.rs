//! What two faces in space share: polygons in a plane across the direction along which the slave face is projected.

use std::sync::OnceLock;

use super::facet::{PlacedFacet, STRAIGHT, SharedPoint, area_vector};
use crate::element::{Cell, FacetKind, ReferenceElement, Shape, gauss_legendre};
use crate::geometry::{cross, dot, length, minus, unit};

/// A corner this close to a line, in squares of the length of the line, lies on it.
const ON_LINE: f64 = 1e-12;

/// A polygon below this share of its facet is rounding.
const NO_AREA: f64 = 1e-14;

/// Faces that are no images of their reference cells by linear maps need more points, because the inverse of the map is
/// no polynomial: points in each direction of a triangle, and the distortion from which on the second number counts.
const FINE: usize = 8;
const FINEST: usize = 12;
const DISTORTED: f64 = 0.5;

/// Steps of Newton's method to the reference coordinates of a point.
const STEPS: usize = 30;

/// Newton's method ends when the reference coordinates move by less: the next step is of the order of the square.
const FOUND: f64 = 1e-9;

type Point = [f64; 2];

/// Points of a triangle, each with the area that it stands for.
type Rule = Vec<(Point, f64)>;

/// The plane across a direction, with two axes.
struct Plane {
    origin: [f64; 3],
    axes: [[f64; 3]; 2],
}

impl Plane {
    fn across(direction: [f64; 3], origin: [f64; 3]) -> Self {
        let least =
            (1..3).fold(0, |least, axis| if direction[axis].abs() < direction[least].abs() { axis } else { least });
        let mut other = [0.0; 3];
        other[least] = 1.0;
        let first = unit(cross(other, direction));
        Plane { origin, axes: [first, cross(direction, first)] }
    }

    fn point(&self, at: [f64; 3]) -> Point {
        let away = minus(at, self.origin);
        self.axes.map(|axis| dot(away, axis))
    }

    fn polygon(&self, corners: &[[f64; 3]]) -> Vec<Point> {
        corners.iter().map(|&corner| self.point(corner)).collect()
    }
}

fn turned(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn from(a: Point, b: Point) -> Point {
    [b[0] - a[0], b[1] - a[1]]
}

/// Twice the area of a triangle, positive if it runs counterclockwise.
fn twice_area(a: Point, b: Point, c: Point) -> f64 {
    turned(from(a, b), from(a, c))
}

/// The part of a polygon inside a convex one that runs counterclockwise, by the method of Sutherland and Hodgman.
fn clipped(polygon: &[Point], by: &[Point]) -> Vec<Point> {
    let (mut left, mut kept) = (polygon.to_vec(), Vec::with_capacity(polygon.len() + by.len()));
    for (corner, &a) in by.iter().enumerate() {
        let edge = from(a, by[(corner + 1) % by.len()]);
        let rounding = ON_LINE * (edge[0] * edge[0] + edge[1] * edge[1]);
        let side = |point: Point| turned(edge, from(a, point));
        let Some(&last) = left.last() else { break };
        let (mut before, mut there) = (last, side(last));
        for &point in &left {
            let here = side(point);
            if here * there < 0.0 && here.abs() > rounding && there.abs() > rounding {
                let share = there / (there - here);
                let way = from(before, point);
                kept.push([before[0] + share * way[0], before[1] + share * way[1]]);
            }
            if here >= -rounding {
                kept.push(point);
            }
            (before, there) = (point, here);
        }
        std::mem::swap(&mut left, &mut kept);
        kept.clear();
    }
    left
}

/// Lowest and highest coordinates of a polygon.
fn limits(polygon: &[Point]) -> [Point; 2] {
    [f64::min, f64::max]
        .map(|pick| [0, 1].map(|axis| polygon.iter().map(|point| point[axis]).fold(polygon[0][axis], pick)))
}

/// A map from reference coordinates to the plane.
enum Map {
    /// Origin and both tangents.
    Linear([Point; 3]),
    /// The coefficients of 1, xi, eta and xi eta.
    Bilinear([Point; 4]),
    Curved,
}

/// The map from the plane to the reference coordinates of a face.
struct InverseProjection {
    reference: &'static ReferenceElement,
    places: Vec<Point>,
    map: Map,
    /// The distance of a quadrilateral from a parallelogram, relative to its edges.
    distortion: f64,
}

impl InverseProjection {
    fn of(facet: &PlacedFacet, plane: &Plane) -> Self {
        let (reference, places) = (facet.reference(), plane.polygon(facet.places()));
        let quarter = |signs: [f64; 4]| {
            [0, 1].map(|axis| (0..4).map(|corner| signs[corner] * places[corner][axis]).sum::<f64>() / 4.0)
        };
        let (skew, [origin, first, second]) = match reference.form {
            Shape::Simplex => ([0.0; 2], [places[0], from(places[0], places[1]), from(places[0], places[2])]),
            Shape::Product => {
                let half = |way: Point| way.map(|part| part / 2.0);
                let (first, second) = (half(from(places[0], places[1])), half(from(places[0], places[3])));
                let (below, above) = (from(places[0], places[1]), from(places[3], places[2]));
                (from(below, above), [quarter([1.0; 4]), first, second])
            }
        };
        let distortion = skew[0].hypot(skew[1]) / facet.radius;
        let map = match (facet.is_straight, reference.form) {
            (false, _) => Map::Curved,
            (true, Shape::Product) if distortion > STRAIGHT => Map::Bilinear([
                quarter([1.0; 4]),
                quarter([-1.0, 1.0, 1.0, -1.0]),
                quarter([-1.0, -1.0, 1.0, 1.0]),
                quarter([1.0, -1.0, 1.0, -1.0]),
            ]),
            _ => Map::Linear([origin, first, second]),
        };
        InverseProjection { reference, places, map, distortion }
    }

    /// The reference coordinates of a point; `None` where the face folds.
    fn at(&self, point: Point) -> Option<[f64; 3]> {
        match self.map {
            Map::Linear([origin, first, second]) => {
                let (whole, way) = (turned(first, second), from(origin, point));
                Some([turned(way, second) / whole, turned(first, way) / whole, 0.0])
            }
            Map::Bilinear([middle, first, second, skew]) => {
                let to = from(middle, point);
                newton([0.0; 2], |[xi, eta]| {
                    let place = |axis: usize| xi * first[axis] + eta * (second[axis] + xi * skew[axis]);
                    let tangents = [
                        [0, 1].map(|axis| first[axis] + eta * skew[axis]),
                        [0, 1].map(|axis| second[axis] + xi * skew[axis]),
                    ];
                    ([0, 1].map(|axis| to[axis] - place(axis)), tangents)
                })
            }
            Map::Curved => {
                let [xi, eta, _] = self.reference.centroid();
                newton([xi, eta], |[xi, eta]| self.away(point, [xi, eta, 0.0]))
            }
        }
    }

    /// The way to a point from the place at some reference coordinates, and the tangents there.
    fn away(&self, point: Point, at: [f64; 3]) -> (Point, [Point; 2]) {
        let (shape, slope) = ((self.reference.shape)(at), (self.reference.derivative)(at));
        let (mut away, mut tangents) = (point, [[0.0; 2]; 2]);
        for (node, place) in self.places.iter().enumerate() {
            for axis in 0..2 {
                away[axis] -= shape[node] * place[axis];
                tangents[0][axis] += slope[node][0] * place[axis];
                tangents[1][axis] += slope[node][1] * place[axis];
            }
        }
        (away, tangents)
    }

    /// Points in each direction of a triangle that integrate its functions well enough; `None` for a linear map.
    fn points(&self) -> Option<usize> {
        match self.map {
            Map::Linear(_) => None,
            _ => Some(if self.distortion > DISTORTED { FINEST } else { FINE }),
        }
    }
}

/// The zero of the way to a point by Newton's method, from the way and the tangents at reference coordinates.
fn newton(start: Point, away: impl Fn(Point) -> (Point, [Point; 2])) -> Option<[f64; 3]> {
    let mut at = start;
    for _ in 0..STEPS {
        let (way, [first, second]) = away(at);
        let whole = turned(first, second);
        let step = [turned(way, second) / whole, turned(first, way) / whole];
        at = [at[0] + step[0], at[1] + step[1]];
        if !(at[0].abs() < 10.0 && at[1].abs() < 10.0) {
            return None;
        }
        if step[0].abs().max(step[1].abs()) <= FOUND {
            break;
        }
    }
    Some([at[0], at[1], 0.0])
}

/// A rule on the triangle (0,0), (1,0), (0,1): points with weights that add up to 1/2.
fn rule(points: Option<usize>) -> &'static [(Point, f64)] {
    static RULES: [OnceLock<Rule>; 3] = [const { OnceLock::new() }; 3];
    let place = match points {
        None => 0,
        Some(FINE) => 1,
        Some(_) => 2,
    };
    RULES[place].get_or_init(|| {
        let Some(points) = points else {
            let quartic = FacetKind::T6.reference().quadrature.iter();
            return quartic.map(|point| ([point.at[0], point.at[1]], point.weight)).collect();
        };
        let line: Vec<(f64, f64)> =
            gauss_legendre(points).map(|(at, weight)| ((1.0 + at) / 2.0, weight / 2.0)).collect();
        let product = line.iter().flat_map(|&a| line.iter().map(move |&b| (a, b)));
        product.map(|((s, v), (t, w))| ([s * (1.0 - t), t], v * w * (1.0 - t))).collect()
    })
}

/// Calls `visit` for the points of a rule on a convex polygon, with the area that each stands for.
fn for_each_of_polygon(polygon: &[Point], rule: &[(Point, f64)], mut visit: impl FnMut(Point, f64)) {
    for at in 2..polygon.len() {
        let a = polygon[0];
        let (first, second) = (from(a, polygon[at - 1]), from(a, polygon[at]));
        let twice = turned(first, second);
        for &([s, t], weight) in rule {
            visit([0, 1].map(|axis| a[axis] + s * first[axis] + t * second[axis]), weight * twice);
        }
    }
}

/// A slave face with the plane across its direction.
pub(super) struct Projected<'a> {
    facet: &'a PlacedFacet<'a>,
    direction: [f64; 3],
    plane: Plane,
    inverse: InverseProjection,
    /// Its straight pieces, counterclockwise.
    pieces: Vec<Vec<Point>>,
    /// Its area in the plane.
    area: f64,
    cell: Cell,
    /// The ratio of area in place to area in the plane, if it is the same everywhere.
    ratio: Option<f64>,
}

impl<'a> Projected<'a> {
    /// The face seen along a unit vector that leads out of it.
    pub fn new(facet: &'a PlacedFacet<'a>, direction: [f64; 3]) -> Self {
        let plane = Plane::across(direction, facet.middle);
        let piece = |corners: &Vec<[f64; 3]>| {
            let vector = area_vector(corners);
            let facing = dot(vector, direction);
            (facing > 0.0).then(|| (plane.polygon(corners), facing))
        };
        let found: Vec<_> = facet.pieces.iter().filter_map(piece).collect();
        let area = found.iter().map(|(_, area)| area).sum();
        let pieces = found.into_iter().map(|(polygon, _)| polygon).collect();
        let cell = Cell::at(facet.reference(), |local| facet.corners[local]);
        let ratio = facet.is_flat().then(|| 1.0 / dot(facet.normal, direction));
        Projected { facet, direction, inverse: InverseProjection::of(facet, &plane), plane, pieces, area, cell, ratio }
    }

    /// Calls `visit` for the integration points of the whole face: reference coordinates and area.
    pub fn for_each_of_whole(&self, visit: &mut dyn FnMut([f64; 3], f64)) {
        for polygon in &self.pieces {
            for_each_of_polygon(polygon, rule(self.inverse.points()), |point, area| {
                if let Some(at) = self.inverse.at(point) {
                    visit(at, area * self.ratio(at));
                }
            });
        }
    }

    /// The ratio of area in place to area in the plane.
    fn ratio(&self, at: [f64; 3]) -> f64 {
        self.ratio.unwrap_or_else(|| {
            let vector = self.cell.area_vector(&(self.facet.reference().derivative)(at));
            length(vector) / dot(vector, self.direction)
        })
    }

    /// The reference coordinates of the place that is seen behind a point.
    pub fn foot(&self, at: [f64; 3]) -> Option<[f64; 3]> {
        self.inverse.at(self.plane.point(at))
    }

    /// Calls `visit` for every integration point of the part that `master` covers, if it is within `reach`.
    pub fn for_each_point(&self, master: &PlacedFacet, reach: f64, visit: &mut dyn FnMut(SharedPoint)) {
        let inverse = InverseProjection::of(master, &self.plane);
        let rule = rule(self.inverse.points().max(inverse.points()));
        for piece in &master.pieces {
            let vector = area_vector(piece);
            if dot(vector, self.direction) >= 0.0 {
                continue;
            }
            // Seen along the direction, the other face runs clockwise.
            let mut other = self.plane.polygon(piece);
            other.reverse();
            let [low, high] = limits(&other);
            for own in &self.pieces {
                let [first, last] = limits(own);
                if (0..2).any(|axis| low[axis] > last[axis] || high[axis] < first[axis]) {
                    continue;
                }
                let shared = clipped(&other, own);
                let area: f64 =
                    (2..shared.len()).map(|at| twice_area(shared[0], shared[at - 1], shared[at])).sum::<f64>() / 2.0;
                if shared.len() < 3 || area <= NO_AREA * self.area || self.is_far(&shared, master, &inverse, reach) {
                    continue;
                }
                for_each_of_polygon(&shared, rule, |point, area| {
                    if let (Some(slave), Some(master)) = (self.inverse.at(point), inverse.at(point)) {
                        visit(SharedPoint { slave, master, weight: area * self.ratio(slave) });
                    }
                });
            }
        }
    }

    /// Returns `true` if both faces are farther apart than `reach` in the middle of a polygon.
    fn is_far(&self, polygon: &[Point], master: &PlacedFacet, inverse: &InverseProjection, reach: f64) -> bool {
        let count = polygon.len() as f64;
        let centre = [0, 1].map(|axis| polygon.iter().map(|point| point[axis]).sum::<f64>() / count);
        let height = |facet: &PlacedFacet, inverse: &InverseProjection| {
            let shape = (facet.reference().shape)(inverse.at(centre)?);
            let heights = facet.places().iter().map(|&place| dot(minus(place, self.facet.middle), self.direction));
            Some(heights.zip(shape).map(|(height, share)| share * height).sum::<f64>())
        };
        match (height(self.facet, &self.inverse), height(master, inverse)) {
            (Some(own), Some(other)) => (other - own).abs() > reach,
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_cut_by_a_triangle_leaves_their_common_part() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let area = |polygon: &[Point]| {
            (2..polygon.len()).map(|at| twice_area(polygon[0], polygon[at - 1], polygon[at])).sum::<f64>() / 2.0
        };
        assert_eq!(area(&clipped(&square, &square)), 1.0);
        assert_eq!(area(&clipped(&square, &[[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]])), 1.0);
        assert_eq!(area(&clipped(&square, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])), 0.5);
        assert_eq!(area(&clipped(&square, &[[2.0, 0.0], [3.0, 0.0], [2.0, 1.0]])), 0.0);
    }

    /// Moments over a pentagon, against the formula of Green's theorem.
    #[test]
    fn the_rules_integrate_quartics_on_polygons() {
        let pentagon = [[0.1, 0.0], [1.0, 0.2], [1.1, 0.9], [0.4, 1.3], [-0.2, 0.6]];
        let exact: f64 = (0..5)
            .map(|at| {
                let ([a, b], [c, d]) = (pentagon[at], pentagon[(at + 1) % 5]);
                // The integral of x^5/5 dy along an edge.
                let along = |s: f64| (a + s * (c - a)).powi(5) / 5.0 * (d - b);
                gauss_legendre(5).map(|(s, weight)| weight / 2.0 * along((1.0 + s) / 2.0)).sum::<f64>()
            })
            .sum();
        for points in [None, Some(FINE), Some(FINEST)] {
            let mut sum = 0.0;
            for_each_of_polygon(&pentagon, rule(points), |[x, _], area| sum += area * x.powi(4));
            assert!((sum / exact - 1.0).abs() < 1e-13, "{points:?}: {sum} against {exact}");
        }
    }
}
