//! The effect of a parameter on the data of a problem: changes of load, stiffness and rows, at an answer.

use std::collections::HashMap;

use super::parameter::{self, Datum, Variable};
use crate::error::Error;
use crate::fem::ElasticBody;
use crate::fem::assembly::internal_force;
use crate::fem::body::PhaseNumber;
use crate::fem::geometry::COORDINATES;
use crate::scene::answers::answer::Answer;
use crate::scene::input::obstacle::{PlacedObstacle, SideOrder};
use crate::scene::input::parse::files;
use crate::scene::input::schema::Scene;
use crate::scene::models::elastic::{bodies, joined};
use crate::scene::models::load::add_load;
use crate::scene::models::rows::{self, Found};
use signorini_qp::{Change, SparseMatrix, largest};

/// What a parameter changes, per unit.
#[derive(Clone, Debug)]
pub(super) struct Effect {
    /// On load, stiffness, rows and gaps.
    pub change: Change,
    /// The body whose stresses are the derivatives of the stresses, if a material or a temperature changes.
    pub body: Option<ElasticBody>,
    /// The changes of the normals of rows, [x, y, z]; none if they stay.
    pub normals: HashMap<usize, [f64; 3]>,
}

/// The reason why an effect is not known, in one sentence.
pub(super) type Why = String;

impl Effect {
    fn of(change: Change) -> Self {
        Effect { change, body: None, normals: HashMap::new() }
    }
}

/// The effect of a parameter of `scene` at an answer; `active` are the rows that may be closed.
pub(super) fn effect(scene: &Scene, parameter: &Variable, answer: &Answer, active: &[usize]) -> Result<Effect, Why> {
    let parts = &answer.model().parts;
    let nodal_load = |scene: &Scene, index: usize| -> Result<Vec<f64>, Why> {
        let mut nodal = vec![0.0; parts.body.nodal_dofs()];
        add_load(scene, &parts.body, index, &mut nodal).map_err(in_words)?;
        Ok(nodal)
    };
    let of_load = |nodal: &[f64]| -> Result<Effect, Why> {
        let load = parts.conditions.dofs.restrict(nodal).map_err(in_words)?;
        Ok(Effect::of(Change { load, ..unchanged(answer) }))
    };
    match &parameter.kind {
        Datum::Gap | Datum::GapOf(_) | Datum::InShape(..) => of_rows(scene, parameter, answer, active),
        Datum::Force(obstacle) => {
            let mut change = unchanged(answer);
            if let Some(travel) = parts.travel(*obstacle) {
                change.load[travel] = parts.share_of(*obstacle, 1.0);
            }
            Ok(Effect::of(change))
        }
        Datum::Load(index) => of_load(&nodal_load(scene, *index)?),
        Datum::InLoad(index, _) if parameter.is_linear() => {
            let unit = parameter::unit_load(scene, parameter).map_err(in_words)?;
            of_load(&nodal_load(&unit, *index)?)
        }
        Datum::InLoad(index, _) => {
            let varied = |by: f64| parameter::varied(scene, parameter, by).map_err(in_words);
            let at = |by: f64| nodal_load(&varied(by)?, *index);
            let scale = if parameter.value == 0.0 { 1.0 } else { parameter.value.abs() };
            let nodal = derivative(at, scale)?.ok_or_else(|| corner(parameter))?;
            of_load(&nodal)
        }
        Datum::Young(_) | Datum::Poisson(_) | Datum::Temperature(_) => {
            let body = derivative_of_body(scene, parameter, &parts.body)?;
            if let (Datum::Young(_), true) = (&parameter.kind, is_proportional(answer)) {
                let forces = answer.model().problem().stiffness().mul(answer.unknowns());
                let load = forces.iter().map(|force| -force / parameter.value).collect();
                return Ok(Effect { body: Some(body), ..Effect::of(Change { load, ..unchanged(answer) }) });
            }
            let forces = internal_force(&body, answer.displacement()).map_err(in_words)?;
            let nodal: Vec<f64> = forces.iter().map(|force| -force).collect();
            Ok(Effect { body: Some(body), ..of_load(&nodal)? })
        }
        Datum::Places => Err("the places of all nodes are many parameters".to_string()),
    }
}

/// Returns `true` if the whole stiffness is proportional to one Young's modulus, and no force comes from elsewhere in
/// the body.
fn is_proportional(answer: &Answer) -> bool {
    let parts = &answer.model().parts;
    let is_one = parts.body.phases().len() == 1 && !parts.body.has_own_stress();
    is_one
        && parts.conditions.springs.is_empty()
        && parts.conditions.rigid_faces.is_empty()
        && !parts.conditions.dofs.is_moved()
}

/// No change of the problem of an answer.
fn unchanged(answer: &Answer) -> Change {
    let problem = answer.model().problem();
    Change { load: vec![0.0; problem.dofs()], distance: vec![0.0; problem.inequalities() + problem.equality_rows()] }
}

