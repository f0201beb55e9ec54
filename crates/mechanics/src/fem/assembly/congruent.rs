//! Elements with one stiffness: their nodes lie alike, and they have one material.

use crate::fem::body::ElasticBody;

/// Coordinates are known to this many units in the last place: they are products and sums of the numbers of a scene.
const COORDINATE_ULPS: f64 = 4.0;

/// For each element one before it, or itself, whose stiffness it has to the rounding of coordinates.
pub(super) struct Congruent {
    representative: Vec<u32>,
}

impl Congruent {
    /// Compares each element with the representative of the element before it. Elements of a body of revolution, or
    /// with axes that turn, have their own stiffness each.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::element::ElementKind;
    use crate::fem::formulation::Formulation;
    use crate::fem::material::Material;
    use crate::fem::mesh::Mesh;

    /// The representatives of a row of unit squares whose corners lie at `place(x, y)`.
    fn representatives(formulation: Formulation, place: impl Fn(f64, f64) -> [f64; 2]) -> Vec<u32> {
        let node = |index: usize| place((index / 2) as f64, (index % 2) as f64);
        let nodes = (0..12).map(|index| [node(index)[0], node(index)[1], 0.0]).collect();
        let connectivity = (0..5).flat_map(|cell| [0, 2, 3, 1].map(|corner| 2 * cell + corner)).collect();
        let bilinear = ElementKind::ALL.into_iter().find(|kind| kind.dimension() == 2 && kind.nodes() == 4).unwrap();
        let mesh = Mesh::new(nodes, bilinear, connectivity, Vec::new()).unwrap();
        let body = ElasticBody::new(mesh, Material::new(1.0, 0.3).unwrap(), formulation).unwrap();
        let soft = Material::new(0.5, 0.3).unwrap();
        let body = body.with_material(&[4], soft).unwrap();
        Congruent::of(&body).representative
    }

    #[test]
    fn cells_of_a_lattice_have_one_stiffness_and_others_their_own() {
        let plane = || Formulation::PlaneStrain { thickness: 1.0 };
        // A tenth is no binary number: cells differ by rounding.
        assert_eq!(representatives(plane(), |x, y| [0.1 * x + 3.0, 0.1 * y]), [0, 0, 0, 0, 4]);
        let stretched = |x: f64, y: f64| [x + if x > 2.5 { 1e-9 } else { 0.0 }, y];
        assert_eq!(representatives(plane(), stretched), [0, 0, 2, 3, 4]);
        let around_the_axis = Formulation::Axisymmetric;
        assert_eq!(representatives(around_the_axis, |x, y| [x, y]), [0, 1, 2, 3, 4]);
    }
}
