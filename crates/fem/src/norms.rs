//! Norms of the error against an exact solution: `||u - u_h||` in energy and in L2.

use crate::body::{BodyElement, ElasticBody};
use crate::element::{Part, PerNode, QuadraturePoint, ReferenceElement, Tabulated};
use crate::error::Error;
use crate::geometry::{Symmetric, trace};
use crate::material::Law;

/// An exact solution at one point, with which [`error_norms`](crate::error_norms) compares a discrete one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactState {
    /// Displacement [x, y, z], in length, along the positive axes; zero beyond the dimension of the model.
    pub displacement: [f64; 3],
    /// Strain [xx, yy, zz, xy, yz, zx], dimensionless, extension positive, with the tensor's shear components (half of
    /// the engineering ones).
    pub strain: Symmetric,
}

/// The error of a discrete solution against the exact one, in two norms, each relative to the norm of the exact
/// solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorNorms {
    /// `sqrt(integral of sigma(e) : eps(e))` over the same of the exact solution.
    pub energy: f64,
    /// `sqrt(integral of e . e)` over the same of the exact solution.
    pub l2: f64,
}

/// A part of a cell is halved further until that changes the total by less than this.
const DIVISION_SHARE: f64 = 1e-5;

/// Relative errors below this are rounding: no cell is divided for them.
const ERROR_ROUNDING: f64 = 1e-12;

/// The most halvings of a cell: at a strain singularity like that of a crack tip, the last part holds 2^-12 of the
/// error.
const HALVINGS: usize = 12;

/// The relative errors of the nodal displacement `displacement` (length `dim * n_nodes`) against `exact(point)`.
///
/// Integrals use five quadrature points in each direction of an element and of its halves along each direction. Parts
/// are halved further as long as the halves change the sum: four digits are correct, also if the exact strain is
/// singular at a point. The errors are infinite or NaN if the exact solution is zero.
///
/// ```
/// use signorini_fem::{ElasticBody, ElementKind, ExactState, Formulation, Material, Mesh, error_norms};
///
/// // u_x = x on one cell; the answer is 0.9 u_x at every node.
/// let nodes = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| [x, y, 0.0]).to_vec();
/// let mesh = Mesh::new(nodes, ElementKind::Q4, vec![0, 1, 2, 3], Vec::new())?;
/// let nodal: Vec<f64> = mesh.nodes().iter().flat_map(|at| [0.9 * at[0], 0.0]).collect();
/// let body = ElasticBody::new(mesh, Material::new(1.0, 0.3)?, Formulation::PlaneStrain { thickness: 1.0 })?;
/// let strain = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let errors = error_norms(&body, &nodal, |[x, _, _]| ExactState { displacement: [x, 0.0, 0.0], strain })?;
/// assert!((errors.energy - 0.1).abs() < 1e-14);
/// assert!((errors.l2 - 0.1).abs() < 1e-14);
/// # Ok::<(), signorini_fem::Error>(())
/// ```
pub fn error_norms(
    body: &ElasticBody,
    displacement: &[f64],
    exact: impl Fn([f64; 3]) -> ExactState,
) -> Result<ErrorNorms, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let squares = Squares { body, exact };
    let tables = body.finely_tabulated();
    let elements = || body.elements().map(|element| (body.gather(displacement, element.nodes), element));
    let coarse: Vec<Sums> =
        elements().map(|(local, element)| squares.over(&element, &local, tables.at(element.kind))).collect();
    let allowed = Sums::total(&coarse).allowed();
    let halves = body.per_kind(|reference| Halves::of(reference, Part::WHOLE, HALVINGS));
    let fine: Vec<Sums> = (elements().zip(&coarse))
        .map(|((local, element), sums)| squares.refined(&element, &local, *sums, halves.at(element.kind), allowed))
        .collect();
    Ok(Sums::total(&fine).norms())
}

/// The same with one fixed quadrature rule for elements of one kind, whose integration error is not corrected; the
/// displacement has an entry per nodal dof, in length.
pub fn error_norms_by(
    rule: &[QuadraturePoint],
    body: &ElasticBody,
    displacement: &[f64],
    exact: impl Fn([f64; 3]) -> ExactState,
) -> Result<ErrorNorms, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let squares = Squares { body, exact };
    let table = Tabulated::with_rule(body.mesh().kind_of(0).reference(), rule.to_vec());
    let of_element = |element: BodyElement| squares.over(&element, &body.gather(displacement, element.nodes), &table);
    Ok(Sums::total(&body.elements().map(of_element).collect::<Vec<_>>()).norms())
}

