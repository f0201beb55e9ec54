//! What can keep a guaranteed error from a user.

/// An error of the body or of a quadratic program, with the same sentence.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Faulty data, a setting, or a step of a library.
    #[error(transparent)]
    Linear(#[from] signorini_linear::Error),
    /// An error of the body.
    #[error(transparent)]
    Fem(#[from] signorini_fem::Error),
    /// An error of a quadratic program.
    #[error(transparent)]
    Qp(#[from] signorini_qp::Error),
}
