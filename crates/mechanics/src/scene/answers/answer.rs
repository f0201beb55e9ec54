//! An answer: a model with displacements and multipliers. The results that follow from them are computed once.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use super::deformation;
use crate::error::Error;
use crate::fem::geometry::dot;
use crate::fem::recovery::state::{Deformation, DisplacedState, at_points, nodal_strain, volume_and_energy};
use crate::fem::recovery::{self, StressField};
use crate::scene::Model;
use crate::scene::models::model;
use crate::scene::models::resultants::{self, Resultant, at_node, without_rounding};
use crate::scene::models::rows::ContactRow;
use crate::scene::models::set_up::{self, Forces};
use signorini_qp as qp;
use signorini_qp::{ContactSet, Solution};

/// The sum of all forces is rounding below this share of the diagonal of the stiffness times the displacement.
const ROUNDED: f64 = 16.0 * f64::EPSILON;

/// Displacements, multipliers and closed rows of a model, and the results that follow: stresses, pressures, forces.
/// Stresses and forces are computed on demand, and only once.
#[derive(Clone, Debug)]
pub struct Answer {
    model: Arc<Model>,
    displacement: Vec<f64>,
    /// The solved unknowns of the model: those of the body, then the travels of pressed obstacles.
    unknowns: Vec<f64>,
    /// The travel of each obstacle that a force presses, in length.
    travel: Vec<Option<f64>>,
    multiplier: Vec<f64>,
    /// The multiplier of each equation of a tie, in force, of either sign.
    of_ties: Vec<f64>,
    contact_set: ContactSet,
    pressure: Vec<f64>,
    state: OnceLock<DisplacedState>,
    beyond: OnceLock<Option<String>>,
    forces: OnceLock<Forces>,
    resultants: OnceLock<Vec<Resultant>>,
}

impl Answer {
    /// The answer of a solver, with its displacement, multiplier and closed rows.
    ///
    /// # Errors
    /// [`qp::LinearError::Length`] if it is not an answer to this model; [`Error::BeyondSmallDisplacements`] with the
    /// solution if small displacements do not describe it, unless the scene [is linear](crate::Scene::is_linear).
    pub fn of(model: Arc<Model>, solution: &Solution) -> Result<Self, Error> {
        let answer = Self::of_any_size(model, solution)?;
        match answer.beyond_small_displacements().filter(|_| !answer.model.parts.scene.is_linear) {
            Some(message) => Err(Error::BeyondSmallDisplacements { message, solution: Box::new(solution.clone()) }),
            None => Ok(answer),
        }
    }

    /// The same, also for an answer that small displacements do not describe.
    pub fn of_any_size(model: Arc<Model>, solution: &Solution) -> Result<Self, Error> {
        let multiplier = [solution.multiplier.as_slice(), &solution.equality_multiplier].concat();
        Self::new(model, &solution.displacement, &multiplier, &solution.contact_set)
    }

    /// An answer from the displacement of the free dofs (one entry per free dof, in length) with the multiplier (one
    /// entry per contact row, then one per equation of a tie, in force) and the closed rows.
    pub fn new(
        model: Arc<Model>,
        displacement: &[f64],
        multiplier: &[f64],
        contact_set: &ContactSet,
    ) -> Result<Self, Error> {
        qp::LinearError::check_length("contact set", contact_set.rows(), model.rows().len(), "contact rows")?;
        let ((multiplier, of_ties), obstacles) = (model::split(&model, multiplier)?, 0..model.obstacles().len());
        Ok(Answer {
            displacement: model.nodal_displacement(displacement)?,
            unknowns: displacement.to_vec(),
            travel: obstacles.map(|index| model.travel(displacement, index)).collect::<Result<_, _>>()?,
            pressure: model.pressure(multiplier)?,
            multiplier: multiplier.to_vec(),
            of_ties: of_ties.to_vec(),
            contact_set: contact_set.clone(),
            state: OnceLock::new(),
            beyond: OnceLock::new(),
            forces: OnceLock::new(),
            resultants: OnceLock::new(),
            model,
        })
    }

