//! Reads the settings of a solve from keyword arguments.

use std::time::Duration;

use pyo3::prelude::*;
use signorini::{Condense, ContactProblem, Method, Settings};

use crate::arrays::kind_of;
use crate::errors::{bad_input, bad_type};

/// A stiffness with fewer entries fits into any machine, so that the available memory need not be determined.
const FEW_ENTRIES: usize = 100_000;

/// The keyword arguments of a solve, unchecked.
#[derive(Default)]
pub struct Options<'py> {
    pub method: Option<Bound<'py, PyAny>>,
    pub accuracy: Option<Bound<'py, PyAny>>,
    pub tolerance: Option<Bound<'py, PyAny>>,
    pub time: Option<Bound<'py, PyAny>>,
    pub threads: Option<Bound<'py, PyAny>>,
    pub memory: Option<Bound<'py, PyAny>>,
    pub precision: Option<Bound<'py, PyAny>>,
    pub condense: Option<bool>,
    pub proof: Option<bool>,
}

/// Reads a real number. One that is not finite is left to the library, which refuses it with its own message.
pub fn number(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let py = value.py();
    value
        .extract()
        .map_err(|_| bad_type(py, format!("{name} is of the type {}; it must be a real number", kind_of(value))))
}

/// Returns the value of a word in a table.
pub fn word<T: Copy>(name: &str, value: &Bound<'_, PyAny>, words: &[(&str, T)]) -> PyResult<T> {
    let py = value.py();
    let known: Vec<&str> = words.iter().map(|word| word.0).collect();
    let known = known.join(", ");
    let Ok(given) = value.extract::<String>() else {
        return Err(bad_type(py, format!("{name} is of the type {}; it must be one of {known}", kind_of(value))));
    };
    let found = words.iter().find(|word| word.0 == given.replace('_', "-"));
    found.map(|word| word.1).ok_or_else(|| bad_input(py, format!("{name} is {given:?}; it must be one of {known}")))
}

const METHODS: [(&str, Method); 5] = [
    ("auto", Method::Auto),
    ("qp", Method::qp()),
    ("active-set", Method::ActiveSet),
    ("penalty", Method::penalty()),
    ("mprgp", Method::Mprgp),
];

/// The precisions, and whether there are factors in them.
const PRECISIONS: [(&str, bool); 3] = [("auto", true), ("double", true), ("mixed", false)];

impl Options<'_> {
    /// Returns the settings. The defaults are those of the program: rows are proven, and all available memory may be
    /// used.
    pub fn settings(&self, problem: Option<&ContactProblem>) -> PyResult<Settings> {
        self.settings_for(problem.map(|problem| problem.stiffness().lower().entries()))
    }

    /// The same for a stiffness with this number of entries in its lower triangle.
    pub fn settings_for(&self, entries: Option<usize>) -> PyResult<Settings> {
        let mut settings = Settings::default().with_proof();
        if let Some(method) = &self.method {
            settings.method = word("method", method, &METHODS)?;
        }
        if let Some(precision) = &self.precision
            && !word("precision", precision, &PRECISIONS)?
        {
            return Err(bad_input(precision.py(), Settings::NO_SINGLE_PRECISION));
        }
        if let Some(tolerance) = &self.tolerance {
            settings.tolerance = Some(number("tolerance", tolerance)?);
        }
        match &self.accuracy {
            Some(word) if word.extract::<String>().is_ok_and(|word| word == "exact") => settings = settings.exactly(),
            Some(accuracy) => settings.accuracy = Some(number("accuracy", accuracy)?),
            None => {}
        }
        if let Some(time) = &self.time {
            let (py, seconds) = (time.py(), number("time", time)?);
            let sentence = || format!("time is {seconds}; it must be a number of seconds that is positive and finite");
            let span = Duration::try_from_secs_f64(seconds).ok().filter(|span| !span.is_zero());
            settings.time = Some(span.ok_or_else(|| bad_input(py, sentence()))?);
        }
        if let Some(threads) = &self.threads {
            let most = std::thread::available_parallelism().map_or(1, |most| 4 * most.get()).max(64);
            let (py, given) = (threads.py(), threads.extract::<usize>().ok());
            let fits = given.filter(|given| (1..=most).contains(given));
            let sentence = || format!("threads is {threads}; it must be a whole number from 1 to {most}");
            settings.threads = Some(fits.ok_or_else(|| bad_input(py, sentence()))?);
        }
        settings.condense = if self.condense == Some(false) { Condense::Never } else { Condense::Auto };
        settings.prove = self.proof != Some(false);
        match &self.memory {
            Some(memory) => settings.memory = Some(number("memory", memory)?),
            None if entries.is_some_and(|entries| entries < FEW_ENTRIES) => {}
            None => settings = settings.with_available_memory(),
        }
        Ok(settings)
    }
}
