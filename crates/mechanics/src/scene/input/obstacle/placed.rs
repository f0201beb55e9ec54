//! An obstacle of a model: its surface, and the candidates that may touch it.

use std::sync::Arc;

use super::order::{Between, BodyRow, SideOrder};
use super::row::{Obstacle, ObstacleRow};
use super::shape::{Geometry, ObstacleSite};
use crate::error::Error;
use crate::fem::assembly::{DofMap, node_normals, tributary_areas};
use crate::fem::body::ElasticBody;
use crate::fem::geometry::{length, plus, unit};
use crate::scene::Warning;
use crate::scene::input::entry::{Files, boundary, finite, number, positive, wrong};
use crate::scene::input::schema::model::{Approach, Rule};
use crate::scene::input::schema::obstacle::ObstacleSpec;

/// A component of a unit normal below this is rounding of the geometry, not a direction.
const NO_COMPONENT: f64 = 1e-14;

/// A component of the mean of many unit normals below this is no direction: the normals cancel.
const NO_DIRECTION: f64 = 1e-6;

/// A given normal is of unit length to within this rounding.
const UNIT: f64 = 1e-9;

/// An obstacle of a model: a rigid shape, or the surface of another body, with the boundary that may touch it.
#[derive(Clone, Debug)]
pub struct PlacedObstacle {
    boundary: String,
    candidates: Vec<(usize, f64)>,
    /// The outward normal of the body at each candidate.
    outward: Vec<[f64; 3]>,
    approach: [f64; 3],
    dimension: usize,
    geometry: Geometry,
    /// The rule for the rows of the obstacle; `None` for a user-defined one.
    rule: Option<Rule>,
    /// Shift along the approach direction in addition to that of the scene, in length.
    gap: f64,
    /// The force that presses it against its approach direction, in force.
    force: Option<f64>,
    inertia: Option<Inertia>,
}

/// The inertia of an obstacle that moves along its approach direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// The mass of the whole obstacle, positive, in mass.
    pub mass: f64,
    /// The velocity towards the body with which it starts, in length over time.
    pub speed: f64,
}

impl PlacedObstacle {
    /// Checks the obstacle at the JSON path `path`.
    pub(crate) fn of_scene(
        spec: &ObstacleSpec,
        path: &str,
        (body, dofs, order): (&ElasticBody, &DofMap, &SideOrder),
        files: Files,
    ) -> Result<Self, Error> {
        let (mut candidates, mut outward) = candidates(body, &spec.boundary, &format!("{path}.boundary"))?;
        let (gap, force, inertia) = (spec.gap.unwrap_or(0.0), spec.force, inertia(spec, path)?);
        check_pressing(spec, path)?;
        let dimension = body.dimension();
        let named = named_approach(spec, path, dimension)?;
        let (name, shape) = spec.shape.in_model(dimension).map_err(|misfit| wrong(format!("{path}.shape"), misfit))?;
        let site = ObstacleSite {
            obstacle: path,
            path: format!("{path}.shape.{name}"),
            boundary: &spec.boundary,
            approach: named,
            rule: spec.rule,
            body,
            dofs,
            candidates: &candidates,
            order,
            files,
        };
        let (mut approach, geometry) = (site.direction(), shape.place(&site)?);
        let own = [
            ("force", force.is_some(), "another body is pressed by its own loads; give it one instead"),
            ("mass", inertia.is_some(), "another body has the mass of its own material; give it a density instead"),
        ];
        if let Some((key, _, message)) =
            own.into_iter().find(|one| one.1).filter(|_| matches!(geometry, Geometry::Body(_)))
        {
            return Err(wrong(format!("{path}.{key}"), message));
        }
        let (mut boundary, rule) = (spec.boundary.clone(), Some(spec.rule));
        if let (Geometry::Body(between), Some(other)) = (&geometry, shape.other_boundary())
            && between.is_swapped
        {
            (candidates, outward) = self::candidates(body, other, path)?;
            (boundary, approach) = (other.into(), approach.map(|part| 0.0 - part));
        }
        if spec.approach.is_none() {
            approach = mean_direction(&outward);
        }
        Ok(PlacedObstacle { boundary, candidates, outward, approach, dimension, geometry, rule, gap, force, inertia })
    }

