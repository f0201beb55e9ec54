//! What can be wrong with a body.

/// An error of a body: data, a file or a setting, or a mesh. Each is one sentence for a reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Faulty data, a file, a setting, or a step of a library.
    #[error(transparent)]
    Linear(#[from] signorini_linear::Error),
    /// Nodes and elements that form no mesh.
    #[error("mesh: {message}")]
    Mesh {
        /// A sentence on the node or element, its fault, and what is allowed.
        message: String,
    },
}

impl Error {
    /// The name of the kind of error, the same in every version.
    pub fn code(&self) -> &'static str {
        match self {
            Error::Linear(error) => error.class().0,
            Error::Mesh { .. } => "mesh",
        }
    }
}

/// A number as a person writes it: plain for moderate sizes, with an exponent for extremes.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-4..1e7).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

/// Names longer than this are no spelling errors.
const LONGEST_NAME: usize = 100;

/// `; did you mean ...?` for a name that differs from one of `names` by a few letters, otherwise nothing.
pub fn nearly<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name, names).map_or_else(String::new, |other| format!("; did you mean `{other}`?"))
}

/// The nearest of `names` if it differs from `name` by a few letters.
///
/// One letter in three may be replaced, missing, added, or exchanged with its neighbour.
pub fn nearest<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > LONGEST_NAME {
        return None;
    }
    let length = name.chars().count();
    let most = length.max(3) / 3;
    let written = name.to_lowercase();
    let away = |other: &str| strsim::damerau_levenshtein(&written, &other.to_lowercase());
    let others = names.into_iter().filter(|other| !other.is_empty() && other.len() <= LONGEST_NAME);
    let near = others.map(|other| (away(other), other));
    // A name of one letter that differs has no letter in common.
    let near = near.filter(|(away, other)| *away <= most && *away < length.max(other.chars().count()));
    near.min_by_key(|(away, _)| *away).map(|(_, other)| other)
}
