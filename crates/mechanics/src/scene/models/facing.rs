//! Two surfaces that face each other, for ties: the means of one of them over the other.

use std::collections::{BTreeMap, HashSet};

use super::tie_row::TieRow;
use crate::error::Error;
use crate::fem::Boundary;
use crate::fem::assembly::DofMap;
use crate::fem::body::ElasticBody;
use crate::fem::mortar::{Found, MortarRow};
use crate::scene::Warning;
use crate::scene::input::entry::{boundary, number, positive, wrong};
use crate::scene::input::obstacle::SideOrder;
use crate::scene::input::obstacle::mortar::{ends, means};
use crate::scene::input::obstacle::order::facet_size;

/// Surfaces farther apart than this share of a facet are apart: far above what straight facets miss of a curve.
const APART: f64 = 0.1;

/// A surface covered by less than this share is only partly tied.
const COVERED: f64 = 1.0 - 1e-6;

/// Two surfaces within reach of each other.
pub(super) struct Facing<'a> {
    pub body: &'a ElasticBody,
    pub dofs: &'a DofMap,
    path: String,
    /// The one that takes the means, then the other.
    sides: [&'a Boundary; 2],
    /// `true` if the second of the given surfaces takes the means.
    pub is_swapped: bool,
    reach: f64,
    pub found: Found,
}

impl<'a> Facing<'a> {
    pub fn of(
        names: [&str; 2],
        reach: Option<f64>,
        path: &str,
        (body, dofs, order): (&'a ElasticBody, &'a DofMap, &SideOrder),
        warnings: &mut Vec<Warning>,
    ) -> Result<Self, Error> {
        let (path, mesh) = (path.to_string(), body.mesh());
        let one = boundary(mesh, names[0], &format!("{path}.boundary"))?;
        let other = boundary(mesh, names[1], &format!("{path}.to"))?;
        let is_swapped = order.carries_other(body, [one, other]);
        let sides = if is_swapped { [other, one] } else { [one, other] };
        let facet = facet_size(body, &[sides[0]]).powf(1.0 / (body.dimension() as f64 - 1.0));
        let reach = match reach {
            Some(reach) => positive(&format!("{path}.reach"), reach)?,
            None => facet,
        };
        let found = means((body, dofs), sides, (reach, None, false), &|_| true, &path)?;
        if found.rows.is_empty() {
            let [boundary, to] = names;
            let message = format!(
                "no facet of `{boundary}` faces `{to}` within {}; check the boundaries, or give a larger `reach`",
                number(reach)
            );
            return Err(wrong(path, message));
        }
        let [boundary, to] = sides.map(|side| side.name.clone());
        let apart = found.rows.iter().map(|row| row.gap.abs()).fold(0.0, f64::max);
        if apart > APART * facet {
            let (boundary, to) = (boundary.clone(), to.clone());
            warnings.push(Warning::TiedApart { tie: path.clone(), boundary, to, apart });
        }
        let [share, of_other] = found.covered;
        if share < COVERED && of_other < COVERED {
            warnings.push(Warning::PartlyTied { tie: path.clone(), boundary, to, share, of_other });
        }
        Ok(Facing { body, dofs, path, sides, is_swapped, reach, found })
    }

    /// The rows along the vector of each node, a unit vector.
    ///
    /// Where supports hold both surfaces along it, an equation would bind their neighbours: it goes to these.
    pub fn rows(&self, along: impl Fn(usize) -> [f64; 3]) -> Result<Vec<TieRow>, Error> {
        let dimension = self.body.dimension();
        let is_held =
            |node: usize, row: &MortarRow| self.dofs.along(node, &along(row.node)[..dimension]).free.is_empty();
        let faces_held = |row: &&MortarRow| {
            let nearest = row.master.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            is_held(row.node, row) && nearest.is_some_and(|nearest| is_held(nearest.0, row))
        };
        let held: HashSet<usize> = self.found.rows.iter().filter(faces_held).map(|row| row.node).collect();
        if held.is_empty() {
            return Ok(self.rows_along(&self.found, along));
        }
        let carries = |node: usize| !held.contains(&node);
        let handed_over = means((self.body, self.dofs), self.sides, (self.reach, None, false), &carries, &self.path)?;
        Ok(self.rows_along(&handed_over, along))
    }

    /// The rows of all nodes along one unit vector, also where supports hold both surfaces.
    pub fn all_rows(&self, along: [f64; 3]) -> Vec<TieRow> {
        self.rows_along(&self.found, |_| along)
    }

    fn rows_along(&self, found: &Found, along: impl Fn(usize) -> [f64; 3]) -> Vec<TieRow> {
        let (dofs, mesh) = (self.dofs, self.body.mesh());
        let row = |row: &MortarRow| {
            let ends = ends(row, &dofs.basis);
            let own = row.slave.iter().filter(|end| end.1 != 0.0).count();
            let along = along(row.node);
            let terms = ends.into_iter().map(|(node, share)| (node, along.map(|part| share * part))).collect();
            let at = Some(dofs.basis.place(mesh.nodes(), row.node));
            TieRow { terms, own: 0..own, at, value: 0.0, on_points: BTreeMap::new() }
        };
        found.rows.iter().map(row).collect()
    }
}
