//! Judges any other displacement by the ball that contains the exact stress.

use super::bound::Bracket;
use super::johnson_mercier::{at, part};
use super::problem::{Tensor, work};
use super::triangulation::Point;
use crate::fem::element::{FacetKind, Tabulated};
use crate::fem::geometry::minus;

/// The distance of a displacement w from others, in the energy norm.
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
    /// bound follows from its distance to the centre of the ball and the radius. Integrals are by 25 points on each third of a triangle.
    pub fn judged<S: Fn(Point) -> Tensor>(&self, strain_in: impl Fn(usize) -> S) -> Judged {
        let rule = Tabulated::fine(FacetKind::T3.reference()).points;
        let (mut from_centre, mut from_displacement, mut norm) = (0.0_f64, 0.0_f64, 0.0_f64);
        for triangle in 0..self.mesh.triangles.len() {
            // The weights of the rule add up to one half, and the thirds are equal.
            let volume = self.volume(triangle) / 3.0 * 2.0;
            let strain = strain_in(self.mesh.origins[triangle]);
            for k in 0..3 {
                let corners = part(self.mesh.corners(triangle), k);
                for point in &rule {
                    let weights = [point.shape[0], point.shape[1], point.shape[2]];
                    let place = [0, 1].map(|axis| (0..3).map(|corner| weights[corner] * corners[corner][axis]).sum());
                    let own = strain(place);
                    let of_bracket = self.strain(&self.primal.values, triangle, k, weights);
                    let balanced = self.problem.compliance(at(&self.stress[triangle], k, weights));
                    let centre = [0, 1, 2].map(|entry| (of_bracket[entry] + balanced[entry]) / 2.0);
                    let square = |strain: Tensor| point.weight * volume * work(self.problem.stress(strain), strain);
                    from_centre += square(minus(own, centre));
                    from_displacement += square(minus(own, of_bracket));
                    norm += square(own);
                }
            }
        }
        Judged {
            bound: from_centre.sqrt() + self.square_of_radius().max(0.0).sqrt(),
            from_displacement: from_displacement.sqrt(),
            norm: norm.sqrt(),
        }
    }
}
