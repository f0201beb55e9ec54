//! The derivative of the conditions of an answer with respect to the places of all nodes.
//!
//! Moving a node changes the stiffness K, the load f, the contact rows B and the gaps g. With the displacement u and
//! the multiplier lambda of an answer, and the solution w, nu of an adjoint problem, a result changes by the change of
//!
//! `R = w . (f - K u + B' lambda) - nu . (g - B u)`
//!
//! with u, lambda, w and nu kept. In nodal terms, prescribed displacements included, with the forces p of loads and s
//! of springs, the internal forces q and the rows b_i . u <= g_i:
//!
//! `R = w . (p + s - q(u)) + sum of lambda_i b_i . w + nu_i (b_i . u - g_i)`.
//!
//! Supports, frames of inclined supports, forces at points, groups of elements and boundaries stay with their nodes. A
//! plane of symmetry and the axis of revolution do too: entries along the normal of such a plane mean something only
//! for motions that keep the end flat. A gap with a corner there counts as that of a symmetric obstacle, which does not
//! change to first order.

mod slopes;
#[cfg(test)]
mod tests;

pub(super) use slopes::Slopes;
use slopes::add_at;
pub(crate) use slopes::{Pairing, add_width, areas_by_places};

use super::effect::{Why, derivative, in_words};
use super::output::{Direct, Smooth, by_component, moment_of, obstacles_of, stress_of};
use crate::error::Error;
use crate::fem::assembly::{
    Density, FacetPoint, Kinks, Points, area_and_integral, body_force_by_places, centrifugal_by_places,
    gravity_by_places, integral_by_places, internal_work_by_places, interpolated, own_energy_by_places,
    turning_traction,
};
use crate::fem::body::BodyElement;
use crate::fem::element::Cell;
use crate::fem::geometry::{COORDINATES, Symmetric, cross, distance, dot, minus};
use crate::fem::{Boundary, ElasticBody};
use crate::scene::answers::answer::Answer;
use crate::scene::input::entry::boundary;
use crate::scene::input::profile::Profile;
use crate::scene::input::schema::tie::StiffnessOf;
use crate::scene::input::schema::{PlaceSpec, SupportSpec, TieSpec};
use crate::scene::models::load::{Acting, acting};
use crate::scene::models::model::{check_multiplier, place};
use crate::scene::models::rows::ContactRow;
use crate::scene::{Model, Scene};

/// The change of R with the place of each node (length `dim * n_nodes`, order `[x_0, y_0, x_1, ...]`), per length.
pub(crate) fn by_places(scene: &Scene, pairing: &Pairing) -> Result<Vec<f64>, String> {
    refused(scene).map_or(Ok(()), Err)?;
    let (answer, model) = (pairing.answer, pairing.answer.model());
    let (body, parts) = (model.body(), &model.parts);
    check_multiplier(model, pairing.forces).map_err(in_words)?;
    let adjoint = parts.conditions.dofs.expand_motion(pairing.adjoint).map_err(in_words)?;
    let mut gradient = vec![0.0; body.nodal_dofs()];
    internal_work_by_places(body, answer.displacement(), &adjoint, &mut gradient)?;
    gradient.iter_mut().for_each(|entry| *entry = 0.0 - *entry);
    add_loads(scene, body, &adjoint, &mut gradient).map_err(in_words)?;
    add_springs(scene, model, [answer.displacement(), &adjoint], &mut gradient).map_err(in_words)?;
    slopes::add(pairing, &adjoint, &mut gradient)?;
    Ok(gradient)
}

/// What depends on the places of nodes beyond elements, loads, springs and rows.
fn refused(scene: &Scene) -> Option<String> {
    let is_moved = |support: &&SupportSpec| {
        let values = [support.x, support.y, support.z, support.value];
        support.profile.is_some() && values.into_iter().flatten().any(|value| value != 0.0)
    };
    let reason = if scene.analysis.is_some() {
        "a motion in time depends on the places of nodes by its mass too; derivatives are those of equilibria"
    } else if !scene.rigid_faces.is_empty() {
        "the motions of rigid faces depend on the places of their nodes; their derivative is not available yet"
    } else if scene.ties.iter().any(|tie| !matches!(tie, TieSpec::Equation(_))) {
        "ties of surfaces and of bolts depend on the places of many nodes; their derivative is not available yet"
    } else if scene.supports.iter().any(|support| is_moved(&support)) {
        "prescribed displacements with a profile depend on the places of their nodes; their derivative is not available yet"
    } else {
        return None;
    };
    Some(reason.into())
}

