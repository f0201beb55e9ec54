//! The motion of a scene: mass, scheme, step, initial state, loads in time.

use std::sync::Arc;

use super::moving_supports::{MovingSupports, NodalLoads, loads_in_time};
use crate::error::{Error, nearly};
use crate::fem::Formulation;
use crate::fem::assembly::{MassForm, free_mass, internal_force, least_over_lumped, stiffness_on};
use crate::fem::body::{ElasticBody, Phase};
use crate::fem::geometry::minus;
use crate::motion::{DynamicProblem, Integrator, MOST_IN_CONTACT, Scheme, SchemeSpec, TimeFunction, frequency_bound};
use crate::scene::input::entry::{COORDINATE_ROUNDING, finite, located, number, point, refused, vector, wrong};
use crate::scene::input::schema::analysis::PATH;
use crate::scene::input::schema::{DynamicSpec, FieldSpec, PenetrationSpec, Scene};
use crate::scene::models::model::row_shifts;
use crate::scene::models::resultants::{self, at_node, without_rounding};
use crate::scene::models::set_up::{mass_of_nodes, mass_of_unknowns};
use crate::scene::{Model, Resultant, Warning, WatchedPoint};
use signorini_qp as qp;
use signorini_qp::{ContactProblem, Method, Settings, SymmetricMatrix, dot, solve};

/// Steps and durations that differ by less than this, relative, are equal up to rounding.
const STEP_ROUNDING: f64 = 1e-12;

/// Largest number of steps: no run would end within reasonable time.
const MOST_STEPS: f64 = 1e9;

/// Largest number of states that are written.
const MOST_FRAMES: usize = 10_000;

/// The default steps, in the time of a wave through the smallest cell, and in the largest stable step.
const COURANT: [f64; 2] = [0.5, 0.9];

/// Contact forces are averaged over this share of the time in which a pressure wave crosses the body.
///
/// An impact lasts at least two such times, so this is at most a tenth of an impact: the mean over it reduces the peak
/// of half a sine wave by 0.4 %. The oscillations of a mesh behind a wave front are shorter the finer the cells are,
/// and disappear from this mean; the largest force of a single step contains them.
const WINDOW: f64 = 0.2;

/// The peak of the force is a mean over the time of a wave through this many of the smallest cells: it holds one period
/// of the shortest waves of the mesh, and shrinks with the cells.
const PEAK_CELLS: f64 = 4.0;

/// A motion to be computed: the problem, the scheme, its steps, and the times and points of its output.
#[derive(Clone, Debug)]
pub struct Dynamics {
    /// Mass, damping, loads in time, initial state.
    pub problem: DynamicProblem,
    /// Scheme of time integration, with the value of its parameter.
    pub scheme: Scheme,
    /// Length of every step of the motion, in time, positive.
    pub step: f64,
    /// Number of steps from the start to the end of the motion.
    pub steps: usize,
    /// Number of states to be written, besides the first.
    pub frames: usize,
    /// The two times over which contact forces are averaged, in time: `[0]` a fifth of the time in which a pressure
    /// wave crosses the body along the first contact normal (zero without contact rows), `[1]` that of a wave through
    /// four of the smallest cells, for the peak.
    pub windows: [f64; 2],
    /// Points with output at every step.
    pub watched: Vec<WatchedPoint>,
    supports: MovingSupports,
    #[doc(hidden)]
    pub obstacles: Vec<MovingObstacle>,
    /// Warnings about the scene and the scheme of the motion.
    pub warnings: Vec<Warning>,
}

/// An obstacle that moves along its approach direction, by `shift` times the growth of its factor since the start.
#[derive(Clone, Debug)]
pub struct MovingObstacle {
    obstacle: usize,
    shift: f64,
    factor: TimeFunction,
}

