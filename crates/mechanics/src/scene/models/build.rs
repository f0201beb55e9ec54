//! From a scene to a model: every value is checked at its use, and errors name it by its JSON path. Errors of the
//! solvers in the words of the scene.

use std::sync::Arc;

use super::elastic::{bodies, joined};
use super::held::held;
use super::load::load;
use super::model::{Model, assembled, check_held, matrices};
use super::overlap::with_contacts;
use super::part::with_parts;
use super::parts::{Conditions, Parts};
use super::points::reference_points;
use super::rigid_body_modes::RigidBodyModes;
use super::rigid_face::rigid_faces;
use super::rows;
use super::springs::springs;
use super::suspect::suspect;
use super::symmetry::planes_of_symmetry;
use super::ties::{tied, tied_surfaces};
use super::unknowns::following;
use crate::error::Error;
use crate::fem::assembly::DofMap;
use crate::fem::body::ElasticBody;
use crate::scene::input::entry::{COORDINATE_ROUNDING, number, point, six_digits, wrong};
use crate::scene::input::obstacle::{Obstacle, PlacedObstacle, SideOrder};
use crate::scene::input::parse::{files, with_line};
use crate::scene::input::schema::Scene;
use crate::scene::input::size::check_bodies;
use signorini_qp as qp;

/// The model of a scene whose bodies may take at most `most` bytes, with further obstacles; errors have lines of decks.
pub(crate) fn within(scene: &Scene, most: f64, further: &[Further]) -> Result<Model, Error> {
    let within = |bodies: Vec<_>| check_bodies(&bodies, most).and_then(|()| model_of(scene, bodies, further));
    bodies(scene).and_then(within).map_err(|error| with_line(scene, error))
}

/// An obstacle of a user, after the name of the boundary that may touch it.
type Further<'a> = (&'a str, Arc<dyn Obstacle>);

/// The model of a scene with its bodies, in the order of the scene, on any meshes.
pub fn model_of(scene: &Scene, bodies: Vec<ElasticBody>, further: &[Further]) -> Result<Model, Error> {
    let body = with_parts(scene, joined(scene, bodies)?)?;
    let (scene, body) = with_contacts(scene, body)?;
    let mut conditions = conditions(&scene, &body, further)?;
    let obstacles = placed_obstacles(&scene, &body, &conditions.dofs, further)?;
    let warnings = suspect(&scene, &body, &conditions.dofs)?;
    let pressed = pressed(&scene, &obstacles)?;
    conditions.dofs = conditions.dofs.with_further(pressed.len());
    let ties = tied(&scene, &body, &conditions.dofs, &conditions.points)?;
    let gap = scene.gap;
    let parts = Parts { scene: scene.into_owned(), body, conditions, obstacles, pressed, ties, warnings };
    let rows = rows::build(&parts, gap)?;
    check_held(&parts, &rows)?;
    let matrices = matrices(&parts)?;
    assembled(parts.into(), gap, rows, matrices)
}

fn conditions(scene: &Scene, body: &ElasticBody, further: &[Further]) -> Result<Conditions, Error> {
    let (symmetry, points) = (planes_of_symmetry(scene, body)?, reference_points(scene, body)?);
    let springs = springs(scene, body, &points)?;
    let mut held = held(scene, body)?;
    symmetry.hold(body, &mut held);
    let rigid_faces = rigid_faces(scene, body, &mut held)?;
    let dofs = with_contact_faces(scene, held.dofs(body.mesh())?, body, further);
    let dofs = following(dofs, body, &rigid_faces);
    let mut load = load(scene, body)?;
    points.add_load(&mut load, body.dimension());
    Ok(Conditions { dofs, held, load, springs, symmetry, rigid_faces, points })
}

/// The obstacles with a travel, in order.
fn pressed(scene: &Scene, obstacles: &[PlacedObstacle]) -> Result<Vec<usize>, Error> {
    let pressed: Vec<usize> = (0..obstacles.len()).filter(|&index| obstacles[index].has_travel()).collect();
    for &index in &pressed {
        let (key, message) = match (scene.dynamic().is_some(), obstacles[index].inertia()) {
            (true, None) => (
                "force",
                "in a motion an obstacle that a force presses needs its `mass`; give it, or let the obstacle stand",
            ),
            (false, Some(_)) if scene.modes().is_none() => {
                ("mass", "only motions and modes have masses; leave it out of an equilibrium, or give `analysis`")
            }
            _ => continue,
        };
        return Err(wrong(format!("obstacles[{index}].{key}"), message));
    }
    Ok(pressed)
}

