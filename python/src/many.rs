//! Many small dense problems of one size, solved at once.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use signorini::qp;
use signorini::{ContactProblem, ContactSet, SparseMatrix, SymmetricMatrix, Watch};

use crate::arrays::{block, of_reals, of_table, of_truths};
use crate::errors::bad_input;
use crate::exceptions::{plain_exception, signalled};
use crate::matrices::{by_columns, symmetric};
use crate::options::Options;
use crate::work::{End, Place, run};

/// Numbers of many problems: one block for each, or one block that all of them share.
struct Blocks {
    values: Vec<f64>,
    /// Number of values of one block.
    size: usize,
    is_shared: bool,
}

impl Blocks {
    fn of(&self, number: usize) -> &[f64] {
        let first = if self.is_shared { 0 } else { number * self.size };
        &self.values[first..first + self.size]
    }
}

/// The number of problems, as far as it is known, with the argument that says so.
type Count = Option<(usize, &'static str)>;

/// Reads the argument `name`, of which each problem has a block of this shape.
fn blocks(
    name: &'static str,
    object: &Bound<'_, PyAny>,
    of_one: &[Option<usize>],
    count: &mut Count,
) -> PyResult<(Blocks, Vec<usize>)> {
    let (py, (values, shape)) = (object.py(), block(name, object)?);
    let is_shared = shape.len() == of_one.len();
    let own = &shape[shape.len().saturating_sub(of_one.len())..];
    let fits = |(asked, &found): (&Option<usize>, &usize)| asked.is_none_or(|asked| asked == found);
    if (!is_shared && shape.len() != of_one.len() + 1) || !of_one.iter().zip(own).all(fits) {
        let asked: Vec<String> = of_one.iter().map(|size| size.map_or("any".into(), |size| size.to_string())).collect();
        let (asked, found) =
            (asked.join(", "), object.getattr("shape").map_or(String::new(), |shape| format!("{shape}")));
        let sentence = format!(
            "{name} has the shape {found}; it must be ({asked}) for all problems, or (N, {asked}) for N of them"
        );
        return Err(bad_input(py, sentence));
    }
    if !is_shared {
        match *count {
            Some((before, of)) if before != shape[0] => {
                let sentence = format!("{name} is given for {} problems, {of} for {before}", shape[0]);
                return Err(bad_input(py, sentence));
            }
            _ => *count = Some((shape[0], name)),
        }
    }
    Ok((Blocks { size: own.iter().product(), values, is_shared }, own.to_vec()))
}

/// All numbers of the problems.
struct Family {
    dofs: usize,
    rows: usize,
    stiffness: Blocks,
    load: Blocks,
    contact: Blocks,
    gap: Blocks,
    /// The stiffness and the rows that all problems share.
    shared: (Option<SymmetricMatrix>, Option<SparseMatrix>),
}

impl Family {
    /// A problem, zeros left out.
    fn problem(&self, number: usize) -> Result<ContactProblem, qp::Error> {
        let stiffness = match &self.shared.0 {
            Some(stiffness) => stiffness.clone(),
            None => symmetric(self.stiffness.of(number), self.dofs)?,
        };
        let contact = match &self.shared.1 {
            Some(contact) => contact.clone(),
            None => by_columns(self.contact.of(number), [self.rows, self.dofs])?,
        };
        ContactProblem::new(stiffness, self.load.of(number).to_vec(), contact, self.gap.of(number).to_vec())
    }
}

/// What is kept of an answer, or of none.
struct Kept {
    displacement: Vec<f64>,
    multiplier: Vec<f64>,
    /// Bounds on the error in the energy norm, absolute and relative.
    bounds: [f64; 2],
    proven: Option<qp::ProvenSet>,
    error: Option<qp::Error>,
}

impl Kept {
    fn of(answer: Result<qp::Solution, qp::Error>, dofs: usize, rows: usize) -> Self {
        match answer {
            Ok(solution) => Self::best(solution),
            Err(error) => {
                let kept = match &error {
                    qp::Error::NotCertified { solution, .. } => Self::best((**solution).clone()),
                    _ => {
                        let (displacement, multiplier) = (vec![f64::NAN; dofs], vec![f64::NAN; rows]);
                        Kept { displacement, multiplier, bounds: [f64::INFINITY; 2], proven: None, error: None }
                    }
                };
                Kept { error: Some(error), ..kept }
            }
        }
    }

    fn best(solution: qp::Solution) -> Self {
        let qp::Solution { displacement, multiplier, certificate, proven, .. } = solution;
        let bounds = [certificate.energy_error, certificate.energy_error_bound];
        Kept { displacement, multiplier, bounds, proven, error: None }
    }
}

/// Solves many problems of one size. Returns the arrays of their solutions, by name, and the exceptions of problems
/// without a certified solution.
#[pyfunction]
#[pyo3(name = "_solve_many")]
#[pyo3(signature = (K, f, B, g, method, accuracy, time, threads, tolerance, proof))]
#[expect(non_snake_case, reason = "the names of the equation")]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn solve_many<'py>(
    K: &Bound<'py, PyAny>,
    f: &Bound<'py, PyAny>,
    B: &Bound<'py, PyAny>,
    g: &Bound<'py, PyAny>,
    method: Option<Bound<'py, PyAny>>,
    accuracy: Option<Bound<'py, PyAny>>,
    time: Option<Bound<'py, PyAny>>,
    threads: Option<Bound<'py, PyAny>>,
    tolerance: Option<Bound<'py, PyAny>>,
    proof: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let py = K.py();
    let mut count = None;
    let (load, of_load) = blocks("f", f, &[None], &mut count)?;
    let dofs = of_load[0];
    let (stiffness, _) = blocks("K", K, &[Some(dofs), Some(dofs)], &mut count)?;
    let (gap, of_gap) = blocks("g", g, &[None], &mut count)?;
    let rows = of_gap[0];
    let (contact, _) = blocks("B", B, &[Some(rows), Some(dofs)], &mut count)?;
    let count = count.map_or(1, |count| count.0);
    let failed = |error| plain_exception(py, error);
    let shared = (
        stiffness.is_shared.then(|| symmetric(&stiffness.values, dofs)).transpose().map_err(failed)?,
        contact.is_shared.then(|| by_columns(&contact.values, [rows, dofs])).transpose().map_err(failed)?,
    );
    let condense = Some(true);
    let options =
        Options { method, accuracy, tolerance, time, threads, proof: Some(proof), condense, ..Options::default() };
    let settings = options.settings_for(Some(dofs * (dofs + 1) / 2))?;
    let family = Family { dofs, rows, stiffness, load, contact, gap, shared };
    let work = move |watch: &Watch| {
        settings.watched(watch).each_of_many(count, |number, settings| {
            let answer = family.problem(number).and_then(|problem| qp::solve(&problem, settings));
            Kept::of(answer, dofs, rows)
        })
    };
    match run(py, Place::Apart, work)? {
        End::Done(kept) => arrays_of(py, kept, dofs, rows),
        End::Signalled(signal, _) => Err(signalled(py, signal, None)),
    }
}