pub(crate) fn dynamics(scene: &Scene, model: &Model) -> Result<Option<Dynamics>, Error> {
    let Some(spec) = scene.dynamic() else { return Ok(None) };
    let (scheme, form) = checked(model, spec)?;
    let path = |index: usize| format!("{PATH}.watch[{index}]");
    let watched = spec.watch.iter().enumerate().map(|(index, spec)| WatchedPoint::new(model, spec, &path(index)));
    let watched = watched.collect::<Result<_, Error>>()?;
    let loads = loads_in_time(scene, model.body(), spec)?;
    let nodal_mass = mass_of_nodes(model, form)?;
    let mass = mass_of_unknowns(model, &nodal_mass)?;
    let moving = moving(model, spec, mass, &loads)?;
    let (moving, obstacles) = spec.with_moving_obstacles(model, moving, scheme)?;
    let mut problem = starting(model, spec, moving)?;
    if scheme.about().uses_frequency {
        problem = problem.bounded_by(largest_frequency(model, form)?);
    }
    let supports = MovingSupports::new(model, &nodal_mass, problem.damping(), &loads)?;
    let (step, steps) = spec.steps(model.body(), &problem, scheme)?;
    let gains = |name: &str| {
        let message = format!(
            "the scheme `{name}` can gain energy at every impact: it is for comparison only; take `fox-goodwin` or \
             `contact-stabilised` for answers"
        );
        Warning::new("gains-energy", message)
    };
    let warnings = scheme.gains_energy().then(|| gains(scheme.name())).into_iter().collect();
    let windows = [WINDOW * crossing_time(model).unwrap_or(0.0), PEAK_CELLS * wave_time(model.body())];
    let frames = spec.frames;
    Ok(Some(Dynamics { problem, scheme, step, steps, frames, windows, watched, supports, obstacles, warnings }))
}

/// The scheme and the form of the mass of a motion that is possible.
fn checked(model: &Model, spec: &DynamicSpec) -> Result<(Scheme, MassForm), Error> {
    let quadratic = model.mesh().kinds().find(|kind| kind.is_quadratic());
    if let Some(kind) = quadratic.filter(|_| !model.dofs().basis.is_nodal()) {
        let message = format!(
            "contact of {} elements is for equilibria only; take {} for a motion",
            kind.name(),
            kind.linear().name()
        );
        return Err(wrong("analysis", message));
    }
    if let Some(row) = model.rows().iter().find(|row| row.is_mean) {
        let message = "the meshes of the two bodies do not match: their rows hold means over several nodes, for which the schemes \
                       cannot share out the mass of the contact; give both boundaries nodes that lie opposite each other for a \
                       motion, or leave the analysis out"
            .into();
        return Err(refused("motion-of-means", format!("obstacles[{}].shape.body", row.obstacle), message));
    }
    let scheme = spec.scheme();
    spec.check_parameters()?;
    scheme.check().map_err(|error| located(error, &format!("{PATH}.")))?;
    if !(spec.duration.is_finite() && spec.duration > 0.0) {
        return Err(not_positive("duration", spec.duration));
    }
    if !(1..=MOST_FRAMES).contains(&spec.frames) {
        let message = format!("{} is not allowed: it must be from 1 to {MOST_FRAMES}", spec.frames);
        return Err(wrong(format!("{PATH}.frames"), message));
    }
    let form = spec.mass.unwrap_or(scheme.mass_form());
    if !scheme.allows(form) {
        let message = match scheme.is_explicit() {
            true => "central differences need a lumped mass",
            false => "a redistributed mass leaves dofs without mass, which only the scheme `midpoint` allows",
        };
        return Err(wrong(format!("{PATH}.mass"), message));
    }
    if scheme.is_unstable_in_contact(form) && !model.rows().is_empty() {
        let message = format!(
            "`{}` leaves mass on the contact nodes, and with the scheme `{}` the energy then grows at impacts: \
             only `redistributed` is allowed, or take the scheme `contact-stabilised`",
            form.word(),
            scheme.name()
        );
        return Err(refused("unstable", format!("{PATH}.mass"), message));
    }
    Ok((scheme, form))
}

