//! Vectors in space, `[x, y, z]`, with z = 0 in the plane; symmetric tensors; edges, and the cells around points.

/// The unit vectors along x, y and z.
pub const COORDINATES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The vector of this length, or against the axis if it is negative, along an axis.
pub fn along_axis(axis: usize, length: f64) -> [f64; 3] {
    let mut vector = [0.0; 3];
    vector[axis] = length;
    vector
}

/// The scalar product.
#[inline]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product of two vectors `[x, y, z]`, in the product of their units: normal to both, and right-handed with
/// them.
#[inline]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The vector `[x, y, z]` from the end of b to the end of a, if both begin in one point: their difference, in their
/// unit.
#[inline]
pub fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The sum of two vectors.
#[inline]
pub fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The point at this share of a way from another point.
#[inline]
pub fn shifted(from: [f64; 3], share: f64, way: [f64; 3]) -> [f64; 3] {
    [from[0] + share * way[0], from[1] + share * way[1], from[2] + share * way[2]]
}

/// The middle of two points.
#[inline]
pub fn midpoint(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0, (a[2] + b[2]) / 2.0]
}

/// The Euclidean norm of a vector `[x, y, z]`, in its unit: how far its end lies from its beginning.
#[inline]
pub fn length(vector: [f64; 3]) -> f64 {
    vector[0].hypot(vector[1]).hypot(vector[2])
}

/// The distance of two points.
#[inline]
pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(minus(a, b))
}

/// The vector scaled to length 1; zero stays zero.
#[inline]
pub fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = length(vector);
    if length > 0.0 { vector.map(|component| component / length) } else { vector }
}

/// A unit vector at right angles to a unit vector.
pub fn across(vector: [f64; 3]) -> [f64; 3] {
    let smallest = (0..3).min_by(|&a, &b| vector[a].abs().total_cmp(&vector[b].abs())).unwrap_or(0);
    unit(cross(vector, COORDINATES[smallest]))
}

/// A symmetric tensor `[xx, yy, zz, xy, yz, zx]`, dimensionless for strains, in force per area for stresses; in a body
/// of revolution zz is the hoop component.
///
/// Strains have the tensor's shear components, half of the engineering shear strains.
pub type Symmetric = [f64; 6];

/// The dilatation of a strain.
#[inline]
pub fn trace(strain: &Symmetric) -> f64 {
    strain[0] + strain[1] + strain[2]
}

/// The components of a symmetric tensor along other axes, of unit length and at right angles.
pub fn turned([xx, yy, zz, xy, yz, zx]: Symmetric, axes: &[[f64; 3]; 3]) -> Symmetric {
    let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let along = |a: usize, b: usize| dot(axes[a], rows.map(|row| dot(row, axes[b])));
    [along(0, 0), along(1, 1), along(2, 2), along(0, 1), along(1, 2), along(2, 0)]
}

/// The moments of inertia of a unit mass about the coordinate axes through the end of its arm: `r.r I - r r'`.
pub fn inertia([x, y, z]: [f64; 3]) -> Symmetric {
    [y * y + z * z, z * z + x * x, x * x + y * y, -x * y, -y * z, -z * x]
}

/// Most sweeps over the three pairs of axes; four reach rounding.
const MOST_SWEEPS: usize = 20;

