//! Warnings about an answer, with their numbers, and the refusal of a scene that poses another problem than was meant.

use std::collections::BTreeMap;

use signorini_deck::NONLINEAR;
use signorini_fem::geometry::{along_axis, dot, plus};
use signorini_mechanics::Error;
use signorini_mechanics::scene::answers::deformation;
use signorini_mechanics::scene::models::build::{node_in_words, place_in_words};
use signorini_mechanics::scene::models::overlap::{Overlap, deepest_overlap};
use signorini_mechanics::scene::models::parts::Origin;
use signorini_mechanics::scene::models::resultants::{at_node, moment_defect};
use signorini_mechanics::scene::models::rigid_body_modes::RigidBodyModes;
use signorini_mechanics::scene::models::rigid_body_modes::soft::SoftMotion;
use signorini_mechanics::scene::{Answer, ContactRow, Model, Resultant, Rule, Segment, Warning, refused};
use signorini_qp::{Certificate, ContactProblem, Solution, largest};

/// Overlaps below this share of the size of the mesh are rounding of coordinates.
const ROUNDING_OF_PLACES: f64 = 1e-12;

/// Strains above this are no longer small, as the equations assume.
const LARGE_STRAIN: f64 = 0.1;

/// Code of the warning about an answer that small displacements do not describe.
pub(super) const BEYOND: &str = "beyond-small-displacements";

/// Strains or rotations above this change the answer to a deck with large displacements by some percent.
const LARGE_DEFORMATION: f64 = 0.05;

/// Forces of a row below this share of the largest force of its obstacle are rounding.
const NO_FORCE: f64 = 1e-9;

/// Forces of a row below this share of the largest force of all obstacles are rounding of the solve.
const ROUNDING: f64 = 1e-13;

/// A direction may point to the wrong side of a surface by this sine: rounding of the geometry.
const SIDEWAYS: f64 = 1e-9;

/// If the normal of a surface is more than this many degrees off the direction of its rows, the force differs: the
/// cosine is 1.5 % off.
const LEANING: f64 = 10.0;

/// A force of a support above this share of the largest counts as a force.
const FELT: f64 = 1e-6;

/// A boundary that faces away from its obstacle by more than the angle of this cosine, 60 degrees, is probably not the
/// intended one.
const ASIDE: f64 = 0.5;

/// Allowed depth of a body in an obstacle between its nodes, as a share of the displacement that contact imposes: with
/// two cells in each half of a smooth contact it is a sixteenth.
const BETWEEN: f64 = 0.25;

/// A displacement below this share of the largest is rounding: far above that of doubles.
const ROUNDED: f64 = 1e-9;

/// A motion that is softly held is visible above this share of the largest displacement.
const VISIBLE: f64 = 0.1;

/// A moment that contact forces have on both bodies together counts above this share of force times length.
const TURNING: f64 = 1e-3;

/// Offset beside a corner of a surface, in units of the size of the mesh: above rounding, below every cell.
const BESIDE: f64 = 1e-6;

/// A contact with at most this many nodes has no visible shape.
pub(super) const FEW_NODES: usize = 2;

/// A peak depends on the mesh if its uncertainty, relative to the peak, is larger than this.
const UNCERTAIN: f64 = 0.5;

/// Codes of the warnings that a finer mesh settles.
const OF_MESH: [&str; 3] = ["nothing-touches", "mesh-dependent", "between-nodes"];

/// Warns that the entries of the stiffness determine few digits of the answer, even with a good certificate.
pub(super) fn lost_digits(solution: &Solution) -> Option<Warning> {
    let (digits, pivot) = (solution.digits_of_stiffness()?, solution.lost_pivot()?);
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
    Some(Warning { code: "lost-digits", message })
}

/// Warns that multipliers have the sign of rows that pull.
pub(super) fn opposite_sign(certificate: &Certificate, multiplier: &[f64], tolerance: f64) -> Option<Warning> {
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
    Some(Warning { code: "opposite-sign", message })
}

pub(super) fn of_scene(answer: &Answer, solution: &Solution, segments: &[Segment]) -> Vec<Warning> {
    let model = answer.model();
    let of_model = model.warnings().iter().map(|warning| of_model(answer, warning));
    let of_answer = [
        nothing_touches(model, solution),
        large_strain(answer),
        leaning_normals(answer),
        across_approach(answer),
        mesh_dependent(model, segments),
        between_nodes(answer),
        overlap(answer),
        unbalanced_moment(answer),
    ];
    of_model.chain(of_answer.into_iter().flatten()).chain(softly_held(answer)).collect()
}

