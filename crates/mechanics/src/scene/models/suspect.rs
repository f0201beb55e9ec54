//! Legal but rarely intended parts of a scene: supports, loads, obstacles and meshes without the expected effect.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::elastic::{locking, stiffness_jumps, unit_of_young};
use super::load::add_load;
use super::parts::Parts;
use super::preload::terms_of;
use super::rows::ContactRow;
use super::ties::tied_surfaces;
use crate::error::Error;
use crate::fem::geometry::dot;
use crate::fem::{Boundary, DofMap, ElasticBody};
use crate::scene::Warning;
use crate::scene::input::entry::COORDINATE_ROUNDING;
use crate::scene::input::schema::{EquationSpec, PlaceSpec, Scene, SupportSpec, SymmetryPlane, TieSpec};

/// A load on the free dofs below this share of the whole load is rounding.
const NOTHING: f64 = 1e-9;

/// Two rows of a node are the same if the sine of their angle is below this: the rounding of written normals.
const PARALLEL: f64 = 1e-9;

/// Prefix of the name of a cut at a plane of symmetry, in the meshes of the program.
const SYMMETRY: &str = "symmetry-";

/// What reading noted, and the suspect materials, supports, loads and properties of the mesh.
pub(crate) fn suspect(scene: &Scene, body: &ElasticBody, dofs: &DofMap) -> Result<Vec<Warning>, Error> {
    let mut warnings = scene.noted.clone();
    warnings.extend(locking(body));
    warnings.extend(stiffness_jumps(body));
    warnings.extend(unit_of_young(body, &scene.units));
    warnings.extend(free_symmetries(scene, body));
    let tied = tied_surfaces(scene).flatten().filter_map(|name| body.mesh().boundary(name));
    warnings.extend(coincident_nodes(body, &tied.flat_map(Boundary::nodes).collect()));
    warnings.extend(folded_corner(body));
    // An equation hands a force on one of its nodes over to the others.
    let mut joined = HashSet::new();
    for (index, tie) in scene.ties.iter().enumerate() {
        if let TieSpec::Equation(EquationSpec { terms, .. }) = tie {
            let path = format!("ties[{index}].equation");
            let points = |_: &str, _: String| Ok(usize::MAX);
            joined.extend(terms_of(terms, &path, body, &points)?.into_iter().map(|(node, _)| node));
        }
    }
    for index in 0..scene.loads.len() {
        let mut load = vec![0.0; body.nodal_dofs()];
        add_load(scene, body, index, &mut load)?;
        let size = |values: &[f64]| values.iter().map(|value| value.abs()).sum::<f64>();
        let (whole, free) = (size(&load), size(&dofs.part(&load, |dof| !dofs.is_supported(dof))?));
        if whole > 0.0 && free <= NOTHING * whole {
            let message = format!(
                "loads[{index}] acts only on nodes that supports hold: the supports take it and nothing moves; load another \
                 boundary"
            );
            warnings.push(Warning::new("load-on-support", message));
        } else if scene.loads[index].is_at_points()
            && body.dimension() > 1
            && node_alone(&load, body.dimension()).is_some_and(|node| !joined.contains(&node))
        {
            let message = format!(
                "loads[{index}] is a force on a single node: displacement and stress there grow with every refinement; spread it over a \
                 boundary as a traction if they matter"
            );
            warnings.push(Warning::new("point-load", message));
        }
    }
    Ok(warnings)
}

/// Cuts at planes of symmetry that no support holds.
fn free_symmetries(scene: &Scene, body: &ElasticBody) -> Vec<Warning> {
    let is_held = |name: &str| {
        let of_plane = |plane: &SymmetryPlane| name.strip_prefix(SYMMETRY) == Some(plane.name());
        let of_support = |support: &SupportSpec| matches!(&support.on, PlaceSpec::Boundary(on) if on == name);
        scene.symmetry.iter().any(of_plane) || scene.supports.iter().any(of_support)
    };
    let names = body.mesh().boundaries().iter().map(|boundary| boundary.name.as_str());
    let is_cut = |name: &&str| name.rsplit('.').next().is_some_and(|own| own.starts_with(SYMMETRY));
    // In an axisymmetric section the axis itself holds the cut.
    let on_axis = |name: &&str| body.formulation().is_axisymmetric() && name.ends_with("symmetry-x");
    let free = names.filter(is_cut).filter(|name| !is_held(name) && !on_axis(name));
    let warning = |name: &str| {
        let message = format!(
            "no support holds the boundary `{name}`: the body can move across this cut, so that it is not half of a symmetric body; \
             hold the component across the cut"
        );
        Warning::new("free-symmetry", message)
    };
    free.map(warning).collect()
}

/// The first element whose Jacobian is negative at a node, although it is positive where it is integrated.
fn folded_corner(body: &ElasticBody) -> Option<Warning> {
    let (mesh, count) = (body.mesh(), body.folded().len());
    let &(element, node, value) = body.folded().first()?;
    let at = &mesh.nodes()[mesh.element(element)[node]][..body.dimension()];
    let element = mesh.element_numbers().and_then(|numbers| numbers.get(element).copied()).unwrap_or(element);
    let message = format!(
        "the Jacobian determinant of element {element} is {value:.2e} at its node at {at:?}, but positive where it is integrated, and so \
         it is for {count} elements: they are solved; stresses at such a corner are not to be trusted; move the node"
    );
    Some(Warning::new("folded-corner", message))
}

