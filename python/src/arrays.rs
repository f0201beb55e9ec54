//! Arrays from and to Python. Arrays of numpy are read in place; other objects are converted into arrays of numpy
//! first.

use pyo3::buffer::{Element, PyBuffer};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyBytes;

use crate::errors::{bad_input, bad_type, no_memory};

/// Returns a function or class of a Python module, which is imported only once.
pub fn imported<'py>(
    py: Python<'py>,
    cell: &'static PyOnceLock<Py<PyAny>>,
    module: &str,
    name: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let found = cell.get_or_try_init(py, || Ok::<_, PyErr>(py.import(module)?.getattr(name)?.unbind()))?;
    Ok(found.bind(py).clone())
}

/// Returns a function of numpy.
macro_rules! numpy {
    ($py:expr, $name:literal) => {{
        static FOUND: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        $crate::arrays::imported($py, &FOUND, "numpy", $name)
    }};
}

/// Returns the values of a contiguous buffer, in place.
///
/// The caller stays attached to the interpreter while the slice lives, so that no Python code can change it.
pub fn slice<'a, T: Element>(buffer: &'a PyBuffer<T>, _attached: Python<'_>) -> Option<&'a [T]> {
    if buffer.item_count() == 0 {
        return Some(&[]);
    }
    // SAFETY: the buffer holds `item_count` aligned values of this type, which `PyBuffer::get` has checked, and it
    // stays alive and in place while it is borrowed. Nothing writes to it: only code of the interpreter could, and that
    // waits for this thread.
    buffer.as_slice_ptr().map(|values| unsafe { &*values.as_ptr() })
}

/// Returns the class name of a Python object, for messages.
pub fn kind_of(object: &Bound<'_, PyAny>) -> String {
    object.get_type().name().map_or_else(|_| "object".into(), |name| name.to_string())
}

/// Converts the argument `name` into an array of numpy whose dtype has one of the `kinds`; other objects are refused
/// with a message.
fn array_of<'py>(name: &str, object: &Bound<'py, PyAny>, kinds: &str, wanted: &str) -> PyResult<Bound<'py, PyAny>> {
    let py = object.py();
    if object.is_none() {
        return Err(bad_type(py, format!("{name} is None; it must be {wanted}")));
    }
    if numpy!(py, "ma")?.call_method1("isMaskedArray", (object,))?.is_truthy()? {
        let advice = "fill it first, as numpy does with filled()";
        return Err(bad_type(py, format!("{name} is a masked array; {advice}")));
    }
    let array = numpy!(py, "asarray")?
        .call1((object,))
        .map_err(|error| bad_type(py, format!("{name} is no array ({}); it must be {wanted}", error.value(py))))?;
    let dtype = array.getattr("dtype")?;
    let kind: String = dtype.getattr("kind")?.extract()?;
    let is_long = kind == "f" && dtype.getattr("itemsize")?.extract::<usize>()? > size_of::<f64>();
    if !kinds.contains(&kind) || is_long {
        let what = if kind == "O" { format!("a {}", kind_of(object)) } else { "an array".into() };
        return Err(bad_type(py, format!("{name} is {what} of dtype {dtype}; it must be {wanted}")));
    }
    Ok(array)
}

/// Converts an array to this dtype, contiguous in C order and aligned.
fn required<'py>(array: &Bound<'py, PyAny>, dtype: Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    numpy!(array.py(), "require")?.call1((array, dtype, "CA"))
}

/// Converts an array to `f64`, contiguous in C order.
fn doubles<'py>(array: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    required(array, numpy!(array.py(), "float64")?)
}

/// Returns the buffer of an array of this type in the byte order of the machine, and `None` for any other array.
fn native<T: Element>(array: &Bound<'_, PyAny>) -> Option<PyBuffer<T>> {
    let buffer = PyBuffer::<T>::get(array).ok()?;
    let swapped: &[u8] = if cfg!(target_endian = "little") { b">!" } else { b"<" };
    let is_swapped = buffer.format().to_bytes().first().is_some_and(|order| swapped.contains(order));
    (!is_swapped).then_some(buffer)
}

/// Returns `true` for an array of numpy; an object of a derived class, such as a masked array, is none.
pub fn is_array(object: &Bound<'_, PyAny>) -> PyResult<bool> {
    Ok(object.get_type().is(&numpy!(object.py(), "ndarray")?))
}

