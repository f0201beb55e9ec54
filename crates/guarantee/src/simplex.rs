//! A triangle in the plane or a tetrahedron in space, by its corners. The order of the corners does
//! not matter: sizes are positive.

use signorini_fem::geometry::{Symmetric, cross, distance, dot, key, length, minus};

/// Coordinates or components `[x, y, z]`; in the plane z is zero.
pub type Point = [f64; 3];

/// Symmetric tensors `[xx, yy, zz, xy, yz, zx]`; in the plane those with z are zero.
pub type Tensor = Symmetric;

/// The entries of a tensor that exist, in the plane and in space.
pub const ENTRIES: [&[usize]; 2] = [&[0, 1, 3], &[0, 1, 2, 3, 4, 5]];

/// Corners of a tetrahedron, the larger simplex.
pub const MOST_CORNERS: usize = 4;

/// Barycentric coordinates.
pub type Weights = [f64; MOST_CORNERS];

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simplex {
    /// Number of coordinates of the corners, 2 or 3.
    pub dimension: usize,
    corners: [Point; MOST_CORNERS],
}

/// The pairs of `count` numbers: first each with itself, then `i < j`. They number the functions of Bernstein's
/// quadratic basis on a simplex of `count` corners.
pub fn pairs(count: usize) -> impl Iterator<Item = [usize; 2]> + Clone {
    (0..count).map(|i| [i, i]).chain((0..count).flat_map(move |i| (i + 1..count).map(move |j| [i, j])))
}

/// The corners of the side opposite to a corner, in their order.
pub fn corners_of_side(dimension: usize, side: usize) -> impl Iterator<Item = usize> + Clone {
    (0..=dimension).filter(move |&corner| corner != side)
}

/// The number among these of the pair of two numbers.
pub fn number_of_pair(count: usize, one: usize, other: usize) -> usize {
    pairs(count).position(|pair| pair == key(one, other)).unwrap_or(0)
}

/// The barycentric coordinates of the centre.
pub fn weights_of_centre(dimension: usize) -> Weights {
    std::array::from_fn(|corner| if corner <= dimension { 1.0 / (dimension + 1) as f64 } else { 0.0 })
}

/// The length of an edge, or the area of a triangle in space.
pub fn size_of_facet(corners: &[Point]) -> f64 {
    match *corners {
        [a, b] => distance(a, b),
        [a, b, c] => length(cross(minus(b, a), minus(c, a))) / 2.0,
        _ => 0.0,
    }
}

impl Simplex {
    pub fn new(dimension: usize, of_corners: impl IntoIterator<Item = Point>) -> Self {
        let mut corners = [[0.0; 3]; MOST_CORNERS];
        corners.iter_mut().zip(of_corners).for_each(|(corner, at)| *corner = at);
        Simplex { dimension, corners }
    }

    pub fn corners(&self) -> &[Point] {
        &self.corners[..=self.dimension]
    }

    /// The edges from the first corner; in the plane the third one is the unit vector along z.
    pub fn edges(&self) -> [Point; 3] {
        let [a, b, c, d] = self.corners;
        [minus(b, a), minus(c, a), if self.dimension == 2 { [0.0, 0.0, 1.0] } else { minus(d, a) }]
    }

    /// The determinant of the edges.
    fn determinant(&self) -> f64 {
        let [first, second, third] = self.edges();
        dot(first, cross(second, third))
    }

    /// Area or volume; negative if the corners stand in the other order.
    pub fn oriented_size(&self) -> f64 {
        self.determinant() / if self.dimension == 2 { 2.0 } else { 6.0 }
    }

    /// Area or volume.
    pub fn size(&self) -> f64 {
        self.oriented_size().abs()
    }

    /// The gradients of the barycentric coordinates.
    pub fn slopes(&self) -> [Point; MOST_CORNERS] {
        let ([first, second, third], determinant) = (self.edges(), self.determinant());
        let mut slopes = [[0.0; 3]; MOST_CORNERS];
        let others = [cross(second, third), cross(third, first), cross(first, second)];
        for (corner, normal) in (1..=self.dimension).zip(others) {
            slopes[corner] = normal.map(|part| part / determinant);
            slopes[0] = minus(slopes[0], slopes[corner]);
        }
        slopes
    }

