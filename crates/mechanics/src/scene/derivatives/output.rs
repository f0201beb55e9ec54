//! Outputs of an answer, with their derivatives with respect to displacement and multipliers.

use std::collections::HashMap;

use super::effect::{Effect, Why, in_words};
use crate::error::{Error, nearly};
use crate::fem::ElasticBody;
use crate::fem::assembly::{internal_force, own_energy, own_energy_change};
use crate::fem::body::BodyElement;
use crate::fem::element::TabulatedPoint;
use crate::fem::geometry::{Symmetric, distance, dot};
use crate::scene::answers::answer::Answer;
use crate::scene::input::entry::wrong;
use crate::scene::models::model::{Model, place};
use crate::scene::models::rows::ContactRow;

/// Values that are this close, relative, tie for the largest: they differ by rounding.
const TIE: f64 = 1e-9;

/// The step of a multiplier for the derivative of a width, relative to the largest.
const STEP_OF_FORCE: f64 = 1e-4;

/// Tolerance of a place on an element, in its reference coordinates.
const ON_ELEMENT: f64 = 1e-9;

/// Components of a stress by name; the last is the equivalent stress.
const COMPONENTS: [&str; 7] = ["xx", "yy", "zz", "xy", "yz", "zx", "von-mises"];

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Output {
    /// As `obstacles[0].force`.
    pub name: String,
    kind: Aspect,
}

#[derive(Clone, Debug, PartialEq)]
enum Aspect {
    /// The sum of the contact forces, of the whole body. This and the next two are of one obstacle or of all.
    Force(Option<usize>),
    PeakPressure(Option<usize>),
    Width(Option<usize>),
    /// The moment of the contact forces of an obstacle about an axis through the origin, of the whole body.
    Moment(usize, usize),
    Travel(usize),
    /// At the candidate nearest to a place.
    PressureAt([f64; 3]),
    LargestDisplacement,
    StrainEnergy,
    /// A component of the stress of the element at a place.
    StressAt([f64; 3], usize),
}

/// A smooth branch of an output: the output itself, or one of several values that tie for the largest.
#[derive(Clone, Debug)]
pub(super) struct Smooth {
    pub value: f64,
    /// The derivative with respect to the unknowns of the problem.
    pub by_displacement: Vec<f64>,
    /// The derivative with respect to the multipliers of the rows, and of ties.
    pub by_multiplier: Vec<f64>,
    /// What it is of, in words, for ties: `node 7`.
    pub of: String,
    pub direct: Direct,
}

/// The dependence of an output on the data of the scene, at fixed displacement and multipliers.
#[derive(Clone, Debug)]
pub(super) enum Direct {
    None,
    /// Of a moment, on the normals of its rows.
    Moment(usize, usize),
    /// Of the pressure of a row, on its area.
    Pressure(usize),
    /// Of the strain energy, on stiffness and own stress.
    Energy,
    /// Of a component of the stress at a point of an element, on its material.
    Stress {
        element: usize,
        at: [f64; 3],
        component: usize,
    },
    /// Of a width, on one obstacle or on all, on the places of nodes and on the areas of its rows.
    Width(Option<usize>),
}

impl Output {
    /// The outputs of a model by name; those at a place are named once, with a place for the coordinates.
    pub fn names(model: &Model) -> Vec<String> {
        let dimension = model.body().dimension();
        let place = ["X", "X,Y", "X,Y,Z"][dimension - 1];
        let mut names: Vec<String> = Vec::new();
        let of_contact = ["force", "peak-pressure", "width"];
        let of_contact = &of_contact[..if dimension == 2 { 3 } else { 2 }];
        if !model.obstacles().is_empty() {
            names.extend(of_contact.iter().map(|name| name.to_string()));
            names.push(format!("pressure@{place}"));
        }
        for (index, _) in model.obstacles().iter().enumerate() {
            names.extend(of_contact.iter().map(|name| format!("obstacles[{index}].{name}")));
            match dimension {
                2 if !model.body().formulation().is_axisymmetric() => names.push(format!("obstacles[{index}].moment")),
                3 => names.extend((0..3).map(|axis| format!("obstacles[{index}].moment[{axis}]"))),
                _ => {}
            }
            names.extend(model.parts.pressed.contains(&index).then(|| format!("obstacles[{index}].travel")));
        }
        names.extend(["largest-displacement", "strain-energy"].map(String::from));
        names.push(format!("stress@{place}:xx"));
        names
    }

