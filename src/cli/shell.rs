//! `signorini completions` and `signorini man`: the arguments for a shell and for the manual.

use std::io;

use clap::{Command, CommandFactory};
use clap_complete::generate;
use clap_mangen::Man;

use super::options::{Arguments, Completions};
use super::outcome::Outcome;

/// The name of the program.
const NAME: &str = "signorini";

/// The completions of a shell.
pub(super) fn completions(options: &Completions) -> Outcome {
    let mut script = Vec::new();
    generate(options.shell, &mut Arguments::command(), NAME, &mut script);
    Outcome::done(String::from_utf8_lossy(&script).into_owned())
}

/// The page of the manual, in roff: the program, and a section for every command.
pub(super) fn manual() -> Outcome {
    let mut page = Vec::new();
    // Writing into memory cannot fail.
    let _ = write_manual(&mut page);
    let text = String::from_utf8_lossy(&page);
    let mut is_set_up = false;
    let mut kept = String::new();
    for line in text.lines() {
        // Every piece begins with the definition of the apostrophe; only the first one is needed.
        let sets_up = line.starts_with(".ie ") || line.starts_with(".el ");
        is_set_up |= !sets_up;
        if !(sets_up && is_set_up) {
            kept += line;
            kept.push('\n');
        }
    }
    Outcome::done(kept)
}

fn write_manual(page: &mut Vec<u8>) -> io::Result<()> {
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    let whole = Man::new(program.clone()).title(NAME.to_uppercase()).manual("User Commands");
    whole.render_title(page)?;
    whole.render_name_section(page)?;
    whole.render_synopsis_section(page)?;
    whole.render_description_section(page)?;
    whole.render_options_section(page)?;
    for command in program.get_subcommands() {
        page.extend(format!(".SH \"{} {}\"\n", NAME.to_uppercase(), command.get_name().to_uppercase()).into_bytes());
        page.extend(section(command)?.into_bytes());
    }
    page.extend(format!(".SH \"EXIT STATUS\"\n{}", after(&program)).into_bytes());
    whole.render_version_section(page)
}

/// The description, the call, the options and the examples of a command.
fn section(command: &Command) -> io::Result<String> {
    let man = Man::new(command.clone());
    let mut body = Vec::new();
    man.render_description_section(&mut body)?;
    man.render_synopsis_section(&mut body)?;
    man.render_options_section(&mut body)?;
    // Sections of a separate page are subsections here.
    let body = String::from_utf8_lossy(&body).replace("\n.SH ", "\n.SS ");
    Ok(format!("{body}.SS EXAMPLES\n{}", after(command)))
}

/// The text after the options in the help, line by line and unchanged.
fn after(command: &Command) -> String {
    let text = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let line = |line: &str| format!("\\&{}\n", line.replace('\\', "\\e").replace('-', "\\-"));
    format!(".nf\n{}.fi\n", text.lines().map(line).collect::<String>())
}