    /// The outward unit normal of the side opposite to a corner, and the length or area of the side.
    pub fn outward(&self, corner: usize) -> (Point, f64) {
        let slope = self.slopes()[corner];
        let steepness = length(slope);
        (slope.map(|part| -part / steepness), self.dimension as f64 * self.size() * steepness)
    }

    pub fn centre(&self) -> Point {
        let count = self.corners().len() as f64;
        [0, 1, 2].map(|axis| self.corners().iter().map(|corner| corner[axis]).sum::<f64>() / count)
    }

    /// Part k: the simplex with the centre in the place of corner k, next to the side opposite to that corner.
    pub fn part(&self, k: usize) -> Simplex {
        let mut part = *self;
        part.corners[k] = self.centre();
        part
    }

    /// The barycentric coordinates in the simplex of a point of part k.
    pub fn in_whole(&self, k: usize, weights: Weights) -> Weights {
        let share = weights[k] / self.corners().len() as f64;
        let of_corner = |corner: usize| match corner {
            _ if corner > self.dimension => 0.0,
            _ if corner == k => share,
            _ => weights[corner] + share,
        };
        std::array::from_fn(of_corner)
    }

    /// The point with these barycentric coordinates.
    pub fn at(&self, weights: Weights) -> Point {
        mixed(&self.corners, &weights)
    }

    /// A stress on the simplex of the origin and the unit vectors, carried to this one: the map of Piola, which
    /// preserves balance and tractions.
    pub fn carried(&self, [xx, yy, zz, xy, yz, zx]: Tensor) -> Tensor {
        let (edges, size) = (self.edges(), self.determinant().abs());
        let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
        let along = |axis: usize| edges.map(|edge| edge[axis]);
        let entry = |i: usize, j: usize| dot(along(i), rows.map(|row| dot(row, along(j)))) / size;
        [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)]
    }
}

/// The sum of points times their weights.
pub fn mixed(points: &[Point], weights: &[f64]) -> Point {
    [0, 1, 2].map(|axis| points.iter().zip(weights).map(|(point, weight)| weight * point[axis]).sum())
}

/// The traction of a stress on a surface with this normal.
pub fn traction([xx, yy, zz, xy, yz, zx]: Tensor, normal: Point) -> Point {
    [dot([xx, xy, zx], normal), dot([xy, yy, yz], normal), dot([zx, yz, zz], normal)]
}

pub fn work(stress: Tensor, strain: Tensor) -> f64 {
    let product = |entry: usize| stress[entry] * strain[entry];
    product(0) + product(1) + product(2) + 2.0 * (product(3) + product(4) + product(5))
}

pub fn less(a: Tensor, b: Tensor) -> Tensor {
    std::array::from_fn(|entry| a[entry] - b[entry])
}

pub fn middle(a: Tensor, b: Tensor) -> Tensor {
    std::array::from_fn(|entry| (a[entry] + b[entry]) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::super::bodies::any_simplex;
    use super::*;
    use signorini_fem::geometry::shifted;

    #[test]
    fn normals_point_outwards_and_close_the_surface_and_parts_fill_the_simplex() {
        for simplex in [2, 3].map(any_simplex) {
            let count = simplex.dimension + 1;
            let mut sum = [0.0; 3];
            for corner in 0..count {
                let (normal, size) = simplex.outward(corner);
                let on_side = simplex.corners()[(corner + 1) % count];
                assert!(dot(normal, minus(simplex.corners()[corner], on_side)) < 0.0);
                sum = shifted(sum, size, normal);
                assert!((simplex.part(corner).size() * count as f64 / simplex.size() - 1.0).abs() < 1e-14);
                let weights = [0.1, 0.2, 0.3, 0.4].map(|weight| if count == 3 { weight / 0.6 } else { weight });
                let weights = if count == 3 { [weights[0], weights[1], weights[2], 0.0] } else { weights };
                let [one, other] = [simplex.part(corner).at(weights), simplex.at(simplex.in_whole(corner, weights))];
                assert!(length(minus(one, other)) < 1e-14, "{one:?} {other:?}");
            }
            assert!(length(sum) < 1e-14, "{sum:?}");
        }
    }
}