/// The principal values of a symmetric tensor, decreasing, each with its axis, a unit vector; `None` if a component is
/// not finite.
pub fn principal(tensor: &Symmetric) -> Option<[(f64, [f64; 3]); 3]> {
    let [xx, yy, zz, xy, yz, zx] = *tensor;
    // The shear of each axis is that between the other two.
    let (mut values, mut shears, mut axes) = ([xx, yy, zz], [yz, zx, xy], COORDINATES);
    let largest = tensor.iter().fold(0.0, |largest: f64, component| largest.max(component.abs()));
    if !tensor.iter().all(|component| component.is_finite()) {
        return None;
    }
    for _ in 0..MOST_SWEEPS {
        if shears.iter().all(|shear| shear.abs() <= f64::EPSILON / 4.0 * largest) {
            break;
        }
        for axis in 0..3 {
            let (first, second, shear) = ((axis + 1) % 3, (axis + 2) % 3, shears[axis]);
            if shear != 0.0 {
                let (cosine, sine) = rotation(values[first], values[second], shear);
                let turn = |x: f64, y: f64| (cosine * x - sine * y, sine * x + cosine * y);
                values[first] -= sine / cosine * shear;
                values[second] += sine / cosine * shear;
                (shears[second], shears[first]) = turn(shears[second], shears[first]);
                shears[axis] = 0.0;
                let [one, other] = [axes[first], axes[second]];
                (0..3).for_each(|k| (axes[first][k], axes[second][k]) = turn(one[k], other[k]));
            }
        }
    }
    let mut principal = [0, 1, 2].map(|axis| (values[axis], axes[axis]));
    principal.sort_by(|a, b| b.0.total_cmp(&a.0));
    Some(principal)
}

/// Cosine c and sine s of the rotation that makes `[[a, both], [both, b]]` diagonal: (x, y) becomes (c x - s y, s x + c
/// y).
///
/// # Source
/// G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th edition (2013), section 8.5: the smaller of the two angles.
pub fn rotation(a: f64, b: f64, both: f64) -> (f64, f64) {
    let cotangent = (b - a) / (2.0 * both);
    let tangent = 1.0_f64.copysign(cotangent) / (cotangent.abs() + (1.0 + cotangent * cotangent).sqrt());
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    (cosine, tangent * cosine)
}

/// The value at `t` of straight lines between points `(t, value)`, t increasing; constant before the first and after
/// the last, 1 without points.
pub fn between(points: &[(f64, f64)], t: f64) -> f64 {
    let after = points.partition_point(|&(at, _)| at <= t);
    match (after.checked_sub(1).and_then(|before| points.get(before)), points.get(after)) {
        (Some(&(from, first)), Some(&(to, last))) => first + (last - first) * (t - from) / (to - from),
        (Some(&(_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => 1.0,
    }
}

/// Nodes in increasing order: the same for a face of any orientation.
pub fn sorted(nodes: impl IntoIterator<Item = usize>) -> Vec<usize> {
    let mut nodes: Vec<usize> = nodes.into_iter().collect();
    nodes.sort_unstable();
    nodes
}

/// The key of an edge: its two nodes, increasing.
#[inline]
pub fn key(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// The cells around every point, by one counting sort.
#[derive(Debug, Default)]
pub struct Around {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Along its principal axes a tensor is diagonal, whatever its size; equal values and zero included.
    #[test]
    fn a_tensor_along_its_principal_axes_has_its_principal_values_and_no_shear() {
        let tensors = [
            [3.0, -1.0, 2.0, 0.5, -4.0, 1.0],
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            [2.0, 2.0, 2.0, 0.0, 0.0, 0.0],
            [1e8, 1.0, -1.0, 1e-3, 1e4, 1e-9],
            [1.0, 1.0 + 1e-15, 1.0, 1e-16, 1e-12, 0.0],
            [0.0; 6],
        ];
        for scale in [1.0, 2.0_f64.powi(500), 2.0_f64.powi(-500)] {
            for tensor in tensors.map(|tensor| tensor.map(|component| scale * component)) {
                let principal = principal(&tensor).unwrap();
                let rounding = 1e-15 * tensor.iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
                let [xx, yy, zz, rest @ ..] = turned(tensor, &principal.map(|entry| entry.1));
                let values = principal.map(|entry| entry.0);
                let off = [xx - values[0], yy - values[1], zz - values[2], rest[0], rest[1], rest[2]];
                assert!(off.iter().all(|off| off.abs() <= 4.0 * rounding), "{tensor:?} {principal:?}");
                assert!(values.is_sorted_by(|a, b| a >= b), "{values:?}");
            }
        }
        assert_eq!(principal(&[0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0]), None);
        assert_eq!(principal(&[0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]), None);
    }
}