    /// A user-defined obstacle, at `path`.
    pub(crate) fn of_user(
        boundary: &str,
        obstacle: Arc<dyn Obstacle>,
        path: &str,
        body: &ElasticBody,
    ) -> Result<Self, Error> {
        let (candidates, outward) = candidates(body, boundary, &format!("{path}.boundary"))?;
        let (approach, dimension) = (obstacle.approach(), body.dimension());
        check_direction(approach, dimension)
            .map_err(|reason| wrong(format!("{path}.approach"), format!("the approach direction {reason}")))?;
        let (boundary, geometry) = (boundary.into(), Geometry::Rigid(obstacle));
        let (rule, gap, force, inertia) = (None, 0.0, None, None);
        Ok(PlacedObstacle { boundary, candidates, outward, approach, dimension, geometry, rule, gap, force, inertia })
    }

    /// Name of the boundary that contains its candidates.
    pub fn boundary(&self) -> &str {
        &self.boundary
    }

    /// The obstacle, if it is rigid; `None` for the surface of another body.
    pub fn rigid(&self) -> Option<&dyn Obstacle> {
        match &self.geometry {
            Geometry::Rigid(obstacle) => Some(obstacle.as_ref()),
            Geometry::Body(_) => None,
        }
    }

    /// Its whole shift along the approach direction if the scene shifts all obstacles by `gap`, in length, without the
    /// travel under a force.
    pub fn shift(&self, gap: f64) -> f64 {
        gap + self.gap
    }

    /// The same obstacle shifted by `by` along its approach direction.
    pub(crate) fn moved(&self, by: f64) -> Self {
        PlacedObstacle { gap: self.gap + by, ..self.clone() }
    }

    /// The force that presses it against its approach direction, in force, `>= 0`; `None` for an obstacle that stands
    /// still.
    pub fn force(&self) -> Option<f64> {
        self.force
    }

    /// Its mass and its speed at the start of a motion; `None` for an obstacle without mass.
    pub fn inertia(&self) -> Option<Inertia> {
        self.inertia
    }

    /// Returns `true` if its travel along the approach direction is an unknown.
    pub(crate) fn has_travel(&self) -> bool {
        self.force.is_some() || self.inertia.is_some()
    }

    /// The rule by which rows are made from the shape; `None` for a user-defined obstacle.
    pub fn rule(&self) -> Option<Rule> {
        self.rule
    }

    /// The approach direction [x, y, z], a dimensionless vector of length 1: from the body to the obstacle.
    pub fn approach(&self) -> [f64; 3] {
        self.approach
    }

    /// The candidate nodes as `(node, area)`, in the order of the boundary: index from 0, and tributary area.
    pub fn candidates(&self) -> &[(usize, f64)] {
        &self.candidates
    }

    /// The surface as a polyline [x, y] for pictures, in length: over the body's extent and its size beyond, shifted by
    /// `gap` along the approach direction, in `segments` pieces (10,000 at most), with exact corners. The obstacle lies
    /// on the side to which [`approach`](Self::approach) points. Empty if the surface does not reach over the body, for
    /// another body, and outside the plane.
    pub fn outline(&self, gap: f64, segments: usize) -> Vec<[f64; 2]> {
        self.rigid().map_or_else(Vec::new, |obstacle| obstacle.outline(gap, segments))
    }

    /// The rows against another body; `None` if the obstacle is rigid.
    #[doc(hidden)]
    pub fn between(&self) -> Option<&Between> {
        match &self.geometry {
            Geometry::Body(between) => Some(between),
            Geometry::Rigid(_) => None,
        }
    }

