//! The tables of the verification: answers compared with exact values, and errors of manufactured blocks with their
//! rates. The tests compare the same answers with tolerances.

mod blocks;

use std::path::PathBuf;

use blocks::{AGAINST_REFERENCE, BLOCKS, ERRORS, error_plots, error_rows, families, reference_rows};
use signorini::Error;
use signorini::fem::Integration;
use support::verification::answer::Answer;
use support::verification::contact_patch::{VARIANTS, contact_patch};
use support::verification::{closed_forms, punches, round_bodies};

use crate::clock::timed;
use crate::process::Failure;
use crate::table::{csv, show, table};

/// Numbers of cells along a side of the manufactured blocks.
const CELLS: [usize; 5] = [8, 16, 32, 64, 128];

/// Answers beside exact values, and errors of manufactured blocks with their rates
#[derive(clap::Args)]
pub struct Options {
    /// Leave out fine meshes, only to show that the study runs
    #[arg(long)]
    short: bool,
    /// Folder for the tables as Markdown and CSV, and plots of the errors over the cell size
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let (cells, ball) = match options.short {
        true => (&CELLS[..2], round_bodies::quarter_ball(8, 2.0)),
        false => (&CELLS[..], round_bodies::quarter_ball(9, 1.4)),
    };
    let answers = [
        closed_forms::bars()?,
        patches()?,
        closed_forms::obstacle_problems()?,
        closed_forms::stored_answers()?,
        punches::punches()?,
        round_bodies::half_cylinders()?,
        round_bodies::half_balls(&ball)?,
        blocks::near_incompressibility()?,
        round_bodies::nearly_incompressible_half_balls()?,
    ]
    .concat();
    let families = families(cells)?;
    let tables = [
        ("answers", Answer::HEADING, answers.iter().map(Answer::row).collect::<Vec<_>>()),
        ("errors", ERRORS, error_rows(&families)),
        ("errors-against-reference", AGAINST_REFERENCE, reference_rows(&families)),
    ];
    let text: Vec<String> = tables.iter().map(|(_, heading, rows)| table(heading, rows)).collect();
    let files: Vec<_> =
        tables.iter().map(|(name, heading, rows)| (format!("{name}.csv"), csv(heading, rows))).collect();
    show(&text.join("\n"), options.out.as_deref(), "verification.md", &files)?;
    if let Some(folder) = &options.out {
        for block in BLOCKS {
            error_plots(block, &families).write(folder, &block.to_lowercase().replace(' ', "-"))?;
        }
    }
    Ok(())
}

/// Returns one row for every element and formulation, with its largest error.
fn patches() -> Result<Vec<Answer>, Error> {
    let row = |(kind, formulation, integration)| {
        let (errors, seconds) = timed(|| contact_patch(kind, formulation, integration));
        let errors = errors?;
        let mean = if integration == Integration::MeanDilatation { ", mean dilatation" } else { "" };
        Ok(Answer {
            case: format!("contact patch, {}{mean}", formulation.name()),
            element: kind.name(),
            unknowns: errors.unknowns,
            quantity: "worst of pressure, displacement, stress".into(),
            ours: errors.worst(),
            exact: 0.0,
            seconds,
        })
    };
    VARIANTS.into_iter().map(row).collect()
}