/// Adds the change of the work of all loads, `virtual_displacement . load`, both nodal vectors. Forces at nodes do not
/// change.
pub(crate) fn add_loads(
    scene: &Scene,
    body: &ElasticBody,
    virtual_displacement: &[f64],
    gradient: &mut [f64],
) -> Result<(), Error> {
    let on = |boundary| Loaded { body, boundary, virtual_displacement };
    for index in 0..scene.loads.len() {
        match acting(scene, body, index)? {
            Acting::AtNodes(_) => {}
            Acting::BodyForce(force) => body_force_by_places(body, force, virtual_displacement, gradient),
            Acting::Gravity(acceleration) => gravity_by_places(body, acceleration, virtual_displacement, gradient)?,
            Acting::Centrifugal { omega, axis } => {
                centrifugal_by_places(body, omega, axis, virtual_displacement, gradient)?;
            }
            Acting::Traction { boundary, traction, profile } => {
                let work = |_: &FacetPoint, moved: [f64; 3]| dot(traction, moved);
                on(boundary).add_profiled(work, 0.0, profile.as_ref(), gradient);
            }
            Acting::Pressure { boundary, pressure, profile } => {
                let work = |point: &FacetPoint, moved: [f64; 3]| -pressure * dot(point.normal, moved);
                on(boundary).add_profiled(work, pressure, profile.as_ref(), gradient);
            }
            Acting::Spread { boundary, force } => on(boundary).add_spread(force, gradient),
            Acting::Moment { boundary, moment } => on(boundary).add_moment(moment, gradient),
        }
    }
    Ok(())
}

struct Loaded<'a> {
    body: &'a ElasticBody,
    boundary: &'a Boundary,
    virtual_displacement: &'a [f64],
}

impl Loaded<'_> {
    fn moved(&self, point: &FacetPoint) -> [f64; 3] {
        at_point(self.body, self.virtual_displacement, point)
    }

    /// The `work` of a traction on a displacement, times the factor of a profile; `pressure` is its part that turns
    /// with the normal.
    fn add_profiled(
        &self,
        work: impl Fn(&FacetPoint, [f64; 3]) -> f64,
        pressure: f64,
        profile: Option<&Profile>,
        gradient: &mut [f64],
    ) {
        let density = |point: &FacetPoint| {
            let (factor, slope) = profile.map_or((1.0, [0.0; 3]), |own| (own.at(point.at), own.by_place(point.at)));
            let moved = self.moved(point);
            let work = work(point, moved);
            Density {
                value: factor * work,
                by_place: slope.map(|part| part * work),
                by_normal: moved.map(|part| -pressure * factor * part),
            }
        };
        let points = profile.map_or(Points::Own, |profile| Points::Fine(profile.kinks()));
        integral_by_places(self.body, self.boundary, points, density, gradient);
    }

    /// The traction is the force over the area, which changes too.
    fn add_spread(&self, force: [f64; 3], gradient: &mut [f64]) {
        let work = |point: &FacetPoint| dot(force, self.moved(point));
        let [area, sum] = area_and_integral(self.body, self.boundary, Points::Own, work);
        let density = |point: &FacetPoint| Density { value: (work(point) - sum / area) / area, ..Density::default() };
        integral_by_places(self.body, self.boundary, Points::Own, density, gradient);
    }

    /// The traction of a moment m is `omega x r`, r = x - c, with `I omega = m` for the moments of inertia I of the
    /// area about its centre c. Its virtual work is `omega . q`, q the moment of w, and changes by w . (omega x dr) at
    /// each place, by `- eta . dI omega` with `I eta = q`, and by `- dc . (W x omega)` with the integral W of w.
    /// Because r integrates to zero, dI is that at a fixed centre.
    fn add_moment(&self, moment: [f64; 3], gradient: &mut [f64]) {
        let points = Points::Fine(Kinks::NONE);
        let sum = |value: &dyn Fn(&FacetPoint) -> f64| area_and_integral(self.body, self.boundary, points, value);
        let Some((omega, centre)) = turning_traction(self.body, self.boundary, moment) else { return };
        let arm = |point: &FacetPoint| minus(point.at, centre);
        let turn = [0, 1, 2].map(|axis| sum(&|point| cross(arm(point), self.moved(point))[axis])[1]);
        let Some((eta, _)) = turning_traction(self.body, self.boundary, turn) else { return };
        let whole = [0, 1, 2].map(|axis| sum(&|point| self.moved(point)[axis])[1]);
        let [area, _] = sum(&|_| 0.0);
        let of_centre = cross(whole, omega).map(|part| part / area);
        let density = |point: &FacetPoint| {
            let (r, moved) = (arm(point), self.moved(point));
            let [both, of_eta, of_omega] = [dot(eta, omega), dot(eta, r), dot(omega, r)];
            let turned = cross(moved, omega);
            let by_place =
                |k: usize| turned[k] - of_centre[k] - 2.0 * both * r[k] + eta[k] * of_omega + omega[k] * of_eta;
            Density {
                value: dot(turned, r) - dot(of_centre, r) - both * dot(r, r) + of_eta * of_omega,
                by_place: [0, 1, 2].map(by_place),
                by_normal: [0.0; 3],
            }
        };
        integral_by_places(self.body, self.boundary, points, density, gradient);
    }
}