    /// The row of the candidate of this index against another body; `None` if the obstacle is rigid, or nothing faces
    /// the candidate.
    pub(crate) fn facing(&self, candidate: usize) -> Option<&BodyRow> {
        self.between()?.rows.get(candidate)?.as_ref()
    }

    /// Further rows of candidates at corners, by the indices of the candidates, if the surface is shifted by `gap`.
    pub(crate) fn further_rows(&self, gap: f64) -> impl Iterator<Item = (usize, &BodyRow, ObstacleRow)> {
        let row = move |facing: &BodyRow| without_rounding(facing.row(gap, self.approach));
        let further = self.between().into_iter().flat_map(|between| &between.further);
        further.map(move |(candidate, facing)| (*candidate, facing, row(facing)))
    }

    /// The rows of all candidates against another body; none if the obstacle is rigid.
    pub(crate) fn all_facing(&self) -> impl Iterator<Item = &BodyRow> {
        let all = self.between().into_iter();
        all.flat_map(|between| between.rows.iter().flatten().chain(between.further.iter().map(|one| &one.1)))
    }

    /// The contact seen from nodes of the other body, if rows are means.
    pub(crate) fn across(&self) -> &[(usize, BodyRow)] {
        self.between().map_or(&[], |between| &between.across)
    }

    /// The name of the boundary of the other body, if the obstacle is one, and, if the rows are means, the covered
    /// shares `[own, other]`, dimensionless, from 0 to 1: of the area of [`boundary`](Self::boundary), and of the nodes
    /// of the other boundary.
    pub fn other_body(&self) -> Option<(&str, Option<[f64; 2]>)> {
        self.between().map(|between| (between.other.as_str(), between.covered))
    }

    /// What the search for the rows against another body noticed.
    pub(crate) fn warnings(&self) -> &[Warning] {
        self.between().map_or(&[], |between| &between.warnings)
    }

    /// The outward normal of the body at the candidate of this index; zero if the facets around it cancel.
    pub(crate) fn outward(&self, candidate: usize) -> [f64; 3] {
        self.outward.get(candidate).copied().unwrap_or_default()
    }

    /// The unit normal of the surface, into the obstacle, at the point where the row of the candidate of this index
    /// meets it; for another body the mean of both normals. `None` if it is out of reach.
    #[doc(hidden)]
    pub fn surface_normal(&self, candidate: usize, node: [f64; 3], gap: f64) -> Option<[f64; 3]> {
        match &self.geometry {
            Geometry::Rigid(obstacle) => obstacle.surface_normal(node, gap),
            Geometry::Body(_) => self.facing(candidate).map(|facing| facing.mean),
        }
    }

    /// The row of the candidate of this index, at the place `node`, with the surface shifted by `gap`; `None` if it is
    /// out of reach.
    ///
    /// # Errors
    /// A predicate of the node, if no meaningful row exists.
    pub(crate) fn row(&self, candidate: usize, node: [f64; 3], gap: f64) -> Result<Option<ObstacleRow>, String> {
        let row = match &self.geometry {
            Geometry::Rigid(obstacle) => obstacle.shifted_row(node, gap).map_err(|reason| away(&reason))?,
            Geometry::Body(_) => self.facing(candidate).map(|facing| facing.row(gap, self.approach)),
        };
        let Some(row) = row else { return Ok(None) };
        if row.gap.is_nan() {
            return Err(away("has a distance that is not a number"));
        }
        if !row.gap.is_finite() {
            return Ok(None);
        }
        check_direction(row.normal, self.dimension).map_err(|reason| format!("has a row whose normal {reason}"))?;
        Ok(Some(without_rounding(row)))
    }
}

fn without_rounding(row: ObstacleRow) -> ObstacleRow {
    ObstacleRow { normal: row.normal.map(|c| if c.abs() < NO_COMPONENT { 0.0 } else { c }), ..row }
}

