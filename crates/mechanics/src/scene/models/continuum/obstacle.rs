//! The obstacles of a contact problem of the continuum.

use std::sync::Arc;

use super::why_not::{WhyNot, none};
use crate::continuum::{Distance, Enclosure, Facing, Point, Pressed, Surface, pairs};
use crate::fem::geometry::{COORDINATES, dot};
use crate::scene::Model;
use crate::scene::input::obstacle::{Between, PlacedObstacle};
use crate::scene::input::schema::Rule;

/// The component of a unit vector normal to a coordinate axis below which it is rounding of the written components.
const ALONG_AXIS: f64 = 1e-14;

/// Normals and heights that differ by less than this, relative to the size of the body, belong to one plane.
const IN_PLANE: f64 = 1e-12;

/// The unit vector; along an axis without the rounding of its other components.
fn along_axis(direction: [f64; 3]) -> [f64; 3] {
    let is_across = |axis: usize| (0..3).all(|other| other == axis || direction[other].abs() <= ALONG_AXIS);
    let axis = (0..3).find(|&axis| is_across(axis));
    axis.map_or(direction, |axis| COORDINATES[axis].map(|part| part * direction[axis].signum()))
}

/// Obstacle number `index` of a model, with rows along one direction.
pub(super) fn facing(model: &Model, index: usize) -> Result<Facing, WhyNot> {
    let (obstacle, path) = (&model.obstacles()[index], format!("obstacles[{index}]"));
    let (shift, approach) = (obstacle.shift(model.gap()), obstacle.approach());
    let rigid = || Shifted { obstacle: obstacle.clone(), gap: shift };
    let changing = || {
        let message = "rows along normals that change along the obstacle have no guaranteed bound: rule `approach` has \
                       one, and a plane";
        none(format!("{path}.rule"), message)
    };
    let body = |normal: Point, between: &Between| {
        if model.mesh().dimension() == 3 {
            return Err(none(&*path, "two bodies in space have no guaranteed bound: only those in the plane have one"));
        }
        let Between { reach, fit, .. } = *between;
        let surface = Surface::Body { reach, fit, shift: shift * dot(normal, approach) };
        Ok((along_axis(normal), surface))
    };
    let (normal, surface): (Point, Surface) = match (obstacle.rule(), obstacle.between()) {
        (Some(Rule::Approach), None) => (along_axis(approach), Surface::Rigid(Arc::new(rigid()))),
        (Some(Rule::Approach), Some(between)) => body(approach, between)?,
        (Some(Rule::ClosestPoint), None) => {
            (along_axis(flat(model, index).ok_or_else(changing)?), Surface::Rigid(Arc::new(Closest(rigid()))))
        }
        (Some(Rule::ClosestPoint), Some(between)) => body(one_normal(model, index).ok_or_else(changing)?, between)?,
        (None, _) => return Err(none(path, "an obstacle without a rule has no guaranteed bound")),
    };
    let pressed = |force| Pressed { force: model.parts.share_of(index, force), cosine: dot(normal, approach) };
    Ok(Facing { normal, surface, pressed: obstacle.force().map(pressed) })
}

/// The normal of all rows of an obstacle, if they have one.
fn one_normal(model: &Model, index: usize) -> Option<Point> {
    let mut rows = model.rows().iter().filter(|row| row.obstacle == index);
    let normal = rows.next()?.normal;
    rows.all(|row| dot(row.normal, normal) > 1.0 - IN_PLANE).then_some(normal)
}

/// The normal of all rows of an obstacle, if they meet it in one plane.
fn flat(model: &Model, index: usize) -> Option<Point> {
    let normal = one_normal(model, index)?;
    let mut heights =
        model.rows().iter().filter(|row| row.obstacle == index).map(|row| dot(model.place(row.node), normal) + row.gap);
    let first = heights.next()?;
    heights.all(|height| (height - first).abs() <= IN_PLANE * model.mesh().size()).then_some(normal)
}

/// An obstacle of the model at its gap.
#[derive(Debug)]
struct Shifted {
    obstacle: PlacedObstacle,
    gap: f64,
}

/// A plane along its normal.
#[derive(Debug)]
struct Closest(Shifted);

impl Distance for Closest {
    fn gap(&self, corners: &[Point]) -> Option<Enclosure> {
        let Closest(Shifted { obstacle, gap }) = self;
        let of_corner = |&corner: &Point| obstacle.rigid()?.shifted_row(corner, *gap).ok()?.map(|row| row.gap);
        let of_corners = corners.iter().map(of_corner).collect::<Option<Vec<f64>>>()?;
        let coefficients = pairs(corners.len()).map(|[i, j]| (of_corners[i] + of_corners[j]) / 2.0).collect();
        Some(Enclosure { coefficients, below: 0.0, above: 0.0 })
    }
}

impl Distance for Shifted {
    fn gap(&self, corners: &[Point]) -> Option<Enclosure> {
        let rigid = self.obstacle.rigid()?;
        match *corners {
            [from, to] => {
                let ([first, middle, last], [below, above]) = rigid.gap_along(from, to, self.gap)?;
                let coefficients = vec![first, last, 2.0 * middle - (first + last) / 2.0];
                Some(Enclosure { coefficients, below, above })
            }
            [first, second, third] => {
                let (coefficients, [below, above]) = rigid.gap_over([first, second, third], self.gap)?;
                Some(Enclosure { coefficients: coefficients.to_vec(), below, above })
            }
            _ => None,
        }
    }
}