/// Warns of means between curved surfaces whose forces turn both bodies together.
fn unbalanced_moment(answer: &Answer) -> Option<Warning> {
    let model = answer.model();
    let defect = |index: usize| Some((index, moment_defect(model, index, answer.multiplier())?));
    let defects = (0..model.obstacles().len()).filter_map(defect);
    let (index, defect) = defects.max_by(|one, other| one.1.total_cmp(&other.1))?;
    let message = format!(
        "the contact forces of obstacles[{index}] on both bodies have a moment of {defect:.1e} of their sum times the size of the mesh: \
         means over curved surfaces miss it. Refine both surfaces and compare the moments"
    );
    (defect > TURNING).then_some(Warning { code: "moment-defect", message })
}

/// Warns of rigid motions of bodies that contact without friction hardly resists and no force drives: they follow the
/// rounding of the mesh, or the moment of loads.
fn softly_held(answer: &Answer) -> Vec<Warning> {
    let (model, displacement) = (answer.model(), answer.displacement());
    let of_row = |row: usize| Some((model.rows().get(row)?, *answer.multiplier().get(row)?));
    let closed: Vec<(&ContactRow, f64)> = answer.contact_set().iter().filter_map(of_row).collect();
    let largest = largest(displacement);
    let soft = RigidBodyModes::of_parts(&model.parts).soft_motions(&model.parts, &closed, displacement);
    let visible = soft.unwrap_or_default().into_iter().filter(|soft| soft.moved > VISIBLE * largest);
    let warning = |SoftMotion { name, moved, advice, is_driven }| {
        let (drive, follows) = match is_driven {
            true => ("under the loads", "so that its size depends on the rounding of the mesh"),
            false => ("and no force drives it", "so that it follows the rounding of the mesh"),
        };
        let amount = format!("{moved:.3e} {}", model.units().length);
        let message = format!(
            "softly held: the {name} moves nodes by {}, {:.0} % of the largest displacement, {drive}; {advice}. The \
             contact rows hardly resist it, {follows}",
            amount.trim_end(),
            100.0 * moved / largest
        );
        Warning { code: "softly-held", message }
    };
    visible.map(warning).collect()
}

/// Warns that two displaced bodies go through each other, with what helps.
fn overlap(answer: &Answer) -> Option<Warning> {
    let model = answer.model();
    let Overlap { node, depth, bodies, has_rows } = deepest_overlap(model, answer.displacement(), answer.unknowns())?;
    let name = |body: usize| match model.body().regions()[body].name() {
        "" => "body",
        name => name,
    };
    let help = match model.parts.origin() {
        _ if has_rows => "between contact rows, which do not keep every point apart: make the elements smaller there",
        Origin::Deck => "where no contact row keeps them apart; name both surfaces in a `*CONTACT PAIR`",
        Origin::WithAuto => {
            "where no contact row keeps them apart, and `\"contact\": \"auto\"` finds none; name both boundaries in an obstacle"
        }
        Origin::Scene => {
            "where no contact row keeps them apart; name both boundaries in an obstacle, or set `\"contact\": \"auto\"`"
        }
    };
    let message = format!(
        "`{}` and `{}` go through each other, by {depth:.3e} {} at {}, {help}",
        name(bodies[0]),
        name(bodies[1]),
        model.units().length,
        node_in_words(model, node)
    );
    Some(Warning { code: "bodies-overlap", message: message.replace("  ", " ") })
}

/// The warnings about an answer on a first mesh that is refined further.
pub(super) fn of_refined(answer: &Answer, solution: &Solution) -> Result<Vec<Warning>, Error> {
    check_approach(answer.model(), &solution.multiplier)?;
    check_deformation(answer)?;
    let warnings = of_scene(answer, solution, &[]);
    Ok(warnings.into_iter().filter(|warning| !OF_MESH.contains(&warning.code)).collect())
}