/// The mean of outward normals; the x axis if they cancel, as around a shaft.
fn mean_direction(outward: &[[f64; 3]]) -> [f64; 3] {
    let sum = outward.iter().copied().fold([0.0; 3], plus);
    let mean = sum.map(|part| part / outward.len().max(1) as f64);
    let mean = unit(mean.map(|part| if part.abs() < NO_DIRECTION { 0.0 } else { part }));
    if mean == [0.0; 3] { [1.0, 0.0, 0.0] } else { mean }
}

/// The approach direction of an obstacle, which only a body with rows along normals can do without; none lies along it.
fn named_approach(spec: &ObstacleSpec, path: &str, dimension: usize) -> Result<Approach, Error> {
    let needs_none = spec.shape.shape().other_boundary().is_some() && spec.rule == Rule::ClosestPoint;
    let Some(approach) = spec.approach.or(needs_none.then_some(Approach::PlusX)) else {
        let message = "the key `approach` is missing: one of `+x`, `-x`, `+y`, `-y`, `+z`, `-z`, from the body to the obstacle; only \
                       another body with `\"rule\": \"closest-point\"` needs none";
        return Err(wrong(path, message));
    };
    if approach.axis().0 >= dimension {
        let names = ["x", "x and y", "x, y and z"][dimension - 1];
        let message = format!("`{}` is no direction of this model, which has {names}", approach.name());
        return Err(wrong(format!("{path}.approach"), message));
    }
    if spec.approach.is_none() && spec.gap.is_some() {
        let message =
            "shifts the other body along the approach direction, which is missing; give `approach`, or a `fit`";
        return Err(wrong(format!("{path}.gap"), message));
    }
    Ok(approach)
}

/// The mass and the speed of an obstacle.
fn inertia(spec: &ObstacleSpec, path: &str) -> Result<Option<Inertia>, Error> {
    let speed = spec.speed.unwrap_or(0.0);
    finite(format!("{path}.speed"), speed)?;
    let Some(mass) = spec.mass else {
        let message = "only an obstacle with a `mass` has a speed of its own; give it one";
        return spec.speed.map_or(Ok(None), |_| Err(wrong(format!("{path}.speed"), message)));
    };
    positive(&format!("{path}.mass"), mass)?;
    Ok(Some(Inertia { mass, speed }))
}

/// Checks the shift of an obstacle in addition to the gap of the scene, and the force that presses it.
fn check_pressing(spec: &ObstacleSpec, path: &str) -> Result<(), Error> {
    finite(format!("{path}.gap"), spec.gap.unwrap_or(0.0))?;
    if let Some(force) = spec.force {
        finite(format!("{path}.force"), force)?;
        if force <= 0.0 {
            let message = format!(
                "{} is not allowed: the force presses the obstacle on the body, and must be positive",
                number(force)
            );
            return Err(wrong(format!("{path}.force"), message));
        }
        if spec.gap.is_some() && spec.mass.is_none() {
            return Err(wrong(path, "gives both gap and force; the force determines the gap, so give only one"));
        }
    }
    Ok(())
}

/// The nodes of a boundary with their tributary areas, and the outward normals there.
#[allow(clippy::type_complexity)]
fn candidates(body: &ElasticBody, name: &str, path: &str) -> Result<(Vec<(usize, f64)>, Vec<[f64; 3]>), Error> {
    let boundary = boundary(body.mesh(), name, path)?;
    let outward = node_normals(body, boundary).into_iter().map(|(_, normal)| normal).collect();
    Ok((tributary_areas(body, boundary), outward))
}

/// The fault of a node, and a remedy.
fn away(reason: &str) -> String {
    format!("{reason}; move the obstacle away from it")
}

/// Checks that a vector is of unit length and lies in a space of `dimension` coordinates.
fn check_direction(vector: [f64; 3], dimension: usize) -> Result<(), String> {
    let length = length(vector);
    if length.is_nan() || (length - 1.0).abs() > UNIT {
        return Err(format!("has the length {}; it must be 1", number(length)));
    }
    match vector[dimension..].iter().any(|&component| component != 0.0) {
        true => Err(format!("leads out of the model, which has {dimension} coordinates")),
        false => Ok(()),
    }
}