/// The obstacles of the scene, then those of the user.
fn placed_obstacles(
    scene: &Scene,
    body: &ElasticBody,
    dofs: &DofMap,
    further: &[Further],
) -> Result<Vec<PlacedObstacle>, Error> {
    let path = |index: usize| format!("obstacles[{index}]");
    let mut obstacles = Vec::with_capacity(scene.obstacles.len() + further.len());
    let bodies =
        scene.obstacles.iter().filter_map(|spec| Some([&*spec.boundary, spec.shape.shape().other_boundary()?]));
    let order = SideOrder::of(body, bodies.flatten().filter_map(|name| body.mesh().boundary(name)));
    for (index, spec) in scene.obstacles.iter().enumerate() {
        obstacles.push(PlacedObstacle::of_scene(spec, &path(index), (body, dofs, &order), files(scene))?);
    }
    let rows =
        obstacles.iter().enumerate().flat_map(|(index, obstacle)| obstacle.all_facing().map(move |row| (index, row)));
    if let Some(index) = order.circle(body, rows) {
        let (own, other) = (obstacles[index].boundary(), obstacles[index].other_body().map_or("", |other| other.0));
        let message = format!(
            "the rows of `{own}` lead to nodes of `{other}` that carry rows which lead back, so that a contact would count twice; \
             leave out `side`, or one of the obstacles"
        );
        return Err(wrong(format!("{}.shape.body.side", path(index)), message));
    }
    for (boundary, obstacle) in further {
        let path = path(obstacles.len());
        obstacles.push(PlacedObstacle::of_user(boundary, obstacle.clone(), &path, body)?);
    }
    Ok(obstacles)
}

/// The dofs with coefficients on the quadratic faces that may touch an obstacle or are tied.
fn with_contact_faces(scene: &Scene, dofs: DofMap, body: &ElasticBody, further: &[Further]) -> DofMap {
    let of_scene = scene
        .obstacles
        .iter()
        .flat_map(|spec| [Some(spec.boundary.as_str()), spec.shape.shape().other_boundary()].into_iter().flatten());
    let tied = tied_surfaces(scene).flatten();
    dofs.with_contact_faces(body, of_scene.chain(tied).chain(further.iter().map(|(boundary, _)| *boundary)))
}

/// More nodes than this are counted, not listed.
const LISTED_NODES: usize = 3;

pub(crate) fn explain(model: &Model, error: Error) -> Error {
    match error {
        Error::Qp(qp::Error::Unbounded { mode, direction }) => {
            let mode = named(model, &direction).map_or(mode, |(name, _)| name);
            qp::Error::Unbounded { mode, direction }.into()
        }
        Error::Qp(qp::Error::UnderHeld { mode, direction }) => {
            let mode = named(model, &direction).map_or(mode, |(name, advice)| format!("{name}: {advice}"));
            qp::Error::UnderHeld { mode, direction }.into()
        }
        Error::Qp(qp::Error::Infeasible { reason, rows, weights, overlap }) => {
            let length = &model.units().length;
            let by = if overlap > 0.0 { format!("; they overlap by {overlap:.3e} {length}") } else { String::new() };
            let reason = describe_rows(model, &rows).map_or(reason, |rows| format!("{rows}{}", by.trim_end()));
            qp::Error::Infeasible { reason, rows, weights, overlap }.into()
        }
        other => other,
    }
}

/// A node with its coordinates, as `node 5 at (0.25, 1)`.
pub fn node_in_words(model: &Model, node: usize) -> String {
    format!("node {node}{} at {}", model.of_part(), place_in_words(model, node))
}

/// The coordinates of a node to six digits; those of rounding are 0.
pub fn place_in_words(model: &Model, node: usize) -> String {
    let rounding = COORDINATE_ROUNDING * model.mesh().size();
    let at = model.mesh().nodes()[node].map(|value| if value.abs() <= rounding { 0.0 } else { six_digits(value) });
    point(&at[..model.mesh().dimension()])
}

/// The name of a rigid-body motion, and the advice against it.
fn named(model: &Model, direction: &[f64]) -> Option<(String, String)> {
    let parts = &model.parts;
    let motion = parts.conditions.dofs.expand_motion(direction).ok()?;
    let modes = RigidBodyModes::of(&parts.body);
    let amplitudes = modes.closest(parts.body.mesh().nodes(), &motion)?;
    Some((modes.name_of(&amplitudes), modes.advice(parts, model.rows(), &[amplitudes])))
}

fn describe_rows(model: &Model, rows: &[usize]) -> Option<String> {
    let mut by_node: Vec<(usize, Vec<usize>)> = Vec::new();
    for &row in rows {
        let node = model.rows().get(row)?.node;
        match by_node.iter_mut().find(|entry| entry.0 == node) {
            Some(entry) => entry.1.push(row),
            None => by_node.push((node, vec![row])),
        }
    }
    let mut parts: Vec<String> =
        by_node.iter().take(LISTED_NODES).map(|(node, rows)| describe_node(model, *node, rows)).collect();
    if by_node.len() > LISTED_NODES {
        parts.push(format!("{} more nodes", by_node.len() - LISTED_NODES));
    }
    (!parts.is_empty()).then(|| parts.join("; "))
}

fn describe_node(model: &Model, node: usize, rows: &[usize]) -> String {
    let obstacle = |row: &usize| {
        let row = &model.rows()[*row];
        format!("obstacles[{}] (gap {})", row.obstacle, number(row.gap))
    };
    let dimension = model.mesh().dimension();
    let node_at = node_in_words(model, node);
    let names: Vec<String> = rows.iter().map(obstacle).collect();
    let supported = (0..dimension).all(|axis| model.parts.conditions.dofs.is_supported(dimension * node + axis));
    match names.as_slice() {
        [one] if supported => format!("{node_at} is supported inside {one}"),
        [one] => format!("{node_at} cannot leave {one}"),
        _ => format!("{node_at} has no room between {}", names.join(" and ")),
    }
}