/// Adds the change of the work of the forces of all springs at the first of two nodal displacements on the second. Only
/// foundations under boundaries change.
pub(crate) fn add_springs(
    scene: &Scene,
    model: &Model,
    fields: [&[f64]; 2],
    gradient: &mut [f64],
) -> Result<(), Error> {
    let body = model.body();
    for ((index, spec), springs) in scene.springs.iter().enumerate().zip(&model.parts.conditions.springs) {
        let (Some(PlaceSpec::Boundary(name)), Some((along, normal))) = (&spec.on, springs.per_area) else { continue };
        let boundary = boundary(body.mesh(), name, &format!("springs[{index}].on.boundary"))?;
        let density = |point: &FacetPoint| {
            let [u, w] = fields.map(|field| at_point(body, field, point));
            let [of_u, of_w] = [u, w].map(|field| dot(point.normal, field));
            let along: f64 = (0..3).map(|axis| along[axis] * u[axis] * w[axis]).sum();
            let by_normal = [0, 1, 2].map(|axis| 0.0 - normal * (of_u * w[axis] + of_w * u[axis]));
            Density { value: 0.0 - along - normal * of_u * of_w, by_place: [0.0; 3], by_normal }
        };
        // A spring as a whole is shared out over the area, which changes too.
        let mean = match spec.stiffness {
            StiffnessOf::PerArea => 0.0,
            StiffnessOf::Total => {
                let [area, sum] = area_and_integral(body, boundary, Points::Own, |point| density(point).value);
                sum / area
            }
        };
        let density = |point: &FacetPoint| {
            let own = density(point);
            Density { value: own.value - mean, ..own }
        };
        integral_by_places(body, boundary, Points::Own, density, gradient);
    }
    Ok(())
}

fn at_point(body: &ElasticBody, nodal: &[f64], point: &FacetPoint) -> [f64; 3] {
    interpolated(&body.gather(nodal, point.nodes), &point.shape, point.nodes.len())
}