/// Integrals of squares: of the error and of the exact solution.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    energy: [f64; 2],
    l2: [f64; 2],
}

impl Sums {
    fn plus(self, other: &Sums, factor: f64) -> Sums {
        let add = |a: [f64; 2], b: [f64; 2]| [a[0] + factor * b[0], a[1] + factor * b[1]];
        Sums { energy: add(self.energy, other.energy), l2: add(self.l2, other.l2) }
    }

    fn total(sums: &[Sums]) -> Sums {
        sums.iter().fold(Sums::default(), |total, sums| total.plus(sums, 1.0))
    }

    fn norms(&self) -> ErrorNorms {
        let ratio = |[error, exact]: [f64; 2]| (error / exact).sqrt();
        ErrorNorms { energy: ratio(self.energy), l2: ratio(self.l2) }
    }

    /// The allowed error of a part in the squares of the error: in energy and in L2.
    fn allowed(&self) -> [f64; 2] {
        [self.energy, self.l2].map(|[error, exact]| DIVISION_SHARE * error + ERROR_ROUNDING * ERROR_ROUNDING * exact)
    }

    fn away(&self, other: &Sums, allowed: [f64; 2]) -> bool {
        let off = [self.energy[0] - other.energy[0], self.l2[0] - other.l2[0]];
        off.iter().zip(allowed).any(|(off, allowed)| off.abs() > allowed)
    }
}

/// The halves of a part of the reference cell, and the number of further halvings allowed.
struct Halves {
    parts: Vec<Part>,
    tables: Vec<Tabulated>,
    left: usize,
}

impl Halves {
    fn of(reference: &'static ReferenceElement, part: Part, left: usize) -> Self {
        let parts: Vec<Part> = part.halves(reference.dimension).collect();
        let tables = parts.iter().map(|&half| Tabulated::fine_in(reference, half)).collect();
        Halves { parts, tables, left }
    }
}

struct Squares<'a, F> {
    body: &'a ElasticBody,
    exact: F,
}

impl<F: Fn([f64; 3]) -> ExactState> Squares<'_, F> {
    /// The sums over the points of a table of one element with the given displacements of its nodes.
    fn over(&self, element: &BodyElement, local: &PerNode<[f64; 3]>, table: &Tabulated) -> Sums {
        let (cell, law) = (&element.cell, &element.phase.law);
        let scale = cell.unit().powi(self.body.dimension() as i32);
        let mut sums = Sums::default();
        for at in &table.points {
            let point = self.body.displaced(cell, at, local);
            let place = cell.place(&at.shape);
            let exact = (self.exact)(place);
            let mut away = exact.displacement;
            for (value, share) in local.iter().zip(at.shape) {
                away.iter_mut().zip(value).for_each(|(away, component)| *away -= share * component);
            }
            let mut difference = exact.strain;
            difference.iter_mut().zip(point.strain()).for_each(|(entry, component)| *entry -= component);
            let weight = point.weight * scale;
            let square = |vector: &[f64; 3]| vector.iter().map(|component| component * component).sum::<f64>();
            let here = Sums {
                energy: [energy(law, &difference, place), energy(law, &exact.strain, place)],
                l2: [square(&away), square(&exact.displacement)],
            };
            sums = sums.plus(&here, weight);
        }
        sums
    }

    /// The sums over a part of an element that has `sums` by its own points: those of its halves, halved further if
    /// they differ.
    fn refined(
        &self,
        element: &BodyElement,
        local: &PerNode<[f64; 3]>,
        sums: Sums,
        halves: &Halves,
        allowed: [f64; 2],
    ) -> Sums {
        let parts = halves.tables.iter().map(|table| self.over(element, local, table)).collect::<Vec<_>>();
        let total = Sums::total(&parts);
        if halves.left == 0 || !total.away(&sums, allowed) {
            return total;
        }
        let further = |(&half, &sums): (&Part, &Sums)| {
            let halves = Halves::of(element.kind.reference(), half, halves.left - 1);
            self.refined(element, local, sums, &halves, allowed)
        };
        Sums::total(&halves.parts.iter().zip(&parts).map(further).collect::<Vec<_>>())
    }
}

/// Twice the density of the strain energy at a place, `sigma : eps`.
fn energy(law: &Law, strain: &Symmetric, place: [f64; 3]) -> f64 {
    let stress = law.stress(strain, trace(strain), || place);
    (0..6).map(|axis| if axis < 3 { 1.0 } else { 2.0 } * stress[axis] * strain[axis]).sum()
}
