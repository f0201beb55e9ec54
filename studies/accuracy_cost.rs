//! The time that each method needs for an accuracy, on the scene of the README and on a block of 131,584 dofs.

use std::path::PathBuf;

use signorini::output::{InWords, Measured, Medium};
use signorini::scene::Units;
use signorini::study::{Tradeoff, TradeoffGrid, TradeoffPoint};
use signorini::{Scene, Watch};

use crate::block::block;
use crate::process::Failure;
use crate::table::{show, table};

/// Required relative errors in energy. The last one stands for an answer that is exact up to rounding.
const ACCURACIES: [(&str, f64); 4] = [("1e-2", 1e-2), ("1e-4", 1e-4), ("1e-8", 1e-8), ("exact", 1e-11)];

/// Method and unknowns, `true` for those of the contact alone, in the order of the table.
const WAYS: [(&str, bool); 9] = [
    ("active-set", true),
    ("qp, polished", true),
    ("qp", true),
    ("penalty", true),
    ("active-set", false),
    ("qp, polished", false),
    ("qp", false),
    ("penalty", false),
    ("mprgp", false),
];

/// Milliseconds of each method for an accuracy
#[derive(clap::Args)]
pub struct Options {
    /// Folder for the table, and for the values and a picture of each scene
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let square = block([1.0; 2], [256; 2], "q4", 1.0, -0.01).to_string();
    let scenes = [
        ("indentation", "Indentation by a parabola", Scene::read(support::root().join("examples/indentation.json"))?),
        ("block", "Block of 256 x 256 cells", Scene::from_json(&square, "block")?),
    ];
    let (mut text, mut files) = (String::new(), Vec::new());
    for (name, title, scene) in scenes {
        let grid = TradeoffGrid { refinements: 0, ..TradeoffGrid::default() };
        let measured = Tradeoff::of_scene(&scene, &grid, &Watch::default())?;
        text += &rows(title, &measured);
        files.push((format!("{name}.txt"), measured.text(title, &Units::unnamed())));
        files.push((format!("{name}.csv"), measured.csv()));
        if let (Some(folder), Some((_, plot))) = (&options.out, measured.plots(Medium::Screen, title).first()) {
            plot.write(folder, name)?;
        }
    }
    Ok(show(&text, options.out.as_deref(), "accuracy_cost.md", &files)?)
}

/// For each method and accuracy, the milliseconds of the fastest point that reaches the accuracy.
fn rows(title: &str, measured: &Tradeoff) -> String {
    let mesh = &measured.meshes[0];
    let of_mesh = mesh.discretisation_error.unwrap_or(f64::NAN);
    let heading = format!(
        "{title}: {} dofs, {} rows, mesh {of_mesh:.1e} off; ms | {}",
        mesh.dofs,
        mesh.contact_rows,
        ACCURACIES.map(|(name, _)| name).join(" | ")
    );
    let row = |&(method, condensed): &(&str, bool)| {
        let is_own = |point: &&TradeoffPoint| point.method == method && point.condensed == condensed;
        let own: Vec<&TradeoffPoint> = measured.points.iter().filter(is_own).collect();
        let cheapest = |accuracy: f64| {
            let good = own.iter().filter(|point| point.energy_error <= accuracy).map(|point| point.seconds);
            good.min_by(f64::total_cmp).map_or("-".to_string(), |least| format!("{:.2}", 1e3 * least))
        };
        let unknowns = if condensed { "contact dofs" } else { "all dofs" };
        let cells = ACCURACIES.map(|(_, accuracy)| cheapest(accuracy)).join(" | ");
        (!own.is_empty()).then(|| format!("{method}, {unknowns} | {cells}"))
    };
    table(&heading, &WAYS.iter().filter_map(row).collect::<Vec<_>>()) + "\n"
}
