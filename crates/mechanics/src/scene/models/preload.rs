//! Preloads of bolts: two faces of a cut that move together along themselves, and towards each other by one shortening
//! q.
//!
//! Each mean over the cut holds t . (u - u') = 0 along the faces. Along the direction n of the bolt, either all hold n
//! . (u - u') = q with a prescribed q, or they are equal to each other, and the tension F does the work F q.

use super::facing::{Facing, TieRow};
use crate::error::{Error, nearly};
use crate::fem::assembly::DofMap;
use crate::fem::body::ElasticBody;
use crate::fem::geometry::{cross, dot, length, plus, shifted, unit};
use crate::fem::sum::LinearForm;
use crate::scene::Warning;
use crate::scene::input::entry::{boundary, finite, node_at, nodes_named_once, refused, vector, wrong};
use crate::scene::input::obstacle::SideOrder;
use crate::scene::input::schema::{PointSpec, PreloadSpec, Scene, TermPlace, TermSpec, TieSpec};

/// The shortening of a bolt.
#[derive(Clone, Debug)]
pub struct Shortening {
    pub tie: usize,
    /// Its own side is the first side of the cut.
    pub form: LinearForm,
    /// The tension along it; `None` if it is prescribed.
    pub force: Option<f64>,
    /// 1, or -1 if the direction leads from the other side back to the first, so that a positive sum is a lengthening.
    pub sense: f64,
}

impl Shortening {
    /// The unit vector from the first side to the other.
    pub fn towards(&self) -> [f64; 3] {
        unit(self.form.sides()[0].iter().fold([0.0; 3], |sum, (_, vector)| plus(sum, *vector)))
    }
}

/// The number of the preload that a reference point of this name stands for.
pub(super) fn bolt_of(scene: &Scene, point: &str) -> Option<usize> {
    let stands = |tie: &TieSpec| matches!(tie, TieSpec::Preload(spec) if spec.point.as_deref() == Some(point));
    scene.ties.iter().position(stands)
}

pub(super) fn point_named(scene: &Scene, name: &str, path: &str) -> Result<usize, Error> {
    scene.points.iter().position(|point| point.name == name).ok_or_else(|| {
        let names = || scene.points.iter().map(|point| point.name.as_str());
        let listed: Vec<String> = names().map(|name| format!("`{name}`")).collect();
        let there = if listed.is_empty() { "none; add it to `points`".into() } else { listed.join(", ") };
        wrong(path, format!("there is no reference point `{name}`; there are {there}{}", nearly(name, names())))
    })
}

/// A preload with the force or the shortening of its point.
pub(super) fn drawn(scene: &Scene, spec: &PreloadSpec, (path, tie): (&str, usize)) -> Result<PreloadSpec, Error> {
    let Some(name) = &spec.point else { return Ok(spec.clone()) };
    let point = point_named(scene, name, &format!("{path}.point"))?;
    if let Some(other) = bolt_of(scene, name).filter(|&other| other != tie) {
        let message = format!("`{name}` stands for the bolt of ties[{other}]; give each bolt a point of its own");
        return Err(wrong(format!("{path}.point"), message));
    }
    if spec.force.or(spec.shortening).is_some() {
        let message = format!("has the point `{name}`; give the tension or the shortening there, along x");
        return Err(wrong(path, message));
    }
    let PointSpec { x: shortening, force, .. } = &scene.points[point];
    let tension = force.as_ref().and_then(|force| force.first().copied()).unwrap_or(0.0);
    let force = if shortening.is_none() { Some(tension) } else { None };
    Ok(PreloadSpec { force, shortening: *shortening, ..spec.clone() })
}

impl PreloadSpec {
    /// The rows of the cut at `path`, tie number `tie`, and its shortening.
    pub(super) fn rows(
        &self,
        (path, tie): (&str, usize),
        place: (&ElasticBody, &DofMap, &SideOrder),
        warnings: &mut Vec<Warning>,
    ) -> Result<(Vec<TieRow>, Shortening), Error> {
        let facing = Facing::of([&self.boundary, &self.to], None, path, place, warnings)?;
        let (dofs, dimension) = (facing.dofs, facing.body.dimension());
        let (towards, sense) = self.direction(&facing, path)?;
        let mut rows = Vec::new();
        for number in 0..dimension - 1 {
            rows.extend(facing.rows(|node| across(towards, dofs.axes(node), dimension)[number])?);
        }
        let mut along = facing.all_rows(towards);
        along.iter_mut().for_each(|row| row.at = None);
        let first = along.remove(0);
        let shortening = match (self.force, self.shortening) {
            (Some(force), None) => {
                finite(format!("{path}.force"), force)?;
                along.iter_mut().for_each(|row| *row = TieRow::of(row.form.minus(&first.form), 0.0));
                Shortening { tie, form: first.form, force: Some(force), sense }
            }
            (None, Some(shortening)) => {
                finite(format!("{path}.shortening"), shortening)?;
                along.insert(0, first.clone());
                along.iter_mut().for_each(|row| row.value = shortening);
                Shortening { tie, form: first.form, force: None, sense }
            }
            _ => return Err(wrong(path, "needs one of `force`, `shortening` and `point`")),
        };
        rows.extend(along);
        Ok((rows, shortening))
    }