/// Returns the buffer of an array of numpy that consists of doubles in C order, and `None` for any other object.
fn in_place(object: &Bound<'_, PyAny>) -> PyResult<Option<PyBuffer<f64>>> {
    Ok(is_array(object)?.then(|| native::<f64>(object)).flatten().filter(|buffer| buffer.is_c_contiguous()))
}

/// Passes a one-dimensional array of real numbers to `take`, in place if it consists of contiguous doubles.
pub fn with_reals<T>(name: &str, object: &Bound<'_, PyAny>, take: impl FnOnce(&[f64]) -> PyResult<T>) -> PyResult<T> {
    let py = object.py();
    if let Some(buffer) = in_place(object)?.filter(|buffer| buffer.dimensions() == 1) {
        return take(slice(&buffer, py).unwrap_or(&[]));
    }
    let array = array_of(name, object, "fiub", "an array of real numbers in one dimension, preferably float64")?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    if shape.len() != 1 {
        let shape = array.getattr("shape")?;
        let advice = if shape.len()? == 0 { "" } else { ", as ravel() makes it" };
        return Err(bad_input(py, format!("{name} has the shape {shape}; it must have one dimension{advice}")));
    }
    let buffer = PyBuffer::<f64>::get(&doubles(&array)?)?;
    take(slice(&buffer, py).unwrap_or(&[]))
}

/// Copies a one-dimensional array of real numbers.
pub fn reals(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    with_reals(name, object, |values| copied(object.py(), values))
}

/// Copies a one-dimensional array of real numbers, which must be finite.
pub fn finite_reals(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let values = reals(name, object)?;
    if let Some(entry) = values.iter().position(|value| !value.is_finite()) {
        let sentence = format!("{name} has the value {} at entry {entry} (from 0); it must be finite", values[entry]);
        return Err(bad_input(object.py(), sentence));
    }
    Ok(values)
}

/// Passes a two-dimensional array, row by row, and its shape to `take`, in place if it consists of contiguous doubles.
pub fn with_table<T>(
    name: &str,
    object: &Bound<'_, PyAny>,
    take: impl FnOnce(&[f64], [usize; 2]) -> PyResult<T>,
) -> PyResult<T> {
    let py = object.py();
    if let Some(buffer) = in_place(object)?
        && let &[rows, columns] = buffer.shape()
    {
        return take(slice(&buffer, py).unwrap_or(&[]), [rows, columns]);
    }
    let array = array_of(name, object, "fiub", "a matrix of real numbers")?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    let &[rows, columns] = shape.as_slice() else {
        let shape = array.getattr("shape")?;
        return Err(bad_input(py, format!("{name} has the shape {shape}; it must have two dimensions")));
    };
    let buffer = PyBuffer::<f64>::get(&doubles(&array)?)?;
    take(slice(&buffer, py).unwrap_or(&[]), [rows, columns])
}

/// Copies an array of real numbers of any shape, in C order, with its shape.
pub fn block(name: &str, object: &Bound<'_, PyAny>) -> PyResult<(Vec<f64>, Vec<usize>)> {
    let py = object.py();
    let array = array_of(name, object, "fiub", "an array of real numbers, preferably float64")?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    let buffer = PyBuffer::<f64>::get(&doubles(&array)?)?;
    Ok((copied(py, slice(&buffer, py).unwrap_or(&[]))?, shape))
}

/// Makes a read-only array of truth values.
pub fn of_truths<'py>(py: Python<'py>, values: &[bool]) -> PyResult<Bound<'py, PyAny>> {
    array(py, "?", values.iter().map(|&value| [u8::from(value)]))
}