    pub fn of(name: &str, model: &Model) -> Result<Self, Error> {
        let names = Self::names(model);
        let kind = match name.split_once('@') {
            Some((what, place)) => Self::at_place(what, place, model, name)?,
            None if names.iter().any(|known| known == name) => Self::plain(name),
            None => None,
        };
        kind.map(|kind| Output { name: name.to_string(), kind }).ok_or_else(|| {
            let listed: Vec<String> = names.iter().map(|known| format!("`{known}`")).collect();
            let meant = nearly(name, names.iter().map(String::as_str));
            let components = COMPONENTS.join(", ");
            let message = format!(
                "there is no output `{name}`; there are {}, with the components {components} of a stress{meant}",
                listed.join(", ")
            );
            wrong("--of", message)
        })
    }

    fn plain(name: &str) -> Option<Aspect> {
        let (obstacle, what) = match name.strip_prefix("obstacles[").and_then(|rest| rest.split_once("].")) {
            Some((index, what)) => (Some(index.parse().ok()?), what),
            None => (None, name),
        };
        Some(match what {
            "force" => Aspect::Force(obstacle),
            "peak-pressure" => Aspect::PeakPressure(obstacle),
            "width" => Aspect::Width(obstacle),
            "travel" => Aspect::Travel(obstacle?),
            "moment" => Aspect::Moment(obstacle?, 2),
            "largest-displacement" => Aspect::LargestDisplacement,
            "strain-energy" => Aspect::StrainEnergy,
            axis => Aspect::Moment(obstacle?, axis.strip_prefix("moment[")?.strip_suffix(']')?.parse().ok()?),
        })
    }

    fn at_place(what: &str, place: &str, model: &Model, name: &str) -> Result<Option<Aspect>, Error> {
        let (place, component) = match place.split_once(':') {
            Some((place, component)) => (place, Some(component)),
            None => (place, None),
        };
        let numbers: Result<Vec<f64>, _> = place.split(',').map(|part| part.trim().parse::<f64>()).collect();
        let dimension = model.body().dimension();
        let at = numbers.ok().filter(|numbers| numbers.len() == dimension && numbers.iter().all(|x| x.is_finite()));
        let Some(at) = at else {
            return Err(wrong("--of", format!("the place of `{name}` needs {dimension} numbers, as `pressure@0.5,1`")));
        };
        let at = [0, 1, 2].map(|axis| at.get(axis).copied().unwrap_or(0.0));
        Ok(match (what, component) {
            ("pressure", None) if !model.obstacles().is_empty() => Some(Aspect::PressureAt(at)),
            ("stress", Some(component)) => {
                COMPONENTS.iter().position(|known| *known == component).map(|component| Aspect::StressAt(at, component))
            }
            _ => None,
        })
    }

    pub fn unit(&self, model: &Model) -> String {
        let units = model.units();
        let product = || match (units.force.as_str(), units.length.as_str()) {
            ("", "") => String::new(),
            (force, length) => format!("{force} {length}"),
        };
        match self.kind {
            Aspect::Force(_) => units.force.clone(),
            Aspect::Moment(..) | Aspect::StrainEnergy => product(),
            Aspect::Travel(_) | Aspect::Width(_) | Aspect::LargestDisplacement => units.length.clone(),
            Aspect::PeakPressure(_) | Aspect::PressureAt(_) | Aspect::StressAt(..) => units.pressure(),
        }
    }

    /// What the number does not say by itself: that it is of several obstacles.
    pub(super) fn note(&self, model: &Model) -> Option<String> {
        let count = model.obstacles().len();
        let is_sum = matches!(self.kind, Aspect::Force(None) | Aspect::Width(None)) && count > 1;
        is_sum
            .then(|| format!("the sum over all {count} obstacles; `obstacles[0].{}` is of the first alone", self.name))
    }

