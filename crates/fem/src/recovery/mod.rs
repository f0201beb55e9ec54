//! Stress recovery: at the centroids, and extrapolated to the nodes and averaged there; the discretisation error from
//! it.

pub mod along;
pub mod patches;
pub mod state;

pub use patches::discretisation_error;
pub use state::stress;

use std::collections::{BTreeMap, BTreeSet};

use crate::body::ElasticBody;
use crate::dense::DenseMatrix;
use crate::element::{MAX_NODES, PerNode, Tabulated, TabulatedPoint};
use crate::formulation::Formulation;
use crate::geometry::{Symmetric, principal};

/// The stress at a point, in force per area; tension is positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stress {
    /// Normal stress along x; the radial stress of a body of revolution.
    pub sigma_xx: f64,
    /// Normal stress sigma_yy at the point, along y.
    pub sigma_yy: f64,
    /// Normal stress along z: `nu (sigma_xx + sigma_yy)` in plane strain, 0 in plane stress, the hoop stress of a body
    /// of revolution.
    pub sigma_zz: f64,
    /// Shear stress sigma_xy at the point, between x and y.
    pub sigma_xy: f64,
    /// Shear stress between y and z; 0 except in space.
    pub sigma_yz: f64,
    /// Shear stress between z and x; 0 except in space.
    pub sigma_zx: f64,
    /// The largest principal stress; except in space, the largest of those in the plane.
    pub sigma_1: f64,
    /// The second principal stress. In the plane the smaller one, and so the largest compression there.
    pub sigma_2: f64,
    /// The smallest principal stress in space; otherwise sigma_zz, whatever its size.
    pub sigma_3: f64,
    /// The von Mises stress of all components.
    pub von_mises: f64,
}

impl Stress {
    /// The stress with the given components in the plane and normal to it, in force per area, tension positive.
    pub fn new(sigma_xx: f64, sigma_yy: f64, sigma_xy: f64, sigma_zz: f64) -> Self {
        let centre = (sigma_xx + sigma_yy) / 2.0;
        let radius = ((sigma_xx - sigma_yy) / 2.0).hypot(sigma_xy);
        // sqrt(((s1-s2)^2 + (s2-s3)^2 + (s3-s1)^2)/2) with (s1-s2)/2 = radius, (s1+s2)/2 = centre, s3 = sigma_zz.
        let von_mises = (3_f64.sqrt() * radius).hypot(centre - sigma_zz);
        let (sigma_1, sigma_2, sigma_3) = (centre + radius, centre - radius, sigma_zz);
        let (sigma_yz, sigma_zx) = (0.0, 0.0);
        Stress { sigma_xx, sigma_yy, sigma_zz, sigma_xy, sigma_yz, sigma_zx, sigma_1, sigma_2, sigma_3, von_mises }
    }

    /// The stress with the components `[xx, yy, zz, xy, yz, zx]` in space, in force per area, tension positive.
    pub fn in_space(components: Symmetric) -> Self {
        let [sigma_xx, sigma_yy, sigma_zz, sigma_xy, sigma_yz, sigma_zx] = components;
        let values = principal(&components).map(|principal| principal.map(|(value, _)| value));
        let [sigma_1, sigma_2, sigma_3] = values.unwrap_or([f64::NAN; 3]);
        let normal = (sigma_xx - sigma_yy).hypot(sigma_yy - sigma_zz).hypot(sigma_zz - sigma_xx) / 2_f64.sqrt();
        let shear = sigma_xy.hypot(sigma_yz).hypot(sigma_zx) * 3_f64.sqrt();
        let von_mises = normal.hypot(shear);
        Stress { sigma_xx, sigma_yy, sigma_zz, sigma_xy, sigma_yz, sigma_zx, sigma_1, sigma_2, sigma_3, von_mises }
    }

    /// The components `[xx, yy, zz, xy, yz, zx]`.
    pub fn components(&self) -> Symmetric {
        [self.sigma_xx, self.sigma_yy, self.sigma_zz, self.sigma_xy, self.sigma_yz, self.sigma_zx]
    }

    /// The traction on a plane with the unit normal `normal`, in force per area.
    #[doc(hidden)]
    pub fn on(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        [
            self.sigma_xx * x + self.sigma_xy * y + self.sigma_zx * z,
            self.sigma_xy * x + self.sigma_yy * y + self.sigma_yz * z,
            self.sigma_zx * x + self.sigma_yz * y + self.sigma_zz * z,
        ]
    }
}

