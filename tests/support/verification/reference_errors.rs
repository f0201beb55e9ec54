//! Errors of an independent implementation on the manufactured blocks, and the quadrature with which it computed them.
//!
//! The strain has a square-root singularity at the edge of the contact, which this quadrature integrates inexactly. It
//! changes the energy error of quadratic elements by up to 0.9 %. With the same quadrature, the numbers can be
//! reproduced.

use signorini::fem::ElementKind::{self, Q4, Q8, T3, T6};
use signorini::fem::QuadraturePoint;

/// Relative errors in energy and in L2 of one element on one block.
pub struct ReferenceErrors {
    pub block: &'static str,
    pub cells: usize,
    pub kind: ElementKind,
    pub energy: f64,
    pub l2: f64,
}

const fn errors(block: &'static str, cells: usize, kind: ElementKind, energy: f64, l2: f64) -> ReferenceErrors {
    ReferenceErrors { block, cells, kind, energy, l2 }
}

/// The reference errors: in energy with four digits, in L2 with three.
pub const REFERENCE: [ReferenceErrors; 24] = [
    errors("smooth", 16, T3, 9.798e-2, 9.82e-3),
    errors("smooth", 16, Q4, 6.485e-2, 6.99e-3),
    errors("smooth", 16, T6, 1.791e-3, 8.76e-5),
    errors("smooth", 16, Q8, 5.060e-4, 4.58e-5),
    errors("smooth", 64, T3, 2.453e-2, 6.38e-4),
    errors("smooth", 64, Q4, 1.621e-2, 4.38e-4),
    errors("smooth", 64, T6, 1.128e-4, 1.34e-6),
    errors("smooth", 64, Q8, 3.163e-5, 7.15e-7),
    errors("generic edge", 16, T3, 5.721e-2, 2.03e-3),
    errors("generic edge", 16, Q4, 2.893e-2, 1.06e-3),
    errors("generic edge", 16, T6, 2.742e-3, 6.79e-5),
    errors("generic edge", 16, Q8, 1.898e-3, 4.70e-5),
    errors("generic edge", 64, T3, 1.446e-2, 1.17e-4),
    errors("generic edge", 64, Q4, 7.272e-3, 6.33e-5),
    errors("generic edge", 64, T6, 3.158e-4, 2.35e-6),
    errors("generic edge", 64, Q8, 2.127e-4, 1.02e-6),
    errors("Hertz", 16, T3, 7.971e-2, 2.35e-3),
    errors("Hertz", 16, Q4, 5.351e-2, 1.10e-3),
    errors("Hertz", 16, T6, 8.675e-3, 1.34e-4),
    errors("Hertz", 16, Q8, 6.001e-3, 9.62e-5),
    errors("Hertz", 64, T3, 2.105e-2, 1.34e-4),
    errors("Hertz", 64, Q4, 1.360e-2, 6.83e-5),
    errors("Hertz", 64, T6, 9.946e-4, 4.86e-6),
    errors("Hertz", 64, Q8, 6.668e-4, 2.06e-6),
];

/// The quadrature of the reference: twelve points on triangles, 3 x 3 on Q4, 4 x 4 on Q8.
pub fn reference_rule(kind: ElementKind) -> Vec<QuadraturePoint> {
    match kind {
        T3 | T6 => triangle_12(),
        Q4 => square(&[(-(0.6_f64).sqrt(), 5.0 / 9.0), (0.0, 8.0 / 9.0), ((0.6_f64).sqrt(), 5.0 / 9.0)]),
        _ => {
            // Gauss points +-sqrt(3/7 -+ 2/7 sqrt(6/5)), weights (18 +- sqrt 30)/36.
            let root = 2.0 / 7.0 * (1.2_f64).sqrt();
            let [inner, outer] = [(3.0 / 7.0 - root).sqrt(), (3.0 / 7.0 + root).sqrt()];
            let [heavy, light] = [(18.0 + 30_f64.sqrt()) / 36.0, (18.0 - 30_f64.sqrt()) / 36.0];
            square(&[(-outer, light), (-inner, heavy), (inner, heavy), (outer, light)])
        }
    }
}

fn square(line: &[(f64, f64)]) -> Vec<QuadraturePoint> {
    let row = |&(eta, down): &(f64, f64)| {
        line.iter().map(move |&(xi, across)| QuadraturePoint { at: [xi, eta, 0.0], weight: across * down })
    };
    line.iter().flat_map(row).collect()
}

/// D. A. Dunavant, High degree efficient symmetrical Gaussian quadrature rules for the triangle, 1985, degree 6.
fn triangle_12() -> Vec<QuadraturePoint> {
    let orbits = [
        (0.249_286_745_170_91, 0.249_286_745_170_91, 0.116_786_275_726_379),
        (0.063_089_014_491_502, 0.063_089_014_491_502, 0.050_844_906_370_207),
        (0.053_145_049_844_817, 0.310_352_451_033_784, 0.082_851_075_618_374),
    ];
    let mut points = Vec::new();
    for (a, b, weight) in orbits {
        let c = 1.0 - a - b;
        let places = [[a, b], [c, a], [b, c], [b, a], [a, c], [c, b]];
        let count = if a == b { 3 } else { 6 };
        points.extend(places[..count].iter().map(|&[x, y]| QuadraturePoint { at: [x, y, 0.0], weight: weight / 2.0 }));
    }
    points
}
