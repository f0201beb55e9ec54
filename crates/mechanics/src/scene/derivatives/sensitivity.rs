//! The derivatives of outputs of a scene with respect to its parameters.

use std::sync::Arc;
use std::time::Instant;

use super::effect::{Effect, Why, effect};
use super::output::{Output, Smooth};
use super::parameter::{self, Datum, Variable};
use super::places::{Pairing, by_places};
use crate::error::Error;
use crate::scene::answers::answer::Answer;
use crate::scene::input::entry::wrong;
use crate::scene::input::schema::Scene;
use crate::scene::models::model::Model;
use serde::Serialize;
use signorini_qp::{Adjoint, Derivative, Derivatives, Prepared, Settings, Solution};

/// Derivatives of branches that are this close, relative, are one.
const SAME: f64 = 1e-9;

/// A number of an answer, such as a force, with its derivatives by numbers of the scene.
#[derive(Clone, Debug, Serialize)]
pub struct Sensitivity {
    /// As `force`, or `obstacles[0].moment`.
    pub output: String,
    /// The number at the answer, in its unit.
    pub value: f64,
    /// The unit of the output; empty if it is dimensionless.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// The derivatives, in the order of the parameters.
    pub by: Vec<ByParameter>,
    /// Sentences on kinks of the output itself: values that tie for the largest.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// One entry of a gradient: a number of the scene, and the change of the output with it.
#[derive(Clone, Debug, Serialize)]
pub struct ByParameter {
    /// As `obstacles[0].radius`, or `nodes`.
    pub parameter: String,
    /// The number in the scene, in its unit; zero for the places of nodes.
    pub value: f64,
    /// The unit of this number of the scene; empty if it is dimensionless.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// The derivative, in the unit of the output over that of the parameter; of the places of all nodes the largest
    /// magnitude.
    pub derivative: Derivative<f64>,
    /// The change of the output in per cent for a parameter larger by one per cent; `None` if one of both is zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative: Option<Derivative<f64>>,
    /// For the places of all nodes, the derivative with respect to each coordinate, length `dim * n_nodes`, in
    /// the unit of the output over that of length.
    #[serde(skip)]
    pub places: Option<Derivative<Vec<f64>>>,
}

/// A solved scene with the gradients that were asked for, and the rows at which they may not exist.
#[derive(Debug)]
pub struct Sensitivities {
    /// Displacements, pressures and forces, with the model.
    pub answer: Answer,
    /// The certified solution of the contact problem behind it.
    pub solution: Solution,
    /// The gradients, in the order of the names that were asked for.
    pub outputs: Vec<Sensitivity>,
    /// Indices of contact rows, from 0, in increasing order: those at a kink, or that the proof leaves undecided.
    pub at_kink: Vec<usize>,
    /// Seconds of the derivatives alone, without model, solve and proof.
    pub seconds: f64,
}

/// The names that [`Scene::outputs`] gives, for a scene whose model is built already.
pub fn outputs_of(model: &Model) -> Vec<String> {
    Output::names(model)
}

impl Sensitivities {
    /// As [`Scene::sensitivity`], for a scene with its model.
    pub fn of(
        scene: &Scene,
        model: Arc<Model>,
        outputs: &[&str],
        parameters: &[&str],
        settings: &Settings,
    ) -> Result<Self, Error> {
        if scene.analysis.is_some() {
            let message = "only an equilibrium has derivatives here, no motion and no modes; leave `analysis` out";
            return Err(wrong("analysis", message));
        }
        let outputs: Vec<Output> = outputs.iter().map(|name| Output::of(name, &model)).collect::<Result<_, _>>()?;
        let parameters: Vec<Variable> =
            parameters.iter().map(|name| parameter::named(scene, name)).collect::<Result<_, _>>()?;
        let (answer, solution, derivatives) = proven(&model, settings)?;
        let clock = Instant::now();
        let at = At { scene, answer: &answer, derivatives: &derivatives };
        let outputs = at.all(&outputs, &parameters)?;
        let (at_kink, seconds) = (derivatives.at_kink().to_vec(), clock.elapsed().as_secs_f64());
        Ok(Sensitivities { answer, solution, outputs, at_kink, seconds })
    }
}

pub(crate) fn proven(model: &Arc<Model>, settings: &Settings) -> Result<(Answer, Solution, Derivatives), Error> {
    let explain = |error: signorini_qp::Error| model.explain(error);
    let settings = settings.clone().with_proof();
    let prepared = Prepared::for_gaps(model.problem(), 1, &settings).map_err(explain)?;
    let solution = prepared.solve(model.problem().gap()).map_err(explain)?;
    let answer = Answer::of(model.clone(), &solution)?;
    let derivatives = prepared.derivatives(&solution).map_err(explain)?;
    Ok((answer, solution, derivatives))
}

struct At<'a> {
    scene: &'a Scene,
    answer: &'a Answer,
    derivatives: &'a Derivatives,
}