/// Refuses a displacement whose largest component is `largest`, in length, if it is rounding only: no load acts, and no
/// obstacle reaches into the body.
pub(super) fn check_motion(model: &Model, largest: f64) -> Result<(), Error> {
    let is_rounding = largest > 0.0 && largest <= ROUNDING_OF_PLACES * model.mesh().size();
    let is_loaded = model.problem().load().iter().any(|&force| force != 0.0);
    let is_pressed = (0..model.obstacles().len()).any(|obstacle| model.parts.pressed.contains(&obstacle));
    if !is_rounding || is_loaded || is_pressed {
        return Ok(());
    }
    let message = "nothing moves, so that there is no error to reduce: no load acts, and no obstacle reaches into the body; a \
                   negative `gap` presses an obstacle into it";
    Err(Error::Scene { path: "gap".into(), message: message.into() })
}

/// Warns that a support on a single node carries a force.
pub(super) fn point_support(answer: &Answer, resultants: &[Resultant]) -> Option<Warning> {
    let size = |one: &Resultant| one.force.iter().fold(0.0, |size: f64, part| size.hypot(*part));
    // The contact forces all around a shaft have no resultant.
    let of_contact: f64 = answer.multiplier().iter().map(|lambda| lambda.abs()).sum();
    let largest = resultants.iter().map(size).fold(of_contact, f64::max);
    let is_point = |one: &&Resultant| one.of.starts_with("supports") && one.nodes == 1 && size(one) > FELT * largest;
    let found = resultants.iter().find(is_point).filter(|_| answer.model().mesh().dimension() > 1)?;
    let message = format!(
        "{} holds a single node with a force of {:.3e}: displacement and stress there grow with every refinement; hold a boundary",
        found.of,
        size(found)
    );
    Some(Warning { code: "point-support", message })
}

fn loaded_rows<'a>(model: &'a Model, multiplier: &[f64]) -> Vec<&'a ContactRow> {
    let mut largest = vec![0.0_f64; model.obstacles().len()];
    let rows = || model.rows().iter().zip(multiplier);
    rows().for_each(|(row, lambda)| largest[row.obstacle] = largest[row.obstacle].max(-lambda));
    let of_all = largest.iter().copied().fold(0.0, f64::max);
    let least = |row: &ContactRow| (NO_FORCE * largest[row.obstacle]).max(ROUNDING * of_all);
    rows().filter(|(row, lambda)| -**lambda > least(row)).map(|(row, _)| row).collect()
}

