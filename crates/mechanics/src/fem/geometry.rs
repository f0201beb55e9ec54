//! Vectors in space, `[x, y, z]`, with z = 0 in the plane; symmetric tensors; edges, and the cells around points.

/// The unit vectors along x, y and z.
pub(crate) const COORDINATES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The vector of this length, or against the axis if it is negative, along an axis.
pub(crate) fn along_axis(axis: usize, length: f64) -> [f64; 3] {
    let mut vector = [0.0; 3];
    vector[axis] = length;
    vector
}

/// The scalar product.
#[inline]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product of two vectors `[x, y, z]`, in the product of their units: normal to both, and right-handed with them.
#[inline]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The vector `[x, y, z]` from the end of b to the end of a, if both begin in one point: their difference, in their unit.
pub fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The Euclidean norm of a vector `[x, y, z]`, in its unit: how far its end lies from its beginning.
pub fn length(vector: [f64; 3]) -> f64 {
    vector[0].hypot(vector[1]).hypot(vector[2])
}

/// The distance of two points.
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(minus(a, b))
}

/// The vector scaled to length 1; zero stays zero.
pub(crate) fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = length(vector);
    if length > 0.0 { vector.map(|component| component / length) } else { vector }
}

/// A unit vector at right angles to a unit vector.
pub(crate) fn across(vector: [f64; 3]) -> [f64; 3] {
    let smallest = (0..3).min_by(|&a, &b| vector[a].abs().total_cmp(&vector[b].abs())).unwrap_or(0);
    unit(cross(vector, COORDINATES[smallest]))
}

/// A symmetric tensor `[xx, yy, zz, xy, yz, zx]`, dimensionless for strains, in force per area for stresses; in a body of revolution zz is the hoop component.
///
/// Strains have the tensor's shear components, half of the engineering shear strains.
pub type Symmetric = [f64; 6];

/// The dilatation of a strain.
#[inline]
pub(crate) fn trace(strain: &Symmetric) -> f64 {
    strain[0] + strain[1] + strain[2]
}

/// The components of a symmetric tensor along other axes, of unit length and at right angles.
pub(crate) fn turned([xx, yy, zz, xy, yz, zx]: Symmetric, axes: &[[f64; 3]; 3]) -> Symmetric {
    let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let along = |a: usize, b: usize| dot(axes[a], rows.map(|row| dot(row, axes[b])));
    [along(0, 0), along(1, 1), along(2, 2), along(0, 1), along(1, 2), along(2, 0)]
}

/// The key of an edge: its two nodes, increasing.
pub(crate) fn key(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// The cells around every point, by one counting sort.
#[derive(Debug)]
pub(crate) struct Around {
    starts: Vec<u32>,
    cells: Vec<u32>,
}

impl Around {
    /// From the points of each cell, in the order of the cells: less than 2^32 in all.
    pub fn new<C: IntoIterator<Item = usize>>(points: usize, cells: impl Iterator<Item = C> + Clone) -> Self {
        let mut starts = vec![0_u32; points + 1];
        cells.clone().flatten().for_each(|point| starts[point + 1] += 1);
        for point in 0..points {
            starts[point + 1] += starts[point];
        }
        let mut around = vec![0; starts[points] as usize];
        // Each start moves to its end while its list is filled, and ends up as the start of the next point.
        for (index, cell) in cells.enumerate() {
            for point in cell {
                around[starts[point] as usize] = index as u32;
                starts[point] += 1;
            }
        }
        starts.rotate_right(1);
        starts[0] = 0;
        Around { starts, cells: around }
    }

    /// The cells around a point, increasing.
    pub fn at(&self, point: usize) -> &[u32] {
        &self.cells[self.starts[point] as usize..self.starts[point + 1] as usize]
    }
}
