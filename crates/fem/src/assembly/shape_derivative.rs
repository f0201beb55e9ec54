//! Derivatives with respect to the places of all nodes: of the virtual work of stresses and of body forces.
//!
//! Every function adds to `gradient` (length `dim * n_nodes`, order `[x_0, y_0, x_1, ...]`) the change of a virtual
//! work, in force times length, with each coordinate, in length; the nodal values of all fields stay as they are. They
//! are derivatives of the sums over quadrature points themselves, so that nothing but rounding separates them from
//! differences of these sums.
//!
//! A node that moves along V = N_a e_k changes the volume by div V, the gradient of a field u by `- grad u grad V`, and
//! in a body of revolution the radius by V_r: volumes and hoop strains take part.

use std::ops::Range;

use super::load::{FacetPoint, Kinks, for_each_fine_point, for_each_point};
use crate::body::{BodyElement, ElasticBody, Integration, LocalPoint};
use crate::element::{MAX_NODES, PerKind, PerNode, Tabulated, TabulatedPoint};
use crate::error::Error;
use crate::geometry::{COORDINATES, Symmetric, dot, minus, shifted, trace};
use crate::material::{Stiffness, engineering};
use crate::mesh::Boundary;
use crate::threads::in_order;

/// A tensor: row, column.
type Tensor = [[f64; 3]; 3];

/// Adds the change of the work `virtual_displacement . internal_force(displacement)`, both nodal vectors of length
/// `dim * n_nodes`, in length.
///
/// With the stress sigma of u, the stress tau of w without own stress, and the work sigma : eps(w) per volume it is the
/// integral of `M : grad V`, M = (sigma : eps(w)) I - (grad w)' sigma - (grad u)' tau. With mean dilatation theta, the
/// work has theta(u) and theta(w) in place of both traces. A temperature that changes along the body adds the change of
/// its stress.
///
/// # Errors
/// Why there is no derivative: a material whose axes turn around a line.
pub fn internal_work_by_places(
    body: &ElasticBody,
    displacement: &[f64],
    virtual_displacement: &[f64],
    gradient: &mut [f64],
) -> Result<(), String> {
    if body.phases().iter().any(|phase| phase.law.turns()) {
        return Err(
            "the axes of a material turn around a line, so that its stiffness depends on the places of nodes; \
                    this derivative is not available yet"
                .into(),
        );
    }
    let tables = body.tabulated();
    let fields = [displacement, virtual_displacement];
    let of_element = |index: usize| match body.element(index) {
        Some(element) => of_stresses(body, &tables, &element, fields),
        None => [[0.0; 3]; MAX_NODES],
    };
    let of_run = |run: Range<usize>| (run.start, run.map(of_element).collect::<Vec<_>>());
    in_order(body.mesh().element_count(), of_run, |(first, of_elements)| {
        for (index, of_nodes) in of_elements.iter().enumerate() {
            add(body, body.mesh().element(first + index), of_nodes, gradient);
        }
    });
    Ok(())
}

