//! Rows between two surfaces whose meshes do not match: dual mortar elements, integrated segment by segment over the
//! covered part.
//!
//! The slave surface carries a row at each of its nodes, with a dual function `psi_j` of the multiplier,
//! `integral psi_j phi_k = delta_jk D_j`, and `D_j = integral phi_j`, all over the part of the slave surface that the
//! master surface covers:
//!
//! ```text
//! n_j . (u_j - sum_l P_jl u_l) <= g_j,    P_jl = (integral psi_j phi_l) / D_j,    sum_l P_jl = 1.
//! ```
//!
//! A multiplier is a force; over `D_j` it is a pressure. A uniform pressure passes between any two meshes without
//! error. A node of which less than a tenth is covered carries no row: its function goes to the other nodes of its
//! facets, and its motion enters their rows. Functions of quadratic faces in space are those of the positive basis,
//! because a uniform pressure has no force at the corners of the others.
//!
//! # Source
//! B. I. Wohlmuth, SIAM J. Numer. Anal. 38 (2000) 989-1012 (dual functions); M. A. Puso, T. A. Laursen, J. Solberg,
//! Comput. Methods Appl. Mech. Engrg. 197 (2008) 555-566 (segments of quadratic faces); T. Cichosz, M. Bischoff,
//! Comput. Methods Appl. Mech. Engrg. 200 (2011) 1317-1332 (functions over the covered part); N. Max, J. Graphics Tools
//! 4 (1999) 1-6 (weights of normals); A. Popp, A. Seitz, M. W. Gee, W. A. Wall, Comput. Methods Appl. Mech. Engrg. 264
//! (2013) 67-80 (nodes that are dropped).

mod coverage;
mod data;
mod face;
mod facet;
mod line;
mod search;
mod skin;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;

use super::element::positive_coefficient;
use super::formulation::Formulation;
use super::geometry::{dot, minus, unit};
use super::mesh::Boundary;
use crate::error::Error;
use crate::geometry::shifted;
use coverage::{Covered, RowPart, kept, parts};
use data::{Sided, named};
use facet::{PlacedFacet, SurfaceMesh};
use search::{BothSurfaces, Distances, Sight};
use signorini_linear::SparseMatrix;

pub use data::{FoundRows, MortarRow, Opposite};
pub use data::{Mortar, MortarRows};
pub use skin::{Skin, TwoSkins};

/// A share below this is rounding of zero; one this close to 1 is 1.
const ROUNDING: f64 = 1e-12;

#[derive(Clone, Debug)]
pub struct Seen {
    /// Which slave facets face the master surface within reach.
    pub faces: Vec<bool>,
    /// A slave facet faces several layers of the master surface.
    pub has_layers: bool,
}

impl std::fmt::Debug for Mortar<'_> {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (slave, master) = (self.slave.facets.len(), self.master.facets.len());
        write!(out, "Mortar({slave} and {master} nodes of facets, {:?})", self.formulation)
    }
}

/// Returns `true` if facets of a surface, seen from outside, turn away from each other at a node.
pub fn has_corners(nodes: &[[f64; 3]], boundary: &Boundary) -> bool {
    let surface = SurfaceMesh::of((nodes, boundary));
    surface.kind.reference().dimension > 0 && Sided::of(&surface).has_corners()
}

impl<'a> Mortar<'a> {
    /// Rows at the nodes of `slave`, against `master`: better on the softer body, and on the finer mesh if both are as
    /// soft.
    ///
    /// Each surface is `(nodes, boundary)`: the coordinates [x, y, z] of its own nodes, in length, z = 0 in the plane,
    /// and facets that name these nodes. The body lies to the left of an edge; from outside, the corners of a face run
    /// counterclockwise.
    pub fn new(
        slave: (&'a [[f64; 3]], &'a Boundary),
        master: (&'a [[f64; 3]], &'a Boundary),
        formulation: Formulation,
    ) -> Self {
        Self::of(SurfaceMesh::of(slave), SurfaceMesh::of(master), formulation)
    }

