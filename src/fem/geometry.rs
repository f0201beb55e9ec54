//! Vectors in space, `[x, y, z]`, with z = 0 in the plane; symmetric tensors.

/// The scalar product.
#[inline]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
#[inline]
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a - b`.
pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The length of a vector.
pub(crate) fn length(vector: [f64; 3]) -> f64 {
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

/// A symmetric tensor `[xx, yy, zz, xy, yz, zx]`; in a body of revolution zz is the hoop component.
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
