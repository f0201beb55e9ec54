//! The natural vibrations of a scene about its equilibrium: closed contact rows stay closed, open rows stay open.
//!
//! ```text
//! K x = w M x,   B_C x = 0,   w = (2 pi f)^2
//! ```
//!
//! K is the stiffness of the free unknowns, M their consistent mass, C the closed rows with all ties. The stress of the
//! equilibrium does not change the stiffness, nothing is damped, and no contact opens or closes during a vibration.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use crate::error::Error;
use crate::fem::MassForm;
use crate::scene::Scene;
use crate::scene::answers::answer::Answer;
use crate::scene::derivatives::sensitivity::proven;
use crate::scene::input::entry::wrong;
use crate::scene::input::schema::analysis::MODES;
use crate::scene::input::schema::{AnalysisSpec, ModesSpec};
use crate::scene::models::model::Model;
use crate::scene::models::rigid_body_modes::RigidBodyModes;
use crate::scene::models::rows::ContactRow;
use crate::scene::models::set_up::mass_of_nodes;
use signorini_qp as qp;
use signorini_qp::{ContactSet, Settings, Solution, SymmetricMatrix, dot};

/// Most modes of one analysis.
const MOST_MODES: usize = 1000;

/// Forces and motions of a row below this share of the largest in a mode are rounding.
const ROUNDING: f64 = 1e-9;

/// The amplitude of a mode at which a contact row changes between closed and open.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limit {
    /// The largest displacement of the mode, in length.
    pub amplitude: f64,
    /// Index of the contact row, from 0.
    pub row: usize,
    /// Index of the node of the row, from 0.
    pub node: usize,
    /// Index of the obstacle of the row in the scene, from 0.
    pub obstacle: usize,
}

/// A vibration with one frequency, about an equilibrium.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mode {
    /// Natural frequency, in one over time, `>= 0`; exactly 0 for a rigid motion. Undecided rows are closed.
    pub frequency: f64,
    /// The same with undecided rows open, `<= frequency`; `None` if no row is undecided.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency_open: Option<f64>,
    /// Residual of the pair, dimensionless: as in [`qp::ContactProblem::modes`]. The relative error of the frequency is
    /// at most about half of it, and mostly its square.
    pub residual: f64,
    /// Participation factor for each axis of the coordinates, in the root of mass: `x'M e`, with a unit motion e of the
    /// whole body.
    pub participation: Vec<f64>,
    /// Effective mass for each axis, in mass: the square of the factor, for all copies of a part with planes of
    /// symmetry.
    pub effective_mass: Vec<f64>,
    /// The amplitude at which the first closed row opens; `None` if none does.
    pub opens: Option<Limit>,
    /// The amplitude at which the first open row closes; `None` if none does.
    pub closes: Option<Limit>,
    /// Displacement of the nodes, length `dim * n_nodes`, order `[u_x0, u_y0, u_x1, ...]`, in one over the root of
    /// mass, along the positive axes: its mass is 1.
    #[serde(skip)]
    pub displacement: Vec<f64>,
}

impl Mode {
    /// The largest displacement of a node with `dimension` coordinates, in one over the root of mass.
    pub fn largest(&self, dimension: usize) -> f64 {
        largest(&self.displacement, dimension)
    }
}

/// The largest length among vectors of `dimension` components.
fn largest(vectors: &[f64], dimension: usize) -> f64 {
    vectors.chunks(dimension).map(|moved| dot(moved, moved).sqrt()).fold(0.0, f64::max)
}

