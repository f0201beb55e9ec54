//! Body shapes: each is named only in its file and here.

#[cfg(test)]
mod curved_bodies;
mod disc;
mod fan;
mod half_ball;
mod lattice;
mod mesh_file;
mod rectangle;
mod shape;

pub use disc::{DiscSpec, HalfDiscSpec, RingSpec, disc, half_disc, ring};
pub use half_ball::{HalfBallSpec, half_ball};
pub use mesh_file::{DeckSpec, GmshSpec};
pub use rectangle::{BarSpec, BoxSpec, RectangleSpec, bar, cuboid, rectangle};
pub use shape::Sides;
pub(crate) use shape::{About, BodyShape, BodySite};

use crate::fem::Integration;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The kinds of bodies: each with its variant, its numbers, its name and the dimensions of the models that allow it.
macro_rules! bodies {
    ($($(#[$about:meta])* $kind:ident($spec:ty): $name:literal $dimensions:expr,)*) => {
        /// The elastic body.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "kebab-case")]
        pub enum BodySpec {
            $($(#[$about])* $kind($spec),)*
        }

        /// All body shapes, in the order of messages.
        const ALL: &[About] = &[$(About { name: $name, dimensions: $dimensions }),*];

        impl BodySpec {
            /// The name of the body shape and the models that allow it.
            pub(crate) fn about(&self) -> About {
                match self { $(BodySpec::$kind(_) => About { name: $name, dimensions: $dimensions },)* }
            }

            /// The numbers of the body shape, of whatever kind it is.
            pub(crate) fn shape(&self) -> &dyn BodyShape {
                match self { $(BodySpec::$kind(spec) => spec,)* }
            }

            /// The sides that are circles, each with its centre and its radius.
            #[doc(hidden)]
            pub fn circles(&self) -> Vec<(&'static str, [f64; 2], f64)> {
                self.shape().circles()
            }

            /// The same, for changes.
            pub(crate) fn shape_mut(&mut self) -> &mut dyn BodyShape {
                match self { $(BodySpec::$kind(spec) => spec,)* }
            }
        }
    };
}

bodies! {
    /// A rectangle with a structured mesh; its boundaries are `left`, `right`, `bottom`, `top`. In an axisymmetric
    /// model it is the section of the body.
    Rectangle(RectangleSpec): "rectangle" &[2],
    /// A bar along x; its boundaries are `left`, `right`.
    Bar(BarSpec): "bar" &[1],
    /// A box with a structured mesh; its boundaries are `left`, `right` (along x), `front`, `back` (along y), `bottom`,
    /// `top` (along z).
    Box(BoxSpec): "box" &[3],
    /// A disc, graded towards its lowest and its highest point; its boundaries are `lower`, `upper` and, if only its
    /// right part is meshed, `symmetry-x`. In an axisymmetric model the right part with its centre at x = 0 is a ball.
    Disc(DiscSpec): "disc" &[2],
    /// Half of a disc, graded towards its lowest (highest) point; its boundaries are `cut` (flat), `arc` and, if only
    /// its right part is meshed, `symmetry-x`. In an axisymmetric model the right part with its centre at x = 0 is half
    /// a ball.
    HalfDisc(HalfDiscSpec): "half-disc" &[2],
    /// Half of a ball, or a quarter or an eighth of one, graded towards its lowest (highest) point; its boundaries are
    /// `cut` (flat), `round` and the planes `symmetry-x` and `symmetry-y`.
    HalfBall(HalfBallSpec): "half-ball" &[3],
    /// A ring or a sector of a ring; its boundaries are `inner`, `outer` and, if it is not closed, `start` and `end`.
    Ring(RingSpec): "ring" &[2],
    /// A mesh written by Gmsh; its physical groups are the boundaries.
    Gmsh(GmshSpec): "gmsh" &[1, 2, 3],
    /// The mesh of an input deck of CalculiX; its surfaces are the boundaries.
    Deck(DeckSpec): "deck" &[2, 3],
}

impl BodySpec {
    /// The integration of the stiffness that the scene asks for.
    pub(crate) fn integration(&self) -> Integration {
        match self {
            BodySpec::Rectangle(spec) => spec.integration,
            BodySpec::Bar(_) => Integration::Standard,
            BodySpec::Box(spec) => spec.integration,
            BodySpec::Disc(spec) => spec.integration,
            BodySpec::HalfDisc(spec) => spec.integration,
            BodySpec::HalfBall(spec) => spec.integration,
            BodySpec::Ring(spec) => spec.integration,
            BodySpec::Gmsh(spec) => spec.integration,
            BodySpec::Deck(spec) => spec.integration,
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