    fn of(slave: SurfaceMesh<'a>, master: SurfaceMesh<'a>, formulation: Formulation) -> Self {
        let reach = f64::INFINITY;
        let (direction, between, may_carry, has_coefficient) = (None, None, None, None);
        let has_sides = false;
        Mortar { slave, master, formulation, direction, reach, may_carry, has_coefficient, between, has_sides }
    }

    /// The same with all rows along `direction`, a unit vector [x, y, z] from the slave body into the other, instead of
    /// half way between the normals of both surfaces.
    pub fn along(self, direction: [f64; 3]) -> Self {
        Mortar { direction: Some(direction), ..self }
    }

    /// The same without rows where the surfaces are farther apart than `reach`, in length.
    pub fn within(self, reach: f64) -> Self {
        Mortar { reach, ..self }
    }

    /// The same without rows where something solid lies between the surfaces. They belong to two bodies, `own` and
    /// `other`, of those with these skins.
    #[doc(hidden)]
    pub fn between(self, skins: &'a [Skin], [own, other]: [usize; 2]) -> Self {
        Mortar { between: Some(TwoSkins { skins, own, other }), ..self }
    }

    /// The rows in nodal displacements.
    ///
    /// # Errors
    /// [`Error::Mesh`] for facets that do not fit the formulation, nodes that do not exist, and a surface that lies in
    /// several layers before the other within reach.
    pub fn rows(&self) -> Result<MortarRows, Error> {
        let (found, dimension) = (self.found()?, self.formulation.dimension());
        let first_of_master = self.slave.nodes.len();
        let ends = self.ends_of_middles();
        let mut entries = Vec::new();
        for (index, row) in found.rows.iter().enumerate() {
            let slave = row.slave.iter().flat_map(|&(node, share)| {
                // A coefficient in nodal displacements.
                let inverse = positive_coefficient(1.0, [0.0; 2]);
                let [own, of_end] = match ends[node] {
                    Some(_) => [inverse, positive_coefficient(0.0, [1.0, 0.0])],
                    None => [1.0, 0.0],
                };
                let of_ends = ends[node].into_iter().flatten().map(move |end| (end, share * of_end));
                std::iter::once((node, share * own)).chain(of_ends)
            });
            let master = row.master.iter().map(|&(node, share)| (first_of_master + node, -share));
            for (node, share) in slave.chain(master) {
                let parts = row.normal.iter().take(dimension).enumerate().filter(|part| *part.1 != 0.0);
                entries.extend(parts.map(|(axis, part)| (index, dimension * node + axis, share * part)));
            }
        }
        let columns = dimension * (first_of_master + self.master.nodes.len());
        Ok(MortarRows {
            contact: SparseMatrix::from_triplets(found.rows.len(), columns, &entries)?,
            gap: found.rows.iter().map(|row| row.gap).collect(),
            area: found.rows.iter().map(|row| row.area).collect(),
            normal: found.rows.iter().map(|row| row.normal).collect(),
            nodes: found.rows.iter().map(|row| row.node).collect(),
        })
    }

    /// The rows in coefficients of slave nodes and displacements of master nodes.
    #[doc(hidden)]
    pub fn found(&self) -> Result<FoundRows, Error> {
        self.check()?;
        let alone @ [slave, master] = &[self.slave, self.master].map(|surface| Sided::alone(&surface));
        Ok(named(self.on(alone, |mortar| mortar.found_on_all_nodes())?, [&slave.node, &master.node]))
    }