/// The body of derivatives by a number of a material, or by a temperature.
fn derivative_of_body(scene: &Scene, parameter: &Variable, body: &ElasticBody) -> Result<ElasticBody, Why> {
    let by = match parameter.kind {
        Datum::Young(_) => PhaseNumber::Young,
        Datum::Poisson(_) => PhaseNumber::Poisson,
        _ => PhaseNumber::Temperature,
    };
    let numbers: Vec<PhaseNumber> = match body.phases().len() {
        1 => vec![by],
        _ => {
            // The phases that another value would change.
            let by_value = if parameter.value == 0.0 { 0.1 } else { -1e-3 * parameter.value };
            let varied = parameter::varied(scene, parameter, by_value).map_err(in_words)?;
            let varied = bodies(&varied).and_then(|bodies| joined(&varied, bodies)).map_err(in_words)?;
            if varied.phases().len() != body.phases().len() {
                return Err(format!("`{}` joins or parts materials", parameter.name));
            }
            let pairs = body.phases().iter().zip(varied.phases());
            pairs.map(|(own, other)| if own == other { PhaseNumber::Nothing } else { by }).collect()
        }
    };
    if numbers.iter().all(|number| *number == PhaseNumber::Nothing) {
        return Err(format!("`{}` belongs to no element", parameter.name));
    }
    body.derivative(&numbers).ok_or_else(|| format!("`{}` is not of an isotropic material", parameter.name))
}

/// The effect of a parameter of the obstacles: of the rows that may be closed.
fn of_rows(scene: &Scene, parameter: &Variable, answer: &Answer, active: &[usize]) -> Result<Effect, Why> {
    let (model, dimension) = (answer.model(), answer.model().body().dimension());
    let (parts, problem) = (&model.parts, model.problem());
    let mut columns: Vec<(usize, usize)> = Vec::new();
    for &row in active {
        let ends = model.rows()[row].ends.iter().map(|end| end.0);
        let of_axes = ends.flat_map(|node| (0..dimension).map(move |axis| (node, axis)));
        let of_ends =
            of_axes.flat_map(|(node, axis)| parts.conditions.dofs.along(node, &COORDINATES[axis][..dimension]).free);
        let travel = parts.travel(model.rows()[row].obstacle);
        let mut of_row: Vec<usize> = of_ends.map(|entry| entry.0).chain(travel).collect();
        of_row.sort_unstable();
        of_row.dedup();
        columns.extend(of_row.into_iter().map(|column| (row, column)));
    }
    let at = |by: f64| -> Result<Vec<f64>, Why> {
        let (obstacles, gap) = obstacles(scene, parameter, answer, by)?;
        let Found { rows, entries, gap, .. } = rows::found(parts, &obstacles, gap).map_err(in_words)?;
        let of_node: HashMap<(usize, usize), usize> =
            rows.iter().enumerate().map(|(index, row)| ((row.obstacle, row.node), index)).collect();
        let mut of_entry: HashMap<(usize, usize), f64> = HashMap::new();
        entries.into_iter().for_each(|(row, column, value)| *of_entry.entry((row, column)).or_insert(0.0) += value);
        let mut values = Vec::with_capacity(4 * active.len() + columns.len());
        let mut place = HashMap::new();
        for &row in active {
            let own = &model.rows()[row];
            let Some(&found) = of_node.get(&(own.obstacle, own.node)) else {
                return Err(format!("the obstacle ends at node {}, which presses on it", own.node));
            };
            place.insert(row, found);
            values.push(gap[found]);
            values.extend(rows[found].normal);
        }
        values.extend(columns.iter().map(|(row, column)| of_entry.get(&(place[row], *column)).copied().unwrap_or(0.0)));
        Ok(values)
    };
    let scale = match parameter.unit.is_empty() {
        // A direction or a slope.
        true if matches!(parameter.kind, Datum::InShape(..)) => parameter.value.abs().max(1.0),
        _ => parameter.value.abs().max(model.mesh().size()),
    };
    let found = derivative(at, scale)?.ok_or_else(|| corner(parameter))?;
    let (of_rows, of_entries) = found.split_at(4 * active.len());
    let mut change = unchanged(answer);
    let mut normals = HashMap::new();
    for (&row, values) in active.iter().zip(of_rows.chunks(4)) {
        change.distance[row] = values[0];
        if values[1..] != [0.0; 3] {
            normals.insert(row, [values[1], values[2], values[3]]);
        }
    }
    let entries: Vec<(usize, usize, f64)> =
        columns.iter().zip(of_entries).map(|(&(row, column), &value)| (row, column, value)).collect();
    let rows = SparseMatrix::from_triplets(change.distance.len(), problem.dofs(), &entries).map_err(in_words)?;
    let (unknowns, multiplier) = (answer.unknowns(), answer.all_multipliers());
    let change = change.with_rows(&rows, unknowns, &multiplier).map_err(in_words)?;
    Ok(Effect { normals, ..Effect::of(change) })
}

