//! Judges any other displacement by the ball that contains the exact stress.

use super::bound::Bracket;
use super::integration::samples;
use super::sample::Sample;
use super::simplex::{Point, Simplex, Tensor, less, middle};
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

/// The strain of a displacement in an element of the first mesh.
pub enum Strain<S> {
    /// The same everywhere.
    Constant(Tensor),
    /// A function of the place.
    Varying(S),
}

impl Bracket<'_> {
    /// Judges a displacement by its strain in an element of the first mesh. The displacement needs no other property:
    /// the bound follows from its distance to the centre of the ball and the radius. Integrals of a constant strain are
    /// exact, except where axes turn; those of others are by five points in each direction on each part of a simplex.
    pub fn judged<S: Fn(Point) -> Tensor>(&self, strain_in: impl Fn(usize) -> Strain<S> + Sync) -> Judged {
        let fine = self.fine_rule();
        let of_cell = |cell: usize| {
            let (mut from_centre, mut from_displacement, mut norm) = (0.0, 0.0, 0.0);
            let (simplex, strain) = (self.mesh.simplex(cell), strain_in(self.mesh.origins[cell]));
            for k in 0..=self.mesh.dimension {
                let part = simplex.part(k);
                let points = match strain {
                    Strain::Constant(_) => samples(self.problem, self.mesh.origins[cell], &part),
                    Strain::Varying(_) => fine(&part),
                };
                for Sample { weights, place, weight, .. } in points {
                    let law = self.law(cell, place);
                    let own = match &strain {
                        Strain::Constant(strain) => *strain,
                        Strain::Varying(strain) => strain(place),
                    };
                    let of_bracket = self.strain(&self.primal.values, cell, k, weights);
                    let balanced = law.compliance(self.elastic_stress(cell, k, weights));
                    let square = |strain: Tensor| weight * law.square(strain);
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

    /// Five points in each direction on a part of a simplex.
    fn fine_rule(&self) -> impl Fn(&Simplex) -> Vec<Sample> + Sync + use<'_> {
        let corners = self.mesh.dimension + 1;
        // On these elements the shape functions are the barycentric coordinates; the weights add up to the size of the
        // reference element.
        let kind = if corners == 3 { ElementKind::LINEAR_TRIANGLE } else { ElementKind::LINEAR_TETRAHEDRON };
        let rule = Tabulated::fine(kind.reference()).points;
        let reference: f64 = rule.iter().map(|point| point.weight).sum();
        move |part| {
            let volume = self.problem.thickness * part.size() / reference;
            let sample = |shape: &[f64], weight: f64| {
                let weights = std::array::from_fn(|corner| if corner < corners { shape[corner] } else { 0.0 });
                let place = part.at(weights);
                Sample { weights, place, weight: weight * volume * self.problem.radius(place), extra: 0.0 }
            };
            rule.iter().map(|point| sample(&point.shape, point.weight)).collect()
        }
    }
}
