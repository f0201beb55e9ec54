//! Ties of a scene: linear equations E u = e between displacements.

use std::collections::HashSet;
use std::ops::Range;

use super::unknowns::Unknowns;
use crate::error::Error;
use crate::fem::assembly::DofMap;
use crate::fem::body::ElasticBody;
use crate::fem::mortar::MortarRow;
use crate::scene::Warning;
use crate::scene::input::entry::{
    COORDINATE_ROUNDING, boundary, finite, node_at, nodes_named_once, number, positive, wrong,
};
use crate::scene::input::obstacle::SideOrder;
use crate::scene::input::obstacle::mortar::{ends, means};
use crate::scene::input::obstacle::order::facet_size;
use crate::scene::input::schema::{EquationSpec, Place, Scene, TieSpec, TiedSurfacesSpec};
use signorini_qp::SparseMatrix;

/// Surfaces farther apart than this share of a facet are apart: far above what straight facets miss of a curve.
const APART: f64 = 0.1;

/// An equation of which less than this share is left by others follows from them: far above the rounding of integrals over facets.
const REPEATED: f64 = 1e-9;

/// A surface covered by less than this share is only partly tied.
const COVERED: f64 = 1.0 - 1e-6;

/// One equation: the sum of `vector . u` over its terms is `value`.
#[derive(Clone, Debug)]
pub(crate) struct TieRow {
    /// Nodes with their vectors [x, y, z], dimensionless; at a node with a coefficient for the coefficient.
    pub terms: Vec<(usize, [f64; 3])>,
    /// The nodes of its first side.
    pub own: Range<usize>,
    /// The place at which two surfaces are tied; `None` for an equation between nodes.
    pub at: Option<[f64; 3]>,
    value: f64,
}

impl TieRow {
    /// Its nodes, each with a node of the other side.
    pub fn sides(&self) -> impl Iterator<Item = (usize, usize)> {
        let (first, second) = self.terms.split_at(self.own.end);
        [(first, second), (second, first)]
            .into_iter()
            .flat_map(|(side, other)| side.iter().zip(std::iter::repeat(other.first())))
            .filter_map(|(term, other)| Some((term.0, other?.0)))
    }
}

/// All ties of a scene in the unknowns.
#[derive(Debug)]
pub(crate) struct Ties {
    pub rows: Vec<TieRow>,
    /// The rows of each tie of the scene.
    pub of_tie: Vec<Range<usize>>,
    /// E, a row for each of `rows`, dimensionless.
    pub matrix: SparseMatrix,
    /// e, in length.
    pub values: Vec<f64>,
    pub warnings: Vec<Warning>,
}

impl Ties {
    /// The same without equations that follow from others, as where three bodies meet that are tied to each other.
    fn without_repeated(self) -> Self {
        let stays = self.matrix.independent_rows(&self.values, REPEATED);
        let before = |row: usize| stays.partition_point(|&own| own < row);
        Ties {
            rows: stays.iter().map(|&row| self.rows[row].clone()).collect(),
            of_tie: self.of_tie.iter().map(|rows| before(rows.start)..before(rows.end)).collect(),
            matrix: self.matrix.select_rows(&stays),
            values: stays.iter().map(|&row| self.values[row]).collect(),
            warnings: self.warnings,
        }
    }
}

impl Scene {
    /// The ties, without equations that supports alone fulfil.
    ///
    /// # Errors
    /// [`Error::Scene`] for a boundary or a node that does not exist, surfaces that do not face each other, an equation without terms, and
    /// for one that supports contradict.
    pub(crate) fn tied(&self, body: &ElasticBody, dofs: &DofMap, unknowns: &Unknowns) -> Result<Ties, Error> {
        if !self.ties.is_empty() && self.analysis.is_some() {
            return Err(wrong("ties", "ties are for equilibria only; a motion has only supports"));
        }
        let surfaces = self.tied_surfaces().flatten().filter_map(|name| body.mesh().boundary(name));
        let order = SideOrder::of(body, surfaces);
        let (mut rows, mut of_tie, mut warnings) = (Vec::new(), Vec::with_capacity(self.ties.len()), Vec::new());
        let (mut entries, mut values) = (Vec::new(), Vec::new());
        let (dimension, rounding) = (body.dimension(), COORDINATE_ROUNDING * body.mesh().size());
        for (index, tie) in self.ties.iter().enumerate() {
            let path = format!("ties[{index}]");
            let found = match tie {
                TieSpec::Surfaces(spec) => of_surfaces(spec, &path, (body, dofs, &order), &mut warnings)?,
                TieSpec::Equation(spec) => vec![of_equation(spec, &path, body, dofs)?],
            };
            let first = rows.len();
            for row in found {
                let (mut free, mut left) = (Vec::new(), row.value);
                for (node, vector) in &row.terms {
                    let (entries, prescribed) = unknowns.along(dofs, *node, &vector[..dimension]);
                    left -= prescribed;
                    free.extend(entries.into_iter().map(|(column, part)| (rows.len(), column, part)));
                }
                if !free.is_empty() {
                    entries.extend(free);
                    values.push(left);
                    rows.push(row);
                } else if left.abs() > rounding {
                    let message = format!(
                        "supports prescribe all its displacements, and miss it by {}; change the tie or the supports",
                        number(left)
                    );
                    return Err(wrong(path, message));
                }
            }
            of_tie.push(first..rows.len());
        }
        let matrix = SparseMatrix::from_triplets(rows.len(), unknowns.count(), &entries)?;
        let ties = Ties { rows, of_tie, matrix, values, warnings };
        Ok(if ties.of_tie.len() > 1 { ties.without_repeated() } else { ties })
    }