/// The arrays of all answers, by name.
fn arrays_of<'py>(py: Python<'py>, mut kept: Vec<Kept>, dofs: usize, rows: usize) -> PyResult<Bound<'py, PyDict>> {
    let errors = PyDict::new(py);
    let certified: Vec<bool> = kept.iter().map(|kept| kept.error.is_none()).collect();
    for (number, kept) in kept.iter_mut().enumerate() {
        if let Some(error) = kept.error.take() {
            errors.set_item(number, plain_exception(py, error).into_value(py))?;
        }
    }
    let table = |of: fn(&Kept) -> &[f64], columns: usize| {
        let values: Vec<f64> = kept.iter().flat_map(of).copied().collect();
        of_table(py, &values, columns)?.call_method1("reshape", (kept.len(), columns))
    };
    let proven = |of: fn(&qp::ProvenSet) -> &ContactSet| {
        let flags = |kept: &Kept| -> Vec<bool> {
            (0..rows).map(|row| kept.proven.as_ref().is_some_and(|proven| of(proven).contains(row))).collect()
        };
        of_truths(py, &kept.iter().flat_map(flags).collect::<Vec<_>>())?.call_method1("reshape", (kept.len(), rows))
    };
    let bounds = |which: usize| of_reals(py, &kept.iter().map(|kept| kept.bounds[which]).collect::<Vec<_>>());
    let all = PyDict::new(py);
    all.set_item("u", table(|kept| &kept.displacement, dofs)?)?;
    all.set_item("multiplier", table(|kept| &kept.multiplier, rows)?)?;
    all.set_item("energy_error", bounds(0)?)?;
    all.set_item("energy_error_bound", bounds(1)?)?;
    all.set_item("certified", of_truths(py, &certified)?)?;
    all.set_item("proven_open", proven(|proven| &proven.open)?)?;
    all.set_item("proven_closed", proven(|proven| &proven.closed)?)?;
    all.set_item("errors", errors)?;
    Ok(all)
}
