//! Ties between two surfaces that face each other: the means of one of them over the other, and one equation.

use std::collections::{BTreeMap, HashSet};

use crate::error::Error;
use crate::fem::Boundary;
use crate::fem::assembly::DofMap;
use crate::fem::body::ElasticBody;
use crate::fem::mortar::{FoundRows, MortarRow};
use crate::fem::sum::{Component, LinearForm};
use crate::scene::Warning;
use crate::scene::input::entry::{boundary, number, positive, wrong};
use crate::scene::input::obstacle::SideOrder;
use crate::scene::input::obstacle::mortar::{COVERED, ends, means};
use crate::scene::input::obstacle::order::facet_size;

/// Surfaces farther apart than this share of a facet are apart: far above what straight facets miss of a curve.
const APART: f64 = 0.1;

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
    pub found: FoundRows,
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
        let [boundary, to] = sides.map(|side| &side.name);
        let apart = found.rows.iter().map(|row| row.gap.abs()).fold(0.0, f64::max);
        if apart > APART * facet {
            let message = format!(
                "{path}: `{boundary}` and `{to}` are tied over distances up to {apart:.2e}: forces along the surfaces turn both bodies over \
                 such a distance; move the bodies together, or give a smaller `reach`"
            );
            warnings.push(Warning::new("tied-apart", message));
        }
        let [share, of_other] = found.covered;
        if share < COVERED && of_other < COVERED {
            let message = format!(
                "{path}: {:.1} % of the area of `{boundary}` and {:.1} % of the nodes of `{to}` are tied; the rest is free, and the bodies \
                 can go through each other there",
                100.0 * share,
                100.0 * of_other
            );
            warnings.push(Warning::new("partly-tied", message));
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

    fn rows_along(&self, found: &FoundRows, along: impl Fn(usize) -> [f64; 3]) -> Vec<TieRow> {
        let (dofs, mesh) = (self.dofs, self.body.mesh());
        let row = |row: &MortarRow| {
            let ends = ends(row, &dofs.basis);
            let own = row.slave.iter().filter(|end| end.1 != 0.0).count();
            let form = LinearForm::along(along(row.node), &ends, own);
            TieRow { at: Some(dofs.basis.place(mesh.nodes(), row.node)), ..TieRow::of(form, 0.0) }
        };
        found.rows.iter().map(row).collect()
    }
}

/// One equation: a form in the displacements of nodes is `value`.
#[derive(Clone, Debug)]
pub struct TieRow {
    pub form: LinearForm,
    /// The place at which two surfaces are tied; `None` for an equation between nodes.
    pub at: Option<[f64; 3]>,
    pub value: f64,
    /// The coefficients of the prescribed components of reference points, which are in the value, and the shares of
    /// equations at points that the row has taken up.
    pub on_points: BTreeMap<Component, f64>,
}

impl TieRow {
    pub fn of(form: LinearForm, value: f64) -> Self {
        TieRow { form, at: None, value, on_points: BTreeMap::new() }
    }

    /// Its nodes, each with a node of the other side.
    pub fn sides(&self) -> impl Iterator<Item = (usize, usize)> {
        let [first, second] = self.form.sides();
        [(first, second), (second, first)]
            .into_iter()
            .flat_map(|(side, other)| side.iter().zip(std::iter::repeat(other.first())))
            .filter_map(|(term, other)| Some((term.0, other?.0)))
    }
}
