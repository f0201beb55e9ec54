//! Two surfaces, their nodes, and the rows between them: plain data.

use super::facet::{PlacedFacet, SurfaceMesh};
use super::skin::TwoSkins;
use crate::element::FacetKind;
use crate::formulation::Formulation;
use signorini_linear::SparseMatrix;

/// Two surfaces of different bodies that may touch, each with its own mesh.
///
/// ```
/// use signorini_fem::{Boundary, FacetKind, Formulation, Mortar};
///
/// // The lower side of an upper body: one edge. The upper side of a lower body: two edges.
/// let upper = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
/// let lower = [[1.0, -0.1, 0.0], [0.5, -0.1, 0.0], [0.0, -0.1, 0.0]];
/// let slave = Boundary::new("bottom", FacetKind::Line2, vec![0, 1]);
/// let master = Boundary::new("top", FacetKind::Line2, vec![0, 1, 1, 2]);
/// let rows = Mortar::new((&upper, &slave), (&lower, &master), Formulation::PlaneStrain { thickness: 1.0 }).rows()?;
/// // Row 0 along -y: -u_y of node 0 of the upper body, and 3/4, 1/2, -1/4 of the lower nodes from left to right.
/// let row: Vec<f64> = (0..10).map(|dof| rows.contact.column(dof).filter(|entry| entry.0 == 0).map(|entry| entry.1).sum()).collect();
/// let expected = [0.0, -1.0, 0.0, 0.0, 0.0, -0.25, 0.0, 0.5, 0.0, 0.75];
/// assert!(row.iter().zip(expected).all(|(value, expected)| (value - expected).abs() < 1e-15));
/// assert!(rows.gap.iter().all(|gap| (gap - 0.1).abs() < 1e-15));
/// # Ok::<(), signorini_fem::Error>(())
/// ```
#[derive(Clone, Copy)]
pub struct Mortar<'a> {
    pub(super) slave: SurfaceMesh<'a>,
    pub(super) master: SurfaceMesh<'a>,
    pub(super) formulation: Formulation,
    pub(super) direction: Option<[f64; 3]>,
    pub(super) reach: f64,
    /// Which slave nodes may carry a row; all without it.
    #[doc(hidden)]
    pub may_carry: Option<&'a dyn Fn(usize) -> bool>,
    /// Which mid-side nodes of slave faces in space have a coefficient of the positive basis; all without it.
    #[doc(hidden)]
    pub has_coefficient: Option<&'a dyn Fn(usize) -> bool>,
    pub(super) between: Option<TwoSkins<'a>>,
    /// A node at a corner has a row for each side, as contact needs it: what sticks together does not.
    #[doc(hidden)]
    pub has_sides: bool,
}

/// The rows of a [`Mortar`] in the nodal displacements: `contact * [u_slave, u_master] <= gap`.
#[derive(Clone, Debug)]
pub struct MortarRows {
    /// B, dimensionless: a row for each entry of `nodes`, `dim` columns for each node of the slave surface, then of the
    /// master surface.
    pub contact: SparseMatrix,
    /// The mean distance of the undeformed surfaces over the area of each row, in length; negative where they overlap.
    pub gap: Vec<f64>,
    /// The area of each row, positive, in area: thickness or circumference included. A multiplier over it is a
    /// pressure.
    pub area: Vec<f64>,
    /// Dimensionless unit normal [x, y, z] of each row, from the slave body into the other.
    pub normal: Vec<[f64; 3]>,
    /// The node of the slave surface that carries each row, from 0.
    pub nodes: Vec<usize>,
}

/// One row: `normal . (sum slave - sum master) <= gap`.
#[derive(Clone, Debug)]
pub struct MortarRow {
    /// The slave node that carries it; at a corner it carries a row for each side.
    pub node: usize,
    /// The coefficients of slave nodes with their shares, which add up to 1, and displacements of master nodes with
    /// theirs.
    pub slave: Vec<(usize, f64)>,
    pub master: Vec<(usize, f64)>,
    pub normal: [f64; 3],
    /// Half way between the normals of both surfaces, from the slave body into the other.
    pub mean: [f64; 3],
    /// The outward unit normal of the slave surface at the node, of the side that carries the row.
    pub outward: [f64; 3],
    pub gap: f64,
    pub area: f64,
    /// The share of the whole area of the node that is covered.
    pub covered: f64,
}

/// A master node and the place of the slave surface that it faces.
#[derive(Clone, Debug)]
pub struct Opposite {
    pub node: usize,
    /// The nodes of the slave facet with the values of their shape functions at that place.
    pub slave: Vec<(usize, f64)>,
    /// Unit vector from the slave body into the other.
    pub normal: [f64; 3],
    /// Distance of the node from that place along the normal, in length; negative inside the slave body.
    pub gap: f64,
}