/// The natural vibrations of a scene with the equilibrium about which it vibrates.
#[derive(Clone, Debug, Serialize)]
pub struct ModalAnalysis {
    /// The equilibrium; zero displacements if nothing holds the body and there is none.
    #[serde(skip)]
    pub answer: Answer,
    /// The certified solution behind it; `None` if nothing holds the body.
    #[serde(skip)]
    pub solution: Option<Solution>,
    /// Indices of the contact rows that stay closed, undecided ones included, from 0, in increasing order.
    pub closed: Vec<usize>,
    /// Those of them that may be open: each frequency lies between that with all of them open and that with all of them
    /// closed.
    pub undecided: Vec<usize>,
    /// The reason, in words, if the closed rows are those of the answer without a proof.
    pub unproven: Option<String>,
    /// At most as many as were asked for, by increasing frequency.
    pub modes: Vec<Mode>,
    /// `true` if a count of negative pivots shows that no frequency below the last is missed.
    pub is_complete: bool,
    /// The motions without energy, in words.
    pub rigid_motions: Vec<String>,
    /// Mass of the whole bodies, in mass.
    pub mass: f64,
    /// Seconds of the modes alone, without equilibrium and proof.
    pub seconds: f64,
}

pub(crate) fn modal_analysis(scene: &Scene, count: usize, settings: &Settings) -> Result<ModalAnalysis, Error> {
    let analysis = Some(AnalysisSpec::Modes(ModesSpec { count }));
    let scene = Scene { analysis, ..scene.clone() };
    ModalAnalysis::of(Arc::new(scene.build()?), count, settings)
}

impl ModalAnalysis {
    /// The same for the model that a scene with a request for modes built.
    pub fn of(model: Arc<Model>, count: usize, settings: &Settings) -> Result<Self, Error> {
        if !(1..=MOST_MODES).contains(&count) {
            let message = format!("{count} is not allowed: it must be from 1 to {MOST_MODES}");
            return Err(wrong(format!("{MODES}.count"), message));
        }
        let problem = model.problem();
        // Without contact rows the equilibrium decides nothing, and need not exist.
        let rigid = RigidBodyModes::of_parts(&model.parts);
        let is_held = rigid.check_held(&model.parts, model.rows()).is_ok();
        let mut unproven = None;
        let (answer, solution, [closed, undecided]) = match is_held {
            true => {
                let (answer, solution, derivatives) = proven(&model, settings)?;
                let closed = derivatives.closed().unwrap_or_else(|| {
                    unproven = derivatives.why_unknown().filter(|_| !model.rows().is_empty()).map(String::from);
                    solution.contact_set.clone()
                });
                let rows = [closed.iter().collect(), derivatives.at_kink().to_vec()];
                (answer, Some(solution), rows)
            }
            false => {
                let zeros = [vec![0.0; problem.dofs()], vec![0.0; model.parts.ties.rows.len()]];
                let still = Answer::new(model.clone(), &zeros[0], &zeros[1], &ContactSet::default())?;
                (still, None, [Vec::new(), Vec::new()])
            }
        };
        let clock = Instant::now();
        let mass = model.mass(MassForm::Consistent)?;
        let mut all: Vec<usize> = closed.iter().chain(&undecided).copied().collect();
        all.sort_unstable();
        // A travel without mass is determined by the rows of its obstacle.
        let parts = &model.parts;
        let travels: Vec<usize> = parts.pressed.iter().filter_map(|&obstacle| parts.travel(obstacle)).collect();
        let threads = settings.threads.unwrap_or_else(qp::Settings::threads_of_machine);
        let lowest = |closed: &[usize]| problem.modes(&mass, (closed, &travels), count, threads, &settings.watch);
        let found = lowest(&all)?;
        let open = if undecided.is_empty() { None } else { Some(lowest(&closed)?) };
        let is_complete = found.is_complete && open.as_ref().is_none_or(|open| open.is_complete);
        let shapes = Shapes::of(&answer, &all)?;
        let of_pair = |(number, vector): (usize, &Vec<f64>)| {
            let frequency = |values: &[f64]| values.get(number).map(|value| value.max(0.0).sqrt() / TAU);
            Ok(Mode {
                frequency: frequency(&found.values).unwrap_or(0.0),
                frequency_open: open.as_ref().and_then(|open| frequency(&open.values)),
                residual: found.residuals[number],
                ..shapes.mode(vector, &found.multipliers[number])?
            })
        };
        let modes: Vec<Mode> = found.vectors.iter().enumerate().map(of_pair).collect::<Result<_, Error>>()?;
        let closed_rows: Vec<ContactRow> = all.iter().map(|&row| model.rows()[row].clone()).collect();
        let rigid_motions = match modes.iter().any(|mode| mode.frequency == 0.0) {
            true => rigid.names(&rigid.free(&model.parts, &closed_rows)),
            false => Vec::new(),
        };
        let (mass, seconds) = (shapes.mass(), clock.elapsed().as_secs_f64());
        Ok(ModalAnalysis {
            answer,
            solution,
            closed: all,
            undecided,
            unproven,
            modes,
            is_complete,
            rigid_motions,
            mass,
            seconds,
        })
    }
}

