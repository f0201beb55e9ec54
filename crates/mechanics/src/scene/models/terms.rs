//! Terms of equations and springs: nodes and reference points with their coefficients.

use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::scene::input::entry::{boundary, finite, node_at, nodes_named_once, wrong};
use crate::scene::input::schema::{TermPlace, TermSpec};

/// The numbers of reference points, by their names and the paths of these.
pub(super) type NumberOfPoint<'a> = &'a dyn Fn(&str, String) -> Result<usize, Error>;

/// For terms of nodes alone.
pub(super) fn no_point(name: &str, path: String) -> Result<usize, Error> {
    Err(wrong(path, format!("the reference point `{name}` is not known here")))
}

/// The nodes and points of terms, each with its vector [x, y, z].
pub(super) fn terms_of(
    terms: &[TermSpec],
    path: &str,
    body: &ElasticBody,
    point: NumberOfPoint,
) -> Result<Vec<(usize, [f64; 3])>, Error> {
    let mut found = Vec::with_capacity(terms.len());
    for (index, term) in terms.iter().enumerate() {
        let path = format!("{path}.terms[{index}]");
        let (node, is_point) = match &term.on {
            TermPlace::Reference(name) => (point(name, format!("{path}.on.reference"))?, true),
            place => (node_of(place, &path, body)?, false),
        };
        let (vector, turns) = ([term.x, term.y, term.z], [term.rotation.x, term.rotation.y, term.rotation.z]);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            finite(format!("{path}.{name}"), vector[axis])?;
            if axis >= body.dimension() && vector[axis] != 0.0 {
                return Err(wrong(
                    format!("{path}.{name}"),
                    format!("a node of this model has no displacement {name}"),
                ));
            }
            finite(format!("{path}.rotation.{name}"), turns[axis])?;
            if turns[axis] != 0.0 && !(is_point && body.turns().contains(&axis)) {
                let message = match is_point {
                    true => format!("a point of this model does not turn about {name}"),
                    false => "a node has no rotation; a reference point has".into(),
                };
                return Err(wrong(format!("{path}.rotation.{name}"), message));
            }
        }
        if vector == [0.0; 3] && turns == [0.0; 3] {
            return Err(wrong(path, "has no coefficient; give x, y or z"));
        }
        found.push((node, vector));
    }
    match found.is_empty() {
        true => Err(wrong(format!("{path}.terms"), "has no term; give at least one")),
        false => Ok(found),
    }
}

fn node_of(place: &TermPlace, path: &str, body: &ElasticBody) -> Result<usize, Error> {
    let mesh = body.mesh();
    let (nodes, path) = match place {
        TermPlace::Point(at) => (vec![node_at(mesh, at, &format!("{path}.on.point"))?], String::new()),
        TermPlace::Boundary(name) => {
            let path = format!("{path}.on.boundary");
            (boundary(mesh, name, &path)?.nodes(), path)
        }
        TermPlace::Nodes(names) => {
            let path = format!("{path}.on.nodes");
            (nodes_named_once(mesh, names, &path)?, path)
        }
        TermPlace::Reference(_) => (Vec::new(), format!("{path}.on.reference")),
    };
    match nodes[..] {
        [node] => Ok(node),
        _ => Err(wrong(path, format!("has {} nodes; a term of an equation has one", nodes.len()))),
    }
}
