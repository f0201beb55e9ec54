//! Body shapes: each is named only in its file and here.

#[cfg(test)]
mod curved_bodies;
mod disc;
mod half_ball;
mod mesh_file;
mod rectangle;
mod shape;

pub use disc::{DiscSpec, HalfDiscSpec, RingSpec, disc, half_disc, ring};
pub use half_ball::{HalfBallSpec, half_ball};
pub use mesh_file::{DeckSpec, GmshSpec};
pub use rectangle::{BarSpec, BoxSpec, RectangleSpec, bar, cuboid, rectangle};
pub use shape::Sides;
pub(crate) use shape::{About, BodyShape, Site};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The elastic body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BodySpec {
    /// A rectangle with a structured mesh; its boundaries are `left`, `right`, `bottom`, `top`. In an axisymmetric
    /// model it is the section of the body.
    Rectangle(RectangleSpec),
    /// A bar along x; its boundaries are `left`, `right`.
    Bar(BarSpec),
    /// A box with a structured mesh; its boundaries are `left`, `right` (along x), `front`, `back` (along y), `bottom`,
    /// `top` (along z).
    Box(BoxSpec),
    /// A disc, graded towards its lowest and its highest point; its boundaries are `lower`, `upper` and, if only its
    /// right part is meshed, `symmetry-x`. In an axisymmetric model the right part with its centre at x = 0 is a ball.
    Disc(DiscSpec),
    /// Half of a disc, graded towards its lowest (highest) point; its boundaries are `cut` (flat), `arc` and, if only
    /// its right part is meshed, `symmetry-x`. In an axisymmetric model the right part with its centre at x = 0 is half
    /// a ball.
    HalfDisc(HalfDiscSpec),
    /// Half of a ball, or a quarter or an eighth of one, graded towards its lowest (highest) point; its boundaries are
    /// `cut` (flat), `round` and the planes `symmetry-x` and `symmetry-y`.
    HalfBall(HalfBallSpec),
    /// A ring or a sector of a ring; its boundaries are `inner`, `outer` and, if it is not closed, `start` and `end`.
    Ring(RingSpec),
    /// A mesh written by Gmsh; its physical groups are the boundaries.
    Gmsh(GmshSpec),
    /// The mesh of an input deck of CalculiX; its surfaces are the boundaries.
    Deck(DeckSpec),
}

// A shape by its name, with the dimensions of the models that allow it.
const RECTANGLE: About = About { name: "rectangle", dimensions: &[2] };
const BAR: About = About { name: "bar", dimensions: &[1] };
const BOX: About = About { name: "box", dimensions: &[3] };
const DISC: About = About { name: "disc", dimensions: &[2] };
const HALF_DISC: About = About { name: "half-disc", dimensions: &[2] };
const HALF_BALL: About = About { name: "half-ball", dimensions: &[3] };
const RING: About = About { name: "ring", dimensions: &[2] };
const GMSH: About = About { name: "gmsh", dimensions: &[1, 2, 3] };
const DECK: About = About { name: "deck", dimensions: &[2, 3] };

/// The names of all body shapes, in the order of messages.
const ALL: [About; 9] = [RECTANGLE, BAR, BOX, DISC, HALF_DISC, HALF_BALL, RING, GMSH, DECK];

impl BodySpec {
    /// The name of the body shape and the models that allow it.
    pub(crate) fn about(&self) -> About {
        self.described().0
    }

    /// The numbers of the body shape, of whatever kind it is.
    pub(crate) fn shape(&self) -> &dyn BodyShape {
        self.described().1
    }

    /// What [`about`](Self::about) and [`shape`](Self::shape) return: the only place that distinguishes the kinds of
    /// bodies.
    fn described(&self) -> (About, &dyn BodyShape) {
        match self {
            BodySpec::Rectangle(spec) => (RECTANGLE, spec),
            BodySpec::Bar(spec) => (BAR, spec),
            BodySpec::Box(spec) => (BOX, spec),
            BodySpec::Disc(spec) => (DISC, spec),
            BodySpec::HalfDisc(spec) => (HALF_DISC, spec),
            BodySpec::HalfBall(spec) => (HALF_BALL, spec),
            BodySpec::Ring(spec) => (RING, spec),
            BodySpec::Gmsh(spec) => (GMSH, spec),
            BodySpec::Deck(spec) => (DECK, spec),
        }
    }

    /// The shape, for changes.
    pub(crate) fn shape_mut(&mut self) -> &mut dyn BodyShape {
        match self {
            BodySpec::Rectangle(spec) => spec,
            BodySpec::Bar(spec) => spec,
            BodySpec::Box(spec) => spec,
            BodySpec::Disc(spec) => spec,
            BodySpec::HalfDisc(spec) => spec,
            BodySpec::HalfBall(spec) => spec,
            BodySpec::Ring(spec) => spec,
            BodySpec::Gmsh(spec) => spec,
            BodySpec::Deck(spec) => spec,
        }
    }

    /// The bodies allowed in a model of `dimension` coordinates, as `box, half-ball or gmsh`.
    pub(crate) fn fitting(dimension: usize) -> String {
        let fits = |about: &&About| about.dimensions.contains(&dimension);
        let names: Vec<&str> = ALL.iter().filter(fits).map(|about| about.name).collect();
        match names.split_last() {
            Some((last, [])) => (*last).to_string(),
            Some((last, others)) => format!("{} or {last}", others.join(", ")),
            None => String::new(),
        }
    }
}
