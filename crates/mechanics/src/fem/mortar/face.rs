//! What two faces in space share: polygons in a plane across the direction along which the slave face is projected.

use std::sync::OnceLock;

use super::facet::{Facet, STRAIGHT, SharedPoint, area_vector};
use crate::fem::element::{Cell, FacetKind, ReferenceElement, Shape, gauss_legendre};
use crate::fem::geometry::{cross, dot, length, minus, unit};

/// A corner this close to a line, in squares of the length of the line, lies on it.
const ON_LINE: f64 = 1e-12;

/// A polygon below this share of its facet is rounding.
const NO_AREA: f64 = 1e-14;

/// Faces that are no images of their reference cells by linear maps need more points, because the inverse of the map is no polynomial:
/// points in each direction of a triangle, and the distortion from which on the second number counts.
const FINE: usize = 8;
const FINEST: usize = 12;
const DISTORTED: f64 = 0.5;

/// Steps of Newton's method to the reference coordinates of a point.
const STEPS: usize = 30;

/// Newton's method ends when the reference coordinates move by less.
const FOUND: f64 = 1e-15;

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
    let mut left = polygon.to_vec();
    for (corner, &a) in by.iter().enumerate() {
        let edge = from(a, by[(corner + 1) % by.len()]);
        let rounding = ON_LINE * (edge[0] * edge[0] + edge[1] * edge[1]);
        let side = |point: Point| turned(edge, from(a, point));
        let mut kept = Vec::with_capacity(left.len() + 1);
        for (place, &point) in left.iter().enumerate() {
            let before = left[(place + left.len() - 1) % left.len()];
            let (here, there) = (side(point), side(before));
            if here * there < 0.0 && here.abs() > rounding && there.abs() > rounding {
                let share = there / (there - here);
                let way = from(before, point);
                kept.push([before[0] + share * way[0], before[1] + share * way[1]]);
            }
            if here >= -rounding {
                kept.push(point);
            }
        }
        left = kept;
    }
    left
}

/// The map from the plane to the reference coordinates of a face.
struct Inverse {
    reference: &'static ReferenceElement,
    places: Vec<Point>,
    /// Origin and the two tangents of a linear map.
    linear: Option<[Point; 3]>,
    /// The distance of a quadrilateral from a parallelogram, relative to its edges.
    distortion: f64,
}

impl Inverse {
    fn of(facet: &Facet, plane: &Plane) -> Self {
        let (reference, places) = (facet.reference(), plane.polygon(facet.places()));
        let (skew, [origin, first, second]) = match reference.form {
            Shape::Simplex => ([0.0; 2], [places[0], from(places[0], places[1]), from(places[0], places[2])]),
            Shape::Product => {
                let middle = [0, 1].map(|axis| places[..4].iter().map(|place| place[axis]).sum::<f64>() / 4.0);
                let half = |way: Point| way.map(|part| part / 2.0);
                let (first, second) = (half(from(places[0], places[1])), half(from(places[0], places[3])));
                let (below, above) = (from(places[0], places[1]), from(places[3], places[2]));
                (from(below, above), [middle, first, second])
            }
        };
        let distortion = skew[0].hypot(skew[1]) / facet.radius;
        let linear = (distortion <= STRAIGHT && facet.is_straight()).then_some([origin, first, second]);
        Inverse { reference, places, linear, distortion }
    }

    /// The reference coordinates of a point; `None` where the face folds.
    fn at(&self, point: Point) -> Option<[f64; 3]> {
        if let Some([origin, first, second]) = self.linear {
            let (whole, way) = (turned(first, second), from(origin, point));
            return Some([turned(way, second) / whole, turned(first, way) / whole, 0.0]);
        }
        let mut at = self.reference.centroid();
        for _ in 0..STEPS {
            let (shape, slope) = ((self.reference.shape)(at), (self.reference.derivative)(at));
            let (mut away, mut tangents) = (point, [[0.0; 2]; 2]);
            for (node, place) in self.places.iter().enumerate() {
                for axis in 0..2 {
                    away[axis] -= shape[node] * place[axis];
                    tangents[0][axis] += slope[node][0] * place[axis];
                    tangents[1][axis] += slope[node][1] * place[axis];
                }
            }
            let whole = turned(tangents[0], tangents[1]);
            let step = [turned(away, tangents[1]) / whole, turned(tangents[0], away) / whole];
            at = [at[0] + step[0], at[1] + step[1], 0.0];
            if !(at[0].abs() < 10.0 && at[1].abs() < 10.0) {
                return None;
            }
            if step[0].abs().max(step[1].abs()) <= FOUND {
                break;
            }
        }
        Some(at)
    }

