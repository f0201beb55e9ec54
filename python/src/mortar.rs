//! Rows between two surfaces whose meshes do not match.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use signorini::Watch;
use signorini::fem::{Boundary, FacetKind, Formulation, Mortar};

use crate::arrays::{finite_reals, index_table, kind_of, of_indices, of_reals, of_table, room, with_table};
use crate::errors::{bad_input, bad_type};
use crate::exceptions::{plain_exception, signalled};
use crate::matrices::compressed;
use crate::options::{number, word};
use crate::work::{End, Place, run};

/// Surfaces with fewer facets are done in milliseconds.
const FEW_FACETS: usize = 1000;

/// The names of facets, first those of the plane.
const FACETS: [(&str, FacetKind); 6] = [
    ("Line2", FacetKind::Line2),
    ("Line3", FacetKind::Line3),
    ("T3", FacetKind::T3),
    ("Q4", FacetKind::Q4),
    ("T6", FacetKind::T6),
    ("Q8", FacetKind::Q8),
];

/// A model by its name; a thickness completes those of the plane.
#[derive(Clone, Copy)]
enum Model {
    PlaneStrain,
    PlaneStress,
    Axisymmetric,
    Space,
}

const MODELS: [(&str, Model); 4] = [
    ("plane-strain", Model::PlaneStrain),
    ("plane-stress", Model::PlaneStress),
    ("axisymmetric", Model::Axisymmetric),
    ("space", Model::Space),
];

/// A surface of a body: the coordinates of its nodes, and its facets.
struct Surface {
    nodes: Vec<[f64; 3]>,
    boundary: Boundary,
}