/// The node of a nodal load that is zero on all others.
fn node_alone(load: &[f64], dimension: usize) -> Option<usize> {
    let forces = load.chunks(dimension).enumerate();
    let mut loaded = forces.filter(|(_, force)| force.iter().any(|&component| component != 0.0)).map(|(node, _)| node);
    loaded.next().filter(|_| loaded.next().is_none())
}

/// Nodes of one body at the same place, unless both are on tied surfaces: the mesh is connected only in the drawing.
fn coincident_nodes(body: &ElasticBody, tied: &HashSet<usize>) -> Option<Warning> {
    let nodes = body.mesh().nodes();
    let cell = COORDINATE_ROUNDING * body.mesh().size();
    let mut pairs = Vec::new();
    for region in body.regions() {
        let mut at: BTreeMap<[i64; 3], usize> = BTreeMap::new();
        for node in region.nodes() {
            let key = nodes[node].map(|coordinate| (coordinate / cell).round() as i64);
            let first = *at.entry(key).or_insert(node);
            if first != node && !(tied.contains(&first) && tied.contains(&node)) {
                pairs.push((first, node));
            }
        }
    }
    let &(first, second) = pairs.first()?;
    let (at, count) = (&nodes[second][..body.dimension()], pairs.len());
    let message = format!(
        "{count} nodes of the mesh have the place of another node, such as nodes {first} and {second} at {at:?}: the parts of the mesh are \
         not joined there; merge these nodes in the mesher, unless a slit is meant"
    );
    Some(Warning::new("coincident-nodes", message))
}

/// Obstacles with candidates that are mostly held by supports, and obstacles with the same rows as others.
pub(crate) fn suspect_rows(parts: &Parts, rows: &[ContactRow]) -> Vec<Warning> {
    let dimension = parts.body.dimension();
    let mut warnings = Vec::new();
    let is_held = |node: usize| (0..dimension).all(|axis| parts.conditions.dofs.is_supported(dimension * node + axis));
    for (index, obstacle) in parts.obstacles.iter().enumerate() {
        let all = obstacle.candidates();
        let held = all.iter().filter(|candidate| is_held(candidate.0)).count();
        if dimension > 1 && 2 * held > all.len() {
            let message = format!(
                "{held} of {} nodes that may touch obstacles[{index}] are held in all directions by supports: the obstacle cannot press \
                 on them; free that boundary, or name another one",
                all.len()
            );
            warnings.push(Warning::new("held-candidates", message));
        }
    }
    warnings.extend(doubled_obstacles(parts, rows));
    warnings
}

/// For each obstacle the later ones with the same rows at most of their nodes.
fn doubled_obstacles(parts: &Parts, rows: &[ContactRow]) -> Vec<Warning> {
    let rounding = COORDINATE_ROUNDING * parts.body.mesh().size();
    // Along the rows of a node, sorted by their gaps, a row is compared with those before it up to the rounding of a
    // gap.
    let mut sorted: Vec<&ContactRow> = rows.iter().collect();
    sorted.sort_by(|a, b| a.node.cmp(&b.node).then(a.gap.total_cmp(&b.gap)));
    let mut different: Vec<&ContactRow> = Vec::new();
    let mut kinds_of: Vec<Vec<usize>> = vec![Vec::new(); parts.obstacles.len()];
    for row in sorted {
        let is_near = |other: &&&ContactRow| other.node == row.node && row.gap - other.gap <= rounding;
        let is_same = |other: &ContactRow| other.ends == row.ends && dot(other.normal, row.normal) > 1.0 - PARALLEL;
        let same = different.iter().rev().take_while(is_near).position(|other| is_same(other));
        let kind = match same {
            Some(back) => different.len() - 1 - back,
            None => {
                different.push(row);
                different.len() - 1
            }
        };
        kinds_of[row.obstacle].push(kind);
    }
    // Obstacles of equal rows are compared with the others once, so that very many copies of one obstacle cost little.
    let mut later_of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut first_with: HashMap<&[usize], usize> = HashMap::new();
    let mut firsts: Vec<Vec<usize>> = vec![Vec::new(); different.len()];
    for (obstacle, kinds) in kinds_of.iter().enumerate().filter(|entry| !entry.1.is_empty()) {
        let first = *first_with.entry(kinds).or_insert(obstacle);
        match first == obstacle {
            true => kinds.iter().for_each(|&kind| firsts[kind].push(obstacle)),
            false => later_of.entry(first).or_default().push(obstacle),
        }
    }
    let mut same: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for obstacles in &firsts {
        for (place, &second) in obstacles.iter().enumerate() {
            for &first in obstacles[..place].iter().filter(|&&first| first != second) {
                *same.entry((first, second)).or_default() += 1;
            }
        }
    }
    for ((first, second), _) in same.into_iter().filter(|&((_, second), rows)| 2 * rows > kinds_of[second].len()) {
        later_of.entry(first).or_default().push(second);
    }
    let warning = |(first, mut later): (usize, Vec<usize>)| {
        later.sort_unstable();
        let (second, last, count) = (later[0], later[later.len() - 1], later.len());
        let message = match count {
            1 => format!(
                "obstacles[{first}] and obstacles[{second}] make the same rows: the shares of the force between the two have no meaning; \
                 leave one obstacle out"
            ),
            _ => format!(
                "obstacles[{first}] and {count} others, from obstacles[{second}] to obstacles[{last}], make the same rows: the shares of \
                 the force among them have no meaning; leave all but one out"
            ),
        };
        Warning::new("doubled-obstacle", message)
    };
    later_of.into_iter().map(warning).collect()
}
