//! The fields of an answer as a `.vtu` file.

use super::vtu::{Array, Unstructured};
use crate::view::field::{FIELDS, Field, Source, Values};
use signorini_mechanics::Error;

/// The text of the `.vtu` file with all fields.
pub(crate) fn fields(source: &Source) -> Result<String, Error> {
    let mesh = source.answer.model().mesh();
    let elements: Vec<Vec<usize>> = mesh.elements().map(<[usize]>::to_vec).collect();
    let values = FIELDS.iter().map(|field| (field.values)(source)).collect::<Result<Vec<Values>, Error>>()?;
    let arrays = |of: fn(&Values) -> &[f64]| -> Vec<Array> {
        let present = FIELDS.iter().zip(&values).filter(|(_, values)| !of(values).is_empty());
        let array = |field: &Field, values| match field.components {
            1 => Array::Scalars(field.name, values),
            3 => Array::Vectors(field.name, values),
            _ => Array::Tensors(field.name, values),
        };
        present.map(|(field, values)| array(field, of(values))).collect()
    };
    Unstructured {
        nodes: mesh.nodes(),
        cell_types: &(0..elements.len()).map(|element| mesh.kind_of(element)).collect::<Vec<_>>(),
        elements: &elements,
        point_data: &arrays(|values| &values.at_nodes),
        cell_data: &arrays(|values| &values.in_elements),
    }
    .to_vtu()
}
