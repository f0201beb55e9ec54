//! Which shapes a model has, and what they are checked for.

use crate::error::Error;
use crate::fem::geometry::{dot, length};
use crate::scene::entry::{finite, number, point, vector, wrong};
use crate::scene::schema::{PlaneSpec, ShapeSpec};

/// Whether a model of `dimension` coordinates has the shape.
pub(super) fn fits(shape: &ShapeSpec, dimension: usize) -> bool {
    match shape {
        ShapeSpec::Plane(_) | ShapeSpec::Body(_) => true,
        ShapeSpec::Parabola(_) | ShapeSpec::Circle(_) | ShapeSpec::Wedge(_) | ShapeSpec::Table(_) => dimension == 2,
        ShapeSpec::Sphere(_) | ShapeSpec::Cylinder(_) | ShapeSpec::Cone(_) | ShapeSpec::HeightMap(_) => dimension == 3,
    }
}

/// The refusal of a shape that does not fit: where it belongs, and what there is instead.
pub(super) fn misfit(shape: &ShapeSpec, path: String, dimension: usize) -> Error {
    let of = if fits(shape, 2) { "the plane" } else { "space" };
    let there = [
        "on a line there are `plane` and `body`",
        "in the plane there are `plane`, `parabola`, `circle`, `wedge`, `table` and `body`",
        "in space there are `plane`, `sphere`, `cylinder`, `cone`, `height-map` and `body`",
    ][dimension - 1];
    wrong(path, format!("`{}` is a shape of {of}; {there}", shape.name()))
}

/// Point and unit normal of a plane in `dimension` coordinates.
pub(super) fn plane_of(
    spec: &PlaneSpec,
    path: &str,
    dimension: usize,
    approach: [f64; 3],
) -> Result<([f64; 3], [f64; 3]), Error> {
    let at = vector(&format!("{path}.point"), &spec.point, dimension)?;
    let normal = vector(&format!("{path}.normal"), &spec.normal, dimension)?;
    let length = length(normal);
    if length == 0.0 {
        let zero = point(&normal[..dimension]);
        return Err(wrong(format!("{path}.normal"), format!("{zero} has no direction; the normal needs a length")));
    }
    let normal = normal.map(|component| component / length);
    let towards = dot(normal, approach);
    if !(towards > 0.0 && towards.is_finite()) {
        let message = format!(
            "{} must point into the obstacle: to the side of the approach direction {}",
            point(&spec.normal),
            point(&approach[..dimension])
        );
        return Err(wrong(format!("{path}.normal"), message));
    }
    Ok((at, normal))
}

pub(super) fn positive(path: String, value: f64) -> Result<f64, Error> {
    finite(path.as_str(), value)?;
    if value > 0.0 {
        Ok(value)
    } else {
        Err(wrong(path, format!("{} is not allowed: it must be positive", number(value))))
    }
}
