//! Elements with one stiffness: their nodes lie alike, and they have one material.

use crate::fem::body::ElasticBody;

/// Coordinates are known to this many units in the last place: they are products and sums of the numbers of a scene.
const COORDINATE_ULPS: f64 = 4.0;

/// For each element one before it, or itself, whose stiffness it has to the rounding of coordinates.
pub(super) struct Congruent {
    representative: Vec<u32>,
}

impl Congruent {
    /// Compares each element with the representative of the element before it. Elements of a body of revolution, or with axes that turn,
    /// have their own stiffness each.
    pub fn of(body: &ElasticBody) -> Self {
        let has_turning_axes = body.phases().iter().any(|phase| phase.law.turns());
        let is_alone = body.formulation().is_axisymmetric() || has_turning_axes;
        let mut last = 0;
        let mut representative_of = |element: usize| {
            if is_alone || !are_congruent(body, last, element) {
                last = element;
            }
            last as u32
        };
        Congruent { representative: (0..body.mesh().element_count()).map(&mut representative_of).collect() }
    }

    /// The element whose stiffness `element` has.
    pub fn representative(&self, element: usize) -> u32 {
        self.representative[element]
    }
}

/// Returns `true` if one element is the other one moved by a translation.
fn are_congruent(body: &ElasticBody, one: usize, other: usize) -> bool {
    let mesh = body.mesh();
    let of_one_kind =
        mesh.kind_of(one) == mesh.kind_of(other) && std::ptr::eq(body.phase_of(one), body.phase_of(other));
    let mut pairs =
        mesh.element(one).iter().zip(mesh.element(other)).map(|pair| (mesh.nodes()[*pair.0], mesh.nodes()[*pair.1]));
    let Some(first) = pairs.next().filter(|_| of_one_kind) else { return false };
    pairs.all(|(one, other)| {
        (0..3).all(|axis| {
            let [a, b, c, d] = [one[axis], first.0[axis], other[axis], first.1[axis]];
            let size = a.abs().max(b.abs()).max(c.abs()).max(d.abs());
            ((a - b) - (c - d)).abs() <= COORDINATE_ULPS * f64::EPSILON * size
        })
    })
}