/// All rows with what the search for them found.
#[derive(Clone, Debug, Default)]
pub struct FoundRows {
    pub rows: Vec<MortarRow>,
    /// The covered share of the area of the slave surface, and the share of the master nodes, each counted with its
    /// facets, that face it.
    pub covered: [f64; 2],
    /// The nodes in ascending order of each slave facet that faces the other surface, and the covered share of its
    /// area.
    pub facets: Vec<(Vec<usize>, f64)>,
    /// The master nodes that face the slave surface.
    pub opposite: Vec<Opposite>,
    /// The largest distance of a straight facet from the curve for which it stands, in length, by the angles of the
    /// normals around it.
    pub sag: f64,
}

/// A surface with nodes of its own.
pub(super) struct Sided {
    nodes: Vec<[f64; 3]>,
    facets: Vec<usize>,
    /// The node of the surface that each of its nodes is.
    pub node: Vec<usize>,
}

impl Sided {
    /// A surface with those of its nodes that facets have, in their order.
    pub fn alone(surface: &SurfaceMesh) -> Self {
        let mut node = surface.facets.to_vec();
        node.sort_unstable();
        node.dedup();
        let place = |one: &usize| node.partition_point(|other| other < one);
        let facets = surface.facets.iter().map(place).collect();
        Sided { nodes: node.iter().map(|&node| surface.nodes[node]).collect(), facets, node }
    }

    /// A surface in which a node at a corner is several nodes at one place, one for each side.
    pub fn of(surface: &SurfaceMesh) -> Self {
        let count = surface.kind.nodes();
        let facets: Vec<PlacedFacet> =
            surface.facets.chunks_exact(count).map(|nodes| PlacedFacet::new(surface, nodes)).collect();
        let mut around: Vec<Vec<usize>> = vec![Vec::new(); surface.nodes.len()];
        for (number, facet) in facets.iter().enumerate() {
            facet.nodes.iter().for_each(|&node| around[node].push(number));
        }
        let node = (0..surface.nodes.len()).collect();
        let mut sided = Sided { nodes: surface.nodes.to_vec(), facets: surface.facets.to_vec(), node };
        for (node, mut left) in around.into_iter().enumerate() {
            let mut is_first = true;
            while let Some(first) = left.pop() {
                // All facets that are alike, one to the next, are one side.
                let mut side = vec![first];
                let mut next = 0;
                while let Some(&one) = side.get(next) {
                    next += 1;
                    let (alike, others) = left.into_iter().partition(|&other| facets[one].is_alike(&facets[other]));
                    side.extend::<Vec<usize>>(alike);
                    left = others;
                }
                if !is_first {
                    for facet in side {
                        let own = &mut sided.facets[count * facet..count * (facet + 1)];
                        own.iter_mut().filter(|own| **own == node).for_each(|own| *own = sided.nodes.len());
                    }
                    sided.nodes.push(surface.nodes[node]);
                    sided.node.push(node);
                }
                is_first = false;
            }
        }
        sided
    }

    pub fn has_corners(&self) -> bool {
        self.node.last().is_some_and(|&last| last + 1 < self.node.len())
    }

    /// The surface with these nodes.
    pub fn surface(&self, kind: FacetKind) -> SurfaceMesh<'_> {
        SurfaceMesh { nodes: &self.nodes, kind, facets: &self.facets }
    }
}

/// The same with the nodes of both surfaces.
pub(super) fn named(mut found: FoundRows, [slave, master]: [&[usize]; 2]) -> FoundRows {
    let renamed = |list: &mut Vec<(usize, f64)>, nodes: &[usize]| {
        let mut sums: Vec<(usize, f64)> = Vec::with_capacity(list.len());
        for (node, share) in list.drain(..) {
            match sums.iter_mut().find(|sum| sum.0 == nodes[node]) {
                Some(sum) => sum.1 += share,
                None => sums.push((nodes[node], share)),
            }
        }
        *list = sums;
    };
    for row in &mut found.rows {
        row.node = slave[row.node];
        renamed(&mut row.slave, slave);
        renamed(&mut row.master, master);
    }
    for (nodes, _) in &mut found.facets {
        nodes.iter_mut().for_each(|node| *node = slave[*node]);
        nodes.sort_unstable();
    }
    for seen in &mut found.opposite {
        seen.node = master[seen.node];
        renamed(&mut seen.slave, slave);
    }
    found
}
