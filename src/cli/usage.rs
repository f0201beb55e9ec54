//! Errors of the arguments: an unknown option is answered with the nearest one, or with what is not modelled; a scene
//! without a command with `solve`.

use std::ffi::OsString;
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, CommandFactory, Error};

use super::options::Arguments;
use crate::scene::Scene;
use signorini_mechanics::nearest;

/// The error without the tip to pass an unknown option as a value behind `--`, and with the option of the nearest name.
pub(super) fn with_nearest_option(mut error: Error, given: &[OsString]) -> Error {
    if error.kind() == ErrorKind::InvalidSubcommand {
        return with_solve(error);
    }
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    let Some(ContextValue::String(unknown)) = error.get(ContextKind::InvalidArg).cloned() else { return error };
    if !unknown.starts_with("--") {
        return error;
    }
    error.remove(ContextKind::Suggested);
    if let Some(sentence) = Scene::not_modelled(unknown.trim_start_matches('-')) {
        error.remove(ContextKind::SuggestedArg);
        error.remove(ContextKind::Usage);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![sentence.into()]));
        return error;
    }
    if error.get(ContextKind::SuggestedArg).is_none()
        && let Some(near) = nearest_option(&unknown, given)
    {
        error.insert(ContextKind::SuggestedArg, ContextValue::String(near));
    }
    error
}

/// The error about a scene in place of a command, with the command that solves it.
fn with_solve(mut error: Error) -> Error {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand).cloned() else { return error };
    if Path::new(&word).extension().is_some() {
        let tip = format!("to solve the scene `{word}`, run: signorini solve {word}");
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

/// The option of the nearest name among those of the command that was given.
fn nearest_option(unknown: &str, given: &[OsString]) -> Option<String> {
    let program = Arguments::command();
    let is_given = |command: &&Command| given.iter().skip(1).any(|word| word == command.get_name());
    let command = program.get_subcommands().find(is_given);
    let options = program.get_arguments().chain(command.into_iter().flat_map(Command::get_arguments));
    let names: Vec<&str> =
        options.flat_map(|option| option.get_long_and_visible_aliases().unwrap_or_default()).collect();
    nearest(unknown.trim_start_matches('-'), names).map(|name| format!("--{name}"))
}
