//! The measured blocks: clamped at the bottom, with a sphere pressed into the top.

use serde_json::{Value, json};
use signorini::{Error, Model, Scene};

/// A unit block with `cells` Hex8 elements along each side.
#[derive(Clone, Copy)]
pub struct Case {
    pub cells: usize,
    /// Radius of the sphere. Within the contact, the sphere equals the paraboloid of the same radius to one part in
    /// 400.
    pub radius: f64,
    pub gap: f64,
}

const fn block(cells: usize) -> Case {
    Case { cells, radius: 2.0, gap: -0.01 }
}

/// Blocks of 13,872, 104,544, 811,200, 2,387,124 and 19,827,984 dofs; the third case is a block of 104,544 dofs with a
/// wide contact.
pub const CASES: [Case; 6] =
    [block(16), block(32), Case { cells: 32, radius: 0.5, gap: -0.1 }, block(64), block(92), block(187)];

impl Case {
    pub fn scene(&self) -> Value {
        let axis = json!({"points": [0, 1], "divisions": [self.cells]});
        json!({
            "model": "space",
            "body": {"box": {"x": axis, "y": axis, "z": axis, "element": "hex8"}},
            "material": {"young": 1e7, "poisson": 0.3},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
            "obstacles": [{"boundary": "top", "approach": "+z", "rule": "approach",
                           "shape": {"sphere": {"apex": [0.5, 0.5, 1], "radius": self.radius}}}],
            "gap": self.gap,
        })
    }

    pub fn model(&self) -> Result<Model, Error> {
        Scene::from_json(&self.scene().to_string(), "block")?.build()
    }
}