/// Mass, damping, loads in time: the motion from rest.
fn moving(
    model: &Model,
    spec: &DynamicSpec,
    mass: SymmetricMatrix,
    loads: &NodalLoads,
) -> Result<DynamicProblem, Error> {
    let (parts, body) = (&model.parts, model.body());
    let of_nodal = |nodal: &[f64]| parts.conditions.dofs.restrict(nodal);
    let changing: Vec<f64> =
        loads.constant.iter().zip(&parts.conditions.load).map(|(constant, all)| constant - all).collect();
    let statics = model.problem();
    let constant = statics.load().iter().zip(of_nodal(&changing)?).map(|(all, changing)| all + changing).collect();
    let statics = statics.with_load(constant)?;
    // The prescribed displacements alone.
    let lifted = model.nodal_displacement(&vec![0.0; statics.dofs()])?;
    let mut forces = parts.spring_forces(&lifted);
    forces.iter_mut().zip(internal_force(body, &lifted)?).for_each(|(spring, internal)| *spring -= internal);
    let energy = -dot(&lifted, &forces) / 2.0;
    let held = of_nodal(&forces)?;
    let mut problem = DynamicProblem::new(statics, mass)?
        .with_damping(spec.damping.mass, spec.damping.stiffness)
        .map_err(|error| match error {
            qp::Error::Linear(qp::LinearError::Setting { name, value, allowed }) => {
                let field = if name == "mass damping" { "mass" } else { "stiffness" };
                let message = format!("{} is not allowed: it must be {allowed}", number(value));
                wrong(format!("{PATH}.damping.{field}"), message)
            }
            other => other.into(),
        })?
        .holding(held, energy);
    for (factor, load) in &loads.changing {
        problem = problem.with_load(factor.clone(), of_nodal(load)?)?;
    }
    Ok(problem)
}

/// The same from the initial state, after a check.
fn starting(model: &Model, spec: &DynamicSpec, problem: DynamicProblem) -> Result<DynamicProblem, Error> {
    let (displacement, velocity) = spec.initial(model.body())?;
    let (mesh, dimension) = (model.mesh(), model.body().dimension());
    for (node, at) in mesh.nodes().iter().enumerate() {
        let on_planes = model.parts.conditions.symmetry.axes_at(at);
        let crosses = |&axis: &usize| {
            let dof = dimension * node + axis;
            on_planes[axis] && (displacement[dof] != 0.0 || velocity[dof] != 0.0)
        };
        if let Some(axis) = (0..dimension).find(crosses) {
            let message = format!(
                "node {node} at {} lies on a plane of symmetry and starts across it, along {}",
                point(&at[..dimension]),
                ["x", "y", "z"][axis]
            );
            return Err(wrong(format!("{PATH}.initial"), message));
        }
    }
    let held = model.dofs().expand(&vec![0.0; model.dofs().count()])?;
    let from_held = |node: usize| minus(at_node(model, &displacement, node), at_node(model, &held, node));
    let mut displacement = model.parts.nearest(from_held, |_| 0.0);
    if let Some(deepest) = deepest(model, &displacement) {
        if spec.initial_penetration == PenetrationSpec::Refuse {
            return Err(deepest);
        }
        let mass = model.mass(MassForm::Lumped)?;
        displacement = projected(model.problem(), mass, &displacement)?;
    }
    let speed = |obstacle: usize| model.obstacles()[obstacle].inertia().map_or(0.0, |inertia| inertia.speed);
    let velocity = model.parts.nearest(|node| at_node(model, &velocity, node), speed);
    let problem = problem.starting_from(displacement, velocity)?;
    let energy = problem.initial_energy();
    if !energy.is_finite() {
        let message = format!("displacements and velocities are too large: their energy is {energy}");
        return Err(wrong(format!("{PATH}.initial"), message));
    }
    Ok(problem)
}

