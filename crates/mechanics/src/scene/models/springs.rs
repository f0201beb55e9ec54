//! Springs and foundations of a scene, on its nodes.

use super::points::ReferencePoints;
use super::preload::{no_point, terms_of};
use crate::error::Error;
use crate::fem::Boundary;
use crate::fem::assembly::{Springs, tributary_areas};
use crate::fem::body::ElasticBody;
use crate::fem::sum::LinearForm;
use crate::scene::input::entry::{boundary, node_at, positive, wrong};
use crate::scene::input::schema::tie::StiffnessOf;
use crate::scene::input::schema::{PlaceSpec, Scene, SpringSpec};

/// The refusal of a spring that is written in two ways.
const BOTH: &str = "has both a place `on` and `terms` with `along`; give one of them";

/// The springs, in the order of the scene.
pub(crate) fn springs(scene: &Scene, body: &ElasticBody, points: &ReferencePoints) -> Result<Vec<Springs>, Error> {
    let placed = |(index, spec): (usize, &SpringSpec)| match points.spring(index) {
        Some(springs) => Ok(springs),
        None => spec.placed(&format!("springs[{index}]"), body),
    };
    scene.springs.iter().enumerate().map(placed).collect()
}

impl SpringSpec {
    fn placed(&self, path: &str, body: &ElasticBody) -> Result<Springs, Error> {
        let dimension = body.dimension();
        let Some(on) = &self.on else { return self.between(path, body) };
        if !self.terms.is_empty() || self.along.is_some() {
            return Err(wrong(path, BOTH));
        }
        match on {
            PlaceSpec::Point(_) if self.normal.is_some() => {
                Err(wrong(format!("{path}.normal"), "a node alone has no normal; give x, y or z"))
            }
            PlaceSpec::Point(_) if self.stiffness == StiffnessOf::PerArea => {
                Err(wrong(format!("{path}.stiffness"), "a node has no area; `total` is the stiffness of the spring"))
            }
            PlaceSpec::Point(at) => {
                let node = node_at(body.mesh(), at, &format!("{path}.on.point"))?;
                Ok(Springs::at_node(node, self.along_axes(path, dimension)?))
            }
            PlaceSpec::Nodes(_) => Err(wrong(
                format!("{path}.on.nodes"),
                "a spring holds a boundary, or the node at a point; give one of them, or `terms` with `along`",
            )),
            PlaceSpec::Boundary(name) => {
                let boundary = boundary(body.mesh(), name, &format!("{path}.on.boundary"))?;
                let (along, normal) = self.spread_over(path, body, boundary)?;
                Ok(Springs::under(body, boundary, along, normal))
            }
        }
    }

    /// The stiffness along the axes, as it is written.
    fn along_axes(&self, path: &str, dimension: usize) -> Result<[f64; 3], Error> {
        let mut along = [0.0; 3];
        let named = [("x", self.x), ("y", self.y), ("z", self.z), ("normal", self.normal)];
        for (axis, (field, stiffness)) in named.into_iter().enumerate() {
            let Some(stiffness) = stiffness else { continue };
            let path = format!("{path}.{field}");
            if axis >= dimension && axis < 3 {
                return Err(wrong(path, format!("the model has no {field}")));
            }
            let stiffness = positive(&path, stiffness)?;
            if let Some(along) = along.get_mut(axis) {
                *along = stiffness;
            }
        }
        if named.iter().all(|(_, stiffness)| stiffness.is_none()) {
            let names = ["x", "x, y or normal", "x, y, z or normal"][dimension - 1];
            return Err(wrong(path, format!("holds nothing; give a stiffness along {names}")));
        }
        Ok(along)
    }

    /// The stiffness per area of springs under a boundary, along the axes and along the normal.
    fn spread_over(&self, path: &str, body: &ElasticBody, boundary: &Boundary) -> Result<([f64; 3], f64), Error> {
        let along = self.along_axes(path, body.dimension())?;
        let share = match self.stiffness {
            StiffnessOf::PerArea => 1.0,
            StiffnessOf::Total => 1.0 / tributary_areas(body, boundary).iter().map(|(_, area)| area).sum::<f64>(),
        };
        Ok((along.map(|stiffness| share * stiffness), share * self.normal.unwrap_or(0.0)))
    }

    /// A spring along the elongation that its terms give.
    fn between(&self, path: &str, body: &ElasticBody) -> Result<Springs, Error> {
        let along = positive(&format!("{path}.along"), self.along_alone(path)?)?;
        let elongation = LinearForm { terms: terms_of(&self.terms, path, body, &no_point)?, own: 0 };
        Ok(Springs::between(elongation, 0.0, along))
    }

    /// The stiffness along the elongation that terms give.
    pub(crate) fn along_alone(&self, path: &str) -> Result<f64, Error> {
        if self.on.is_some() {
            return Err(wrong(path, BOTH));
        }
        if self.terms.is_empty() {
            return Err(wrong(path, "needs a place `on`, or `terms` of its elongation with the stiffness `along` it"));
        }
        let others = [("x", self.x), ("y", self.y), ("z", self.z), ("normal", self.normal)];
        if let Some((field, _)) = others.into_iter().find(|(_, stiffness)| stiffness.is_some()) {
            return Err(wrong(
                format!("{path}.{field}"),
                "a spring of `terms` has one stiffness, `along` its elongation",
            ));
        }
        if self.stiffness == StiffnessOf::PerArea {
            return Err(wrong(
                format!("{path}.stiffness"),
                "nodes have no area; `along` is the stiffness of the spring",
            ));
        }
        self.along.ok_or_else(|| wrong(format!("{path}.along"), "is missing: the stiffness along the elongation"))
    }
}