    /// The answer with its nodes moved by `factor` times a nodal motion (length `dim * n_nodes`, together in length):
    /// the equilibrium at a moment of a vibration. Contact rows, pressures and the values of the unknowns stay.
    pub fn moved_by(&self, motion: &[f64], factor: f64) -> Result<Self, Error> {
        qp::LinearError::check_length("motion", motion.len(), self.displacement.len(), "nodal dofs")?;
        let displacement = self.displacement.iter().zip(motion).map(|(own, moved)| own + factor * moved).collect();
        let (state, beyond, forces, resultants) = (OnceLock::new(), OnceLock::new(), OnceLock::new(), OnceLock::new());
        Ok(Answer { displacement, state, beyond, forces, resultants, ..self.clone() })
    }

    /// The discretised scene to which the answer belongs.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Nodal displacements, length `dim * n_nodes`, order `[u_x0, u_y0, u_x1, ...]`, in length, along the positive
    /// axes.
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// What the elements tell; computed at the first call.
    fn state(&self) -> Result<&DisplacedState, Error> {
        once(&self.state, || set_up::state(&self.model, &self.displacement))
    }

    /// The answer without its stresses, which take more memory than all else; they are computed anew for who asks.
    #[doc(hidden)]
    pub fn without_stress(self) -> Self {
        Answer { state: OnceLock::new(), ..self }
    }

    /// The largest strain and rotation; `None` without elements.
    #[doc(hidden)]
    pub fn deformation(&self) -> Option<Deformation> {
        self.state().ok()?.deformation
    }

    /// A sentence on why small displacements do not describe the answer: strains above 50 % or rotations above 0.5 rad
    /// on more than a thousandth of a body, or a contact row that starts deeper inside its obstacle than its body is
    /// thick; with the place, the likely cause, and what to do. `None` for an answer that they describe.
    pub fn beyond_small_displacements(&self) -> Option<String> {
        let find = || {
            let moved = qp::largest(&self.displacement);
            deformation::beyond_small_displacements(self.deformation()?, &self.model, moved)
        };
        self.beyond.get_or_init(find).clone()
    }

    /// Displacement of an obstacle that a force presses, against its approach direction, in length; `None` for an
    /// obstacle that stands still.
    pub fn travel(&self, obstacle: usize) -> Option<f64> {
        self.travel.get(obstacle).copied().flatten()
    }

    /// The whole shift of an obstacle along its approach direction, in length: the gap of the scene plus its own gap,
    /// minus its travel.
    pub fn shift(&self, obstacle: usize) -> f64 {
        let (own, moved) = (self.model.obstacles()[obstacle].shift(self.model.gap()), self.model.moved_obstacles());
        own + moved.get(obstacle).copied().unwrap_or(0.0) - self.travel(obstacle).unwrap_or(0.0)
    }

    /// The remaining gap at the node of each row, one entry per contact row, in length, `>= 0` up to rounding.
    pub fn remaining_gaps(&self) -> Vec<f64> {
        self.gaps_of(self.model.rows())
    }

    /// The pressure and the remaining gap at the node of each entry of [`Model::rows_across`]: in force per area,
    /// `>= 0`, that of the carrying side opposite to it, and in length, negative where the node went through.
    pub fn across(&self) -> Vec<[f64; 2]> {
        let rows = self.model.rows().iter().zip(&self.pressure);
        let pressures: HashMap<(usize, usize), f64> =
            rows.map(|(row, &pressure)| ((row.obstacle, row.node), pressure)).collect();
        let seen = self.model.rows_across();
        let pressure = |row: &ContactRow| {
            // Nodes without a row share the pressure of their facet.
            let (mut sum, mut shares) = (0.0, 0.0);
            for &(node, share) in &row.ends[1..] {
                if let Some(pressure) = pressures.get(&(row.obstacle, node)) {
                    (sum, shares) = (sum - share * pressure, shares - share);
                }
            }
            if shares > 0.0 { (sum / shares).max(0.0) } else { 0.0 }
        };
        seen.iter().zip(self.gaps_of(seen)).map(|(row, gap)| [pressure(row), gap]).collect()
    }