/// A bound on the largest frequency of a model with its mass in this form. Rigid faces only reduce it: it is that of
/// the free dofs.
fn largest_frequency(model: &Model, form: MassForm) -> Result<f64, Error> {
    let parts = &model.parts;
    let lumped = mass_of_nodes(model, MassForm::Lumped)?;
    let of_lumped = match parts.conditions.rigid_faces.is_empty() {
        true => frequency_bound(model.problem().stiffness(), &mass_of_unknowns(model, &lumped)?.diagonal()),
        false => {
            let dofs = parts.conditions.held.dofs(parts.body.mesh())?;
            let stiffness = stiffness_on(&parts.body, &dofs, &parts.conditions.springs)?;
            frequency_bound(&stiffness, &free_mass(&parts.body, &dofs, &lumped)?.diagonal())
        }
    };
    Ok(of_lumped / least_over_lumped(&parts.body, form)?.sqrt())
}

impl Dynamics {
    /// The resultants of contact forces, support reactions and springs of the last step, obstacle by obstacle, then
    /// support by support, then spring by spring. `integrator` moves [`problem`](Self::problem), that of `model`.
    ///
    /// Both are those of the balance that the scheme solved in the step: at its beginning (`fox-goodwin`), at its
    /// middle (`midpoint`, `contact-stabilised`), at its end (`trapezoidal`, `penalty`, `penalty-loop`), `1 + alpha`
    /// times that of the end minus `alpha` times that of the beginning (`hht`), the mean of both ends
    /// (`central-difference`). The reactions on the body are, at supported dofs,
    ///
    /// ```text
    /// R = M a + C v + K u - f(t) - B' lambda
    /// ```
    ///
    /// Schemes of Newmark's kind take the acceleration a at the end of the step, others its mean over the step. So
    /// contact forces, reactions and loads add up to the change of momentum. Before the first step, and between a
    /// resume and the next step, this balance does not exist, and the supports are left out.
    pub fn resultants(&self, model: &Model, integrator: &Integrator) -> Result<Vec<Resultant>, Error> {
        let multiplier = &integrator.state().multiplier;
        let [found, expected] = [integrator.problem(), &self.problem].map(|problem| problem.statics().dofs());
        qp::LinearError::check_length("displacement", found, expected, "free dofs")?;
        let mut all = model.contact_resultants(multiplier)?;
        for (index, resultant) in all.iter_mut().enumerate() {
            resultant.travel = model.travel(&integrator.state().displacement, index)?;
        }
        if let Some(balance) = integrator.balance(&self.supports.around) {
            all.extend(resultants::support_resultants(model, self.supports.reactions(model, balance, multiplier)));
            all.extend(self.spring_resultants(model, integrator)?);
        }
        without_rounding(&mut all);
        Ok(all)
    }

    /// The model with its obstacles where they are at time `time` of the motion.
    pub fn model_at(&self, model: &Arc<Model>, time: f64) -> Result<Arc<Model>, Error> {
        if self.obstacles.is_empty() {
            return Ok(model.clone());
        }
        let mut moved = vec![0.0; model.obstacles().len()];
        for MovingObstacle { obstacle, shift, factor } in &self.obstacles {
            moved[*obstacle] += shift * (factor.at(time) - factor.at(0.0));
        }
        Ok(Arc::new(model.with_moved_obstacles(&moved)?))
    }

    /// The forces of springs, damping included, in the balance of the last step.
    fn spring_resultants(&self, model: &Model, integrator: &Integrator) -> Result<Vec<Resultant>, Error> {
        if model.parts.conditions.springs.is_empty() {
            return Ok(Vec::new());
        }
        let everywhere: Vec<usize> = (0..self.problem.statics().dofs()).collect();
        let Some(balance) = integrator.balance(&everywhere) else { return Ok(Vec::new()) };
        let [_, of_stiffness] = self.problem.damping();
        let nodal = model.nodal_displacement(&balance.displacement)?;
        let damped = model.nodal_velocity(&balance.velocity)?;
        let stretched: Vec<f64> = nodal.iter().zip(damped).map(|(u, v)| u + of_stiffness * v).collect();
        Ok(resultants::spring_resultants(model, &stretched))
    }
}

