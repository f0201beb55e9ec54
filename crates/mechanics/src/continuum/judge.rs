//! Judges any other displacement by the ball that contains the exact stress.

use super::bound::Bracket;
use super::simplex::{Point, Tensor, less, middle};
use crate::fem::element::{ElementKind, Tabulated};
use crate::fem::threads::each;

/// The distance of a displacement w from others, in the energy norm of the body without springs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// An upper bound of |u - w|; u is exact.
    pub bound: f64,
    /// |v - w|; v is the displacement of the bracket.
    pub from_displacement: f64,
    /// |w|.
    pub norm: f64,
}

impl Bracket<'_> {
    /// Judges a displacement by its strain in an element of the first mesh, at a point. The displacement needs no other property: the
    /// bound follows from its distance to the centre of the ball and the radius. Integrals are by five points in each direction on each
    /// part of a simplex.
    pub fn judged<S: Fn(Point) -> Tensor>(&self, strain_in: impl Fn(usize) -> S + Sync) -> Judged {
        let (dimension, parts) = (self.mesh.dimension, self.mesh.dimension + 1);
        // On these elements the shape functions are the barycentric coordinates; the weights add up to the size of the reference element.
        let kind = if dimension == 2 { ElementKind::LINEAR_TRIANGLE } else { ElementKind::LINEAR_TETRAHEDRON };
        let rule = Tabulated::fine(kind.reference()).points;
        let reference: f64 = rule.iter().map(|point| point.weight).sum();
        let of_cell = |cell: usize| {
            let (mut from_centre, mut from_displacement, mut norm) = (0.0, 0.0, 0.0);
            let (simplex, strain) = (self.mesh.simplex(cell), strain_in(self.mesh.origins[cell]));
            let law = self.law(cell);
            let volume = self.problem.thickness * simplex.size() / parts as f64 / reference;
            for k in 0..parts {
                let part = simplex.part(k);
                for point in &rule {
                    let weights = std::array::from_fn(|corner| if corner < parts { point.shape[corner] } else { 0.0 });
                    let own = strain(part.at(weights));
                    let volume = volume * self.problem.radius(part.at(weights));
                    let of_bracket = self.strain(&self.primal.values, cell, k, weights);
                    let balanced = law.compliance(self.elastic_stress(cell, k, weights));
                    let square = |strain: Tensor| point.weight * volume * law.square(strain);
                    from_centre += square(less(own, middle(of_bracket, balanced)));
                    from_displacement += square(less(own, of_bracket));
                    norm += square(own);
                }
            }
            [from_centre, from_displacement, norm]
        };
        let of_cells = each(self.mesh.count(), of_cell);
        let [from_centre, from_displacement, norm] =
            [0, 1, 2].map(|square| of_cells.iter().map(|cell| cell[square]).sum::<f64>().sqrt());
        Judged { bound: from_centre + self.square_of_radius().max(0.0).sqrt(), from_displacement, norm }
    }
}