/// Returns the columns of a two-dimensional array.
pub fn columns(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<f64>>> {
    with_table(name, object, |values, [_, columns]| {
        Ok((0..columns).map(|column| values.iter().skip(column).step_by(columns).copied().collect()).collect())
    })
}

/// Copies a two-dimensional array of indices, row by row, with its shape. A negative index becomes `usize::MAX`.
pub fn index_table(name: &str, object: &Bound<'_, PyAny>) -> PyResult<(Vec<usize>, [usize; 2])> {
    let py = object.py();
    let array = array_of(name, object, "iu", "an array of whole numbers in two dimensions")?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    let &[rows, columns] = shape.as_slice() else {
        let shape = array.getattr("shape")?;
        return Err(bad_input(py, format!("{name} have the shape {shape}; they must have two dimensions")));
    };
    let indices = Indices::of(name, &array.call_method1("reshape", (-1,))?)?.to_usize(py)?;
    Ok((indices, [rows, columns]))
}

/// Index arrays of scipy. They are read in place if they have 32 or 64 bits.
pub enum Indices {
    Short(PyBuffer<i32>),
    Long(PyBuffer<i64>),
}

impl Indices {
    pub fn of(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = object.py();
        let array = array_of(name, object, "iu", "an array of whole numbers in one dimension")?;
        if array.getattr("ndim")?.extract::<usize>()? != 1 {
            let shape = array.getattr("shape")?;
            return Err(bad_input(py, format!("{name} has the shape {shape}; it must have one dimension")));
        }
        if let Some(buffer) = native::<i32>(&array).filter(|buffer| buffer.is_c_contiguous()) {
            return Ok(Indices::Short(buffer));
        }
        let long = required(&array, numpy!(py, "int64")?)?;
        Ok(Indices::Long(PyBuffer::<i64>::get(&long)?))
    }

    pub fn len(&self) -> usize {
        match self {
            Indices::Short(buffer) => buffer.item_count(),
            Indices::Long(buffer) => buffer.item_count(),
        }
    }

    /// Copies the indices. A negative index becomes `usize::MAX`, which lies outside every matrix.
    pub fn to_usize(&self, py: Python<'_>) -> PyResult<Vec<usize>> {
        fn each<I: Copy + TryInto<usize>>(py: Python<'_>, indices: &[I]) -> PyResult<Vec<usize>> {
            let mut copy = room(py, indices.len())?;
            copy.extend(indices.iter().map(|&index| index.try_into().unwrap_or(usize::MAX)));
            Ok(copy)
        }
        match self {
            Indices::Short(buffer) => each(py, slice(buffer, py).unwrap_or(&[])),
            Indices::Long(buffer) => each(py, slice(buffer, py).unwrap_or(&[])),
        }
    }
}

/// Copies the values; raises an exception if there is no memory for the copy.
pub fn copied(py: Python<'_>, values: &[f64]) -> PyResult<Vec<f64>> {
    let mut copy = room(py, values.len())?;
    copy.extend_from_slice(values);
    Ok(copy)
}

/// Returns an empty vector with room for this number of entries; raises an exception if there is no memory for it.
pub fn room<T>(py: Python<'_>, entries: usize) -> PyResult<Vec<T>> {
    let mut room = Vec::new();
    match room.try_reserve_exact(entries) {
        Ok(()) => Ok(room),
        Err(error) => Err(no_memory(py, format!("{entries} entries of an array do not fit into memory: {error}"))),
    }
}

/// Makes a read-only array of numpy from these values.
pub fn array<'py, const N: usize>(
    py: Python<'py>,
    dtype: &str,
    values: impl ExactSizeIterator<Item = [u8; N]>,
) -> PyResult<Bound<'py, PyAny>> {
    let bytes = PyBytes::new_with(py, N * values.len(), |bytes| {
        bytes.chunks_exact_mut(N).zip(values).for_each(|(place, value)| place.copy_from_slice(&value));
        Ok(())
    })?;
    numpy!(py, "frombuffer")?.call1((bytes, dtype))
}

/// Makes a read-only array of doubles.
pub fn of_reals<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
    array(py, "f8", values.iter().map(|value| value.to_ne_bytes()))
}

/// Makes a read-only two-dimensional array of doubles from values given row by row.
pub fn of_table<'py>(py: Python<'py>, values: &[f64], columns: usize) -> PyResult<Bound<'py, PyAny>> {
    of_reals(py, values)?.call_method1("reshape", (values.len() / columns.max(1), columns))
}

/// Makes a read-only array of indices.
pub fn of_indices<'py>(py: Python<'py>, indices: impl IntoIterator<Item = usize>) -> PyResult<Bound<'py, PyAny>> {
    let indices: Vec<i64> = indices.into_iter().map(|index| index as i64).collect();
    array(py, "i8", indices.iter().map(|index| index.to_ne_bytes()))
}