impl DynamicSpec {
    /// The scheme with its parameter.
    pub fn scheme(&self) -> Scheme {
        let own = self.scheme.parameter().map(|parameter| parameter.name);
        let given = self.parameters().into_iter().find(|(name, _)| Some(*name) == own);
        self.scheme.with(given.and_then(|(_, value)| value))
    }

    /// The same with another scheme, without the parameters that it does not have.
    pub fn with_scheme(mut self, scheme: SchemeSpec) -> Self {
        self.scheme = scheme;
        let own = scheme.parameter().map(|parameter| parameter.name);
        let [alpha, penalty, threshold, restitution] =
            self.parameters().map(|(name, value)| value.filter(|_| Some(name) == own));
        (self.alpha, self.penalty, self.threshold, self.restitution) = (alpha, penalty, threshold, restitution);
        self
    }

    fn parameters(&self) -> [(&'static str, Option<f64>); 4] {
        [
            ("alpha", self.alpha),
            ("penalty", self.penalty),
            ("threshold", self.threshold),
            ("restitution", self.restitution),
        ]
    }

    /// Refuses a parameter that is given but belongs to another scheme.
    fn check_parameters(&self) -> Result<(), Error> {
        let named = |scheme: SchemeSpec, name| scheme.parameter().is_some_and(|parameter| parameter.name == name);
        for (name, value) in self.parameters() {
            if value.is_none() || named(self.scheme, name) {
                continue;
            }
            let others = SchemeSpec::ALL.into_iter().filter(|&scheme| named(scheme, name));
            let others: Vec<String> = others.map(|scheme| format!("`{}`", scheme.name())).collect();
            let message =
                format!("only the scheme {} has this key; the scheme is `{}`", others.join(" or "), self.scheme.name());
            return Err(wrong(format!("{PATH}.{name}"), message));
        }
        Ok(())
    }

    /// The motion with the obstacles that move in time.
    fn with_moving_obstacles(
        &self,
        model: &Model,
        mut problem: DynamicProblem,
        scheme: Scheme,
    ) -> Result<(DynamicProblem, Vec<MovingObstacle>), Error> {
        let mut found = Vec::new();
        for (index, moving) in self.obstacles_in_time.iter().enumerate() {
            let path = format!("{PATH}.obstacles-in-time[{index}]");
            let Some(obstacle) = model.obstacles().get(moving.obstacle) else {
                let count = model.obstacles().len();
                let message = format!(
                    "there is no obstacles[{}]; the scene has {count} obstacles, counted from 0",
                    moving.obstacle
                );
                return Err(wrong(format!("{path}.obstacle"), message));
            };
            let own = match (obstacle.rigid(), obstacle.has_travel()) {
                (None, _) => Some("another body moves by its own loads and supports"),
                (_, true) => Some("an obstacle with a `mass` moves by its own inertia and force"),
                _ => None,
            };
            if let Some(message) = own {
                return Err(wrong(format!("{path}.obstacle"), message));
            }
            if !scheme.about().follows_obstacles {
                let message = format!("the scheme `{}` has obstacles at rest only; take `fox-goodwin`", scheme.name());
                return Err(wrong(path, message));
            }
            finite(format!("{path}.shift"), moving.shift)?;
            let (factor, shifts) = (moving.factor.function(&path)?, row_shifts(model, moving.obstacle, moving.shift));
            problem = problem.with_moving_gaps(factor.clone(), shifts)?;
            found.push(MovingObstacle { obstacle: moving.obstacle, shift: moving.shift, factor });
        }
        Ok((problem, found))
    }

    fn steps(&self, body: &ElasticBody, problem: &DynamicProblem, scheme: Scheme) -> Result<(f64, usize), Error> {
        let stable = if scheme.is_explicit() { Some(problem.stable_step()?) } else { None };
        let share = if problem.statics().rows() > 0 { MOST_IN_CONTACT } else { 1.0 };
        // The step at which the scheme moves a bar exactly, whatever the scene asks for.
        let is_bar = matches!(body.formulation(), Formulation::Bar { .. });
        let exact = (scheme.about().is_exact_in_bars && is_bar).then(|| wave_time(body));
        let step = match (self.step, self.courant) {
            (Some(_), Some(_)) => return Err(wrong(format!("{PATH}.courant"), "give `step` or `courant`, not both")),
            (Some(step), None) => {
                if !(step.is_finite() && step > 0.0) {
                    return Err(not_positive("step", step));
                }
                if let Some(stable) = stable.filter(|stable| step > share * stable * (1.0 + STEP_ROUNDING)) {
                    let [step, most, stable] = [step, share * stable, stable].map(number);
                    let message = format!(
                        "{step} is beyond {most}: central differences are unstable beyond {share} times {stable}, the largest \
                         stable step of a body that touches nothing"
                    );
                    return Err(refused("unstable", format!("{PATH}.step"), message));
                }
                if step > self.duration * (1.0 + STEP_ROUNDING) {
                    let message = format!("{} is longer than the duration {}", number(step), number(self.duration));
                    return Err(wrong(format!("{PATH}.step"), message));
                }
                step
            }
            (None, courant) => {
                let courant = courant.unwrap_or(COURANT[usize::from(scheme.is_explicit())]);
                if !(courant.is_finite() && courant > 0.0) {
                    return Err(not_positive("courant", courant));
                }
                if scheme.is_explicit() && courant > share {
                    let message =
                        format!("{} is not allowed: at most {share}, or the motion is unstable", number(courant));
                    return Err(refused("unstable", format!("{PATH}.courant"), message));
                }
                let unit = stable.unwrap_or_else(|| wave_time(body));
                // Independent of the duration: a run can then be continued to a longer one.
                (courant * unit).min(self.duration)
            }
        };
        let count = |step: f64| (self.duration / step * (1.0 - STEP_ROUNDING)).ceil();
        let checked = |step: f64| match count(step) > MOST_STEPS {
            false => Ok(step),
            true => {
                let message = format!("{:.2e} steps of {} are too many; take a longer step", count(step), number(step));
                Err(wrong(format!("{PATH}.step"), message))
            }
        };
        let step = checked(step)?;
        let exact = exact.filter(|step| step.is_finite());
        let step = checked(exact.map_or(step, |exact| exact.min(self.duration)))?;
        Ok((step, (count(step) as usize).max(1)))
    }

    fn initial(&self, body: &ElasticBody) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let dimension = body.dimension();
        let (mut displacement, mut velocity) = (vec![0.0; body.nodal_dofs()], vec![0.0; body.nodal_dofs()]);
        for (index, initial) in self.initial.iter().enumerate() {
            let path = format!("{PATH}.initial[{index}]");
            let nodes = match &initial.body {
                None => 0..body.mesh().nodes().len(),
                Some(name) => {
                    let region = body.regions().iter().find(|region| region.name() == name && !name.is_empty());
                    let missing = || {
                        let meant = nearly(name, body.regions().iter().map(|region| region.name()));
                        wrong(format!("{path}.body"), format!("there is no further body `{name}`{meant}"))
                    };
                    region.ok_or_else(missing)?.nodes()
                }
            };
            let fields = [
                (&initial.displacement, "displacement", &mut displacement),
                (&initial.velocity, "velocity", &mut velocity),
            ];
            for (field, name, values) in fields {
                let Some(field) = field else { continue };
                let field = field.linear(&format!("{path}.{name}"), dimension)?;
                for node in nodes.clone() {
                    let value = field(body.mesh().nodes()[node]);
                    values[dimension * node..dimension * (node + 1)].copy_from_slice(&value[..dimension]);
                }
            }
        }
        Ok((displacement, velocity))
    }
}

