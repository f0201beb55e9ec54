//! Judges any other displacement by the ball that contains the exact stress.

use super::bound::Bracket;
use super::sample::Sample;
use super::simplex::{MOST_CORNERS, Point, Simplex, Tensor, Weights, less, middle};
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
    /// A function of the place that is linear.
    Linear(S),
    /// A function of the place.
    Varying(S),
}

impl Bracket<'_> {
    /// Judges a displacement by its strain in an element of the first mesh. The displacement needs no other property:
    /// the bound follows from its distance to the centre of the ball and the radius. Integrals of a constant or linear
    /// strain are exact, except where axes turn; those of others are by five points in each direction on each part of a
    /// simplex.
    pub fn judged<S: Fn(Point) -> Tensor>(&self, strain_in: impl Fn(usize) -> Strain<S> + Sync) -> Judged {
        let fine = self.fine_rule();
        let of_cell = |cell: usize| {
            let (simplex, strain) = (self.mesh.simplex(cell), strain_in(self.mesh.origins[cell]));
            let mut at_corners = [[0.0; 6]; MOST_CORNERS];
            match &strain {
                Strain::Constant(strain) => at_corners.fill(*strain),
                Strain::Linear(strain) => {
                    at_corners.iter_mut().zip(simplex.corners()).for_each(|(own, &corner)| *own = strain(corner));
                }
                Strain::Varying(_) => {}
            }
            let squares = |k: usize, at: &Sample| {
                let own = match &strain {
                    Strain::Varying(strain) => strain(at.place),
                    _ => mean(&at_corners, simplex.in_whole(k, at.weights)),
                };
                let law = self.law(cell, at.place);
                let of_bracket = self.strain(&self.primal.values, cell, k, at.weights);
                let balanced = law.compliance(self.elastic_stress(cell, k, at.weights));
                [less(own, middle(of_bracket, balanced)), less(own, of_bracket), own]
                    .map(|strain| at.weight * law.square(strain))
            };
            match strain {
                Strain::Varying(_) => self.sums(cell, &fine, squares),
                _ => self.sums(cell, &self.rule(cell), squares),
            }
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

/// The mean of tensors at the corners of a simplex with these weights.
fn mean(at_corners: &[Tensor], weights: Weights) -> Tensor {
    let mut mean = [0.0; 6];
    for (own, weight) in at_corners.iter().zip(weights) {
        mean.iter_mut().zip(own).for_each(|(sum, part)| *sum += weight * part);
    }
    mean
}