    fn gaps_of(&self, rows: &[ContactRow]) -> Vec<f64> {
        let dofs = self.model.dofs();
        let moved = |row: &ContactRow| -> f64 {
            let at = |node: usize| dot(at_node(&self.model, &self.displacement, node), row.normal);
            // A mean is one of coefficients.
            let of_node =
                |&(node, share): &(usize, f64)| share * if row.is_mean { dofs.coefficient(node, at) } else { at(node) };
            row.ends.iter().map(of_node).sum()
        };
        let travelled = |row: &ContactRow| {
            let approach = self.model.obstacles()[row.obstacle].approach();
            self.travel(row.obstacle).unwrap_or(0.0) * dot(row.normal, approach)
        };
        rows.iter().map(|row| row.gap - moved(row) - travelled(row)).collect()
    }

    /// The multiplier of each row, one entry per contact row, in force, `<= 0` in compression.
    pub fn multiplier(&self) -> &[f64] {
        &self.multiplier
    }

    #[doc(hidden)]
    pub fn unknowns(&self) -> &[f64] {
        &self.unknowns
    }

    /// The multiplier of each row, and then of each equation of a tie, in force.
    pub(crate) fn all_multipliers(&self) -> Vec<f64> {
        [self.multiplier.as_slice(), &self.of_ties].concat()
    }

    /// Of each reference point the displacements and rotations, and the forces and moments from outside; see
    /// [`ReferencePoints::values`](crate::scene::models::points::ReferencePoints::values).
    pub(crate) fn values_of_points(&self) -> Vec<[[f64; 6]; 2]> {
        let displacement = |node: usize| at_node(&self.model, &self.displacement, node);
        let points = &self.model.parts.conditions.points;
        let mut all = points.values(displacement, &self.model.parts.ties.rows, &self.of_ties);
        for (point, [moved, force]) in points.all.iter().zip(&mut all) {
            if let Some(tie) = point.bolt {
                [moved[0], force[0]] = resultants::of_bolt(&self.model, tie, &self.of_ties, &self.unknowns);
            }
        }
        all
    }

    /// The answer with other multipliers of the rows: only its pressures are computed again.
    pub(crate) fn with_multiplier(&self, multiplier: Vec<f64>) -> Result<Self, Error> {
        let pressure = self.model.pressure(&multiplier)?;
        let (forces, resultants) = (OnceLock::new(), OnceLock::new());
        Ok(Answer { multiplier, pressure, forces, resultants, ..self.clone() })
    }

    /// The contact rows of the model that are closed in the answer.
    pub fn contact_set(&self) -> &ContactSet {
        &self.contact_set
    }

    /// Contact pressure of each row, one entry per contact row, in force per area, `>= 0` in compression.
    pub fn pressure(&self) -> &[f64] {
        &self.pressure
    }

    /// The stress in the displaced body, per element and per node, in force per area, tension positive; computed at the
    /// first call.
    pub fn stress(&self) -> Result<&StressField, Error> {
        Ok(&self.state()?.stress)
    }

    /// The strain at each node, dimensionless tensor components `[xx, yy, zz, xy, yz, zx]`, extension positive, in the
    /// order of the mesh: recovered and averaged as the stress. The expansion by temperature is a part of it.
    pub fn strain(&self) -> Result<Vec<[f64; 6]>, Error> {
        Ok(nodal_strain(self.model.body(), &self.displacement)?)
    }