impl FieldSpec {
    /// The field as a function of the point.
    fn linear(&self, path: &str, dimension: usize) -> Result<impl Fn([f64; 3]) -> [f64; 3] + use<>, Error> {
        let value = vector(&format!("{path}.value"), &self.value, dimension)?;
        let mut gradient = [[0.0; 3]; 3];
        if !self.gradient.is_empty() {
            if self.gradient.len() != dimension {
                let message = format!("the array has {} rows; in this model it has {dimension}", self.gradient.len());
                return Err(wrong(format!("{path}.gradient"), message));
            }
            for (index, (row, entries)) in gradient.iter_mut().zip(&self.gradient).enumerate() {
                *row = vector(&format!("{path}.gradient[{index}]"), entries, dimension)?;
            }
        }
        Ok(move |at: [f64; 3]| [0, 1, 2].map(|axis| value[axis] + dot(&gradient[axis], &at)))
    }
}

fn not_positive(field: &str, value: f64) -> Error {
    let message = format!("{} is not allowed: it must be positive and finite", number(value));
    wrong(format!("{PATH}.{field}"), message)
}

/// The shortest time of a pressure wave from one node of an element to another.
fn wave_time(body: &ElasticBody) -> f64 {
    let nodes = body.mesh().nodes();
    let away = |a: usize, b: usize| (0..3).map(|axis| (nodes[a][axis] - nodes[b][axis]).powi(2)).sum::<f64>();
    let mut squares = vec![f64::INFINITY; body.phases().len()];
    for element in body.elements() {
        let around = element.nodes;
        let pairs = around.iter().enumerate().flat_map(|(k, &a)| around[..k].iter().map(move |&b| (a, b)));
        let least = &mut squares[element.phase_number as usize];
        *least = pairs.fold(*least, |least, (a, b)| least.min(away(a, b)));
    }
    let times = squares.iter().zip(body.phases()).map(|(square, phase)| square.sqrt() / wave_speed(phase));
    times.fold(f64::INFINITY, f64::min)
}