/// The obstacles, and the gap of the scene, with a parameter changed.
fn obstacles(scene: &Scene, parameter: &Variable, answer: &Answer, by: f64) -> Result<(Vec<PlacedObstacle>, f64), Why> {
    let parts = &answer.model().parts;
    let (mut obstacles, gap) = (parts.obstacles.clone(), answer.model().gap());
    match &parameter.kind {
        Datum::GapOf(index) => obstacles[*index] = obstacles[*index].moved(by),
        Datum::InShape(index, _) => {
            let varied = parameter::varied(scene, parameter, by).map_err(in_words)?;
            // Only rigid shapes have such parameters: the order of bodies does not matter.
            let order = SideOrder::of(&parts.body, std::iter::empty());
            let site = (&parts.body, &parts.conditions.dofs, &order);
            let (spec, path) = (&varied.obstacles[*index], format!("obstacles[{index}]"));
            obstacles[*index] = PlacedObstacle::of_scene(spec, &path, site, files(&varied)).map_err(in_words)?;
        }
        _ => return Ok((obstacles, gap + by)),
    }
    Ok((obstacles, gap))
}

fn corner(parameter: &Variable) -> Why {
    format!("`{}` moves a node over a corner of the obstacle, or over an edge of its facets", parameter.name)
}

pub(super) fn in_words(error: impl Into<Error>) -> Why {
    error.into().to_string()
}

/// The first step, in the scale of the variable; each further one is a tenth of it.
const FIRST_STEP: f64 = 1e-3;

const STEPS: usize = 6;

/// Differences of two steps agree if they are closer than this, relative to the largest of the vector. Where the vector
/// is smooth, the error of the fourth order is about the square; where only its slope is continuous, this is the error.
const AGREEMENT: f64 = 1e-7;

/// Rounding of an entry, relative to the largest.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The derivative of a vector at zero, with one entry for each of its entries; `None` at a corner, or where it is
/// nowhere smooth. `scale` is the size of a change of the variable that changes the vector noticeably.
pub(super) fn derivative<E>(at: impl Fn(f64) -> Result<Vec<f64>, E>, scale: f64) -> Result<Option<Vec<f64>>, E> {
    let middle = at(0.0)?;
    let mut step = FIRST_STEP * scale;
    let mut last_error = None;
    for _ in 0..STEPS {
        let places = [-2.0 * step, -step, step, 2.0 * step].map(&at);
        step /= 10.0;
        let [before, near_before, near, after] = match places.into_iter().collect::<Result<Vec<_>, E>>() {
            Ok(values) => <[Vec<f64>; 4]>::try_from(values).unwrap_or_default(),
            // The vector ends within the step.
            Err(error) => {
                last_error = Some(error);
                continue;
            }
        };
        let own = 10.0 * step;
        let mut found = Vec::with_capacity(middle.len());
        let (mut size, mut off) = (0.0_f64, 0.0_f64);
        let rounding = ROUNDING * largest(&middle).max(largest(&before)).max(largest(&after)) / own;
        for (entry, &middle) in middle.iter().enumerate() {
            let narrow = (near[entry] - near_before[entry]) / (2.0 * own);
            let wide = (after[entry] - before[entry]) / (4.0 * own);
            // The jump of the slope halves with the step where the vector is smooth.
            let jump = (near[entry] - 2.0 * middle + near_before[entry]) / own;
            let wide_jump = (after[entry] - 2.0 * middle + before[entry]) / (2.0 * own);
            let apart = (narrow - wide).abs().max((jump - 0.5 * wide_jump).abs());
            off = off.max(apart - rounding);
            size = size.max(narrow.abs()).max(wide.abs());
            found.push((4.0 * narrow - wide) / 3.0);
        }
        if off <= AGREEMENT * size {
            return Ok(Some(found));
        }
    }
    last_error.map_or(Ok(None), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(at: impl Fn(f64) -> f64) -> Option<f64> {
        derivative(|x| Ok::<_, String>(vec![at(x), 1.0]), 1.0).unwrap().map(|found| found[0])
    }

    #[test]
    fn smooth_functions_have_their_derivative_and_corners_have_none() {
        assert!((of(|x| (3.0 * (x + 0.1)).sin()).unwrap() - 3.0 * 0.3_f64.cos()).abs() < 1e-10);
        assert!((of(|x| 2.0 - 5.0 * x).unwrap() + 5.0).abs() < 1e-11);
        assert_eq!(of(|_| 7.0), Some(0.0));
        assert_eq!(of(f64::abs), None);
        assert_eq!(of(|x| x.max(-x / 2.0)), None);
        // A corner beside zero is avoided by smaller steps.
        assert!((of(|x| (x - 1.5e-4).max(0.0) + 2.0 * x).unwrap() - 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_function_that_ends_within_every_step_gives_its_reason() {
        let ends = |x: f64| if x > 0.0 { Err("ends") } else { Ok(vec![x]) };
        assert_eq!(derivative(ends, 1.0), Err("ends"));
    }
}