/// What the numbers of a mode follow from.
struct Shapes<'a> {
    model: &'a Model,
    closed: &'a [usize],
    /// The mass that each node takes in a motion of the whole body, in mass.
    of_nodes: Vec<f64>,
    /// The axes along which the whole may move with all its copies.
    axes: Vec<bool>,
    /// Forces of the rows in equilibrium, and their remaining gaps in the unknowns of the problem.
    forces: Vec<f64>,
    gaps: Vec<f64>,
}

impl<'a> Shapes<'a> {
    fn of(answer: &'a Answer, closed: &'a [usize]) -> Result<Self, Error> {
        let model = answer.model();
        let (problem, dimension) = (model.problem(), model.body().dimension());
        let nodal = SymmetricMatrix::from_lower(mass_of_nodes(model, MassForm::Consistent)?)?;
        let of_nodes = nodal.mul(&vec![1.0; nodal.dim()]);
        let is_radial = |axis: usize| model.body().formulation().is_axisymmetric() && axis == 0;
        let axes =
            (0..dimension).map(|axis| !is_radial(axis) && !model.parts.conditions.symmetry.crosses(axis)).collect();
        let moved = problem.contact().mul(answer.unknowns());
        let gaps = problem.gap().iter().zip(moved).map(|(gap, moved)| gap - moved).collect();
        Ok(Shapes { model, closed, of_nodes, axes, forces: answer.multiplier().to_vec(), gaps })
    }

    fn mass(&self) -> f64 {
        self.model.parts_of_whole() * self.of_nodes.iter().sum::<f64>()
    }

    /// A mode with this vector and these forces of the rows; its frequencies are left at zero.
    fn mode(&self, vector: &[f64], forces: &[f64]) -> Result<Mode, Error> {
        let model = self.model;
        let displacement = model.nodal_velocity(vector)?;
        let dimension = model.body().dimension();
        let along = |axis: usize| {
            let of_node = |(mass, moved): (&f64, &[f64])| mass * moved[axis];
            let sum: f64 = self.of_nodes.iter().zip(displacement.chunks(dimension)).map(of_node).sum();
            if self.axes[axis] { model.parts_of_whole().sqrt() * sum } else { 0.0 }
        };
        let participation: Vec<f64> = (0..dimension).map(along).collect();
        let largest = largest(&displacement, dimension);
        let moved = model.problem().contact().mul(vector);
        let rows = 0..model.rows().len();
        let (closed, open): (Vec<usize>, Vec<usize>) = rows.partition(|row| self.closed.binary_search(row).is_ok());
        Ok(Mode {
            frequency: 0.0,
            frequency_open: None,
            residual: 0.0,
            effective_mass: participation.iter().map(|factor| factor * factor).collect(),
            participation,
            opens: self.first(&closed, |row| self.forces[row].abs(), forces, largest),
            closes: self.first(&open, |row| self.gaps[row].max(0.0), &moved, largest),
            displacement,
        })
    }

    /// The row of which the mode takes up the whole margin first.
    fn first(&self, rows: &[usize], margin: impl Fn(usize) -> f64, change: &[f64], largest: f64) -> Option<Limit> {
        let size = rows.iter().fold(0.0, |size: f64, &row| size.max(change[row].abs()));
        let changing = rows.iter().copied().filter(|&row| change[row].abs() > ROUNDING * size);
        let of_row = |row: usize| (margin(row) / change[row].abs() * largest, row);
        let (amplitude, row) = changing.map(of_row).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let ContactRow { node, obstacle, .. } = self.model.rows()[row];
        Some(Limit { amplitude, row, node, obstacle })
    }
}