/// The stress of a displaced body, at the centroid of each element and, averaged, at each node.
#[derive(Clone, Debug, PartialEq)]
pub struct StressField {
    /// One stress per element, at its centroid, in the order of the mesh.
    pub elements: Vec<Stress>,
    /// One stress per node, in the order of the mesh: extrapolated from the quadrature points, averaged over the
    /// elements around the node, of all materials.
    pub nodes: Vec<Stress>,
    /// The average over the elements of each phase, by node and phase, where several phases meet: there the stress
    /// jumps.
    sides: BTreeMap<(usize, u32), Stress>,
}

impl StressField {
    /// The stress of a node in a phase with an element at that node.
    pub fn within(&self, node: usize, phase: u32) -> &Stress {
        match self.sides.is_empty() {
            true => &self.nodes[node],
            false => self.sides.get(&(node, phase)).unwrap_or(&self.nodes[node]),
        }
    }

    /// The field of the whole of which `body` is a part: at a node on a plane of symmetry the shear stresses of the
    /// mirror images cancel. `axes_at` gives the axes across the planes on which a node lies.
    #[doc(hidden)]
    pub fn of_whole(mut self, body: &ElasticBody, axes_at: impl Fn(usize) -> [bool; 3]) -> Self {
        let nodes = self.nodes.iter_mut().enumerate();
        let sides = self.sides.iter_mut().map(|(&(node, _), stress)| (node, stress));
        for (node, stress) in nodes.chain(sides) {
            let [x, y, z] = axes_at(node);
            if x || y || z {
                let [xx, yy, zz, xy, yz, zx] = stress.components();
                let shear = |cancels: bool, value: f64| if cancels { 0.0 } else { value };
                *stress = finished(body, [xx, yy, zz, shear(x || y, xy), shear(y || z, yz), shear(z || x, zx)]);
            }
        }
        self
    }
}

/// The stresses at some nodes of a boundary, averaged over the elements around. `displacement` has `dim` entries per
/// node.
///
/// Quadratic elements are extrapolated, as in [`StressField::nodes`]. Linear ones give the stress at their centroid,
/// where it is most accurate: on a boundary without friction the normal stress does not change with the depth to first
/// order.
pub fn stress_at(body: &ElasticBody, displacement: &[f64], nodes: &BTreeSet<usize>) -> BTreeMap<usize, Stress> {
    let (tables, extrapolations) = (body.tabulated(), body.extrapolations());
    let mut sums: BTreeMap<usize, (Symmetric, usize)> = BTreeMap::new();
    let mut is_wanted = vec![false; body.mesh().nodes().len()];
    nodes.iter().for_each(|&node| is_wanted[node] = true);
    let near = |index: &usize| body.mesh().element(*index).iter().any(|&node| is_wanted[node]);
    for element in (0..body.mesh().element_count()).filter(near).filter_map(|index| body.element(index)) {
        let (table, is_quadratic) = (tables.at(element.kind), element.kind.is_quadratic());
        let strained = body.strained(&tables, displacement, &element);
        let of_nodes = match is_quadratic {
            true => carried_to_nodes(table, extrapolations.at(element.kind), |at| strained.at(at).1),
            false => [strained.at(&table.centroid).1; MAX_NODES],
        };
        for (node, stress) in element.nodes.iter().zip(&of_nodes).filter(|(node, _)| is_wanted[**node]) {
            add(sums.entry(*node).or_default(), stress);
        }
    }
    let average = |(sum, count): (Symmetric, usize)| finished(body, sum.map(|component| component / count as f64));
    sums.into_iter().map(|(node, sum)| (node, average(sum))).collect()
}

fn finished(body: &ElasticBody, s: Symmetric) -> Stress {
    match body.formulation() {
        Formulation::Space => Stress::in_space(s),
        _ => Stress::new(s[0], s[1], s[3], s[2]),
    }
}

/// The values at the quadrature points of an element, carried to its nodes.
fn carried_to_nodes(
    table: &Tabulated,
    extrapolation: &DenseMatrix,
    value: impl Fn(&TabulatedPoint) -> Symmetric,
) -> PerNode<Symmetric> {
    let mut of_nodes = [[0.0; 6]; MAX_NODES];
    for (at, weights) in table.points.iter().zip(extrapolation.columns()) {
        carry(&value(at), weights, &mut of_nodes);
    }
    of_nodes
}

/// Adds to each node its share of a value at a quadrature point.
fn carry(value: &Symmetric, weights: &[f64], of_nodes: &mut [Symmetric]) {
    for (of_node, weight) in of_nodes.iter_mut().zip(weights) {
        of_node.iter_mut().zip(value).for_each(|(sum, component)| *sum += weight * component);
    }
}

/// Adds a value to a sum, and counts it.
fn add((sum, count): &mut (Symmetric, usize), value: &Symmetric) {
    sum.iter_mut().zip(value).for_each(|(sum, component)| *sum += component);
    *count += 1;
}
