//! The one error type of a user: each error states what is wrong, where, which value, and what is allowed.

pub use signorini_fem::{nearest, nearly};
use signorini_qp::memory::in_words as memory;
use signorini_qp::{Failure, Solution};

/// All errors between a scene and a certified answer: those of the quadratic program, and those of bodies and scenes.
/// Each has a [`code`](Self::code), and one sentence for a reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Faulty data, a file, a setting, or a step of a library, with the same sentence and the same code.
    #[error(transparent)]
    Linear(#[from] signorini_linear::Error),
    /// An error of the quadratic program, with the same sentence and the same code.
    #[error(transparent)]
    Qp(signorini_qp::Error),
    /// A sweep whose answers leave too little memory to each solve.
    #[error(
        "{count} answers with {dofs} dofs, which a sweep keeps, take about {}, and a solve about {}, but {} are allowed; take fewer \
         points, or allow more memory",
        memory(*kept),
        memory(*solve),
        memory(*allowed)
    )]
    TooManyAnswers {
        /// Points of the sweep, each with an answer of its own.
        count: usize,
        /// Number of unknowns of each.
        dofs: usize,
        /// Memory of the answers, estimated, in bytes.
        kept: f64,
        /// Memory of a solve, estimated, in bytes.
        solve: f64,
        /// Memory that all may take, in bytes.
        allowed: f64,
    },
    /// Nodes and elements that form no mesh, with the same sentence and the same code.
    #[error(transparent)]
    Fem(signorini_fem::Error),
    /// A scene with JSON of the wrong form or with a wrong value, at its place in the text.
    #[error("{source_name}:{line}:{column}: at {}: {message}", place_in_scene(path))]
    SceneSyntax {
        /// The file, or `scene` if it came as text.
        source_name: String,
        /// Line of the fault in the text, from 1.
        line: usize,
        /// Column of the fault in its line, from 1.
        column: usize,
        /// JSON path of the field; `.` for the scene itself.
        path: String,
        /// A sentence on what is wrong at this place of the text, and what is allowed.
        message: String,
    },
    /// A scene that can be solved, but with an answer to another question than was meant.
    #[error("{place}at `{path}`: {message}")]
    Refused {
        /// The name of the kind of refusal, the same in every version.
        code: &'static str,
        /// Place of the scene: `scene, `, or its file with line and column.
        place: String,
        /// JSON path of the field that would change it, such as `obstacles[0].approach`.
        path: String,
        /// A sentence on what would go wrong and where, with numbers, and on what to change.
        message: String,
    },
    /// An answer that small displacements do not describe: it solves their equations, and the body would deform
    /// otherwise.
    #[error("{message}")]
    BeyondSmallDisplacements {
        /// A sentence on the strain, rotation or depth with its place, on the likely cause, and on what to change.
        message: String,
        /// The answer of small displacements;
        /// [`Answer::of_any_size`](crate::scene::Answer::of_any_size) joins it with its model.
        solution: Box<Solution>,
    },
    /// A scene with values that do not describe a problem.
    #[error("{} `{path}`: {message}", if path.starts_with("--") { "option" } else { "scene, at" })]
    Scene {
        /// JSON path of the value, or the option of the program.
        path: String,
        /// A sentence on what is wrong with this value of the scene, and what is allowed.
        message: String,
    },
}

impl From<signorini_qp::Error> for Error {
    fn from(error: signorini_qp::Error) -> Self {
        match error {
            signorini_qp::Error::Linear(error) => Error::Linear(error),
            error => Error::Qp(error),
        }
    }
}

impl From<signorini_fem::Error> for Error {
    fn from(error: signorini_fem::Error) -> Self {
        match error {
            signorini_fem::Error::Linear(error) => Error::Linear(error),
            error => Error::Fem(error),
        }
    }
}

impl From<signorini_guarantee::Error> for Error {
    fn from(error: signorini_guarantee::Error) -> Self {
        match error {
            signorini_guarantee::Error::Linear(error) => error.into(),
            signorini_guarantee::Error::Fem(error) => error.into(),
            signorini_guarantee::Error::Qp(error) => error.into(),
        }
    }
}

impl Error {
    /// The best answer of a solve that ended without a certified one; `None` for every other error.
    pub fn into_best(self) -> Option<Solution> {
        match self {
            Error::Qp(error) => error.into_best(),
            Error::BeyondSmallDisplacements { solution, .. } => Some(*solution),
            _ => None,
        }
    }

    /// The name of the kind of error, the same in every version, for programs that distinguish errors; of an error of a
    /// solve as [`qp::Error::code`](signorini_qp::Error::code).
    pub fn code(&self) -> &'static str {
        match self {
            Error::Linear(error) => error.class().0,
            Error::Qp(error) => error.code(),
            Error::TooManyAnswers { .. } => "too-large",
            Error::Fem(error) => error.code(),
            Error::SceneSyntax { .. } | Error::Scene { .. } => "scene",
            Error::Refused { code, .. } => code,
            Error::BeyondSmallDisplacements { .. } => "beyond-small-displacements",
        }
    }

    /// The `status` of a report that ends with the error: that of [`qp::Error::status`](signorini_qp::Error::status),
    /// or `bad_input`.
    pub fn status(&self) -> &'static str {
        match self {
            Error::Linear(error) => error.class().1,
            Error::Qp(error) => error.status(),
            Error::BeyondSmallDisplacements { .. } => "beyond-small-displacements",
            _ => "bad_input",
        }
    }

    /// The statement about the problem: that of [`qp::Error::failure`](signorini_qp::Error::failure) for an error of a
    /// solve, otherwise that the input is bad.
    pub fn failure(&self) -> Failure {
        match self {
            Error::Qp(error) => error.failure(),
            Error::BeyondSmallDisplacements { .. } => Failure::NotCertified,
            _ => Failure::BadInput,
        }
    }
}

/// A JSON path in words; `.` is the scene itself.
fn place_in_scene(path: &str) -> String {
    if path == "." { "the top level".to_string() } else { format!("`{path}`") }
}
