//! Measures the time that each method needs for an accuracy, on the scene of the README and on a block of 131,584 dofs.
//!
//! `cargo run --release --example accuracy_cost -- --out DIR` prints the table and writes it, with pictures and values,
//! into a folder.

use signorini::{Error, Scene, Watch, qp};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::json;
use signorini::output::{InWords, Measured, Medium, write_files};
use signorini::scene::Units;
use signorini::study::{Tradeoff, TradeoffGrid, TradeoffPoint};

/// Required relative errors in energy. The last one stands for an answer that is exact up to rounding.
const ACCURACIES: [(&str, f64); 4] = [("1e-2", 1e-2), ("1e-4", 1e-4), ("1e-8", 1e-8), ("exact", 1e-11)];

/// Method, precision and unknowns, in the order of the table.
const WAYS: [(&str, bool, bool); 11] = [
    ("active-set", true, false),
    ("active-set", true, true),
    ("qp, polished", true, false),
    ("qp, polished", true, true),
    ("qp", true, false),
    ("penalty", true, false),
    ("active-set", false, false),
    ("qp, polished", false, false),
    ("qp", false, false),
    ("penalty", false, false),
    ("mprgp", false, false),
];

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Error> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = match &arguments[..] {
        [] => None,
        [option, folder] if option == "--out" => Some(PathBuf::from(folder)),
        _ => {
            let reason = "it takes nothing, or --out DIR".to_string();
            return Err(Error::Qp(qp::Error::Numerical { step: "reading the arguments", reason }));
        }
    };
    let indentation = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/indentation.json");
    let scenes = [
        ("indentation", "Indentation by a parabola", Scene::read(indentation)?, 5),
        ("block", "Block of 256 x 256 cells", block(256)?, 5),
    ];
    let mut table = String::new();
    for (name, title, scene, runs) in scenes {
        let grid = TradeoffGrid { refinements: 0, runs, ..TradeoffGrid::default() };
        let measured = Tradeoff::of_scene(&scene, &grid, &Watch::default())?;
        table += &rows(title, &measured);
        if let Some(folder) = &folder {
            let files = [
                (format!("{name}.txt"), measured.text(title, &Units::unnamed())),
                (format!("{name}.csv"), measured.csv()),
            ];
            let files: Vec<(&str, String)> = files.iter().map(|(name, text)| (name.as_str(), text.clone())).collect();
            write_files(folder, &files)?;
            for (_, plot) in measured.plots(Medium::Screen, title).iter().take(1) {
                plot.write(folder, name)?;
            }
        }
    }
    print!("{table}");
    if let Some(folder) = &folder {
        write_files(folder, &[("accuracy_cost.md", table)])?;
    }
    Ok(())
}

/// A unit block that is clamped at its bottom, with a parabola of radius 1 pressed 0.01 into its top.
fn block(cells: usize) -> Result<Scene, Error> {
    let axis = json!({ "points": [0, 1], "divisions": [cells] });
    let scene = json!({
        "model": "plane-strain",
        "body": { "rectangle": { "x": axis, "y": axis, "element": "q4" } },
        "material": { "young": 1e7, "poisson": 0.3 },
        "supports": [{ "on": { "boundary": "bottom" }, "x": 0, "y": 0 }],
        "obstacles": [{
            "boundary": "top",
            "approach": "+y",
            "rule": "approach",
            "shape": { "parabola": { "apex": [0.5, 1], "radius": 1 } },
        }],
        "gap": -0.01,
    });
    Scene::from_json(&scene.to_string(), "block")
}

/// Rows of the table: for each method and accuracy, the milliseconds of the fastest point that reaches the accuracy.
fn rows(title: &str, measured: &Tradeoff) -> String {
    let mesh = &measured.meshes[0];
    let of_mesh = mesh.discretisation_error.unwrap_or(f64::NAN);
    let mut text = format!(
        "| {title}: {} dofs, {} rows, mesh {of_mesh:.1e} off; ms | {} |\n|---|{}\n",
        mesh.dofs,
        mesh.contact_rows,
        ACCURACIES.map(|(name, _)| name).join(" | "),
        "---|".repeat(ACCURACIES.len())
    );
    for (method, condensed, mixed) in WAYS {
        let own: Vec<&TradeoffPoint> = measured
            .points
            .iter()
            .filter(|point| point.method == method && point.condensed == condensed && point.mixed == mixed)
            .collect();
        if own.is_empty() {
            continue;
        }
        let cheapest = |accuracy: f64| {
            let good = own.iter().filter(|point| point.energy_error <= accuracy).map(|point| point.seconds);
            let least = good.fold(f64::INFINITY, f64::min);
            if least.is_finite() { format!("{:.2}", 1e3 * least) } else { "-".to_string() }
        };
        let unknowns = if condensed { "contact dofs" } else { "all dofs" };
        let precision = if mixed { ", single-precision factor" } else { "" };
        let cells = ACCURACIES.map(|(_, accuracy)| cheapest(accuracy)).join(" | ");
        text += &format!("| {method}, {unknowns}{precision} | {cells} |\n");
    }
    text + "\n"
}
