//! Body shapes: each has its own file and is named only there and here.

mod bar;
mod cuboid;
#[cfg(test)]
mod curved_bodies;
mod deck;
mod disc;
mod gmsh;
mod half_ball;
mod half_disc;
mod rectangle;
mod ring;
mod shape;

pub use bar::{BarSpec, bar};
pub use cuboid::{BoxSpec, cuboid};
pub use deck::DeckSpec;
pub use disc::{DiscSpec, disc};
pub use gmsh::GmshSpec;
pub use half_ball::{HalfBallSpec, half_ball};
pub use half_disc::{HalfDiscSpec, half_disc};
pub use rectangle::{RectangleSpec, rectangle};
pub use ring::{RingSpec, ring};
pub use shape::Sides;
pub(crate) use shape::{BodyShape, Site};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use shape::About;

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

/// The names of all body shapes, in the order of messages.
const ALL: [About; 9] = [
    rectangle::ABOUT,
    bar::ABOUT,
    cuboid::ABOUT,
    disc::ABOUT,
    half_disc::ABOUT,
    half_ball::ABOUT,
    ring::ABOUT,
    gmsh::ABOUT,
    deck::ABOUT,
];

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
            BodySpec::Rectangle(spec) => (rectangle::ABOUT, spec),
            BodySpec::Bar(spec) => (bar::ABOUT, spec),
            BodySpec::Box(spec) => (cuboid::ABOUT, spec),
            BodySpec::Disc(spec) => (disc::ABOUT, spec),
            BodySpec::HalfDisc(spec) => (half_disc::ABOUT, spec),
            BodySpec::HalfBall(spec) => (half_ball::ABOUT, spec),
            BodySpec::Ring(spec) => (ring::ABOUT, spec),
            BodySpec::Gmsh(spec) => (gmsh::ABOUT, spec),
            BodySpec::Deck(spec) => (deck::ABOUT, spec),
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
