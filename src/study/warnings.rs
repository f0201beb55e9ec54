//! What may mislead in an answer, with its numbers: warnings, and the refusal of a scene that asks for something else than was meant.

use serde::Serialize;

use crate::error::Error;
use crate::fem::assembly::node_normals;
use crate::fem::body::{BodyElement, ElasticBody};
use crate::fem::geometry::dot;
use crate::scene::{Answer, Model, refused};
use crate::solution::{Certificate, Solution};

/// Strains above this are beyond small strains, for which the equations hold.
const LARGE_STRAIN: f64 = 0.1;

/// Forces of a row below this share of the largest are rounding.
const NO_FORCE: f64 = 1e-9;

/// A direction may lean on the wrong side of a surface by this sine: rounding of the geometry.
const SIDEWAYS: f64 = 1e-9;

/// Something about an answer that its reader should know, certified or not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AnswerWarning {
    /// The name of the kind of warning, the same in every version.
    pub code: &'static str,
    /// What it is, with numbers, its likely cause, and what helps.
    pub message: String,
}

/// That the entries of the stiffness determine few digits of the answer, however good its certificate.
pub(super) fn lost_digits(solution: &Solution) -> Option<AnswerWarning> {
    let (digits, pivot) = (solution.digits_of_stiffness()?, solution.lost_pivot?);
    let digits = match digits {
        0 => "hardly a digit".to_string(),
        1 => "only about 1 digit".to_string(),
        digits => format!("only about {digits} digits"),
    };
    let message = format!(
        "the entries of the stiffness are rounded to double precision, and determine {digits} of the displacement \
         (smallest pivot {pivot:.0e} of the diagonal); the certificate takes them as exact. Likely causes: bending of \
         slender bodies (take fewer elements along the thickness, quadratic elements, or a beam), or contrast of \
         stiff parts on soft ones"
    );
    Some(AnswerWarning { code: "lost-digits", message })
}

/// That multipliers have the sign of rows that pull.
pub(super) fn opposite_sign(certificate: &Certificate, multiplier: &[f64], tolerance: f64) -> Option<AnswerWarning> {
    let count = |sign: f64| multiplier.iter().filter(|&&lambda| sign * lambda > 0.0).count();
    let (pulling, pushing) = (count(1.0), count(-1.0));
    if certificate.adhesion <= tolerance || pulling <= pushing {
        return None;
    }
    let message = format!(
        "{pulling} of {} multipliers that are not zero are positive: with K u = f + B' lambda a row that pushes has lambda <= 0. \
         If your convention is K u + B' lambda = f with lambda >= 0, change the sign of lambda",
        pulling + pushing
    );
    Some(AnswerWarning { code: "opposite-sign", message })
}

/// What may mislead in an answer to a scene.
pub(super) fn of_scene(answer: &Answer, solution: &Solution) -> Vec<AnswerWarning> {
    let warnings = [nothing_touches(answer.model(), solution), large_strain(answer)];
    warnings.into_iter().flatten().collect()
}

/// That no row is closed and none carries a force, with the nearest one.
fn nothing_touches(model: &Model, solution: &Solution) -> Option<AnswerWarning> {
    if solution.contact_set.count() > 0 || solution.multiplier.iter().any(|&lambda| lambda != 0.0) {
        return None;
    }
    let left = model.problem().violation(&solution.displacement).into_iter().map(|violation| -violation);
    let nearest = left.enumerate().filter(|(_, gap)| gap.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1));
    let message = match nearest {
        Some((row, gap)) => {
            let (node, unit) = (model.rows()[row].node, &model.units().length);
            let gap =
                if gap < 1e-3 { format!("{gap:.1e}") } else { format!("{gap:.4}").trim_end_matches('0').to_string() };
            format!("nothing touches; the smallest remaining gap is {gap} {unit} at node {node}").replace("  ", " ")
        }
        None if model.obstacles().is_empty() => "nothing touches: the scene has no obstacle".to_string(),
        None => "nothing touches: no obstacle faces a node of its boundary".to_string(),
    };
    Some(AnswerWarning { code: "nothing-touches", message })
}

/// That strains are too large for the equations of small strains.
fn large_strain(answer: &Answer) -> Option<AnswerWarning> {
    let body = answer.model().body();
    let (element, strain) = largest_strain(body, answer.displacement())?;
    if strain <= LARGE_STRAIN {
        return None;
    }
    let message = format!(
        "the largest strain is {:.0} %, in element {element}: the equations hold for small strains, below about {:.0} %. Check the \
         gap, the loads and their units; bodies that overlap at the start are strained by that",
        100.0 * strain,
        100.0 * LARGE_STRAIN
    );
    Some(AnswerWarning { code: "large-strain", message })
}

/// The largest component of a strain at the centre of an element, by magnitude, and that element.
fn largest_strain(body: &ElasticBody, displacement: &[f64]) -> Option<(usize, f64)> {
    let table = body.tabulated();
    let of_element = |BodyElement { nodes, cell, .. }: BodyElement| {
        let strain = body.point(&cell, &table.centroid).strain(&body.gather(displacement, nodes), cell.unit());
        strain.iter().fold(0.0, |largest: f64, component| largest.max(component.abs()))
    };
    body.elements().map(of_element).enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Refuses an answer whose obstacles pull: at a row that carries force the direction into the obstacle points into the body.
///
/// # Errors
/// [`Error::Refused`] with the code `approach-away`.
pub(super) fn check_approach(model: &Model, multiplier: &[f64]) -> Result<(), Error> {
    let largest = multiplier.iter().fold(0.0, |largest: f64, lambda| largest.max(-lambda));
    let mesh = model.mesh();
    for (index, obstacle) in model.obstacles().iter().enumerate() {
        let Some(boundary) = mesh.boundary(obstacle.boundary()) else { continue };
        let mut outward = vec![[0.0; 3]; mesh.nodes().len()];
        node_normals(model.body(), boundary).into_iter().for_each(|(node, normal)| outward[node] = normal);
        let pulls = |(row, lambda): (usize, &f64)| {
            let row = &model.rows()[row];
            let lean = dot(row.normal, outward[row.node]);
            (row.obstacle == index && -lambda > NO_FORCE * largest && lean < -SIDEWAYS).then_some((row.node, lean))
        };
        let worst = multiplier.iter().enumerate().filter_map(pulls).min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((node, lean)) = worst {
            let angle = lean.clamp(-1.0, 1.0).acos().to_degrees();
            let message = format!(
                "the obstacle pulls the body: at node {node} the direction into the obstacle and the outward normal of `{}` \
                 make an angle of {angle:.0} degrees, and the node carries force; turn `approach` around, or name the boundary that \
                 faces the obstacle",
                obstacle.boundary()
            );
            return Err(refused("approach-away", format!("obstacles[{index}].approach"), message));
        }
    }
    Ok(())
}