/// The change of the virtual work of the stresses of an element with the places of its nodes.
fn of_stresses(
    body: &ElasticBody,
    tables: &PerKind<Tabulated>,
    element: &BodyElement,
    fields: [&[f64]; 2],
) -> PerNode<[f64; 3]> {
    let (cell, unit) = (&element.cell, element.cell.unit());
    let scale = unit.powi(body.dimension() as i32 - 1);
    let [moved, virtually] = fields.map(|field| body.strained(tables, field, element));
    let lambda = match (&element.phase.law.stiffness, element.phase.integration) {
        (Stiffness::Isotropic(lame), Integration::MeanDilatation) => lame.lambda,
        _ => 0.0,
    };
    let [mean, virtual_mean] = [&moved, &virtually].map(|field| field.mean_dilatation().unwrap_or(0.0));
    let mut of_nodes = [[0.0; 3]; MAX_NODES];
    for at in &tables.at(element.kind).points {
        let (point, [u, w]) = (body.point(cell, at), [&moved, &virtually].map(|field| field.elastic(at)));
        let mut stress = u.stress;
        if let Some(own) = element.own_stress(at) {
            stress.iter_mut().zip(own).for_each(|(stress, own)| *stress += own);
        }
        // The mean is that of the strain: the volume of each point changes it by as much as its own dilatation is off
        // the mean.
        let work = work(&stress, &w.strain) + lambda * virtual_mean * (trace(&u.strain) - mean);
        let (sigma, tau) = (rows(&stress), rows(&w.stress));
        let energy_momentum = [0, 1, 2].map(|k| {
            [0, 1, 2].map(|j| {
                let turned = (0..3).map(|i| w.slope[i][k] * sigma[i][j] + u.slope[i][k] * tau[i][j]).sum::<f64>();
                if k == j { work - turned } else { 0.0 - turned }
            })
        });
        let hoop = work - stress[2] * w.strain[2] - w.stress[2] * u.strain[2];
        let warming = element.phase.own.as_ref().map_or([0.0; 3], |own| own.work_by_place(&engineering(&w.strain)));
        let weight = point.weight * scale;
        for (local, of_node) in of_nodes.iter_mut().enumerate().take(element.nodes.len()) {
            let moves = energy_momentum.map(|row| dot(row, point.gradients[local]));
            for ((sum, moves), warming) in of_node.iter_mut().zip(moves).zip(warming) {
                *sum += weight * (moves + unit * at.shape[local] * warming);
            }
            of_node[0] += weight * hoop * point.hoop[local];
        }
    }
    of_nodes
}

/// The work of a stress on a strain, per volume.
pub(super) fn work(stress: &Symmetric, strain: &Symmetric) -> f64 {
    stress.iter().zip(engineering(strain)).map(|(stress, strain)| stress * strain).sum()
}

fn rows([xx, yy, zz, xy, yz, zx]: &Symmetric) -> Tensor {
    [[*xx, *xy, *zx], [*xy, *yy, *yz], [*zx, *yz, *zz]]
}

/// A force per volume at a place, and its change with the place: `[i][k]` is that of component i along axis k.
struct ForceAt {
    force: [f64; 3],
    slope: Tensor,
}

/// Adds the change of the work of a constant body force, `virtual_displacement . load` with the load of
/// [`add_body_force`](super::add_body_force).
pub fn body_force_by_places(body: &ElasticBody, force: [f64; 3], virtual_displacement: &[f64], gradient: &mut [f64]) {
    let field = |_, _| ForceAt { force, slope: [[0.0; 3]; 3] };
    force_by_places(body, &body.tabulated(), field, virtual_displacement, gradient);
}

/// The same for the load of [`add_gravity`](super::add_gravity).
pub fn gravity_by_places(
    body: &ElasticBody,
    acceleration: [f64; 3],
    virtual_displacement: &[f64],
    gradient: &mut [f64],
) -> Result<(), Error> {
    let densities = body.densities()?;
    let field = |element: usize, _| {
        let force = acceleration.map(|component| densities[element] * component);
        ForceAt { force, slope: [[0.0; 3]; 3] }
    };
    force_by_places(body, &body.tabulated(), field, virtual_displacement, gradient);
    Ok(())
}

/// The same for the load of [`add_centrifugal`](super::add_centrifugal).
pub fn centrifugal_by_places(
    body: &ElasticBody,
    omega: f64,
    (axis, point): ([f64; 3], [f64; 3]),
    virtual_displacement: &[f64],
    gradient: &mut [f64],
) -> Result<(), Error> {
    let densities = body.densities()?;
    let field = |element: usize, at: [f64; 3]| {
        let factor = densities[element] * omega * omega;
        let slope = [0, 1, 2].map(|i| [0, 1, 2].map(|k| factor * (COORDINATES[i][k] - axis[i] * axis[k])));
        ForceAt { force: slope.map(|row| dot(row, minus(at, point))), slope }
    };
    force_by_places(body, &body.finely_tabulated(), field, virtual_displacement, gradient);
    Ok(())
}

