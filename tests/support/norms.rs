//! Norms of the error against an exact solution: `||u - u_h||` in energy and in L2.

use signorini::fem::body::BodyElement;
use signorini::fem::element::{PerKind, ReferenceElement, Shape, Tabulated, gauss_legendre};
use signorini::fem::geometry::{Symmetric, trace};
use signorini::fem::material::Law;
use signorini::fem::{ElasticBody, QuadraturePoint};

/// An exact solution at one point, with which [`error_norms`] compares a discrete one.
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
pub fn error_norms(body: &ElasticBody, displacement: &[f64], exact: impl Fn([f64; 3]) -> ExactState) -> ErrorNorms {
    let squares = Squares { body, displacement, tables: body.tabulated(), exact };
    let tables = per_kind(body, Tabulated::fine);
    let coarse: Vec<Sums> = body.elements().map(|element| squares.over(&element, tables.at(element.kind))).collect();
    let allowed = Sums::total(&coarse).allowed();
    let halves = per_kind(body, |reference| Halves::of(reference, Part::WHOLE, HALVINGS));
    let fine: Vec<Sums> = (body.elements().zip(&coarse))
        .map(|(element, sums)| squares.refined(&element, *sums, halves.at(element.kind), allowed))
        .collect();
    Sums::total(&fine).norms()
}

/// The same with one fixed quadrature rule for elements of one kind, whose integration error is not corrected; the
/// displacement has an entry per nodal dof, in length.
pub fn error_norms_by(
    rule: &[QuadraturePoint],
    body: &ElasticBody,
    displacement: &[f64],
    exact: impl Fn([f64; 3]) -> ExactState,
) -> ErrorNorms {
    let squares = Squares { body, displacement, tables: body.tabulated(), exact };
    let table = Tabulated::with_rule(body.mesh().kind_of(0).reference(), rule.to_vec());
    let of_element = |element: BodyElement| squares.over(&element, &table);
    Sums::total(&body.elements().map(of_element).collect::<Vec<_>>()).norms()
}

fn per_kind<T>(body: &ElasticBody, make: impl Fn(&'static ReferenceElement) -> T) -> PerKind<T> {
    PerKind::of(body.mesh().kinds(), |kind| make(kind.reference()))
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

/// A cube inside [-1, 1]^dimension; repeated halving reaches any point of that cube.
#[derive(Clone, Copy)]
struct Part {
    /// Its lowest corner.
    low: [f64; 3],
    /// The length of its edges.
    size: f64,
}

impl Part {
    const WHOLE: Part = Part { low: [-1.0; 3], size: 2.0 };

    /// Its 2^dimension halves along every axis.
    fn halves(self, dimension: usize) -> impl Iterator<Item = Part> {
        let size = self.size / 2.0;
        (0..1_usize << dimension).map(move |choice| {
            let mut low = self.low;
            (0..dimension).filter(|axis| choice >> axis & 1 == 1).for_each(|axis| low[axis] += size);
            Part { low, size }
        })
    }

    /// Five Gauss points in each direction of the part; on a simplex they are mapped onto the simplex.
    fn table(self, reference: &'static ReferenceElement) -> Tabulated {
        let mut points = vec![QuadraturePoint { at: [0.0; 3], weight: 1.0 }];
        for axis in 0..reference.dimension {
            let along = |start: &QuadraturePoint| {
                let start = *start;
                gauss_legendre(5).map(move |(at, weight)| {
                    let mut next = start;
                    next.at[axis] = self.low[axis] + (1.0 + at) / 2.0 * self.size;
                    next.weight *= weight * self.size / 2.0;
                    next
                })
            };
            points = points.iter().flat_map(along).collect();
        }
        if reference.form == Shape::Simplex {
            points.iter_mut().for_each(|point| onto_simplex(point, reference.dimension));
        }
        Tabulated::with_rule(reference, points)
    }
}

/// Maps a point of the cube onto the simplex: each coordinate takes its share of what the later ones leave.
fn onto_simplex(point: &mut QuadraturePoint, dimension: usize) {
    let mut left = 1.0;
    for axis in (0..dimension).rev() {
        let share = (1.0 + point.at[axis]) / 2.0;
        point.at[axis] = left * share;
        point.weight *= left / 2.0;
        left *= 1.0 - share;
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
        let tables = parts.iter().map(|half| half.table(reference)).collect();
        Halves { parts, tables, left }
    }
}

struct Squares<'a, F> {
    body: &'a ElasticBody,
    displacement: &'a [f64],
    tables: PerKind<Tabulated>,
    exact: F,
}

impl<F: Fn([f64; 3]) -> ExactState> Squares<'_, F> {
    /// The sums over the points of a table of one element.
    fn over(&self, element: &BodyElement, table: &Tabulated) -> Sums {
        let strained = self.body.strained(&self.tables, self.displacement, element);
        let local = self.body.gather(self.displacement, element.nodes);
        let (cell, law) = (&element.cell, &element.phase.law);
        let scale = cell.unit().powi(self.body.dimension() as i32);
        let mut sums = Sums::default();
        for at in &table.points {
            let point = strained.displaced(at);
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
    fn refined(&self, element: &BodyElement, sums: Sums, halves: &Halves, allowed: [f64; 2]) -> Sums {
        let parts = halves.tables.iter().map(|table| self.over(element, table)).collect::<Vec<_>>();
        let total = Sums::total(&parts);
        if halves.left == 0 || !total.away(&sums, allowed) {
            return total;
        }
        let further = |(&half, &sums): (&Part, &Sums)| {
            let halves = Halves::of(element.kind.reference(), half, halves.left - 1);
            self.refined(element, sums, &halves, allowed)
        };
        Sums::total(&halves.parts.iter().zip(&parts).map(further).collect::<Vec<_>>())
    }
}

/// Twice the density of the strain energy at a place, `sigma : eps`.
fn energy(law: &Law, strain: &Symmetric, place: [f64; 3]) -> f64 {
    let stress = law.stress(strain, trace(strain), || place);
    (0..6).map(|axis| if axis < 3 { 1.0 } else { 2.0 } * stress[axis] * strain[axis]).sum()
}
