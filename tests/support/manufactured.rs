//! Discretised blocks with an exact solution, and the error of their answers.

use std::time::Instant;

use crate::closed_forms::manufactured::{ContactSolution, PlaneElasticity};
use crate::norms::{ErrorNorms, ExactState, error_norms, error_norms_by};
use signorini::fem::{
    DofMap, ElasticBody, ElementKind, Formulation, Integration, Material, QuadraturePoint, add_body_force_field,
    discretisation_error, free_load, stiffness, stress, tributary_areas,
};
use signorini::scene::{cuboid, rectangle};
use signorini::{ContactProblem, Error, SparseMatrix, solve_qp};

/// The contact pressure at one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodalPressure {
    /// Coordinate of the node on y = 0.
    pub x: f64,
    /// Multiplier divided by tributary area.
    pub ours: f64,
    /// Pressure of the exact solution.
    pub exact: f64,
}

/// A block whose exact solution is known, discretised and solved.
pub struct SolvedBlock<'a> {
    /// Number of free dofs of the block.
    pub unknowns: usize,
    /// The pressure at the contact rows, in increasing x.
    pub pressure: Vec<NodalPressure>,
    /// Time of assembly and solve, in seconds.
    pub seconds: f64,
    exact: &'a dyn ContactSolution,
    body: ElasticBody,
    /// Displacement of all nodes.
    displacement: Vec<f64>,
}

impl SolvedBlock<'_> {
    /// The relative errors of the displacement, to four digits.
    pub fn errors(&self) -> ErrorNorms {
        error_norms(&self.body, &self.displacement, |at| state(self.exact, at))
    }

    /// The relative errors of the displacement, with one quadrature rule for every element.
    pub fn errors_by(&self, rule: &[QuadraturePoint]) -> ErrorNorms {
        error_norms_by(rule, &self.body, &self.displacement, |at| state(self.exact, at))
    }

    /// The relative error in energy, estimated from the stresses without the exact solution.
    ///
    /// # Errors
    /// None for a block made by [`solve_block`].
    pub fn estimated_energy_error(&self) -> Result<f64, Error> {
        Ok(discretisation_error(&self.body, &self.displacement, &stress(&self.body, &self.displacement)?)?)
    }

    /// The largest nodal pressure of the answer, and the largest of the exact solution at the nodes.
    pub fn peak_pressure(&self) -> [f64; 2] {
        let largest = |value: fn(&NodalPressure) -> f64| self.pressure.iter().map(value).fold(0.0, f64::max);
        [largest(|at| at.ours), largest(|at| at.exact)]
    }
}

fn state(exact: &dyn ContactSolution, [x, y, _]: [f64; 3]) -> ExactState {
    let [[xx, xy], [yx, yy]] = exact.gradient([x, y]);
    ExactState { displacement: in_space(exact.displacement([x, y])), strain: [xx, yy, 0.0, (xy + yx) / 2.0, 0.0, 0.0] }
}

fn in_space([x, y]: [f64; 2]) -> [f64; 3] {
    [x, y, 0.0]
}

