//! Norms of the error against an exact solution: `||u - u_h||` in energy and in L2.

use crate::body::{BodyElement, ElasticBody, Symmetric, trace};
use crate::element::Tabulated;
use crate::error::Error;
use crate::material::Lame;

/// An exact solution at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactState {
    /// Displacement [x, y, z], in length.
    pub displacement: [f64; 3],
    /// Strain [xx, yy, zz, xy, yz, zx], with the tensor's shear components.
    pub strain: Symmetric,
}

/// How far a discrete solution is from the exact one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorNorms {
    /// `sqrt(integral of sigma(e) : eps(e))` over the same of the exact solution.
    pub energy: f64,
    /// `sqrt(integral of e . e)` over the same of the exact solution.
    pub l2: f64,
}

/// The relative errors of the nodal displacement `displacement` (length `dim * n_nodes`) against `exact(point)`, by five
/// quadrature points in each direction of an element.
///
/// Exact where the squares integrated are polynomials of total degree six; approximate elsewhere. The errors are
/// infinite or NaN where the exact solution is zero.
///
/// # Errors
/// [`Error::Length`] where the displacement does not have `dim` entries per node.
///
/// ```
/// use signorini::body::ElasticBody;
/// use signorini::formulation::Formulation;
/// use signorini::material::Material;
/// use signorini::mesh::{ElementKind, rectangle};
/// use signorini::norm::{ExactState, error_norms};
///
/// // u_x = x on one cell; the answer is nine tenths of it at every node.
/// let mesh = rectangle(&[0.0, 1.0], &[0.0, 1.0], ElementKind::Q4)?;
/// let nodal: Vec<f64> = mesh.nodes().iter().flat_map(|at| [0.9 * at[0], 0.0]).collect();
/// let body = ElasticBody::new(mesh, Material::new(1.0, 0.3)?, Formulation::PlaneStrain { thickness: 1.0 })?;
/// let strain = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let errors = error_norms(&body, &nodal, |[x, _, _]| ExactState { displacement: [x, 0.0, 0.0], strain })?;
/// assert!((errors.energy - 0.1).abs() < 1e-14);
/// assert!((errors.l2 - 0.1).abs() < 1e-14);
/// # Ok::<(), signorini::Error>(())
/// ```
pub fn error_norms(
    body: &ElasticBody,
    displacement: &[f64],
    exact: impl Fn([f64; 3]) -> ExactState,
) -> Result<ErrorNorms, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let table = Tabulated::fine(body.mesh().kind().reference());
    let energy_of = |lame: Lame, strain: &Symmetric, dilatation: f64| {
        let stress = body.stress(lame, strain, dilatation);
        let weighted =
            |axis: usize| if axis < 3 { stress[axis] * strain[axis] } else { 2.0 * stress[axis] * strain[axis] };
        (0..6).map(weighted).sum::<f64>()
    };
    let square = |vector: &[f64; 3]| vector.iter().map(|component| component * component).sum::<f64>();
    let (mut energy, mut l2) = ([0.0; 2], [0.0; 2]);
    for BodyElement { nodes, cell, lame } in body.elements() {
        let local = body.gather(displacement, nodes);
        let scale = cell.unit().powi(body.dimension() as i32);
        for at in &table.points {
            let point = body.point(&cell, at);
            let exact = exact(cell.place(&at.shape));
            let strain = point.strain(&local, cell.unit());
            let mut away = exact.displacement;
            for (value, share) in local.iter().zip(at.shape) {
                away.iter_mut().zip(value).for_each(|(away, component)| *away -= share * component);
            }
            let mut difference = exact.strain;
            difference.iter_mut().zip(strain).for_each(|(entry, component)| *entry -= component);
            let weight = point.weight * scale;
            energy[0] += weight * energy_of(lame, &difference, trace(&difference));
            energy[1] += weight * energy_of(lame, &exact.strain, trace(&exact.strain));
            l2[0] += weight * square(&away);
            l2[1] += weight * square(&exact.displacement);
        }
    }
    let ratio = |[error, whole]: [f64; 2]| (error / whole).sqrt();
    Ok(ErrorNorms { energy: ratio(energy), l2: ratio(l2) })
}