impl At<'_> {
    fn all(&self, outputs: &[Output], parameters: &[Variable]) -> Result<Vec<Sensitivity>, Error> {
        let active = self.active();
        let of = |parameter: &Variable| match parameter.kind {
            Datum::Places => None,
            _ => Some(effect(self.scene, parameter, self.answer, &active)),
        };
        let effects: Vec<Option<Result<Effect, Why>>> = parameters.iter().map(of).collect();
        outputs.iter().map(|output| self.of_output(output, parameters, &effects)).collect()
    }

    /// The rows that may be closed.
    fn active(&self) -> Vec<usize> {
        let mut rows: Vec<usize> = self.answer.contact_set().iter().collect();
        rows.extend(self.derivatives.closed().iter().flatten());
        rows.extend(self.derivatives.at_kink());
        rows.sort_unstable();
        rows.dedup();
        rows
    }

    fn of_output(
        &self,
        output: &Output,
        parameters: &[Variable],
        effects: &[Option<Result<Effect, Why>>],
    ) -> Result<Sensitivity, Error> {
        let model = self.answer.model();
        let unit = output.unit(model);
        let unknown = |why: &Why| Derivative::Unknown { why: why.clone() };
        let row = |parameter: &Variable, derivative, relative, places| ByParameter {
            parameter: parameter.name.clone(),
            value: parameter.value,
            unit: parameter.unit.clone(),
            derivative,
            relative,
            places,
        };
        let mut notes: Vec<String> = output.note(model).into_iter().collect();
        let (output, branches) = (output.name.clone(), output.branches(self.answer));
        let branches = match branches {
            Ok(branches) => branches,
            Err(why) => {
                let by = parameters.iter().map(|parameter| row(parameter, unknown(&why), None, None)).collect();
                return Ok(Sensitivity { output, value: f64::NAN, unit, by, notes: vec![why] });
            }
        };
        let value = branches[0].value;
        let adjoint = |branch: &Smooth| self.derivatives.adjoint(&branch.by_displacement, &branch.by_multiplier);
        let adjoints: Vec<Derivative<Adjoint>> = branches.iter().map(adjoint).collect::<Result<_, _>>()?;
        let mut by = Vec::with_capacity(parameters.len());
        for (parameter, effect) in parameters.iter().zip(effects) {
            by.push(match effect {
                Some(Ok(effect)) => {
                    let along = |(branch, adjoint)| self.along(branch, adjoint, effect);
                    let found: Vec<_> = branches.iter().zip(&adjoints).map(along).collect::<Result<_, _>>()?;
                    let share = parameter.value / value;
                    let derivative = joined(found, if parameter.value == 0.0 { 0.0 } else { 1.0 / share.abs() });
                    let has_share = share.is_finite() && parameter.value != 0.0;
                    let relative = has_share.then(|| derivative.map(|derivative| derivative * share));
                    row(parameter, derivative, relative, None)
                }
                Some(Err(why)) => row(parameter, unknown(why), None, None),
                None => {
                    let of_branches = branches.iter().zip(&adjoints);
                    let found = of_branches.map(|(branch, adjoint)| self.by_places(branch, adjoint)).collect();
                    let places = joined_places(found);
                    row(parameter, places.map(|places| signorini_qp::largest(places)), None, Some(places))
                }
            });
        }
        let names: Vec<&str> = branches.iter().map(|branch| branch.of.as_str()).collect();
        if names.len() > 1 {
            notes.push(format!("{} tie for the largest value: the output itself has a kink", names.join(" and ")));
        }
        Ok(Sensitivity { output, value, unit, by, notes })
    }

    fn by_places(&self, branch: &Smooth, adjoint: &Derivative<Adjoint>) -> Derivative<Vec<f64>> {
        let rows = self.answer.model().rows().len();
        let of_piece = |adjoint: &Adjoint| -> Result<Vec<f64>, Why> {
            let pairing =
                Pairing { answer: self.answer, adjoint: &adjoint.displacement, forces: &adjoint.multiplier[..rows] };
            let (mut gradient, direct) = (by_places(self.scene, &pairing)?, branch.direct_by_places(self.answer)?);
            gradient.iter_mut().zip(direct).for_each(|(entry, direct)| *entry += direct);
            Ok(gradient)
        };
        adjoint.map(of_piece).transposed()
    }

    /// The derivative of a branch along the effect of a parameter: at a kink of the answer by tangents, which tell its
    /// sides apart.
    fn along(&self, branch: &Smooth, adjoint: &Derivative<Adjoint>, effect: &Effect) -> Result<Derivative<f64>, Error> {
        let direct = match branch.direct(self.answer, effect) {
            Ok(direct) => direct,
            Err(why) => return Ok(Derivative::Unknown { why }),
        };
        if self.derivatives.at_kink().is_empty() {
            return Ok(adjoint.map(|adjoint| adjoint.along(&effect.change) + direct));
        }
        let tangent = self.derivatives.tangent(&effect.change)?;
        Ok(tangent.map(|tangent| {
            signorini_qp::dot(&branch.by_displacement, &tangent.displacement)
                + signorini_qp::dot(&branch.by_multiplier, &tangent.multiplier)
                + direct
        }))
    }
}