/// The speed of pressure waves in a phase with a density, in length over time.
fn wave_speed(phase: &Phase) -> f64 {
    (phase.law.wave_modulus() / phase.material().density().unwrap_or(f64::NAN)).sqrt()
}

/// The time in which a pressure wave crosses the body behind the row with the smallest gap, along its normal; for
/// several obstacles the shortest, for several materials that of the fastest. `None` without contact rows.
fn crossing_time(model: &Model) -> Option<f64> {
    let (body, nodes) = (model.body(), model.mesh().nodes());
    let of_obstacle = (0..model.obstacles().len()).filter_map(|obstacle| {
        let rows = model.rows().iter().filter(|row| row.obstacle == obstacle);
        let nearest = rows.min_by(|a, b| a.gap.total_cmp(&b.gap))?;
        let region = &body.regions()[body.region_at(nearest.node)?];
        let along = region.nodes().map(|node| dot(&nearest.normal, &nodes[node]));
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        Some((high - low) / body.phases_of(region).iter().map(wave_speed).fold(0.0, f64::max))
    });
    of_obstacle.reduce(f64::min)
}

/// The error of the deepest initial penetration, if there is one.
fn deepest(model: &Model, displacement: &[f64]) -> Option<Error> {
    let violation = model.problem().violation(displacement);
    let (row, depth) = violation.into_iter().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    if depth <= COORDINATE_ROUNDING * model.mesh().size() {
        return None;
    }
    let row = &model.rows()[row];
    let at = point(&model.mesh().nodes()[row.node][..model.mesh().dimension()]);
    let message = format!(
        "node {} at {at} starts {depth:.3e} inside obstacles[{}]; lift the body, move the obstacle, or set \
         `initial-penetration` to `project`",
        row.node, row.obstacle
    );
    Some(wrong(format!("{PATH}.initial"), message))
}

/// The admissible displacement nearest to a given one in the norm of a mass.
fn projected(problem: &ContactProblem, mass: SymmetricMatrix, displacement: &[f64]) -> Result<Vec<f64>, Error> {
    let load = mass.mul(displacement);
    let nearest = ContactProblem::new(mass, load, problem.contact().clone(), problem.gap().to_vec())?;
    Ok(solve(&nearest, &Settings::with_method(Method::ActiveSet))?.displacement)
}
