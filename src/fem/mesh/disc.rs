//! The disc: a half disc and its mirror image, joined along the cut.

use super::{Boundary, ElementKind, Mesh, Zone, fail, half_disc};
use crate::error::Error;

/// The disc of `radius` about `centre`, of T3, T6, Q4 or Q8, graded towards its lowest and its highest point; only the
/// part right of the centre where `symmetric`, which about the axis is a ball.
///
/// The boundaries are `lower` and `upper`, the halves of the circle, and, where `symmetric`, `symmetry-x` (x = centre).
///
/// ```
/// use signorini::fem::{ElementKind, Zone, disc};
///
/// let zone = Zone { width: 0.2, divisions: 3, growth: 1.5 };
/// let mesh = disc([0.0, 1.0], 1.0, &zone, false, ElementKind::Q4)?;
/// let (low, high) = mesh.extent();
/// assert!((high[1] - low[1] - 2.0).abs() < 1e-15 && mesh.boundary("lower").is_some());
/// # Ok::<(), signorini::Error>(())
/// ```
///
/// # Errors
/// As [`half_disc`].
pub fn disc(centre: [f64; 2], radius: f64, zone: &Zone, symmetric: bool, kind: ElementKind) -> Result<Mesh, Error> {
    let lower = half_disc(centre, radius, zone, symmetric, kind)?;
    let upper = lower.clone().mirrored(1, centre[1]);
    let Some(cut) = lower.boundary("cut").map(Boundary::nodes) else {
        return fail("a half disc without a cut cannot be joined".into());
    };
    let mut nodes = lower.nodes().to_vec();
    let mut number: Vec<usize> = vec![usize::MAX; nodes.len()];
    cut.iter().for_each(|&node| number[node] = node);
    for (node, at) in upper.nodes().iter().enumerate() {
        if number[node] == usize::MAX {
            number[node] = nodes.len();
            nodes.push(*at);
        }
    }
    let mirrored = |nodes: &[usize]| nodes.iter().map(|&node| number[node]).collect::<Vec<usize>>();
    let mut connectivity: Vec<usize> = lower.elements().flatten().copied().collect();
    upper.elements().for_each(|element| connectivity.extend(mirrored(element)));
    let mut boundaries = Vec::new();
    for (of_half, names) in [("arc", &["lower", "upper"][..]), ("symmetry-x", &["symmetry-x"][..])] {
        let Some(half) = lower.boundary(of_half) else { continue };
        let image = mirrored(&half.connectivity);
        match names {
            [one, other] => {
                boundaries.push(Boundary::new(*one, half.kind, half.connectivity.clone()));
                boundaries.push(Boundary::new(*other, half.kind, image));
            }
            _ => boundaries.push(Boundary::new(of_half, half.kind, [half.connectivity.clone(), image].concat())),
        }
    }
    Mesh::new(nodes, kind, connectivity, boundaries)
}