    /// The unit vector from the side that takes the means to the other, and 1; -1 for one that leads back.
    fn direction(&self, facing: &Facing, path: &str) -> Result<([f64; 3], f64), Error> {
        let mut outward = [0.0; 3];
        for row in &facing.found.rows {
            outward.iter_mut().zip(row.normal).for_each(|(sum, part)| *sum += row.area * part);
        }
        let outward = unit(outward);
        let Some(given) = &self.direction else { return Ok((outward, 1.0)) };
        let path = format!("{path}.direction");
        let given = unit(vector(&path, given, facing.body.dimension())?);
        // Cosines of right angles are rounding, which would couple what supports keep apart.
        let given = unit(given.map(|part| if part.abs() < ROUNDING { 0.0 } else { part }));
        if given == [0.0; 3] {
            return Err(wrong(path, "has no length"));
        }
        let given = if facing.is_swapped { given.map(|part| 0.0 - part) } else { given };
        let along = dot(given, outward);
        if along.abs() <= LEAST {
            // It would shear the faces.
            return Err(wrong(path, "lies along the faces of the cut; it must lead from one part to the other"));
        }
        // In a deck both may be turned around: together they draw.
        if along < 0.0 && self.force.or(self.shortening).is_some_and(|amount| amount > 0.0) {
            let message = format!(
                "leads from `{}` back into its own part, so that the tension would push the parts apart; turn its sign, or leave it out",
                self.boundary
            );
            return Err(refused("approach-away", path, message));
        }
        Ok((given, along.signum()))
    }
}

/// Parts of a unit vector below this are rounding of its length and of angles.
const ROUNDING: f64 = 1e-12;

/// The least cosine between the direction of a bolt and the normal of its cut.
const LEAST: f64 = 1e-3;

/// Two unit vectors at right angles to `towards`, one in the plane: along axes of the node where these are at right
/// angles.
fn across(towards: [f64; 3], axes: &[[f64; 3]; 3], dimension: usize) -> [[f64; 3]; 2] {
    if dimension == 2 {
        return [[0.0 - towards[1], towards[0], 0.0], [0.0; 3]];
    }
    let projected = axes.map(|axis| {
        let part = dot(axis, towards);
        shifted(axis, -part, towards)
    });
    let longest = projected.into_iter().max_by(|a, b| length(*a).total_cmp(&length(*b))).unwrap_or_default();
    let first = unit(longest);
    [first, cross(towards, first)]
}

/// The numbers of reference points, by their names and the paths of these.
pub(super) type NumberOfPoint<'a> = &'a dyn Fn(&str, String) -> Result<usize, Error>;

/// For terms of nodes alone.
pub(super) fn no_point(name: &str, path: String) -> Result<usize, Error> {
    Err(wrong(path, format!("the reference point `{name}` is not known here")))
}

/// The nodes and points of terms, each with its vector [x, y, z].
pub(super) fn terms_of(
    terms: &[TermSpec],
    path: &str,
    body: &ElasticBody,
    point: NumberOfPoint,
) -> Result<Vec<(usize, [f64; 3])>, Error> {
    let mut found = Vec::with_capacity(terms.len());
    for (index, term) in terms.iter().enumerate() {
        let path = format!("{path}.terms[{index}]");
        let (node, is_point) = match &term.on {
            TermPlace::Reference(name) => (point(name, format!("{path}.on.reference"))?, true),
            place => (node_of(place, &path, body)?, false),
        };
        let (vector, turns) = ([term.x, term.y, term.z], [term.rotation.x, term.rotation.y, term.rotation.z]);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            finite(format!("{path}.{name}"), vector[axis])?;
            if axis >= body.dimension() && vector[axis] != 0.0 {
                return Err(wrong(
                    format!("{path}.{name}"),
                    format!("a node of this model has no displacement {name}"),
                ));
            }
            finite(format!("{path}.rotation.{name}"), turns[axis])?;
            if turns[axis] != 0.0 && !(is_point && body.turns().contains(&axis)) {
                let message = match is_point {
                    true => format!("a point of this model does not turn about {name}"),
                    false => "a node has no rotation; a reference point has".into(),
                };
                return Err(wrong(format!("{path}.rotation.{name}"), message));
            }
        }
        if vector == [0.0; 3] && turns == [0.0; 3] {
            return Err(wrong(path, "has no coefficient; give x, y or z"));
        }
        found.push((node, vector));
    }
    match found.is_empty() {
        true => Err(wrong(format!("{path}.terms"), "has no term; give at least one")),
        false => Ok(found),
    }
}

fn node_of(place: &TermPlace, path: &str, body: &ElasticBody) -> Result<usize, Error> {
    let mesh = body.mesh();
    let (nodes, path) = match place {
        TermPlace::Point(at) => (vec![node_at(mesh, at, &format!("{path}.on.point"))?], String::new()),
        TermPlace::Boundary(name) => {
            let path = format!("{path}.on.boundary");
            (boundary(mesh, name, &path)?.nodes(), path)
        }
        TermPlace::Nodes(names) => {
            let path = format!("{path}.on.nodes");
            (nodes_named_once(mesh, names, &path)?, path)
        }
        TermPlace::Reference(_) => (Vec::new(), format!("{path}.on.reference")),
    };
    match nodes[..] {
        [node] => Ok(node),
        _ => Err(wrong(path, format!("has {} nodes; a term of an equation has one", nodes.len()))),
    }
}
