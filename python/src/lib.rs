//! The Python module `signorini._signorini`, the interface of the library to Python.
//!
//! `arrays` and `matrices` read arrays with at most one copy. `work` runs the library without the interpreter, answers
//! interrupts and catches panics. `errors` makes exceptions, `exceptions` those of the errors of the library. Each
//! class has a file of its own.

mod answered;
mod arrays;
mod complementarity;
mod delassus;
mod derivative;
mod errors;
mod exceptions;
mod many;
mod matrices;
mod modes;
mod mortar;
mod options;
mod prepared;
mod problem;
mod scene;
mod sensitivity;
mod solution;
mod solving;
mod study;
mod total_error;
mod work;

use pyo3::prelude::*;

/// Frictionless unilateral contact as a convex QP, certified.
#[pymodule]
fn _signorini(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<problem::Problem>()?;
    module.add_class::<solution::Solution>()?;
    module.add_class::<solution::Certificate>()?;
    module.add_class::<solution::Proven>()?;
    module.add_class::<derivative::Gradient>()?;
    module.add_class::<derivative::Vjp>()?;
    module.add_class::<derivative::Tangent>()?;
    module.add_class::<derivative::Jvp>()?;
    module.add_class::<prepared::Prepared>()?;
    module.add_class::<prepared::Path>()?;
    module.add_class::<delassus::Delassus>()?;
    module.add_class::<prepared::Event>()?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<scene::SceneSolution>()?;
    module.add_class::<study::Comparison>()?;
    module.add_class::<total_error::TotalError>()?;
    module.add_class::<complementarity::LcpSolution>()?;
    module.add_function(wrap_pyfunction!(complementarity::lcp, module)?)?;
    module.add_function(wrap_pyfunction!(solving::solve, module)?)?;
    module.add_function(wrap_pyfunction!(solving::solve_qp, module)?)?;
    module.add_function(wrap_pyfunction!(many::solve_many, module)?)?;
    module.add_function(wrap_pyfunction!(solving::prepare, module)?)?;
    module.add_function(wrap_pyfunction!(solving::verify, module)?)?;
    module.add_function(wrap_pyfunction!(derivative::vjp, module)?)?;
    module.add_function(wrap_pyfunction!(derivative::jvp, module)?)?;
    module.add_function(wrap_pyfunction!(study::compare, module)?)?;
    module.add_function(wrap_pyfunction!(study::measured, module)?)?;
    module.add_function(wrap_pyfunction!(study::swept, module)?)?;
    module.add_function(wrap_pyfunction!(total_error::total_error, module)?)?;
    module.add_function(wrap_pyfunction!(sensitivity::sensitivity, module)?)?;
    module.add_function(wrap_pyfunction!(modes::modes, module)?)?;
    module.add_function(wrap_pyfunction!(mortar::mortar_rows, module)?)?;
    Ok(())
}
