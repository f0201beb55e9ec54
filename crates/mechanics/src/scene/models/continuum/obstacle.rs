//! The obstacles of a contact problem of the continuum.

use std::sync::Arc;

use super::{WhyNot, none};
use crate::continuum::{Distance, Enclosure, Facing, Point};
use crate::fem::geometry::COORDINATES;
use crate::scene::Model;
use crate::scene::input::obstacle::PlacedObstacle;
use crate::scene::input::schema::Rule;

/// The component of a unit vector normal to a coordinate axis below which it is rounding of the written components.
const ALONG_AXIS: f64 = 1e-14;

/// The unit vector; along an axis without the rounding of its other components.
fn along_axis(direction: [f64; 3]) -> [f64; 3] {
    let is_across = |axis: usize| (0..3).all(|other| other == axis || direction[other].abs() <= ALONG_AXIS);
    let axis = (0..3).find(|&axis| is_across(axis));
    axis.map_or(direction, |axis| COORDINATES[axis].map(|part| part * direction[axis].signum()))
}

/// Obstacle number `index` of a model, with rows along one direction.
pub(super) fn facing(model: &Model, index: usize) -> Result<Facing, WhyNot> {
    let (obstacle, path) = (&model.obstacles()[index], format!("obstacles[{index}]"));
    match obstacle.rule() {
        Some(Rule::Approach) if obstacle.rigid().is_some() => {
            let surface = Shifted { obstacle: obstacle.clone(), gap: obstacle.shift(model.gap()) };
            let normal = along_axis(obstacle.approach());
            let force = obstacle.force().map(|force| model.parts.share_of(index, force));
            Ok(Facing { normal, surface: Arc::new(surface), force })
        }
        Some(Rule::ClosestPoint) => Err(none(
            format!("{path}.rule"),
            "rows along the normals of an obstacle have no guaranteed bound: rule `approach` has one",
        )),
        _ => Err(none(path, "only the rigid obstacles of a scene have a guaranteed bound")),
    }
}

/// An obstacle of the model at its gap.
#[derive(Debug)]
struct Shifted {
    obstacle: PlacedObstacle,
    gap: f64,
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
