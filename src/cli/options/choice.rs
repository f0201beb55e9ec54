//! Choices of the library by their names on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::output::{Medium, Pictures};
use crate::qp::{Method, Settings};

/// A choice of the library by its name on the command line.
pub(super) trait Choice: Copy + Send + Sync + 'static {
    /// All choices, in the order of the help.
    const ALL: &[Self];

    /// Its name, and what it stands for.
    fn in_words(self) -> (&'static str, &'static str);
}

/// Takes one of the names of a choice.
pub(super) fn choice<T: Choice>() -> impl TypedValueParser<Value = T> {
    let names = T::ALL.iter().map(|one| PossibleValue::new(one.in_words().0).help(one.in_words().1));
    PossibleValuesParser::new(names).try_map(|name| {
        let named = T::ALL.iter().find(|one| one.in_words().0 == name);
        named.copied().ok_or_else(|| format!("there is no `{name}`"))
    })
}

/// Refuses the extrapolation of penalties, which is gone.
pub(super) fn extrapolation(_: &str) -> Result<(), String> {
    Err("the extrapolation of a penalty is gone: take the method active-set, whose answer is that of an infinite penalty"
        .into())
}

/// Takes the precision of a factor, of which one is left.
pub(super) fn precision(name: &str) -> Result<(), String> {
    match name {
        "auto" | "double" => Ok(()),
        "mixed" => Err(Settings::NO_SINGLE_PRECISION.into()),
        _ => Err("it must be double".into()),
    }
}

impl Choice for Method {
    const ALL: &[Self] = &[Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty(), Method::Mprgp];

    fn in_words(self) -> (&'static str, &'static str) {
        let help = match self {
            Method::Qp(_) => "Convex QP by an interior-point method, its contact set settled by active-set steps",
            Method::ActiveSet => "Active-set loop with Lagrange multipliers",
            Method::Penalty(_) => "Penalty loop",
            Method::Mprgp => "Projected conjugate gradients with multigrid, for bodies too large to factorise",
            _ => "The program chooses",
        };
        (self.name(), help)
    }
}

impl Choice for Pictures {
    const ALL: &[Self] = &[Pictures::None, Pictures::Answer, Pictures::All];

    fn in_words(self) -> (&'static str, &'static str) {
        match self {
            Pictures::None => ("none", "No picture"),
            Pictures::Answer => ("answer", "The final answer of the command"),
            Pictures::All => ("all", "Each iteration, penalty, gap and force as well"),
        }
    }
}

impl Choice for Medium {
    const ALL: &[Self] = &[Medium::Screen, Medium::Paper];

    fn in_words(self) -> (&'static str, &'static str) {
        match self {
            Medium::Screen => ("screen", "SVG and PNG, with a title"),
            Medium::Paper => ("paper", "PDF and SVG, 85 or 170 mm wide, with letters on the panels and no title"),
        }
    }
}