    /// The branches of the output at an answer; several if values tie for the largest.
    pub(super) fn branches(&self, answer: &Answer) -> Result<Vec<Smooth>, Why> {
        let model = answer.model();
        let problem = model.problem();
        let lambda = answer.multiplier();
        let blank = || Smooth {
            value: 0.0,
            by_displacement: vec![0.0; problem.dofs()],
            by_multiplier: vec![0.0; problem.inequalities() + problem.equality_rows()],
            of: String::new(),
            direct: Direct::None,
        };
        let of_rows = |coefficient: &dyn Fn(&ContactRow) -> f64, direct: Direct| {
            let mut branch = Smooth { direct, ..blank() };
            for (row, own) in model.rows().iter().enumerate() {
                branch.by_multiplier[row] = coefficient(own);
                branch.value += branch.by_multiplier[row] * lambda[row];
            }
            vec![branch]
        };
        Ok(match self.kind {
            Aspect::Force(None) => of_rows(&|_| -model.parts_of_whole(), Direct::None),
            Aspect::Force(Some(obstacle)) => {
                let parts = model.parts.parts_of_obstacle(obstacle);
                of_rows(&|row| if row.obstacle == obstacle { -parts } else { 0.0 }, Direct::None)
            }
            Aspect::Moment(obstacle, axis) => {
                let arm = |row: &ContactRow| moment_of(model, obstacle, place(model, row.node), row.normal, axis);
                let coefficient = |row: &ContactRow| if row.obstacle == obstacle { arm(row) } else { 0.0 };
                of_rows(&coefficient, Direct::Moment(obstacle, axis))
            }
            Aspect::Travel(obstacle) => {
                let travel = model.parts.travel(obstacle).ok_or("no force presses the obstacle")?;
                let mut branch = Smooth { value: answer.unknowns()[travel], ..blank() };
                branch.by_displacement[travel] = 1.0;
                vec![branch]
            }
            Aspect::PeakPressure(obstacle) => {
                let is_of = |row: usize| obstacle.is_none_or(|own| own == model.rows()[row].obstacle);
                let counts = |row: &usize| is_of(*row) && has_own_pressure(answer, *row);
                let rows: Vec<usize> = (0..lambda.len()).filter(counts).collect();
                let pressure = |row: usize| answer.pressure()[row];
                let largest = rows.iter().fold(0.0, |largest: f64, &row| largest.max(pressure(row)));
                if largest == 0.0 {
                    return Err("nothing presses".to_string());
                }
                let tied = rows.into_iter().filter(|&row| pressure(row) >= (1.0 - TIE) * largest);
                tied.map(|row| of_pressure(answer, row, blank())).collect()
            }
            Aspect::PressureAt(at) => {
                let away = |row: &usize| distance(model.mesh().nodes()[model.rows()[*row].node], at);
                let rows = (0..lambda.len()).filter(|&row| has_own_pressure(answer, row));
                let nearest = rows.min_by(|a, b| away(a).total_cmp(&away(b))).ok_or("there are no candidates")?;
                vec![of_pressure(answer, nearest, blank())]
            }
            Aspect::Width(obstacle) => vec![width(answer, obstacle, blank())?],
            Aspect::LargestDisplacement => {
                let values = answer.displacement();
                let largest = signorini_qp::largest(values);
                if largest == 0.0 {
                    return Err("nothing moves".to_string());
                }
                let tied = (0..values.len()).filter(|&dof| values[dof].abs() >= (1.0 - TIE) * largest);
                let of_dof = |dof: usize| {
                    let mut nodal = vec![0.0; values.len()];
                    nodal[dof] = values[dof].signum();
                    let of = format!("node {}", dof / model.body().dimension());
                    Ok(Smooth { value: values[dof].abs(), by_displacement: of_nodal(model, &nodal)?, of, ..blank() })
                };
                tied.map(of_dof).collect::<Result<_, Why>>()?
            }
            Aspect::StrainEnergy => {
                let parts = model.parts_of_whole();
                let forces = internal_force(model.body(), answer.displacement()).map_err(in_words)?;
                let value = parts * (work_to(answer, model.body())? + own_energy(model.body()));
                let by_displacement = of_nodal(model, &forces)?.iter().map(|force| parts * force).collect();
                vec![Smooth { value, by_displacement, direct: Direct::Energy, ..blank() }]
            }
            Aspect::StressAt(place, component) => vec![stress(answer, place, component, blank())?],
        })
    }
}

