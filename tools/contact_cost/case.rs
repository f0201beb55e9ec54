//! The measured blocks: clamped at the bottom, with a parabola or a sphere pressed into the top.

use serde_json::json;
use signorini::{Error, Model, Scene};

/// First gap of every case, as a multiple of the block's side; it is negative, so that the obstacle starts inside the
/// body.
pub const FIRST_GAP: f64 = -0.01;

/// A unit block of `cells` elements along each side.
#[derive(Clone, Copy, PartialEq)]
pub struct Case {
    pub name: &'static str,
    pub space: bool,
    cells: usize,
}

const fn plane(name: &'static str, cells: usize) -> Case {
    Case { name, space: false, cells }
}

const fn space(name: &'static str, cells: usize) -> Case {
    Case { name, space: true, cells }
}

pub const CASES: [Case; 8] = [
    plane("Q4 64", 64),
    plane("Q4 128", 128),
    plane("Q4 256", 256),
    plane("Q4 512", 512),
    space("Hex8 6", 6),
    space("Hex8 12", 12),
    space("Hex8 20", 20),
    space("Hex8 28", 28),
];

impl Case {
    pub fn named(name: &str) -> Option<Case> {
        CASES.into_iter().find(|case| case.name == name)
    }

    pub fn dofs(&self) -> usize {
        let (n, nodes) = (self.cells, self.cells + 1);
        if self.space { 3 * nodes * nodes * n } else { 2 * nodes * n }
    }

    pub fn model(&self) -> Result<Model, Error> {
        let axis = json!({"points": [0, 1], "divisions": [self.cells]});
        let (model, body, apex, shape) = if self.space {
            (
                "space",
                json!({"box": {"x": axis, "y": axis, "z": axis, "element": "hex8"}}),
                json!([0.5, 0.5, 1]),
                "sphere",
            )
        } else {
            ("plane-strain", json!({"rectangle": {"x": axis, "y": axis, "element": "q4"}}), json!([0.5, 1]), "parabola")
        };
        let clamp = if self.space { json!({"x": 0, "y": 0, "z": 0}) } else { json!({"x": 0, "y": 0}) };
        let mut support = json!({"on": {"boundary": "bottom"}});
        if let (Some(support), Some(clamp)) = (support.as_object_mut(), clamp.as_object()) {
            support.extend(clamp.clone());
        }
        let approach = if self.space { "+z" } else { "+y" };
        let scene = json!({
            "model": model,
            "body": body,
            "material": {"young": 1e7, "poisson": 0.3},
            "supports": [support],
            "obstacles": [{"boundary": "top", "approach": approach, "rule": "approach",
                           "shape": {shape: {"apex": apex, "radius": 1}}}],
            "gap": FIRST_GAP,
        });
        Scene::from_json(&scene.to_string(), self.name)?.build()
    }
}