    /// Strain (dimensionless) and stress (force per area) in some elements of the mesh, numbered from 0, at the points
    /// at which CalculiX prints them, in its order: tensor components `[xx, yy, zz, xy, yz, zx]`, extension and tension
    /// positive.
    pub fn strain_and_stress(&self, elements: &[usize]) -> Result<Vec<Vec<[[f64; 6]; 2]>>, Error> {
        Ok(at_points(self.model.body(), &self.displacement, elements)?)
    }

    /// The volume of each element, and its strain energy, in force times length, in the order of the mesh.
    pub fn volume_and_energy(&self) -> Result<Vec<[f64; 2]>, Error> {
        Ok(volume_and_energy(self.model.body(), &self.displacement)?)
    }

    /// The forces on all nodes by their source; computed at the first call.
    pub fn forces(&self) -> Result<&Forces, Error> {
        once(&self.forces, || {
            set_up::forces(&self.model, &self.displacement, &self.state()?.force, &self.multiplier, &self.of_ties)
        })
    }

    /// The imbalance of all forces, as [`Model::force_balance`]; `None` if all of them are rounding of stiffness times
    /// displacement: there is nothing to balance.
    pub fn balance(&self) -> Result<Option<f64>, Error> {
        let Forces { contact, reactions, springs, rigid_faces, ties, balance } = self.forces()?;
        let all = [contact, reactions, springs, rigid_faces, ties].into_iter().flatten();
        let size: f64 = all.chain(self.model.nodal_load()).map(|force| force.abs()).sum();
        let stiffness = self.model.problem().stiffness().diagonal();
        let moved: f64 = stiffness.iter().zip(&self.unknowns).map(|(k, u)| (k * u).abs()).sum();
        Ok((size > ROUNDED * moved).then_some(*balance))
    }

    /// The resultants of contact forces, support reactions and loads: obstacle by obstacle, support by support.
    pub fn resultants(&self) -> Result<&[Resultant], Error> {
        let found = once(&self.resultants, || {
            let mut all = self.model.contact_resultants(&self.multiplier)?;
            all.iter_mut().zip(&self.travel).for_each(|(resultant, travel)| resultant.travel = *travel);
            let reactions = &self.forces()?.reactions;
            all.extend(resultants::support_resultants(&self.model, |node| at_node(&self.model, reactions, node)));
            all.extend(resultants::spring_resultants(&self.model, &self.displacement));
            all.extend(resultants::face_resultants(&self.model, &self.forces()?.rigid_faces, &self.unknowns)?);
            let ties = resultants::tie_resultants(&self.model, &self.displacement, &self.of_ties, &self.unknowns);
            let points = resultants::point_resultants(&self.model, &self.values_of_points(), &ties);
            all.extend(ties.into_iter().chain(points));
            all.extend(resultants::load_resultant(&self.model));
            without_rounding(&mut all);
            Ok(all)
        });
        found.map(Vec::as_slice)
    }

    /// The discretisation error, relative in energy, estimated from the stress.
    ///
    /// # Source
    /// [`recovery::discretisation_error`].
    pub fn discretisation_error(&self) -> Result<f64, Error> {
        Ok(recovery::discretisation_error(self.model.body(), &self.displacement, self.stress()?)?)
    }

    /// The same, and the strain energy of the meshed part, in force times length.
    pub fn error_and_energy(&self) -> Result<(f64, f64), Error> {
        let estimated = self.estimated_error()?;
        Ok((estimated.relative(), estimated.strain_energy()))
    }

    #[doc(hidden)]
    pub fn estimated_error(&self) -> Result<recovery::patches::EstimatedError, Error> {
        Ok(recovery::patches::EstimatedError::of(self.model.body(), &self.displacement, self.stress()?)?)
    }
}

/// The content of a cell, computed by `find` if the cell is empty.
fn once<T>(cell: &OnceLock<T>, find: impl FnOnce() -> Result<T, Error>) -> Result<&T, Error> {
    match cell.get() {
        Some(found) => Ok(found),
        None => {
            let found = find()?;
            Ok(cell.get_or_init(|| found))
        }
    }
}