/// The moment of a force of an obstacle at a place about an axis through the origin, in the whole body.
pub(super) fn moment_of(model: &Model, obstacle: usize, at: [f64; 3], force: [f64; 3], axis: usize) -> f64 {
    model.parts.conditions.symmetry.moment(model.obstacles()[obstacle].approach(), at, force, axis)
}

/// The work that the internal forces of a body do up to the displacement of an answer: they grow linearly from those of
/// its own stress.
fn work_to(answer: &Answer, body: &ElasticBody) -> Result<f64, Why> {
    let displacement = answer.displacement();
    let work = |at: &[f64]| -> Result<f64, Why> {
        let forces = internal_force(body, at).map_err(in_words)?;
        Ok(forces.iter().zip(displacement).map(|(force, u)| force * u).sum())
    };
    let first = if body.has_own_stress() { work(&vec![0.0; displacement.len()])? } else { 0.0 };
    Ok((first + work(displacement)?) / 2.0)
}

/// Returns `true` if the pressure of a row is its own force over its own area.
fn has_own_pressure(answer: &Answer, row: usize) -> bool {
    let own = -answer.multiplier()[row] / answer.model().rows()[row].projected_area();
    own.is_finite() && (own - answer.pressure()[row]).abs() <= TIE * own.abs()
}

fn of_pressure(answer: &Answer, row: usize, blank: Smooth) -> Smooth {
    let own = &answer.model().rows()[row];
    let mut branch = Smooth { value: answer.pressure()[row], direct: Direct::Pressure(row), ..blank };
    branch.by_multiplier[row] = -1.0 / own.projected_area();
    Smooth { of: format!("node {}", own.node), ..branch }
}

/// The obstacles that an output of one or of all of them is of.
pub(super) fn obstacles_of(model: &Model, one: Option<usize>) -> std::ops::Range<usize> {
    one.map_or(0..model.obstacles().len(), |obstacle| obstacle..obstacle + 1)
}

/// The estimated width of the contact: it depends on the forces of the rows next to its edges.
fn width(answer: &Answer, obstacle: Option<usize>, blank: Smooth) -> Result<Smooth, Why> {
    let model = answer.model();
    let parts = model.parts_of_whole();
    let of = |answer: &Answer| parts * obstacles_of(model, obstacle).map(|index| answer.width_on(index)).sum::<f64>();
    let lambda = answer.multiplier();
    let step = STEP_OF_FORCE * signorini_qp::largest(lambda);
    let mut branch = Smooth { value: of(answer), direct: Direct::Width(obstacle), ..blank };
    if step == 0.0 {
        return Err("nothing presses".to_string());
    }
    for row in answer.contact_set().iter() {
        let at = |by: f64| {
            let mut varied = lambda.to_vec();
            varied[row] += by;
            answer.with_multiplier(varied).map(|answer| of(&answer)).map_err(in_words)
        };
        // A row that is not at an edge leaves the width as it is.
        let (near, far) = (at(step)? - at(-step)?, at(2.0 * step)? - at(-2.0 * step)?);
        branch.by_multiplier[row] = (8.0 * near - far) / (12.0 * step);
    }
    Ok(branch)
}

fn stress(answer: &Answer, place: [f64; 3], component: usize, blank: Smooth) -> Result<Smooth, Why> {
    let (model, body) = (answer.model(), answer.model().body());
    let found = body.elements().enumerate().find_map(|(index, element)| {
        let at = element.cell.weights_at(place, ON_ELEMENT).map(|_| element.cell.reference_coordinates(place));
        at.map(|at| (index, at))
    });
    let (element, at) = found.ok_or_else(|| "the place lies in no element".to_string())?;
    let own = stress_in(body, answer.displacement(), element, at).ok_or("the place lies in no element")?;
    let dimension = body.dimension();
    let mut unit = vec![0.0; body.nodal_dofs()];
    let none = stress_in(body, &unit, element, at).unwrap_or_default();
    let mut nodal = vec![0.0; body.nodal_dofs()];
    for &node in body.mesh().element(element) {
        for dof in dimension * node..dimension * (node + 1) {
            unit[dof] = 1.0;
            let moved = stress_in(body, &unit, element, at).unwrap_or_default();
            unit[dof] = 0.0;
            let by = [0, 1, 2, 3, 4, 5].map(|entry| moved[entry] - none[entry]);
            nodal[dof] = by_component(&own, &by, component);
        }
    }
    let direct = Direct::Stress { element, at, component };
    let value = own.get(component).map_or_else(|| equivalent(&own), |&value| value);
    Ok(Smooth { value, by_displacement: of_nodal(model, &nodal)?, direct, ..blank })
}

