//! The range of the values of a field, without nodes at which the stress has no limit: under a point load, and at the
//! support of a single node.

use crate::plots::ticks::Scale;
use signorini_mechanics::scene::{Hold, Model};

/// Values that differ by less than this share of the largest differ by rounding: a picture would show noise as data.
pub(crate) const ROUNDING: f64 = 1e-9;

/// For each node of a body in the plane or in space: `true` if it shares an element with a node that alone is loaded,
/// or alone is held. The stress of these nodes grows with every refinement and says nothing of the rest of the body.
pub(crate) fn singular(model: &Model) -> Vec<bool> {
    let (mesh, dimension) = (model.mesh(), model.mesh().dimension());
    let count = mesh.nodes().len();
    let [mut loaded, mut held] = [(); 2].map(|()| vec![false; count]);
    model.loaded_nodes().for_each(|(node, _)| loaded[node] = true);
    let single = model.held_nodes().into_iter().filter(|node| !matches!(node.hold, Hold::RigidFace));
    single.for_each(|node| held[node.node] = true);
    let mut marked = vec![false; count];
    // The support of a bar is its end, not a point of it.
    for flags in [loaded, held].iter().filter(|_| dimension > 1) {
        mark_alone(flags, &|| mesh.elements(), &mut marked);
    }
    marked
}

/// Marks the nodes of the elements of each flagged node that shares no element with another flagged node.
fn mark_alone<'a, E: Iterator<Item = &'a [usize]>>(flags: &[bool], elements: &dyn Fn() -> E, marked: &mut [bool]) {
    let mut alone = flags.to_vec();
    for element in elements().filter(|element| element.iter().filter(|&&node| flags[node]).count() > 1) {
        element.iter().for_each(|&node| alone[node] = false);
    }
    for element in elements().filter(|element| element.iter().any(|&node| alone[node])) {
        element.iter().for_each(|&node| marked[node] = true);
    }
}

/// The smallest and the largest finite value at the other nodes; of all nodes if there are no others.
pub(crate) fn limits_without(singular: &[bool], values: &[f64]) -> [f64; 2] {
    let kept: Vec<f64> =
        values.iter().zip(singular).filter(|(_, singular)| !**singular).map(|(&value, _)| value).collect();
    common_limits([if kept.is_empty() { values } else { &kept[..] }])
}

/// The smallest and the largest finite value of all fields of a series, so that its pictures share their colours.
///
/// `[0, 1]` if there is no finite value.
pub fn common_limits<'a>(fields: impl IntoIterator<Item = &'a [f64]>) -> [f64; 2] {
    let values = fields.into_iter().flatten().copied().filter(|&value| Scale::Linear.shows(value));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low <= high { [low, high] } else { [0.0, 1.0] }
}