/// Adds the change of the virtual work of the body force `field(element, place)`.
fn force_by_places(
    body: &ElasticBody,
    tables: &PerKind<Tabulated>,
    field: impl Fn(usize, [f64; 3]) -> ForceAt,
    virtual_displacement: &[f64],
    gradient: &mut [f64],
) {
    let work = |index: usize, element: &BodyElement, at: &TabulatedPoint| {
        let ForceAt { force, slope } = field(index, element.cell.place(&at.shape));
        let moved = interpolated(&body.gather(virtual_displacement, element.nodes), &at.shape, element.nodes.len());
        WorkAt { work: dot(force, moved), slope: [0, 1, 2].map(|k| (0..3).map(|i| moved[i] * slope[i][k]).sum()) }
    };
    work_by_places(body, tables, work, gradient);
}

/// Adds the change of [`own_energy`](super::own_energy) with the place of each node, for materials whose axes do not
/// turn.
pub fn own_energy_by_places(body: &ElasticBody, gradient: &mut [f64]) {
    let energy = |_, element: &BodyElement, at: &TabulatedPoint| match (element.own_strain(at), &element.phase.own) {
        (Some([stress, strain]), Some(own)) => {
            WorkAt { work: work(&stress, &strain) / 2.0, slope: own.work_by_place(&engineering(&strain)) }
        }
        _ => WorkAt { work: 0.0, slope: [0.0; 3] },
    };
    work_by_places(body, &body.tabulated(), energy, gradient);
}

/// Work per volume at a point of an element, and its change with the place.
struct WorkAt {
    work: f64,
    slope: [f64; 3],
}

/// Adds the change of the work of the whole body.
fn work_by_places(
    body: &ElasticBody,
    tables: &PerKind<Tabulated>,
    work_at: impl Fn(usize, &BodyElement, &TabulatedPoint) -> WorkAt,
    gradient: &mut [f64],
) {
    for (index, element) in body.elements().enumerate() {
        let (cell, unit) = (&element.cell, element.cell.unit());
        let scale = unit.powi(body.dimension() as i32 - 1);
        let mut of_nodes = [[0.0; 3]; MAX_NODES];
        for at in &tables.at(element.kind).points {
            let point: LocalPoint = body.point(cell, at);
            let WorkAt { work, slope } = work_at(index, &element, at);
            let weight = point.weight * scale;
            for (local, of_node) in of_nodes.iter_mut().enumerate().take(element.nodes.len()) {
                let of_volume = point.gradients[local];
                for ((sum, of_volume), slope) in of_node.iter_mut().zip(of_volume).zip(slope) {
                    *sum += weight * (work * of_volume + unit * at.shape[local] * slope);
                }
                of_node[0] += weight * work * point.hoop[local];
            }
        }
        add(body, element.nodes, &of_nodes, gradient);
    }
}

/// A field at a point of a cell with this number of nodes, from its values there.
pub fn interpolated(values: &PerNode<[f64; 3]>, shape: &PerNode<f64>, nodes: usize) -> [f64; 3] {
    values.iter().zip(shape).take(nodes).fold([0.0; 3], |sum, (&value, share)| shifted(sum, *share, value))
}

pub(super) fn add(body: &ElasticBody, nodes: &[usize], vectors: &PerNode<[f64; 3]>, nodal: &mut [f64]) {
    let dimension = body.dimension();
    for (&node, vector) in nodes.iter().zip(vectors) {
        let own = &mut nodal[dimension * node..dimension * (node + 1)];
        own.iter_mut().zip(vector).for_each(|(sum, part)| *sum += part);
    }
}

#[cfg(test)]
mod tests;

/// The energy that a body held in its undeformed shape has by its temperatures and initial stresses, in force times
/// length.
pub fn own_energy(body: &ElasticBody) -> f64 {
    sum_over_points(body, |_, element, at| {
        element.own_strain(at).map_or(0.0, |[stress, strain]| work(&stress, &strain) / 2.0)
    })
}