fn stress_in(body: &ElasticBody, displacement: &[f64], element: usize, at: [f64; 3]) -> Option<Symmetric> {
    Some(stress_of(body, displacement, &body.element(element)?, at))
}

/// The same of an element with any coordinates of its nodes.
pub(super) fn stress_of(body: &ElasticBody, displacement: &[f64], element: &BodyElement, at: [f64; 3]) -> Symmetric {
    let point = TabulatedPoint::new(element.kind.reference(), at, 0.0);
    body.strained(&body.tabulated(), displacement, element).at(&point).1
}

/// The derivative of a component along a change of the stress.
pub(super) fn by_component(stress: &Symmetric, change: &Symmetric, component: usize) -> f64 {
    if let Some(&value) = change.get(component) {
        return value;
    }
    let mean = (stress[0] + stress[1] + stress[2]) / 3.0;
    let normal: f64 = (0..3).map(|axis| (stress[axis] - mean) * change[axis]).sum();
    let shear: f64 = (3..6).map(|entry| 2.0 * stress[entry] * change[entry]).sum();
    let size = equivalent(stress);
    if size > 0.0 { 1.5 * (normal + shear) / size } else { 0.0 }
}

/// The equivalent stress of von Mises.
fn equivalent([xx, yy, zz, xy, yz, zx]: &Symmetric) -> f64 {
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

/// The derivative with respect to the unknowns, from that with respect to the displacements of the nodes.
fn of_nodal(model: &Model, nodal: &[f64]) -> Result<Vec<f64>, Why> {
    let parts = &model.parts;
    parts.conditions.dofs.restrict(nodal).map_err(in_words)
}

impl Smooth {
    /// The derivative at fixed displacement and multipliers.
    pub(super) fn direct(&self, answer: &Answer, effect: &Effect) -> Result<f64, Why> {
        let (model, lambda) = (answer.model(), answer.multiplier());
        Ok(match (&self.direct, &effect.body) {
            (Direct::None, _) | (Direct::Energy | Direct::Stress { .. }, None) => 0.0,
            (Direct::Moment(obstacle, axis), _) => {
                let of_row = |&(row, normal): &(usize, [f64; 3])| {
                    let own = &model.rows()[row];
                    if own.obstacle == *obstacle {
                        lambda[row] * moment_of(model, *obstacle, place(model, own.node), normal, *axis)
                    } else {
                        0.0
                    }
                };
                sorted(&effect.normals).iter().map(of_row).sum()
            }
            (Direct::Pressure(_) | Direct::Width(_), _) => {
                // A pressure is a force over the area that faces the obstacle, which changes with the normal.
                let of_row = |(row, normal): &(usize, [f64; 3])| {
                    let own = &model.rows()[*row];
                    let facing = dot(own.normal, own.outward);
                    let share = if facing > 0.0 && facing < 1.0 { dot(*normal, own.outward) / facing } else { 0.0 };
                    -self.by_multiplier[*row] * lambda[*row] * share
                };
                sorted(&effect.normals).iter().map(of_row).sum()
            }
            (Direct::Energy, Some(body)) => {
                let change = work_to(answer, body)? + own_energy_change(model.body(), body);
                model.parts_of_whole() * change
            }
            (Direct::Stress { element, at, component }, Some(body)) => {
                let own = stress_in(model.body(), answer.displacement(), *element, *at).unwrap_or_default();
                let change = stress_in(body, answer.displacement(), *element, *at).unwrap_or_default();
                by_component(&own, &change, *component)
            }
        })
    }
}

/// In the order of the rows, so that sums are the same in every run.
fn sorted(normals: &HashMap<usize, [f64; 3]>) -> Vec<(usize, [f64; 3])> {
    let mut sorted: Vec<(usize, [f64; 3])> = normals.iter().map(|(&row, &normal)| (row, normal)).collect();
    sorted.sort_unstable_by_key(|entry| entry.0);
    sorted
}
