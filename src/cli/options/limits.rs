//! What a scene, a problem or a deck may do: memory, files, and what of a deck is answered all the same.

use clap::Args;

use crate::cli::memory::parse_size;
use crate::qp::memory;

/// What a scene or a deck may do, and what of a deck is answered all the same.
#[derive(Clone, Debug, Args)]
pub(in crate::cli) struct DeckOptions {
    /// Let a scene or a deck read files that lie outside its own folder
    #[arg(long)]
    pub allow_outside: bool,
    /// Take a deck with friction without it: the answer is that of a frictionless contact
    #[arg(long)]
    pub without_friction: bool,
    /// Give the answer of small displacements whatever its strains and rotations are; without it, those above 50 % end
    /// with exit code 4, and those above 5 % of a deck that asks for large displacements (NLGEOM) are refused
    #[arg(long)]
    pub linear: bool,
    /// Step of a deck, from 1 [default: the last one; of `ccx`: all in turn]
    #[arg(long, value_name = "N")]
    pub step: Option<usize>,
}

impl DeckOptions {
    /// A given option that only decks have.
    pub fn of_decks_only(&self) -> Option<&'static str> {
        let named = [("--step", self.step.is_some()), ("--without-friction", self.without_friction)];
        named.into_iter().find(|(_, is_given)| *is_given).map(|(name, _)| name)
    }

    /// The names of the permissions for the reading of a deck.
    pub fn permits(&self) -> Vec<&'static str> {
        let named = [("outside", self.allow_outside), ("friction", self.without_friction)];
        named.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect()
    }
}

/// Limits of memory and files for a scene or a problem.
#[derive(Clone, Debug, Args)]
pub(in crate::cli) struct Limits {
    /// Refuse a problem that needs more memory, such as 500MB or 1.5GB [default: what the machine has available]
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    pub max_memory: Option<f64>,
    #[command(flatten)]
    pub deck: DeckOptions,
}

impl Limits {
    /// The memory, in bytes.
    pub fn most_memory(&self) -> f64 {
        memory::allowed(self.max_memory)
    }
}