    /// The same for surfaces that have all of their nodes.
    fn found_on_all_nodes(&self) -> Result<FoundRows, Error> {
        let sides = BothSurfaces::of(self);
        let Sight { covered, opposite, met } = self.sight(&sides);
        if let Some([slave, master]) = self.between.and_then(|_| sides.without_turned_away(&covered, &met)) {
            let [slave, master] =
                [(self.slave, &slave), (self.master, &master)].map(|(of, facets)| SurfaceMesh { facets, ..of });
            return Mortar { slave, master, ..*self }.found_on_all_nodes();
        }
        let sided @ [slave, master] = &[self.slave, self.master].map(|surface| Sided::of(&surface));
        if self.has_sides && sided.iter().any(Sided::has_corners) {
            return Ok(named(self.on(sided, |mortar| mortar.found_on_all_nodes())?, [&slave.node, &master.node]));
        }
        if let Some((index, one)) = covered.iter().enumerate().find(|(_, one)| one.has_layers()) {
            return Err(Error::Mesh {
                message: format!(
                    "facet {index} at {:?} faces several layers of the other surface, {:.3} times its area; give a reach that leaves one",
                    one.facet.middle,
                    one.facing / one.whole
                ),
            });
        }
        let carries = |node: usize| self.may_carry.is_none_or(|may_carry| may_carry(node));
        let kept = kept(&covered, self.slave.nodes.len(), &carries);
        let ends = self.ends_of_middles();
        let parts = parts(&covered, &kept);
        let distances = sides.has_curves().then(|| Distances::of(self, &sides, &met));
        let of_node = |(node, part): (usize, Option<RowPart>)| {
            let row = self.row(node, part?, &sides.normals, &ends)?;
            let gap = distances.as_ref().and_then(|distances| distances.of_row(&row, &ends)).unwrap_or(row.gap);
            Some(MortarRow { gap, ..row })
        };
        let rows: Vec<MortarRow> = parts.into_iter().enumerate().filter_map(of_node).collect();
        let sum = |part: fn(&Covered) -> f64| covered.iter().map(part).sum::<f64>();
        let area = sum(|facet| facet.area);
        // The other surface counts by its nodes: its area differs from that of what it covers.
        let seen: BTreeSet<usize> = opposite.iter().map(|seen| seen.node).collect();
        let of_facet = |facet: &PlacedFacet| facet.nodes.iter().filter(|node| seen.contains(node)).count() as f64;
        let seen_of_master: f64 = sides.master.iter().map(of_facet).sum();
        let of_master = (sides.master.len() * self.master.kind.nodes()) as f64;
        let share = |part: f64, of: f64| if of > 0.0 { part / of } else { 0.0 };
        Ok(FoundRows {
            covered: [share(area, sum(|facet| facet.whole)), share(seen_of_master, of_master)],
            facets: covered.iter().filter(|facet| facet.is_covered()).map(Covered::share).collect(),
            opposite,
            sag: sides.sag(),
            rows,
        })
    }

    /// What `find` gives on the nodes of other surfaces, which are some of these.
    fn on<T>(&self, [slave, master]: &[Sided; 2], find: impl FnOnce(&Mortar) -> T) -> T {
        let may_carry = |own: usize| self.may_carry.is_none_or(|may_carry| may_carry(slave.node[own]));
        let has_coefficient = |own: usize| self.has_coefficient.is_none_or(|has| has(slave.node[own]));
        find(&Mortar {
            slave: slave.surface(self.slave.kind),
            master: master.surface(self.master.kind),
            may_carry: Some(&may_carry),
            has_coefficient: Some(&has_coefficient),
            ..*self
        })
    }

    /// The same on those nodes of both surfaces that facets have.
    fn alone<T>(&self, find: impl FnOnce(&Mortar) -> T) -> T {
        self.on(&[self.slave, self.master].map(|surface| Sided::alone(&surface)), find)
    }

    /// What the search finds, without rows; surfaces may lie in several layers before each other.
    #[doc(hidden)]
    pub fn seen(&self) -> Result<Seen, Error> {
        self.check()?;
        Ok(self.alone(|mortar| {
            let sides = BothSurfaces::of(mortar);
            let covered = mortar.sight(&sides).covered;
            let has_layers = covered.iter().any(Covered::has_layers);
            Seen { faces: covered.iter().map(Covered::is_covered).collect(), has_layers }
        }))
    }

    /// The sag of each slave facet, in length.
    #[doc(hidden)]
    pub fn sags(&self) -> Vec<f64> {
        self.alone(|mortar| {
            let sides = BothSurfaces::of(mortar);
            sides.slave.iter().map(|one| facet::sag(std::slice::from_ref(one), &sides.normals[0])).collect()
        })
    }