/// The row with a force whose direction deviates most from the outward normal, and the cosine of their angle.
fn most_aside<'a>(model: &'a Model, multiplier: &[f64]) -> Option<(&'a ContactRow, f64)> {
    let rows = loaded_rows(model, multiplier).into_iter().map(|row| (row, dot(row.normal, row.outward)));
    rows.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Warns that rows with force deviate from the boundary's normals.
fn across_approach(answer: &Answer) -> Option<Warning> {
    let (row, cosine) = most_aside(answer.model(), answer.multiplier()).filter(|row| row.1 < ASIDE)?;
    let message = format!(
        "at {} the direction into obstacles[{}] and the outward normal of the body make an angle of {:.0} degrees, and the node carries \
         force: the obstacle drags the boundary along itself; name the boundary that faces the obstacle, or turn `approach`",
        node_in_words(answer.model(), row.node),
        row.obstacle,
        cosine.clamp(-1.0, 1.0).acos().to_degrees()
    );
    Some(Warning { code: "across-approach", message })
}

/// Warns that the body penetrates an obstacle between its nodes: only nodes have rows.
fn between_nodes(answer: &Answer) -> Option<Warning> {
    let model = answer.model();
    let (nodes, dimension) = (model.mesh().nodes(), model.mesh().dimension());
    let moved = |node: usize| at_node(model, answer.displacement(), node);
    let closed = answer.contact_set().iter().map(|row| &model.rows()[row]);
    let depth = closed.map(|row| dot(row.normal, moved(row.node)).abs()).fold(0.0, f64::max);
    let mut worst: Option<(f64, usize, [f64; 3])> = None;
    for (index, obstacle) in model.obstacles().iter().enumerate() {
        let (Some(rigid), Some(boundary)) = (obstacle.rigid(), model.mesh().boundary(obstacle.boundary())) else {
            continue;
        };
        for cell in boundary.facets().flat_map(|facet| boundary.kind.straight_cells(facet)) {
            let mean = |of: &dyn Fn(usize) -> [f64; 3]| {
                let sum = cell.iter().fold([0.0; 3], |sum, &node| plus(sum, of(node)));
                sum.map(|part| part / cell.len() as f64)
            };
            let at = mean(&|node| nodes[node]);
            let Ok(Some(row)) = rigid.shifted_row(at, answer.shift(index)) else { continue };
            let deep = dot(row.normal, mean(&moved)) - row.gap;
            if deep > worst.map_or(BETWEEN * depth, |worst| worst.0) {
                worst = Some((deep, index, at));
            }
        }
    }
    // Rows that closed without a displacement left its rounding.
    let is_moved = depth > ROUNDED * largest(answer.displacement());
    let (deep, index, at) = worst.filter(|_| dimension > 1 && is_moved)?;
    let (place, unit) = (&at[..dimension], &model.units().length);
    let message = format!(
        "between its nodes the body goes {deep:.2e} {unit} into obstacles[{index}], near {place:?}, {:.0} % of how far the contact moves \
         it: the obstacle is smaller than the cells; refine the mesh there",
        100.0 * deep / depth
    );
    Some(Warning { code: "between-nodes", message })
}

/// Warns that no row of a problem without a scene is closed and none carries a force; names the nearest row.
pub(super) fn untouched(problem: &ContactProblem, solution: &Solution) -> Option<Warning> {
    if is_touched(solution) || (problem.inequalities() == 0 && problem.equality_rows() > 0) {
        return None;
    }
    let message = match nearest(problem, solution) {
        Some((row, gap)) => format!("no row is closed; the smallest remaining gap is {} at row {row}", written(gap)),
        None if problem.rows() == 0 => "no row is closed: the problem has none".to_string(),
        None => "no row is closed: every gap is infinite".to_string(),
    };
    Some(Warning { code: "nothing-touches", message })
}

fn is_touched(solution: &Solution) -> bool {
    solution.contact_set.count() > 0 || solution.multiplier.iter().any(|&lambda| lambda != 0.0)
}

/// The row with the smallest remaining gap.
fn nearest(problem: &ContactProblem, solution: &Solution) -> Option<(usize, f64)> {
    let left =
        problem.violation(&solution.displacement).into_iter().take(problem.inequalities()).map(|violation| -violation);
    left.enumerate().filter(|(_, gap)| gap.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// A gap as a person would write it.
fn written(gap: f64) -> String {
    if gap < 1e-3 {
        format!("{gap:.1e}")
    } else {
        format!("{gap:.4}").trim_end_matches('0').trim_end_matches('.').to_string()
    }
}

/// Warns that rows along the approach direction carry force on an inclined surface: the force of a frictionless contact
/// is along its normal.
fn leaning_normals(answer: &Answer) -> Option<Warning> {
    let model = answer.model();
    let nodes = model.mesh().nodes();
    let loaded = loaded_rows(model, answer.multiplier());
    let beside = BESIDE * model.mesh().size();
    let mut shifts = vec![[0.0; 3]];
    for axis in 0..model.mesh().dimension() {
        shifts.extend([beside, -beside].map(|step| along_axis(axis, step)));
    }
    let mut worst: Option<(f64, usize, usize)> = None;
    for (index, obstacle) in model.obstacles().iter().enumerate().filter(|entry| entry.1.rule() == Some(Rule::Approach))
    {
        let place: BTreeMap<usize, usize> =
            (0..).zip(obstacle.candidates()).map(|(at, &(node, _))| (node, at)).collect();
        for row in loaded.iter().filter(|row| row.obstacle == index) {
            // At a corner of the surface every normal between those of both sides is allowed.
            let beside = shifts.iter().map(|&shift| plus(nodes[row.node], shift));
            let normals = beside.filter_map(|at| obstacle.surface_normal(place[&row.node], at, answer.shift(index)));
            let Some(lean) = normals.map(|surface| dot(surface, row.normal)).reduce(f64::max) else { continue };
            let angle = lean.clamp(-1.0, 1.0).acos().to_degrees();
            if worst.is_none_or(|(most, ..)| angle > most) {
                worst = Some((angle, row.node, index));
            }
        }
    }
    let (angle, node, index) = worst.filter(|(angle, ..)| *angle > LEANING)?;
    let place = node_in_words(model, node);
    let message = format!(
        "the surface of obstacles[{index}] leans by {angle:.0} degrees from the approach direction at {place}, which carries force; rule \
         `approach` takes that force along the approach direction, and keeps the node from sliding along the surface. Take rule \
         `closest-point`, whose rows follow the normals"
    );
    Some(Warning { code: "leaning-normals", message })
}

/// Warns that the mesh is too coarse for the numbers of the contact: segments of one or two nodes or without an inner
/// node, a peak that is uncertain or that grows without end.
fn mesh_dependent(model: &Model, segments: &[Segment]) -> Option<Warning> {
    if model.mesh().dimension() == 1 {
        return None;
    }
    let is_small = |segment: &&Segment| {
        let candidates = model.obstacles()[segment.obstacle].candidates().len();
        segment.nodes.len() <= FEW_NODES && candidates > segment.nodes.len()
    };
    let mut reasons = Vec::new();
    let small = segments.iter().filter(is_small).count();
    if let Some(first) = segments.iter().find(is_small) {
        let nodes: Vec<String> = first.nodes.iter().map(|&node| node_in_words(model, node)).collect();
        let nodes = nodes.join(" and ");
        reasons.push(match small {
            1 => format!("a contact of obstacles[{}] closes only {nodes}", first.obstacle),
            _ => {
                format!(
                    "{small} contacts close one or two nodes each, such as {nodes} of obstacles[{}]",
                    first.obstacle
                )
            }
        });
    }
    let peak = segments.iter().max_by(|a, b| a.pressure_max.total_cmp(&b.pressure_max))?;
    match (peak.edge_peak, peak.extent.pressure_uncertainty) {
        (Some(node), _) => reasons.push(format!(
            "the peak pressure stands at the edge of the contact, {}: at an edge of the obstacle or of the body it grows with every \
             refinement, and has no uncertainty",
            node_in_words(model, node)
        )),
        (None, None) if !is_small(&peak) => reasons.push(format!(
            "every node of the contact of obstacles[{}] is next to an open one, and its peak pressure has no uncertainty",
            peak.obstacle
        )),
        (None, Some(off)) if off > UNCERTAIN * peak.pressure_max && !is_small(&peak) => reasons.push(format!(
            "the peak pressure is uncertain by {:.0} %: the force of a row over its area and the stress of the body differ there",
            100.0 * off / peak.pressure_max
        )),
        _ => {}
    }
    let (first, others) = reasons.split_first()?;
    let reasons = others.iter().fold(first.clone(), |all, other| format!("{all}; {other}"));
    let message =
        format!("{reasons}. Peak pressure and extent depend on the mesh there: refine it near the contact and compare");
    Some(Warning { code: "mesh-dependent", message })
}

/// The deepest place of the undeformed body in an obstacle, in words; `None` if it lies in none. An obstacle that a
/// force presses moves to the body first.
pub(super) fn initial_overlap(model: &Model) -> Option<String> {
    let stands = |row: usize| !model.parts.pressed.contains(&model.rows()[row].obstacle);
    let gaps = model.problem().inequalities_given().1.iter().copied().enumerate().filter(|&(row, _)| stands(row));
    let (row, gap) = gaps.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (unit, row) = (&model.units().length, &model.rows()[row]);
    let place = node_in_words(model, row.node);
    let sentence = format!("before contact {place} lies {:.3e} {unit} inside obstacles[{}]", -gap, row.obstacle);
    (gap < -ROUNDING_OF_PLACES * model.mesh().size()).then(|| sentence.replace("  ", " "))
}

/// Warns that no row is closed and none carries a force; names the nearest row.
fn nothing_touches(model: &Model, solution: &Solution) -> Option<Warning> {
    if is_touched(solution) {
        return None;
    }
    let message = match nearest(model.problem(), solution) {
        Some((row, gap)) if gap.abs() <= ROUNDING_OF_PLACES * model.mesh().size() => {
            let node = node_in_words(model, model.rows()[row].node);
            format!("nothing presses: an obstacle just touches {node}; a negative `gap` moves it into the body")
        }
        Some((row, gap)) => {
            let (row, unit) = (&model.rows()[row], &model.units().length);
            let (gap, node) = (written(gap), node_in_words(model, row.node));
            let nearest = format!("the smallest remaining gap is {gap} {unit} at {node}").replace("  ", " ");
            format!("nothing touches; {nearest}{}", behind(model, row))
        }
        // A deck without contact asks for none.
        None if model.obstacles().is_empty() && model.mesh().node_numbers().is_some() => return None,
        None if model.obstacles().is_empty() => "nothing touches: the scene has no obstacle".to_string(),
        None => "nothing touches: no obstacle faces a node of its boundary".to_string(),
    };
    Some(Warning { code: "nothing-touches", message })
}

/// The remark that the obstacle of an open row lies behind the boundary, if its direction points into the body.
fn behind(model: &Model, row: &ContactRow) -> String {
    if dot(row.normal, row.outward) >= -SIDEWAYS {
        return String::new();
    }
    let (index, boundary) = (row.obstacle, model.obstacles()[row.obstacle].boundary());
    format!(
        ". The direction into obstacles[{index}] points into the body there: the obstacle lies behind `{boundary}`; turn `approach` \
         around, or name the boundary that faces the obstacle"
    )
}

/// Warns that strains are too large for the equations of small strains, or far beyond them.
fn large_strain(answer: &Answer) -> Option<Warning> {
    let (model, body) = (answer.model(), answer.model().body());
    if let Some(message) = answer.beyond_small_displacements() {
        return Some(Warning { code: BEYOND, message });
    }
    let deformation = answer.deformation()?;
    let (strain, element) = deformation.strain;
    if strain.max(deformation.rotation.0) > deformation::BEYOND {
        let message = format!(
            "{deformation}, on less than a thousandth of each body, as about a singular point: the numbers there mean nothing, and the \
             rest of the answer hardly depends on them"
        );
        return Some(Warning { code: "large-strain", message });
    }
    if strain <= LARGE_STRAIN {
        return None;
    }
    let corner = place_in_words(model, *body.elements().nth(element)?.nodes.first()?);
    let message = format!(
        "the largest strain is {:.0} %, in element {element} with a corner at {corner}: the equations hold for small strains, below about {:.0} %. Check the \
         gap, the loads and their units; bodies that overlap at the start are strained by that",
        100.0 * strain,
        100.0 * LARGE_STRAIN
    );
    Some(Warning { code: "large-strain", message })
}

/// The warning of a model about an answer: one about large displacements has their size.
fn of_model(answer: &Answer, warning: &Warning) -> Warning {
    match (warning.code == NONLINEAR).then(|| answer.deformation()).flatten() {
        Some(deformation) => Warning::new(NONLINEAR, format!("{warning}: {deformation}")),
        None => warning.clone(),
    }
}

/// Refuses an answer with large strains or rotations to a deck that asks for large displacements, unless small ones are
/// wanted.
pub(super) fn check_deformation(answer: &Answer) -> Result<(), Error> {
    let of_deck = answer.model().warnings().iter().filter(|warning| warning.code == NONLINEAR);
    for warning in of_deck.filter(|_| !answer.model().parts.scene.is_linear) {
        let Some(deformation) = answer.deformation() else { continue };
        if deformation.widespread > LARGE_DEFORMATION {
            let message = format!(
                "{warning}, but {deformation}: above {:.0} % of either large displacements have another answer; `--linear` gives that of small ones",
                100.0 * LARGE_DEFORMATION
            );
            return Err(refused("large-displacements", "body", message));
        }
    }
    Ok(())
}

/// Refuses an answer with obstacles that pull: at a row that carries force the direction into the obstacle points into
/// the body.
pub(super) fn check_approach(model: &Model, multiplier: &[f64]) -> Result<(), Error> {
    let worst = most_aside(model, multiplier).filter(|row| row.1 < -SIDEWAYS);
    let Some((row, cosine)) = worst else { return Ok(()) };
    let message = format!(
        "the obstacle pulls the body: at {} the direction into the obstacle and the outward normal of `{}` make an angle of {:.0} \
         degrees, and the node carries force; turn `approach` around, or name the boundary that faces the obstacle",
        node_in_words(model, row.node),
        model.obstacles()[row.obstacle].boundary(),
        cosine.clamp(-1.0, 1.0).acos().to_degrees()
    );
    Err(refused("approach-away", format!("obstacles[{}].approach", row.obstacle), message))
}
