//! A displaced body: the data that change from one answer to the next.

use std::collections::BTreeMap;

use serde::Serialize;

use super::body::Shape;
use super::packed::{Packed, Packer};
use crate::view::field::{Between, FIELDS, Field, Source};
use crate::view::magnified::carried;
use signorini_mechanics::Error;
use signorini_mechanics::scene::Answer;

/// Displacement, stress and fields at the vertices. Displacement and stress are linear in the answer, so that a page
/// may mix two states.
#[derive(Debug, Serialize)]
pub(super) struct State {
    /// Position on the path: gap, force or time.
    pub at: f64,
    displacement: Packed,
    /// The components xx, yy, zz, xy, and in space yz and zx.
    stress: Packed,
    /// The roots of the other fields that colour a body, by name, one a vertex: 16 bits then hold small values too.
    roots: BTreeMap<&'static str, Packed>,
    /// The shift of each obstacle along its approach direction, in length.
    shifts: Vec<f64>,
    /// The mean displacement of the contact with each obstacle, with which it is shifted beside a magnified
    /// displacement, in length.
    carried: Vec<[f64; 3]>,
}

impl State {
    /// The state of an answer at the position `at` of the path, packed.
    pub fn of(answer: &Answer, at: f64, shape: &Shape, packer: &mut Packer) -> Result<Self, Error> {
        let model = answer.model();
        let dimension = model.mesh().dimension();
        let components = components(dimension);
        let stress: Vec<f64> =
            answer.stress()?.nodes.iter().flat_map(|of| of.components().into_iter().take(components)).collect();
        let mut roots = BTreeMap::new();
        for field in of_roots() {
            let own = (field.values)(&Source { answer, velocity: None })?.at_nodes;
            let own: Vec<f64> = shape.at_vertices(&own, 1).into_iter().map(f64::sqrt).collect();
            roots.insert(field.name, packer.quantised(&own, 1));
        }
        Ok(State {
            at,
            displacement: packer.quantised(&shape.at_vertices(answer.displacement(), dimension), dimension),
            stress: packer.quantised(&shape.at_vertices(&stress, components), components),
            roots,
            shifts: (0..model.obstacles().len()).map(|obstacle| answer.shift(obstacle)).collect(),
            carried: (0..model.obstacles().len()).map(|obstacle| carried(answer, obstacle)).collect(),
        })
    }

    /// Bytes of a state before they are deflated.
    pub fn bytes(shape: &Shape, dimension: usize) -> usize {
        2 * shape.nodes.len() * (dimension + components(dimension) + of_roots().count())
    }
}

/// The fields of which a page mixes the roots.
fn of_roots() -> impl Iterator<Item = &'static Field> {
    FIELDS.iter().filter(|field| field.colours.is_some_and(|colours| colours.between == Between::OfRoots))
}

/// Components of the stress in a model of `dimension` coordinates.
fn components(dimension: usize) -> usize {
    if dimension == 3 { 6 } else { 4 }
}

/// Indices of the kept states among `count`, at most `most`: the first, the last, and others evenly between.
pub(super) fn kept(count: usize, most: usize) -> Vec<usize> {
    let most = most.max(2);
    match count {
        count if count <= most => (0..count).collect(),
        count => (0..most).map(|index| index * (count - 1) / (most - 1)).collect(),
    }
}