/// The change of [`own_energy`] with a parameter; `derivative` is the body of the derivatives of stresses with respect
/// to it.
///
/// With the strain `e = C^-1 sigma_0` it is the integral of `e : d sigma_0 - e : dC : e / 2`.
pub fn own_energy_change(body: &ElasticBody, derivative: &ElasticBody) -> f64 {
    sum_over_points(body, |index, element, at| {
        let (Some([_, strain]), Some(change)) = (element.own_strain(at), derivative.element(index)) else { return 0.0 };
        let of_own = change.own_stress(at).map_or(0.0, |own| work(&own, &strain));
        let stiffer = change.phase.law.stress(&strain, trace(&strain), || element.cell.place(&at.shape));
        of_own - work(&stiffer, &strain) / 2.0
    })
}

/// The integral of a density over the body; zero without own stress.
fn sum_over_points(body: &ElasticBody, density: impl Fn(usize, &BodyElement, &TabulatedPoint) -> f64) -> f64 {
    if !body.has_own_stress() {
        return 0.0;
    }
    let tables = body.tabulated();
    let of_element = |(index, element): (usize, BodyElement)| {
        let points = tables.at(element.kind).points.iter();
        let sum: f64 = points.map(|at| body.point(&element.cell, at).weight * density(index, &element, at)).sum();
        sum * element.cell.unit().powi(body.dimension() as i32)
    };
    body.elements().enumerate().map(of_element).sum()
}

/// A density over a boundary at one of its points, per area, and its change at the same reference coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub struct Density {
    pub value: f64,
    /// With the place of the point, per length.
    pub by_place: [f64; 3],
    /// With the outward unit normal there; the part along the normal does not count.
    pub by_normal: [f64; 3],
}

/// The points at which a boundary is integrated.
#[derive(Clone, Copy, Debug)]
pub enum Points<'a> {
    /// Those of constant tractions, of areas and of foundations.
    Own,
    /// Those of fields: five in each direction of every piece of a facet between kinks.
    Fine(Kinks<'a>),
}

impl Points<'_> {
    fn visit(self, body: &ElasticBody, boundary: &Boundary, visit: &mut dyn FnMut(&FacetPoint)) {
        match self {
            Points::Own => for_each_point(body, boundary, visit),
            Points::Fine(kinks) => for_each_fine_point(body, boundary, kinks, visit),
        }
    }
}

/// The area of a boundary, and the integral of `value` over it.
pub fn area_and_integral(
    body: &ElasticBody,
    boundary: &Boundary,
    points: Points,
    value: impl Fn(&FacetPoint) -> f64,
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    points.visit(body, boundary, &mut |point| {
        sums[0] += point.area;
        sums[1] += point.area * value(point);
    });
    sums
}

/// Adds to `gradient` (length `dim * n_nodes`, order `[x_0, y_0, x_1, ...]`) the change of the integral of a density
/// over a boundary with each coordinate of the nodes, in length.
///
/// It is the derivative of the sum over the points. A density with kinks must be continuous there: a facet is then cut
/// at other reference coordinates when its nodes move, which changes the integral by nothing as long as the pieces are
/// integrated exactly, as those of straight edges, plane triangles and parallelograms are; on other facets it changes
/// it by less than the error of the integral.
pub fn integral_by_places(
    body: &ElasticBody,
    boundary: &Boundary,
    points: Points,
    density: impl Fn(&FacetPoint) -> Density,
    gradient: &mut [f64],
) {
    let by_radius = body.formulation().measure_by_x();
    points.visit(body, boundary, &mut |point| {
        let Density { value, by_place, by_normal } = density(point);
        let (cell, normal) = (point.cell, point.normal);
        let vector = cell.area_vector(point.derivative);
        // The area vector may point inwards.
        let size = dot(vector, normal);
        let (turning, factor) = (value - dot(by_normal, normal), point.area / (size * cell.unit()));
        let along = [0, 1, 2].map(|axis| factor * (by_normal[axis] + turning * normal[axis]));
        let mut of_nodes = cell.area_vector_by_places(point.derivative, along);
        for (of_node, share) in of_nodes.iter_mut().zip(point.shape) {
            of_node.iter_mut().zip(by_place).for_each(|(sum, slope)| *sum += share * point.area * slope);
            of_node[0] += share * point.extent * value * by_radius;
        }
        add(body, point.nodes, &of_nodes, gradient);
    });
}