    /// Points in each direction of a triangle that integrate its functions well enough; `None` for a linear map.
    fn points(&self) -> Option<usize> {
        match self.linear {
            Some(_) => None,
            None => Some(if self.distortion > DISTORTED { FINEST } else { FINE }),
        }
    }
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
    let count = polygon.len() as f64;
    let centre = [0, 1].map(|axis| polygon.iter().map(|point| point[axis]).sum::<f64>() / count);
    // A triangle is its own fan.
    let fan: Vec<[Point; 3]> = match *polygon {
        [a, b, c] => vec![[a, b, c]],
        _ => (0..polygon.len()).map(|at| [centre, polygon[at], polygon[(at + 1) % polygon.len()]]).collect(),
    };
    for [a, b, c] in fan {
        let (first, second) = (from(a, b), from(a, c));
        let twice = turned(first, second);
        for &([s, t], weight) in rule {
            visit([0, 1].map(|axis| a[axis] + s * first[axis] + t * second[axis]), weight * twice);
        }
    }
}

/// A slave face with the plane across its direction.
pub(super) struct Projected<'a> {
    facet: &'a Facet<'a>,
    direction: [f64; 3],
    plane: Plane,
    inverse: Inverse,
    /// Its straight pieces, counterclockwise.
    pieces: Vec<Vec<Point>>,
    /// Its area in the plane.
    area: f64,
}

impl<'a> Projected<'a> {
    /// The face seen along a unit vector that leads out of it.
    pub fn new(facet: &'a Facet<'a>, direction: [f64; 3]) -> Self {
        let plane = Plane::across(direction, facet.middle);
        let piece = |corners: &Vec<[f64; 3]>| {
            let vector = area_vector(corners);
            let facing = dot(vector, direction);
            (facing > 0.0).then(|| (plane.polygon(corners), facing))
        };
        let found: Vec<_> = facet.pieces().iter().filter_map(piece).collect();
        let area = found.iter().map(|(_, area)| area).sum();
        let pieces = found.into_iter().map(|(polygon, _)| polygon).collect();
        Projected { facet, direction, inverse: Inverse::of(facet, &plane), plane, pieces, area }
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
        let cell = Cell::new(self.facet.reference(), &self.facet.corners);
        let vector = cell.area_vector(&(self.facet.reference().derivative)(at));
        length(vector) / dot(vector, self.direction)
    }

    /// The reference coordinates of the place that is seen behind a point.
    pub fn foot(&self, at: [f64; 3]) -> Option<[f64; 3]> {
        self.inverse.at(self.plane.point(at))
    }

    /// Calls `visit` for every integration point of the part that `master` covers, if it is within `reach`.
    pub fn for_each_point(&self, master: &Facet, reach: f64, visit: &mut dyn FnMut(SharedPoint)) {
        let inverse = Inverse::of(master, &self.plane);
        let rule = rule(self.inverse.points().max(inverse.points()));
        for piece in master.pieces() {
            let vector = area_vector(&piece);
            if dot(vector, self.direction) >= 0.0 {
                continue;
            }
            // Seen along the direction, the other face runs clockwise.
            let mut other = self.plane.polygon(&piece);
            other.reverse();
            for own in &self.pieces {
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
    fn is_far(&self, polygon: &[Point], master: &Facet, inverse: &Inverse, reach: f64) -> bool {
        let count = polygon.len() as f64;
        let centre = [0, 1].map(|axis| polygon.iter().map(|point| point[axis]).sum::<f64>() / count);
        let height = |facet: &Facet, inverse: &Inverse| {
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