impl Smooth {
    /// The change with the place of each node, length `dim * n_nodes`, per length.
    pub(super) fn direct_by_places(&self, answer: &Answer) -> Result<Vec<f64>, Why> {
        let (model, body) = (answer.model(), answer.model().body());
        let mut gradient = vec![0.0; body.nodal_dofs()];
        match &self.direct {
            Direct::None => {}
            Direct::Width(obstacle) => {
                // The width depends on the pressures, the forces of rows over their areas.
                let rows = model.rows().iter().zip(answer.multiplier()).zip(&self.by_multiplier);
                let weight = |((row, lambda), by_force): ((&ContactRow, &f64), &f64)| match *by_force {
                    0.0 => 0.0,
                    by_force => -by_force * lambda / row.projected_area(),
                };
                gradient = areas_by_places(model, &rows.map(weight).collect::<Vec<f64>>())?;
                for obstacle in obstacles_of(model, *obstacle) {
                    add_width(answer, obstacle, model.parts_of_whole(), &mut gradient)?;
                }
            }
            Direct::Pressure(row) => {
                let mut weights = vec![0.0; model.rows().len()];
                weights[*row] = -self.value / model.rows()[*row].projected_area();
                gradient = areas_by_places(model, &weights)?;
            }
            Direct::Energy => {
                // The mean of the works of the last and of the first internal forces, and the energy before them.
                let displacement = answer.displacement();
                internal_work_by_places(body, displacement, displacement, &mut gradient)?;
                if body.has_own_stress() {
                    internal_work_by_places(body, &vec![0.0; displacement.len()], displacement, &mut gradient)?;
                }
                gradient.iter_mut().for_each(|entry| *entry *= 0.5);
                own_energy_by_places(body, &mut gradient);
                gradient.iter_mut().for_each(|entry| *entry *= model.parts_of_whole());
            }
            Direct::Moment(obstacle, axis) => add_moment(answer, *obstacle, *axis, &mut gradient)?,
            Direct::Stress { element, at, component } => {
                add_stress(answer, (*element, *at, *component), &mut gradient)?
            }
        }
        Ok(gradient)
    }
}

/// Adds the change of the moment `sum of lambda (r x n)` of an obstacle about an axis through the origin: with the
/// places r of rows, which are those of their coefficients, and with normals that turn.
fn add_moment(answer: &Answer, obstacle: usize, axis: usize, gradient: &mut [f64]) -> Result<(), Why> {
    let (model, dimension) = (answer.model(), answer.model().body().dimension());
    let slopes = Slopes::of(model, obstacle);
    let rows = model.rows().iter().zip(answer.multiplier());
    for (row, &lambda) in rows.filter(|(row, lambda)| row.obstacle == obstacle && **lambda != 0.0) {
        let mut add = |node: usize, change: [f64; 3]| add_at(gradient, dimension, node, lambda, change);
        let moment = |at: [f64; 3], force: [f64; 3]| moment_of(model, obstacle, at, force, axis);
        let at_origin = moment([0.0; 3], row.normal);
        let of_place = COORDINATES.map(|direction| moment(direction, row.normal) - at_origin);
        for (node, share) in model.dofs().basis.shares(row.node) {
            add(node, of_place.map(|change| share * change));
        }
        if !slopes.has_fixed_normals() || row.is_mean {
            let place = place(model, row.node);
            add(row.node, slopes.at(row.node)?.of_normal(COORDINATES.map(|force| moment(place, force))));
        }
    }
    Ok(())
}

/// Adds the change of a component of the stress at reference coordinates of an element: the point moves with the
/// element.
fn add_stress(
    answer: &Answer,
    (element, at, component): (usize, [f64; 3], usize),
    gradient: &mut [f64],
) -> Result<(), Why> {
    let body = answer.model().body();
    let dimension = body.dimension();
    let Some(own) = body.element(element) else { return Ok(()) };
    let places: Vec<[f64; 3]> = own.nodes.iter().map(|&node| body.mesh().nodes()[node]).collect();
    let size = places.iter().fold(0.0, |size: f64, &place| size.max(distance(place, places[0])));
    let stress_at = |places: &[[f64; 3]]| -> Symmetric {
        let cell = Cell::at(own.kind.reference(), |local| places[local]);
        stress_of(body, answer.displacement(), &BodyElement { cell, ..own }, at)
    };
    let stress = stress_at(&places);
    for (local, &node) in own.nodes.iter().enumerate() {
        for axis in 0..dimension {
            let moved = |by: f64| {
                let mut moved = places.clone();
                moved[local][axis] += by;
                Ok::<_, Why>(stress_at(&moved).to_vec())
            };
            let change = derivative(moved, size)?.ok_or_else(|| "the stress has no derivative there".to_string())?;
            let change = [0, 1, 2, 3, 4, 5].map(|entry| change[entry]);
            gradient[dimension * node + axis] += by_component(&stress, &change, component);
        }
    }
    Ok(())
}
