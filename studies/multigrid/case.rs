//! The measured blocks.

use serde_json::Value;
use signorini::{Error, Model, Scene};

use crate::block::block;

/// A unit block with `cells` Hex8 elements along each side.
#[derive(Clone, Copy)]
pub struct Case {
    pub cells: usize,
    /// Radius of the sphere. Within the contact, the sphere equals the paraboloid of the same radius to one part in
    /// 400.
    pub radius: f64,
    pub gap: f64,
}

const fn of(cells: usize) -> Case {
    Case { cells, radius: 2.0, gap: -0.01 }
}

/// Blocks of 13,872, 104,544, 811,200, 2,387,124 and 19,827,984 dofs; the third case is a block of 104,544 dofs with a
/// wide contact.
pub const CASES: [Case; 6] = [of(16), of(32), Case { cells: 32, radius: 0.5, gap: -0.1 }, of(64), of(92), of(187)];

impl Case {
    pub fn dofs(&self) -> usize {
        3 * (self.cells + 1).pow(2) * self.cells
    }

    pub fn scene(&self) -> Value {
        block([1.0; 3], [self.cells; 3], "hex8", self.radius, self.gap)
    }
}

pub fn model(scene: &Value) -> Result<Model, Error> {
    Scene::from_json(&scene.to_string(), "block")?.build()
}