/// Solves the same problem in space: a plate `[0, 1]^2`, at most four cells thick, whose faces z = const do not move
/// along z. Quadratic faces on y = 0 have contact rows for the coefficients.
///
/// # Errors
/// As [`solve_block`].
pub fn solve_plate(exact: &dyn ContactSolution, kind: ElementKind, cells: usize) -> Result<SolvedBlock<'_>, Error> {
    let clock = Instant::now();
    let PlaneElasticity { lambda, mu } = exact.elasticity();
    let material = Material::new(mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu), lambda / (lambda + mu) / 2.0)?;
    let lines: Vec<f64> = (0..=cells).map(|line| line as f64 / cells as f64).collect();
    let mesh = cuboid(&lines, &lines, &lines[..=cells.min(2)], kind)?;
    let body = ElasticBody::new(mesh, material, Formulation::Space)?;
    let nodes = body.mesh().nodes();
    let depth = lines[cells.min(2)];
    let mut held = vec![None; body.nodal_dofs()];
    for (node, &[x, y, z]) in nodes.iter().enumerate() {
        if z == 0.0 || z == depth {
            held[3 * node + 2] = Some(0.0);
        }
        if x == 0.0 || x == 1.0 || y == 1.0 {
            let at = in_space(exact.displacement([x, y]));
            (0..3).for_each(|axis| held[3 * node + axis] = Some(at[axis]));
        }
    }
    let dofs = DofMap::new(held)?.with_contact_faces(&body, ["front"]);
    let mut load = vec![0.0; body.nodal_dofs()];
    add_body_force_field(&body, |[x, y, _]| in_space(exact.body_force([x, y])), &mut load);

    let (mut entries, mut gap, mut places) = (Vec::new(), Vec::new(), Vec::new());
    let front = body.mesh().boundary("front").map_or_else(Vec::new, |front| tributary_areas(&body, front));
    for (node, area) in dofs.row_areas(&front) {
        if let Some(column) = dofs.number(3 * node + 1) {
            entries.push((gap.len(), column, -1.0));
            gap.push(dofs.coefficient(node, |node| exact.gap(nodes[node][0])));
            places.push((nodes[node][0], area));
        }
    }
    let contact = SparseMatrix::from_triplets(gap.len(), dofs.free().len(), &entries)?;
    let problem = ContactProblem::new(stiffness(&body, &dofs)?, free_load(&body, &dofs, &load)?, contact, gap)?;
    let solution = solve_qp(&problem)?;
    let seconds = clock.elapsed().as_secs_f64();
    let displacement = dofs.expand(&solution.displacement)?;
    let compared =
        |(&(x, area), lambda): (&(f64, f64), &f64)| NodalPressure { x, ours: -lambda / area, exact: exact.pressure(x) };
    let pressure = places.iter().zip(&solution.multiplier).map(compared).collect();
    Ok(SolvedBlock { unknowns: problem.dofs(), pressure, seconds, exact, body, displacement })
}

/// Solves the block `[0, 1]^2` in plane strain with `cells` x `cells` cells and compares the answer with `exact`.
///
/// The exact displacement is prescribed at the nodes of the left, right and upper sides; every other node of y = 0 has
/// a contact row `-u_y <= gap(x)`.
///
/// # Errors
/// [`Error::Fem`] for an element that is not plane or an unsuitable integration, [`Error::Setting`] for invalid
/// elastic constants, and the errors of [`solve_qp`].
pub fn solve_block(
    exact: &dyn ContactSolution,
    kind: ElementKind,
    integration: Integration,
    cells: usize,
) -> Result<SolvedBlock<'_>, Error> {
    let clock = Instant::now();
    let PlaneElasticity { lambda, mu } = exact.elasticity();
    let material = Material::new(mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu), lambda / (lambda + mu) / 2.0)?;
    let lines: Vec<f64> = (0..=cells).map(|line| line as f64 / cells as f64).collect();
    let mesh = rectangle(&lines, &lines, kind)?;
    let formulation = Formulation::PlaneStrain { thickness: 1.0 };
    let body = ElasticBody::new(mesh, material, formulation)?.with_integration(integration)?;
    let dofs =
        DofMap::holding(body.mesh(), &["left", "right", "top"], |[x, y, _]| in_space(exact.displacement([x, y])))?;
    let mut load = vec![0.0; body.nodal_dofs()];
    add_body_force_field(&body, |[x, y, _]| in_space(exact.body_force([x, y])), &mut load);

    let (mut entries, mut gap, mut places) = (Vec::new(), Vec::new(), Vec::new());
    for (node, area) in body.mesh().boundary("bottom").map_or_else(Vec::new, |bottom| tributary_areas(&body, bottom)) {
        if let Some(column) = dofs.number(2 * node + 1) {
            let x = body.mesh().nodes()[node][0];
            entries.push((gap.len(), column, -1.0));
            gap.push(exact.gap(x));
            places.push((x, area));
        }
    }
    let contact = SparseMatrix::from_triplets(gap.len(), dofs.free().len(), &entries)?;
    let problem = ContactProblem::new(stiffness(&body, &dofs)?, free_load(&body, &dofs, &load)?, contact, gap)?;
    let solution = solve_qp(&problem)?;
    let seconds = clock.elapsed().as_secs_f64();

    let displacement = dofs.expand(&solution.displacement)?;
    let compared =
        |(&(x, area), lambda): (&(f64, f64), &f64)| NodalPressure { x, ours: -lambda / area, exact: exact.pressure(x) };
    let pressure = places.iter().zip(&solution.multiplier).map(compared).collect();
    Ok(SolvedBlock { unknowns: problem.dofs(), pressure, seconds, exact, body, displacement })
}
