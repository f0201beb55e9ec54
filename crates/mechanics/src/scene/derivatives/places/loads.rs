//! The change of the virtual work of loads and springs with the places of nodes.

use crate::error::Error;
use crate::fem::assembly::{
    Density, FacetPoint, Kinks, Points, area_and_integral, body_force_by_places, centrifugal_by_places,
    gravity_by_places, integral_by_places, interpolated, turning_traction,
};
use crate::fem::geometry::{cross, dot, minus};
use crate::fem::{Boundary, ElasticBody};
use crate::scene::Scene;
use crate::scene::input::entry::boundary;
use crate::scene::input::profile::Profile;
use crate::scene::input::schema::Place;
use crate::scene::input::schema::spring::StiffnessOf;
use crate::scene::models::load::Acting;

/// Adds the change of the work of all loads, `virtual_displacement . load`, both nodal vectors. Forces at nodes do not
/// change.
pub(super) fn add_loads(
    scene: &Scene,
    body: &ElasticBody,
    virtual_displacement: &[f64],
    gradient: &mut [f64],
) -> Result<(), Error> {
    for index in 0..scene.loads.len() {
        match scene.acting(body, index)? {
            Acting::AtNodes(_) => {}
            Acting::BodyForce(force) => body_force_by_places(body, force, virtual_displacement, gradient),
            Acting::Gravity(acceleration) => gravity_by_places(body, acceleration, virtual_displacement, gradient)?,
            Acting::Centrifugal { omega, axis } => {
                centrifugal_by_places(body, omega, axis, virtual_displacement, gradient)?;
            }
            Acting::Traction { boundary, traction, profile } => {
                let on = Loaded { body, boundary, virtual_displacement };
                on.add_traction(traction, profile.as_ref(), gradient);
            }
            Acting::Pressure { boundary, pressure, profile } => {
                let on = Loaded { body, boundary, virtual_displacement };
                on.add_pressure(pressure, profile.as_ref(), gradient);
            }
            Acting::Spread { boundary, force } => {
                Loaded { body, boundary, virtual_displacement }.add_spread(force, gradient);
            }
            Acting::Moment { boundary, moment } => {
                Loaded { body, boundary, virtual_displacement }.add_moment(moment, gradient);
            }
        }
    }
    Ok(())
}

/// A boundary under a load, with the virtual displacement of all nodes.
struct Loaded<'a> {
    body: &'a ElasticBody,
    boundary: &'a Boundary,
    virtual_displacement: &'a [f64],
}

impl Loaded<'_> {
    fn moved(&self, point: &FacetPoint) -> [f64; 3] {
        at_point(self.body, self.virtual_displacement, point)
    }

    fn add_traction(&self, traction: [f64; 3], profile: Option<&Profile>, gradient: &mut [f64]) {
        let density = |point: &FacetPoint| {
            let (factor, slope) = factor(profile, point.at);
            let work = dot(traction, self.moved(point));
            Density { value: factor * work, by_place: slope.map(|part| part * work), by_normal: [0.0; 3] }
        };
        integral_by_places(self.body, self.boundary, points(profile), density, gradient);
    }

    fn add_pressure(&self, pressure: f64, profile: Option<&Profile>, gradient: &mut [f64]) {
        let density = |point: &FacetPoint| {
            let (factor, slope) = factor(profile, point.at);
            let moved = self.moved(point);
            let inwards = -pressure * dot(point.normal, moved);
            Density {
                value: factor * inwards,
                by_place: slope.map(|part| part * inwards),
                by_normal: moved.map(|part| -pressure * factor * part),
            }
        };
        integral_by_places(self.body, self.boundary, points(profile), density, gradient);
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
pub(super) fn add_springs(
    scene: &Scene,
    body: &ElasticBody,
    fields: [&[f64]; 2],
    gradient: &mut [f64],
) -> Result<(), Error> {
    for (index, spec) in scene.springs.iter().enumerate() {
        let Some(Place::Boundary(name)) = &spec.on else { continue };
        let path = format!("springs[{index}]");
        let boundary = boundary(body.mesh(), name, &format!("{path}.on.boundary"))?;
        let (along, normal) = spec.per_area(&path, body, boundary)?;
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

/// A nodal field at a point of a facet.
fn at_point(body: &ElasticBody, nodal: &[f64], point: &FacetPoint) -> [f64; 3] {
    interpolated(&body.gather(nodal, point.nodes), &point.shape, point.nodes.len())
}

/// The factor of a profile at a place, and its change with the place.
fn factor(profile: Option<&Profile>, at: [f64; 3]) -> (f64, [f64; 3]) {
    profile.map_or((1.0, [0.0; 3]), |profile| (profile.at(at), profile.by_place(at)))
}

fn points(profile: Option<&Profile>) -> Points<'_> {
    profile.map_or(Points::Own, |profile| Points::Fine(profile.kinks()))
}
