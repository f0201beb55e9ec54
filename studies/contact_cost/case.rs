//! The measured blocks: clamped at the bottom, with a parabola or a sphere pressed into the top.

use signorini::{Error, Model, Scene};

use crate::block::block;

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
    pub fn named(name: &str) -> Result<Case, String> {
        CASES.into_iter().find(|case| case.name == name).ok_or_else(|| format!("no case is named `{name}`"))
    }

    pub fn dofs(&self) -> usize {
        let (n, nodes) = (self.cells, self.cells + 1);
        if self.space { 3 * nodes * nodes * n } else { 2 * nodes * n }
    }

    pub fn model(&self) -> Result<Model, Error> {
        let scene = match self.space {
            true => block([1.0; 3], [self.cells; 3], "hex8", 1.0, FIRST_GAP),
            false => block([1.0; 2], [self.cells; 2], "q4", 1.0, FIRST_GAP),
        };
        Scene::from_json(&scene.to_string(), self.name)?.build()
    }
}