    fn check(&self) -> Result<(), Error> {
        for surface in [self.slave, self.master] {
            let (reference, count) = (surface.kind.reference(), surface.kind.nodes());
            let dimension = self.formulation.dimension();
            if reference.dimension == 0 || reference.dimension + 1 != dimension {
                let (facet, name) = (reference.name, self.formulation.name());
                return Err(Error::Mesh { message: format!("facets {facet} are no surface of {name}") });
            }
            if surface.facets.len() % count != 0 {
                let message = format!("{} nodes are no facets of {count} nodes each", surface.facets.len());
                return Err(Error::Mesh { message });
            }
            if let Some(node) = surface.facets.iter().find(|&&node| node >= surface.nodes.len()) {
                let message = format!("a facet names node {node}, but there are {} nodes", surface.nodes.len());
                return Err(Error::Mesh { message });
            }
            let is_finite = |node: usize| surface.nodes[node].iter().all(|part| part.is_finite());
            if let Some(node) = surface.facets.iter().find(|&&node| !is_finite(node)) {
                return Err(Error::Mesh { message: format!("node {node} has a coordinate that is not finite") });
            }
        }
        Ok(())
    }

    /// The ends of the edge of each slave node that has a coefficient.
    fn ends_of_middles(&self) -> Vec<Option<[usize; 2]>> {
        let reference = self.slave.kind.reference();
        let mut ends = vec![None; self.slave.nodes.len()];
        if reference.dimension == 2 {
            for facet in self.slave.facets.chunks_exact(self.slave.kind.nodes()) {
                for (&middle, corners) in facet[reference.corners..].iter().zip(reference.mid_sides) {
                    if self.has_coefficient.is_none_or(|has| has(middle)) {
                        ends[middle] = Some(corners.map(|corner| facet[corner]));
                    }
                }
            }
        }
        ends
    }

    /// The row of a node; `None` if it has no area.
    fn row(
        &self,
        node: usize,
        part: RowPart,
        [own, others]: &[Vec<[f64; 3]>; 2],
        ends: &[Option<[usize; 2]>],
    ) -> Option<MortarRow> {
        let area = part.area;
        if area.is_nan() || area <= 0.0 {
            return None;
        }
        let shares = |sums: Vec<(usize, f64)>| -> Vec<(usize, f64)> {
            let snapped = |(node, sum): (usize, f64)| {
                let share = sum / area;
                (node, if (share - 1.0).abs() <= ROUNDING { 1.0 } else { share })
            };
            sums.into_iter().map(snapped).filter(|(_, share)| share.abs() > ROUNDING).collect()
        };
        let (slave, mut master) = (shares(part.slave), shares(part.master));
        master.sort_unstable_by_key(|entry| entry.0);
        // Negative shares count: only all of them together are as exact as the rows where the normals turn.
        let outward = master.iter().fold([0.0; 3], |sum, &(other, share)| shifted(sum, share, others[other]));
        let mean = unit(minus(own[node], unit(outward)));
        let normal = self.direction.unwrap_or(mean);
        // Relative to the node, so that surfaces far from the origin lose no digits.
        let origin = self.slave.nodes[node];
        let place = |at: usize| match ends[at] {
            Some(ends) => [0, 1, 2].map(|axis| {
                let value = |node: usize| self.slave.nodes[node][axis] - origin[axis];
                positive_coefficient(value(at), ends.map(value))
            }),
            None => minus(self.slave.nodes[at], origin),
        };
        let of_slave = slave.iter().map(|&(at, share)| share * dot(normal, place(at))).sum::<f64>();
        let of_master =
            master.iter().map(|&(at, share)| share * dot(normal, minus(self.master.nodes[at], origin))).sum::<f64>();
        let covered = area / part.full;
        let (gap, outward) = (of_master - of_slave, own[node]);
        Some(MortarRow { node, slave, master, normal, mean, outward, gap, area, covered })
    }
}
