//! The contact of each obstacle and pair of bodies, in the whole body.

use super::Summary;
use super::summary::{BetweenBodies, ObstacleContact};
use crate::fem::geometry::length;
use crate::scene::{Answer, ContactExtent, Resultant, Segment};

/// A resultant below this share of the sum of its forces is rounding.
const CANCELS: f64 = 1e-10;

/// Adds the contact of each obstacle to the numbers of an answer, whose resultants begin with those of the obstacles.
pub(super) fn contact_on_obstacles(answer: &Answer, segments: &[Segment], summary: &mut Summary) {
    let resultants = summary.resultants.iter().take(answer.model().obstacles().len()).enumerate();
    let found = resultants.map(|(index, resultant)| of_obstacle(answer, index, resultant, segments)).collect();
    summary.contact.obstacles = found;
}

/// The two surfaces of an obstacle that is another body.
fn between(answer: &Answer, index: usize) -> Option<BetweenBodies> {
    let model = answer.model();
    let obstacle = &model.obstacles()[index];
    let (other, covered) = obstacle.other_body()?;
    let seen = model.rows_across().iter().zip(answer.across()).filter(|(row, _)| row.obstacle == index);
    let deepest = seen.fold(0.0, |deepest: f64, (_, [_, gap])| deepest.max(-gap));
    Some(BetweenBodies {
        boundary: obstacle.boundary().into(),
        other: other.into(),
        rows: if covered.is_some() { "mortar" } else { "pairs" },
        covered,
        moment_on_other: model.moment_on_other(index, answer.multiplier()),
        moment_defect: model.moment_defect(index, answer.multiplier()),
        penetration: covered.map(|_| deepest),
    })
}

fn of_obstacle(answer: &Answer, index: usize, resultant: &Resultant, segments: &[Segment]) -> ObstacleContact {
    let model = answer.model();
    let copies = model.copies_of_obstacle(index);
    let parts = model.parts_of_whole() / copies;
    let own = segments.iter().filter(|segment| segment.obstacle == index);
    let rows = || model.rows().iter().enumerate().filter(|(_, row)| row.obstacle == index).map(|(row, _)| row);
    let sum_of_multipliers = rows().fold(0.0, |sum, row| sum - answer.multiplier()[row]) * parts;
    let mut force = [0.0; 3];
    force.iter_mut().zip(&resultant.force).for_each(|(part, of_resultant)| *part = *of_resultant);
    let estimate = ContactExtent::of(own.clone()).map(|extent| extent.of_parts(parts));
    let area = estimate.map_or(0.0, |extent| extent.area);
    ObstacleContact {
        of: resultant.of.clone(),
        on: resultant.on.clone(),
        between: between(answer, index),
        copies: copies as usize,
        count: rows().filter(|&row| answer.contact_set().contains(row)).count(),
        force: if length(force) > CANCELS * sum_of_multipliers { length(force) } else { 0.0 },
        sum_of_multipliers,
        travel: resultant.travel,
        pressure_max: rows().map(|row| answer.pressure()[row]).fold(0.0, f64::max) + 0.0,
        pressure_mean: (area > 0.0).then(|| sum_of_multipliers / area),
        contacts: own.map(|segment| model.contacts_of(index, &segment.nodes)).sum(),
        estimate: estimate.filter(|_| model.mesh().dimension() > 1),
    }
}
