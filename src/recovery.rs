//! Stress recovery: sigma = D B u at the centroids, and extrapolated to the nodes and averaged there.

use nalgebra::Vector3;

use crate::body::{ElasticBody, gather};
use crate::error::Error;

/// The stress at a point, in force per area; tension is positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stress {
    /// Normal stress along x.
    pub sigma_xx: f64,
    /// Normal stress along y.
    pub sigma_yy: f64,
    /// Shear stress.
    pub sigma_xy: f64,
    /// Normal stress across the plane: nu (sigma_xx + sigma_yy) in plane strain, 0 in plane stress.
    pub sigma_zz: f64,
    /// The larger principal stress in the plane.
    pub sigma_1: f64,
    /// The smaller principal stress in the plane: the largest compression.
    pub sigma_2: f64,
    /// The von Mises stress of all components, sigma_zz included.
    pub von_mises: f64,
}

impl Stress {
    /// The stress of the given components.
    pub fn new(sigma_xx: f64, sigma_yy: f64, sigma_xy: f64, sigma_zz: f64) -> Self {
        let centre = (sigma_xx + sigma_yy) / 2.0;
        let radius = ((sigma_xx - sigma_yy) / 2.0).hypot(sigma_xy);
        // sqrt(((s1-s2)^2 + (s2-s3)^2 + (s3-s1)^2)/2) with (s1-s2)/2 = radius, (s1+s2)/2 = centre, s3 = sigma_zz.
        let von_mises = (3_f64.sqrt() * radius).hypot(centre - sigma_zz);
        let (sigma_1, sigma_2) = (centre + radius, centre - radius);
        Stress { sigma_xx, sigma_yy, sigma_xy, sigma_zz, sigma_1, sigma_2, von_mises }
    }
}

/// The stress of a displaced body.
#[derive(Clone, Debug, PartialEq)]
pub struct StressField {
    /// One per element, at its centroid.
    pub elements: Vec<Stress>,
    /// One per node: extrapolated from the quadrature points, averaged over the elements around the node.
    pub nodes: Vec<Stress>,
}

/// The stress in `body` at the nodal displacement `displacement` (length `2 * n_nodes`, order `[x_0, y_0, ...]`).
///
/// Exact where the displacement is linear.
///
/// # Errors
/// [`Error::Length`] where the displacement does not have two entries per node.
pub fn stress(body: &ElasticBody, displacement: &[f64]) -> Result<StressField, Error> {
    let node_count = body.mesh().nodes().len();
    if displacement.len() != 2 * node_count {
        let (found, expected) = (displacement.len(), 2 * node_count);
        return Err(Error::Length { name: "nodal displacement", found, expected, of: "nodal dofs" });
    }
    let (material, reference) = (body.material(), body.reference());
    let constitutive = material.constitutive();
    let finished = |plane: Vector3<f64>| Stress::new(plane.x, plane.y, plane.z, material.out_of_plane_stress(&plane));
    let mut elements = Vec::with_capacity(body.mesh().element_count());
    let mut sums = vec![(Vector3::zeros(), 0_usize); node_count];
    for (nodes, cell) in body.cells() {
        let local = gather(displacement, nodes);
        let stress_at = |at| constitutive * cell.strain(at, &local);
        elements.push(finished(stress_at(reference.centroid)));
        for (index, point) in reference.quadrature.iter().enumerate() {
            let at_point = stress_at(point.at);
            for (&node, weights) in nodes.iter().zip(reference.extrapolation) {
                sums[node].0 += at_point * weights[index];
            }
        }
        nodes.iter().for_each(|&node| sums[node].1 += 1);
    }
    let nodes = sums.iter().map(|(sum, count)| finished(sum / *count as f64)).collect();
    Ok(StressField { elements, nodes })
}
