//! Why a scene has no guaranteed bound.

use crate::error::Error;

/// What of a scene has no guaranteed bound, and what would have one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NoGuarantee {
    /// JSON path of what has none.
    pub path: String,
    pub message: String,
}

/// Why there is no problem of the continuum: an answer to the question for a guarantee, or a failure, which answers
/// nothing.
#[derive(Debug)]
pub(crate) enum WhyNot {
    /// The scene has no guaranteed bound.
    NoGuarantee(NoGuarantee),
    /// The question has no answer.
    Failed(Error),
}

impl From<Error> for WhyNot {
    fn from(error: Error) -> Self {
        WhyNot::Failed(error)
    }
}

impl From<WhyNot> for Error {
    fn from(why: WhyNot) -> Self {
        match why {
            WhyNot::NoGuarantee(NoGuarantee { path, message }) => Error::Scene { path, message },
            WhyNot::Failed(error) => error,
        }
    }
}

pub(super) fn none(path: impl Into<String>, message: impl Into<String>) -> WhyNot {
    WhyNot::NoGuarantee(NoGuarantee { path: path.into(), message: message.into() })
}