    /// The pairs of boundaries that are tied.
    pub(crate) fn tied_surfaces(&self) -> impl Iterator<Item = [&str; 2]> {
        self.ties.iter().filter_map(|tie| match tie {
            TieSpec::Surfaces(TiedSurfacesSpec { boundary, to, .. }) => Some([boundary.as_str(), to.as_str()]),
            TieSpec::Equation(_) => None,
        })
    }
}

/// The rows of two surfaces: the means of one of them in every direction.
fn of_surfaces(
    spec: &TiedSurfacesSpec,
    path: &str,
    (body, dofs, order): (&ElasticBody, &DofMap, &SideOrder),
    warnings: &mut Vec<Warning>,
) -> Result<Vec<TieRow>, Error> {
    let path = format!("{path}.surfaces");
    let (mesh, dimension) = (body.mesh(), body.dimension());
    let one = boundary(mesh, &spec.boundary, &format!("{path}.boundary"))?;
    let other = boundary(mesh, &spec.to, &format!("{path}.to"))?;
    let sides = if order.carries_other(body, [one, other]) { [other, one] } else { [one, other] };
    let facet = facet_size(body, &[sides[0]]).powf(1.0 / (dimension as f64 - 1.0));
    let reach = match spec.reach {
        Some(reach) => positive(&format!("{path}.reach"), reach)?,
        None => facet,
    };
    let of_carriers = |carries: &dyn Fn(usize) -> bool| means((body, dofs), sides, (reach, None), carries, &path);
    let found = of_carriers(&|_| true)?;
    if found.rows.is_empty() {
        let message = format!(
            "no facet of `{}` faces `{}` within {}; check the boundaries, or give a larger `reach`",
            spec.boundary,
            spec.to,
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
    // Where supports hold both surfaces along an axis, an equation would bind their neighbours: it goes to these.
    let is_held = |node: usize, axis: usize| dofs.number(dimension * node + axis).is_none();
    let mut rows = Vec::with_capacity(dimension * found.rows.len());
    for axis in 0..dimension {
        let faces_held = |row: &&MortarRow| {
            let nearest = row.master.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            is_held(row.node, axis) && nearest.is_some_and(|nearest| is_held(nearest.0, axis))
        };
        let held: HashSet<usize> = found.rows.iter().filter(faces_held).map(|row| row.node).collect();
        let handed_over = match held.is_empty() {
            true => None,
            false => Some(of_carriers(&|node| !held.contains(&node))?),
        };
        for row in &handed_over.as_ref().unwrap_or(&found).rows {
            let ends = ends(row, &dofs.basis);
            let own = ends.iter().take_while(|end| body.region_at(end.0) == body.region_at(row.node)).count();
            let along = dofs.axes(row.node)[axis];
            let terms = ends.into_iter().map(|(node, share)| (node, along.map(|part| share * part))).collect();
            rows.push(TieRow { terms, own: 0..own, at: Some(dofs.basis.place(mesh.nodes(), row.node)), value: 0.0 });
        }
    }
    Ok(rows)
}

/// The row of an equation.
fn of_equation(spec: &EquationSpec, path: &str, body: &ElasticBody, dofs: &DofMap) -> Result<TieRow, Error> {
    let path = format!("{path}.equation");
    finite(format!("{path}.value"), spec.value)?;
    let (mut terms, mut own) = (Vec::new(), 0);
    for (index, term) in spec.terms.iter().enumerate() {
        let path = format!("{path}.terms[{index}]");
        let node = node_of(&term.on, &path, body)?;
        let vector = [term.x, term.y, term.z];
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            finite(format!("{path}.{name}"), vector[axis])?;
            if axis >= body.dimension() && vector[axis] != 0.0 {
                return Err(wrong(
                    format!("{path}.{name}"),
                    format!("a node of this model has no displacement {name}"),
                ));
            }
        }
        if vector == [0.0; 3] {
            return Err(wrong(path, "has no coefficient; give x, y or z"));
        }
        // The displacement of a node with a coefficient is a sum of coefficients.
        terms.extend(dofs.basis.values(node).map(|(of, part)| (of, vector.map(|along| part * along))));
        if index == 0 {
            own = terms.len();
        }
    }
    match terms.is_empty() {
        true => Err(wrong(format!("{path}.terms"), "has no term; give at least one")),
        false => Ok(TieRow { terms, own: 0..own, at: None, value: spec.value }),
    }
}

/// The one node of a term.
fn node_of(place: &Place, path: &str, body: &ElasticBody) -> Result<usize, Error> {
    let mesh = body.mesh();
    let (nodes, path) = match place {
        Place::Point(at) => (vec![node_at(mesh, at, &format!("{path}.on.point"))?], String::new()),
        Place::Boundary(name) => {
            let path = format!("{path}.on.boundary");
            (boundary(mesh, name, &path)?.nodes(), path)
        }
        Place::Nodes(names) => {
            let path = format!("{path}.on.nodes");
            (nodes_named_once(mesh, names, &path)?, path)
        }
    };
    match nodes[..] {
        [node] => Ok(node),
        _ => Err(wrong(path, format!("has {} nodes; a term of an equation has one", nodes.len()))),
    }
}
