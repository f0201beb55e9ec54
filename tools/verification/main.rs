//! Prints the tables of the verification: answers compared with exact values, and errors of manufactured blocks with
//! their rates.
//!
//! `cargo run --release --example verification [-- [--short] [--out DIR]]`; with a folder, the tables as Markdown and
//! CSV and plots of the errors over the cell size are written into it. The short form leaves out fine meshes and only
//! shows that the command runs; the tests compare the same answers with tolerances.

mod blocks;

use std::path::Path;
use std::time::Instant;

use blocks::{AGAINST_REFERENCE, BLOCKS, ERRORS, error_plots, error_rows, families, reference_rows};
use signorini::Error;
use signorini::fem::Integration;
use signorini::output::write_files;
use support::verification::answer::{Answer, csv, markdown};
use support::verification::contact_patch::{VARIANTS, contact_patch};
use support::verification::{closed_forms, punches, round_bodies};

/// Numbers of cells along a side of the manufactured blocks.
const CELLS: [usize; 5] = [8, 16, 32, 64, 128];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (is_short, arguments) = match arguments.split_first() {
        Some((first, rest)) if first == "--short" => (true, rest),
        _ => (false, &arguments[..]),
    };
    let (cells, ball) = match is_short {
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
    let text = tables.iter().map(|(_, heading, rows)| markdown(heading, rows)).collect::<Vec<_>>().join("\n");
    print!("{text}");
    if let [option, folder] = arguments
        && option == "--out"
    {
        let folder = Path::new(folder);
        let files: Vec<_> =
            tables.iter().map(|(name, heading, rows)| (format!("{name}.csv"), csv(heading, rows))).collect();
        let named: Vec<_> = files.iter().map(|(name, text)| (name.as_str(), text.clone())).collect();
        write_files(folder, &[("verification.md", text)])?;
        write_files(folder, &named)?;
        for block in BLOCKS {
            error_plots(block, &families).write(folder, &block.to_lowercase().replace(' ', "-"))?;
        }
    }
    Ok(())
}

/// Returns one row for every element and formulation, with its largest error.
fn patches() -> Result<Vec<Answer>, Error> {
    let row = |(kind, formulation, integration)| {
        let clock = Instant::now();
        let errors = contact_patch(kind, formulation, integration)?;
        let mean = if integration == Integration::MeanDilatation { ", mean dilatation" } else { "" };
        Ok(Answer {
            case: format!("contact patch, {}{mean}", formulation.name()),
            element: kind.name(),
            unknowns: errors.unknowns,
            quantity: "worst of pressure, displacement, stress".into(),
            ours: errors.worst(),
            exact: 0.0,
            seconds: clock.elapsed().as_secs_f64(),
        })
    };
    VARIANTS.into_iter().map(row).collect()
}