/// Returns the arrays of the rows between two surfaces, each `(nodes, facets, kind)`, as a dictionary.
#[pyfunction]
#[pyo3(name = "_mortar_rows", signature = (slave, master, model, thickness, direction, reach))]
pub fn mortar_rows<'py>(
    py: Python<'py>,
    slave: (Bound<'py, PyAny>, Bound<'py, PyAny>, Option<Bound<'py, PyAny>>),
    master: (Bound<'py, PyAny>, Bound<'py, PyAny>, Option<Bound<'py, PyAny>>),
    model: &Bound<'py, PyAny>,
    thickness: &Bound<'py, PyAny>,
    direction: Option<Bound<'py, PyAny>>,
    reach: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let formulation = formulation(model, positive("thickness", thickness)?)?;
    let slave = surface("slave", &slave, formulation)?;
    let master = surface("master", &master, formulation)?;
    let direction = direction.map(|direction| unit(&direction, formulation.dimension())).transpose()?;
    let reach = reach.map(|reach| positive("reach", &reach)).transpose()?;
    let facets = slave.boundary.facet_count() + master.boundary.facet_count();
    let place = if facets < FEW_FACETS { Place::Here } else { Place::Apart };
    let found = run(py, place, move |_: &Watch| {
        let [slave, master] = [&slave, &master].map(|surface| (surface.nodes.as_slice(), &surface.boundary));
        let mut mortar = Mortar::new(slave, master, formulation);
        mortar = direction.into_iter().fold(mortar, Mortar::along);
        reach.into_iter().fold(mortar, Mortar::within).rows()
    })?;
    let rows = match found {
        End::Done(Ok(rows)) => rows,
        End::Done(Err(error)) => return Err(plain_exception(py, error)),
        End::Signalled(signal, _) => return Err(signalled(py, signal, None)),
    };
    let whole = PyDict::new(py);
    whole.set_item("B", compressed(py, &rows.contact)?)?;
    whole.set_item("shape", (rows.contact.rows(), rows.contact.columns()))?;
    whole.set_item("g", of_reals(py, &rows.gap)?)?;
    whole.set_item("area", of_reals(py, &rows.area)?)?;
    let dimension = formulation.dimension();
    let normals: Vec<f64> = rows.normal.iter().flat_map(|normal| &normal[..dimension]).copied().collect();
    whole.set_item("normals", of_table(py, &normals, dimension)?)?;
    whole.set_item("nodes", of_indices(py, rows.nodes)?)?;
    Ok(whole)
}

fn formulation(model: &Bound<'_, PyAny>, thickness: f64) -> PyResult<Formulation> {
    let model = word("model", model, &MODELS)?;
    Ok(match model {
        Model::PlaneStrain => Formulation::PlaneStrain { thickness },
        Model::PlaneStress => Formulation::PlaneStress { thickness },
        Model::Axisymmetric => Formulation::Axisymmetric,
        Model::Space => Formulation::Space,
    })
}

/// Reads a positive and finite number.
fn positive(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let given = number(name, value)?;
    let sentence = || format!("{name} is {given}; it must be positive and finite");
    (given.is_normal() && given > 0.0).then_some(given).ok_or_else(|| bad_input(value.py(), sentence()))
}

/// Reads a direction, and makes its length 1.
fn unit(direction: &Bound<'_, PyAny>, dimension: usize) -> PyResult<[f64; 3]> {
    let py = direction.py();
    let given = finite_reals("direction", direction)?;
    if given.len() != dimension {
        return Err(bad_input(py, format!("direction has length {}; it must have length {dimension}", given.len())));
    }
    let largest = given.iter().fold(0.0_f64, |largest, part| largest.max(part.abs()));
    if largest == 0.0 {
        return Err(bad_input(py, "direction is zero; it must lead from the slave body into the other"));
    }
    let scaled: Vec<f64> = given.iter().map(|part| part / largest).collect();
    let length = scaled.iter().map(|part| part * part).sum::<f64>().sqrt();
    let mut unit = [0.0; 3];
    unit.iter_mut().zip(scaled).for_each(|(part, given)| *part = given / length);
    Ok(unit)
}

/// Reads the surface `name`, `(nodes, facets, kind)`.
fn surface<'py>(
    name: &str,
    (nodes, facets, kind): &(Bound<'py, PyAny>, Bound<'py, PyAny>, Option<Bound<'py, PyAny>>),
    formulation: Formulation,
) -> PyResult<Surface> {
    let py = nodes.py();
    let nodes = places(name, nodes, formulation)?;
    let (connectivity, [count, columns]) = index_table(&format!("facets of {name}"), facets)?;
    if count == 0 {
        return Err(bad_input(py, format!("facets of {name} are 0 x {columns}; a surface has one facet at least")));
    }
    let kind = match kind {
        Some(kind) => word(&format!("kind of {name}"), kind, &FACETS)?,
        None => by_columns(py, name, columns, formulation)?,
    };
    let about = FACETS.iter().find(|about| about.1 == kind).map_or("", |about| about.0);
    let fits = kind.reference().dimension + 1 == formulation.dimension();
    if !fits {
        let sentence = format!("facets of {name} are {about}; they are no surface of {}", formulation.name());
        return Err(bad_input(py, sentence));
    }
    if columns != kind.nodes() {
        let sentence = format!("facets of {name} are {count} x {columns}; {about} has {} columns", kind.nodes());
        return Err(bad_input(py, sentence));
    }
    if let Some(entry) = connectivity.iter().position(|&node| node >= nodes.len()) {
        let node = connectivity[entry];
        let node = if node == usize::MAX { "a node before 0".into() } else { format!("node {node}") };
        let sentence = format!(
            "facet {} of {name} (from 0) names {node}; there are {} nodes, from 0",
            entry / columns,
            nodes.len()
        );
        return Err(bad_input(py, sentence));
    }
    for (facet, of_facet) in connectivity.chunks_exact(columns).enumerate() {
        let doubled = of_facet.iter().enumerate().find(|&(at, node)| of_facet[..at].contains(node));
        if let Some((_, node)) = doubled {
            return Err(bad_input(py, format!("facet {facet} of {name} (from 0) names node {node} twice")));
        }
    }
    Ok(Surface { nodes, boundary: Boundary::new(name, kind, connectivity) })
}

/// The kind of facets with this number of columns.
fn by_columns(py: Python<'_>, name: &str, columns: usize, formulation: Formulation) -> PyResult<FacetKind> {
    let fits = |kind: &FacetKind| kind.reference().dimension + 1 == formulation.dimension();
    let known: Vec<_> = FACETS.into_iter().filter(|(_, kind)| fits(kind)).collect();
    let found = known.iter().find(|about| about.1.nodes() == columns).map(|about| about.1);
    found.ok_or_else(|| {
        let allowed: Vec<String> = known.iter().map(|(about, kind)| format!("{} ({about})", kind.nodes())).collect();
        let allowed = allowed.join(", ");
        bad_input(py, format!("facets of {name} have {columns} columns; in {} they have {allowed}", formulation.name()))
    })
}

/// Reads the coordinates of nodes, one row for each.
fn places(name: &str, nodes: &Bound<'_, PyAny>, formulation: Formulation) -> PyResult<Vec<[f64; 3]>> {
    let (py, name) = (nodes.py(), format!("nodes of {name}"));
    if nodes.extract::<String>().is_ok() {
        return Err(bad_type(py, format!("{name} is of the type {}; it must be an array", kind_of(nodes))));
    }
    with_table(&name, nodes, |values, [count, columns]| {
        let dimension = formulation.dimension();
        if columns != dimension {
            let of = formulation.name();
            return Err(bad_input(py, format!("{name} are {count} x {columns}; {of} has {dimension} coordinates")));
        }
        if let Some(entry) = values.iter().position(|value| !value.is_finite()) {
            let (value, node, axis) = (values[entry], entry / columns, entry % columns);
            let sentence = format!("{name} have the value {value} in row {node} and column {axis} (from 0)");
            return Err(bad_input(py, format!("{sentence}; it must be finite")));
        }
        let mut places = room(py, count)?;
        for (node, at) in values.chunks_exact(columns).enumerate() {
            if formulation.is_axisymmetric() && at[0] < 0.0 {
                let sentence = format!("{name} have the radius {} in row {node} (from 0); it must be 0 or more", at[0]);
                return Err(bad_input(py, sentence));
            }
            let mut place = [0.0; 3];
            place[..dimension].copy_from_slice(at);
            places.push(place);
        }
        Ok(places)
    })
}
