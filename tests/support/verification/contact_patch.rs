//! GOAL: the contact patch test on distorted meshes: a block pressed onto a frictionless plane is compressed uniformly.
//! CONDITIONS: every element in every formulation; a uniform pressure on the top, rollers at one side or two.
//! REFERENCE: the uniform pressure, and the strains under it by Hooke's law.

use signorini::fem::ElementKind::{self, Hex8, Hex20, Q4, Q8, T3, T6, Tet4, Tet10};
use signorini::fem::{
    DofMap, ElasticBody, Formulation, Integration, Material, Mesh, StressField, add_pressure, free_load, stiffness,
    tributary_areas,
};
use signorini::scene::{cuboid, rectangle};
use signorini::{ContactProblem, Error, SparseMatrix, fem, solve_qp};

use crate::bodies::distort;

const STRAIN: Formulation = Formulation::PlaneStrain { thickness: 0.5 };
const STRESS: Formulation = Formulation::PlaneStress { thickness: 0.5 };
const REVOLVED: Formulation = Formulation::Axisymmetric;
const SPACE: Formulation = Formulation::Space;

/// Every element in every formulation that it supports.
pub const VARIANTS: [(ElementKind, Formulation, Integration); 19] = {
    use Integration::{MeanDilatation, Standard};
    [
        (T3, STRAIN, Standard),
        (Q4, STRAIN, Standard),
        (Q4, STRAIN, MeanDilatation),
        (T6, STRAIN, Standard),
        (Q8, STRAIN, Standard),
        (T3, STRESS, Standard),
        (Q4, STRESS, Standard),
        (T6, STRESS, Standard),
        (Q8, STRESS, Standard),
        (T3, REVOLVED, Standard),
        (Q4, REVOLVED, Standard),
        (Q4, REVOLVED, MeanDilatation),
        (T6, REVOLVED, Standard),
        (Q8, REVOLVED, Standard),
        (Tet4, SPACE, Standard),
        (Hex8, SPACE, Standard),
        (Hex8, SPACE, MeanDilatation),
        (Tet10, SPACE, Standard),
        (Hex20, SPACE, Standard),
    ]
};

/// Largest errors, relative to the exact values, of the pressure and the displacement at all nodes and of the stress
/// everywhere.
pub struct PatchErrors {
    pub unknowns: usize,
    pub pressure: f64,
    pub displacement: f64,
    pub stress: f64,
}

impl PatchErrors {
    pub fn worst(&self) -> f64 {
        self.pressure.max(self.displacement).max(self.stress)
    }
}

/// A block of cells of different sizes whose inner nodes are moved.
fn distorted(kind: ElementKind) -> Result<Mesh, Error> {
    let lines = |size: f64, steps: &[f64]| steps.iter().map(|step| step * size).collect::<Vec<f64>>();
    let (x, y) = (lines(1.0, &[0.0, 0.2, 0.45, 0.7, 1.0]), lines(0.8, &[0.0, 0.3, 0.6, 1.0]));
    let regular = match kind.dimension() {
        2 => rectangle(&x, &y, kind)?,
        _ => cuboid(&x, &y, &lines(0.6, &[0.0, 0.4, 0.7, 1.0]), kind)?,
    };
    // In space the midside nodes move independently, so that edges are curved.
    Ok(distort(
        &regular,
        match (kind.dimension(), kind.is_quadratic()) {
            (2, _) => [0.04, 0.04, 0.0],
            (_, false) => [0.04, 0.04, 0.03],
            (_, true) => [0.01, 0.01, 0.008],
        },
    ))
}

/// Returns the largest difference from the normal stresses `exact` and zero shear stresses.
fn stress_error(stresses: &StressField, exact: [f64; 3]) -> f64 {
    let mut worst: f64 = 0.0;
    for found in stresses.elements.iter().chain(&stresses.nodes) {
        let normal = [found.sigma_xx, found.sigma_yy, found.sigma_zz];
        let shear = [found.sigma_xy, found.sigma_yz, found.sigma_zx];
        let differences = normal.iter().zip(&exact).map(|(value, exact)| value - exact).chain(shear);
        worst = differences.fold(worst, |worst, value| worst.max(value.abs()));
    }
    worst
}

/// Solves the patch test: a pressure of 300 acts on the top; rollers guide the left side (and in space the front); all
/// other sides are free.
pub fn contact_patch(
    kind: ElementKind,
    formulation: Formulation,
    integration: Integration,
) -> Result<PatchErrors, Error> {
    let (young, nu, pressure) = (2e5, 0.3, 300.0);
    let body =
        ElasticBody::new(distorted(kind)?, Material::new(young, nu)?, formulation)?.with_integration(integration)?;
    let (mesh, dimension) = (body.mesh(), body.dimension());
    let down = dimension - 1;
    let nodes_of = |name: &str| mesh.boundary(name).map_or_else(Vec::new, |boundary| boundary.nodes());

    let mut held = vec![None; body.nodal_dofs()];
    nodes_of("left").iter().for_each(|node| held[dimension * node] = Some(0.0));
    nodes_of("front").iter().for_each(|node| held[dimension * node + 1] = Some(0.0));
    let dofs = DofMap::new(held)?.with_contact_faces(&body, ["bottom"]);
    let mut load = vec![0.0; body.nodal_dofs()];
    if let Some(top) = mesh.boundary("top") {
        add_pressure(&body, top, pressure, &mut load);
    }
    let areas = mesh.boundary("bottom").map_or_else(Vec::new, |bottom| dofs.row_areas(&tributary_areas(&body, bottom)));
    let column = |&(node, _): &(usize, f64)| dofs.number(dimension * node + down);
    let entries: Vec<_> =
        areas.iter().filter_map(column).enumerate().map(|(row, column)| (row, column, -1.0)).collect();
    let contact = SparseMatrix::from_triplets(entries.len(), dofs.free().len(), &entries)?;
    let gap = vec![0.0; entries.len()];
    let problem = ContactProblem::new(stiffness(&body, &dofs)?, free_load(&body, &dofs, &load)?, contact, gap)?;
    let solution = solve_qp(&problem)?;

    // Plane strain is stiffer, because the strain across the plane is zero.
    let confined = matches!(formulation, Formulation::PlaneStrain { .. });
    let [along, across] = if confined { [1.0 - nu * nu, nu * (1.0 + nu)] } else { [1.0, nu] };
    let nodal = dofs.expand(&solution.displacement)?;
    let strain = |axis: usize| if axis == down { -along * pressure / young } else { across * pressure / young };
    let mut displacement: f64 = 0.0;
    for (node, at) in mesh.nodes().iter().enumerate() {
        for axis in 0..dimension {
            displacement = displacement.max((nodal[dimension * node + axis] - strain(axis) * at[axis]).abs());
        }
    }
    let total: f64 = areas.iter().map(|(_, area)| area).sum();
    let forces = areas.iter().zip(&solution.multiplier);
    // The end of a quadratic edge on the axis has no area, so that forces are compared, relative to the mean force.
    let off = forces.map(|((_, area), lambda)| (lambda + pressure * area).abs()).fold(0.0, f64::max);
    let mut exact = [0.0, 0.0, if confined { -nu * pressure } else { 0.0 }];
    exact[down] = -pressure;
    let stress = stress_error(&fem::stress(&body, &nodal)?, exact);
    Ok(PatchErrors {
        unknowns: problem.dofs(),
        pressure: off / (pressure * total / areas.len() as f64),
        displacement: displacement / (pressure / young),
        stress: stress / pressure,
    })
}