/// The derivatives of branches that tie, as one.
fn joined_places(mut branches: Vec<Derivative<Vec<f64>>>) -> Derivative<Vec<f64>> {
    let is_unknown = |branch: &Derivative<Vec<f64>>| matches!(branch, Derivative::Unknown { .. });
    let alone = if branches.len() == 1 { Some(0) } else { branches.iter().position(is_unknown) };
    match alone {
        Some(place) => branches.swap_remove(place),
        None => Derivative::Undecided { between: branches.iter().flat_map(values_of).collect(), rows: Vec::new() },
    }
}

/// The derivative of the largest of several branches that tie: theirs, if all agree. Derivatives far below `scale` are
/// rounding.
fn joined(mut branches: Vec<Derivative<f64>>, scale: f64) -> Derivative<f64> {
    let values: Vec<f64> = branches.iter().flat_map(values_of).collect();
    let size = values.iter().fold(scale, |size: f64, value| size.max(value.abs()));
    let agree = values.windows(2).all(|pair| (pair[0] - pair[1]).abs() <= SAME * size);
    if branches.len() == 1 || (agree && branches.iter().all(|branch| branch.proven().is_some())) {
        return branches.swap_remove(0);
    }
    match branches.iter().find(|branch| matches!(branch, Derivative::Unknown { .. })) {
        Some(unknown) => unknown.clone(),
        None => Derivative::Undecided { between: values, rows: Vec::new() },
    }
}

fn values_of<T: Clone>(derivative: &Derivative<T>) -> Vec<T> {
    match derivative {
        Derivative::Proven(value) => vec![value.clone()],
        Derivative::OneSided { left, right } => vec![left.clone(), right.clone()],
        Derivative::Undecided { between, .. } => between.clone(),
        Derivative::Unknown { .. } => Vec::new(),
    }
}
