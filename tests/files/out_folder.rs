//! The files that `--out` and `export` write into a folder: complete files that other programs can read, and no other
//! files.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use resvg::tiny_skia::Pixmap;
use resvg::usvg::roxmltree::Document;
use serde_json::{Value, json};
use signorini::qp::{read_problem, read_vector};
use support::program::{Desk, Problem, example, scene};

/// Smallest share of the width or of the height inside the margins that a picture fills.
const FILLED: f64 = 0.85;
/// Margins of a picture, in pixels.
const MARGIN: f64 = 24.0;

/// The shares of the width and of the height inside the margins that contain some drawing.
fn filled(path: &Path) -> [f64; 2] {
    let pixels = Pixmap::load_png(path).unwrap();
    let is_ink = |place: usize| pixels.pixels()[place].demultiply().red().min(pixels.pixels()[place].green()) < 250;
    let width = pixels.width() as usize;
    let places = (0..pixels.pixels().len()).filter(|&place| is_ink(place)).map(|place| [place % width, place / width]);
    let start = [[usize::MAX, 0], [usize::MAX, 0]];
    let ends =
        places.fold(start, |ends, at| [0, 1].map(|axis| [ends[axis][0].min(at[axis]), ends[axis][1].max(at[axis])]));
    let sides = [f64::from(pixels.width()), f64::from(pixels.height())];
    [0, 1].map(|axis| (ends[axis][1] as f64 - ends[axis][0] as f64 + 1.0) / (sides[axis] - 2.0 * MARGIN))
}

/// Checks that a page contains its data as JSON, loads nothing from outside, and contains nothing that ends its scripts
/// early.
fn check_page(name: &str, page: &str) {
    let (_, data) = page.split_once("<script type=\"application/json\" id=\"data\">").expect(name);
    let (data, rest) = data.split_once("</script>").expect(name);
    let data: Value = serde_json::from_str(data).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(data["about"]["version"].is_string() && data["units"].is_object(), "{name}");
    assert_eq!(rest.matches("</script>").count(), 2, "{name}: the arrays and the scripts are not in two elements");
    for address in ["http://", "https://", "src=\"/", "@import", "fetch(", "XMLHttpRequest"] {
        let own = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!own.contains(address), "{name} names {address}");
    }
}

/// The names of the files in a folder; each file is read once in the way of its format.
fn checked(folder: &Path) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_string();
        let bytes = fs::read(&path).unwrap();
        let text = || String::from_utf8(bytes.clone()).unwrap();
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("svg") => {
                let svg = text();
                let document = Document::parse(&svg).unwrap_or_else(|error| panic!("{name}: {error}"));
                assert!(document.root_element().has_tag_name(("http://www.w3.org/2000/svg", "svg")));
                assert!(
                    document
                        .descendants()
                        .filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "text")))
                        .count()
                        > 5
                );
            }
            Some("png") => {
                assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.ends_with(b"IEND\xaeB`\x82"), "{name}");
            }
            Some("vtu") => {
                let vtu = text();
                let document = Document::parse(&vtu).unwrap_or_else(|error| panic!("{name}: {error}"));
                let arrays: Vec<&str> = document.descendants().filter_map(|node| node.attribute("Name")).collect();
                let expected = [
                    "u",
                    "sigma_1",
                    "sigma_2",
                    "von_mises",
                    "energy_density",
                    "stress",
                    "gap",
                    "remaining_gap",
                    "normal",
                    "pressure",
                    "contact",
                    "contact_force",
                    "body",
                    "material",
                ];
                for array in expected {
                    assert!(arrays.contains(&array), "{name} does not contain {array}: {arrays:?}");
                }
            }
            Some("mtx") if !["K.mtx", "B.mtx", "near_null.mtx"].contains(&name.as_str()) => {
                assert!(!read_vector(&path).unwrap().is_empty())
            }
            Some("mtx") => {}
            Some("html") => check_page(&name, &text()),
            Some("json") => assert!(serde_json::from_slice::<Value>(&bytes).unwrap().is_object()),
            Some("csv") => {
                let csv = text();
                let cells: BTreeSet<usize> = csv.lines().map(|line| line.split(',').count()).collect();
                assert!(cells.len() == 1 && csv.lines().count() > 1, "{name}: {cells:?}");
            }
            _ => panic!("{name} has an unknown kind"),
        }
        assert!(!bytes.is_empty(), "{name} is empty");
        names.insert(name);
    }
    names
}

fn names(list: &[&str]) -> BTreeSet<String> {
    list.iter().map(|name| name.to_string()).collect()
}

fn pictures(stems: impl IntoIterator<Item = String>) -> BTreeSet<String> {
    stems.into_iter().flat_map(|stem| [format!("{stem}.svg"), format!("{stem}.png")]).collect()
}

#[test]
fn solve_writes_answer_fields_pictures_and_report() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let run = desk.run(&[
        "solve",
        "block.json",
        "--method",
        "active-set",
        "--format",
        "json",
        "--pictures",
        "all",
        "--out",
        "a/b",
    ]);
    let run = run.ends_with(0);
    let found = checked(&desk.path("a/b"));
    let steps = run.json()["history"].as_array().unwrap().len();
    let mut expected =
        names(&["u.mtx", "lambda.mtx", "dofs.csv", "rows.csv", "contact.csv", "solution.vtu", "report.json"]);
    expected.insert("report.html".into());
    expected.extend(pictures((1..=steps).map(|step| format!("iteration-{step}")).chain(["contact".to_string()])));
    assert_eq!(found, expected);
    assert!(steps >= 2);
    let report: Value = serde_json::from_slice(&fs::read(desk.path("a/b/report.json")).unwrap()).unwrap();
    assert_eq!(report, run.json(), "the report in the folder differs from the printed one");
    // The sum of the nodal contact forces is the resultant.
    let fields = fs::read_to_string(desk.path("a/b/solution.vtu")).unwrap();
    let (_, forces) = fields.split_once("Name=\"contact_force\"").expect("the file has no contact forces");
    let numbers = forces.lines().skip(1).take_while(|line| !line.starts_with('<'));
    let along_y: f64 = numbers.map(|line| line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap()).sum();
    let resultant = report["resultants"][0]["force"][1].as_f64().unwrap();
    assert!(along_y < 0.0 && (along_y - resultant).abs() < 1e-12 * along_y.abs(), "{along_y} and {resultant}");
}

/// A block of two layers in uniaxial strain under a pressure of 3.
pub fn layers() -> Value {
    json!({
        "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [2]}, "y": {"points": [0, 2], "divisions": [2]}}},
        "material": {"young": 1000, "poisson": 0.3},
        "materials": [{"box": {"min": [0, 1], "max": [1, 2]}, "material": {"young": 400, "poisson": 0.2}}],
        "supports": [{"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "left"}, "x": 0},
                     {"on": {"boundary": "right"}, "x": 0}],
        "loads": [{"pressure": {"boundary": "top", "value": 3}}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 3], "normal": [0, 1]}}}]
    })
}

/// GOAL: the strain energy density of the `.vtu` file. CONDITIONS: a block of two layers in uniaxial strain under a
/// pressure p. REFERENCE: w = p^2/(2 M) in each layer, M = E (1 - nu)/((1 + nu)(1 - 2 nu)), and their mean where they
/// meet.
#[test]
fn the_strain_energy_density_is_that_of_the_material_of_each_element() {
    let desk = Desk::new();
    desk.write("layers.json", layers().to_string());
    desk.run(&["solve", "layers.json", "--out", "o", "--pictures", "none"]).ends_with(0);
    let vtu = fs::read_to_string(desk.path("o/solution.vtu")).unwrap();
    let document = Document::parse(&vtu).unwrap();
    let arrays = |name: &str| -> Vec<Vec<f64>> {
        let named = document.descendants().filter(|node| node.attribute("Name") == Some(name));
        named
            .map(|node| node.text().unwrap().split_whitespace().map(|value| value.parse().unwrap()).collect())
            .collect()
    };
    let [at_nodes, in_elements] = &arrays("energy_density")[..] else { panic!("not at nodes and in elements") };
    let (nodes, materials) = (&arrays("Points")[0], &arrays("material")[0]);
    let density =
        |young: f64, poisson: f64| 9.0 / 2.0 * (1.0 + poisson) * (1.0 - 2.0 * poisson) / (young * (1.0 - poisson));
    let [below, above] = [density(1000.0, 0.3), density(400.0, 0.2)];
    // Rounding of a small solve.
    let is_close =
        |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-10, "{found}, not {expected}");
    assert_eq!((at_nodes.len(), in_elements.len()), (9, 4));
    for (found, node) in at_nodes.iter().zip(nodes.chunks(3)) {
        is_close(*found, [below, 0.5 * (below + above), above][node[1] as usize]);
    }
    for (found, material) in in_elements.iter().zip(materials) {
        is_close(*found, [below, above][*material as usize]);
    }
}

/// The columns of a table by name, as numbers; empty cells are NaN.
fn columns(csv: &str) -> std::collections::BTreeMap<String, Vec<f64>> {
    let mut lines = csv.lines();
    let names: Vec<String> = lines.next().unwrap().split(',').map(str::to_string).collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    names.into_iter().enumerate().map(|(place, name)| (name, rows.iter().map(|row| row[place]).collect())).collect()
}

/// A pressed obstacle on quadratic faces, and a rigid face: the tables describe every unknown and every row, in the
/// order of the vectors.
#[test]
fn the_tables_describe_every_entry_of_the_vectors() {
    let axis = |cells: usize| serde_json::json!({"points": [0, 1], "divisions": [cells]});
    let scene = serde_json::json!({
        "model": "space",
        "body": {"box": {"x": axis(2), "y": axis(2), "z": axis(1), "element": "tet10"}},
        "material": {"young": 1000, "poisson": 0.3},
        "rigid-faces": [{"boundary": "bottom", "x": 0, "y": 0, "rotation": {"x": 0, "y": 0, "z": 0}, "force": [0, 0, 2]}],
        "springs": [{"on": {"boundary": "bottom"}, "z": 5}],
        "obstacles": [{"boundary": "top", "approach": "+z", "force": 3,
                       "shape": {"sphere": {"apex": [0.5, 0.5, 1.01], "radius": 3}}}],
    });
    let desk = Desk::new();
    desk.write("scene.json", scene.to_string());
    let run = desk.run(&["solve", "scene.json", "--format", "json", "--out", "o", "--pictures", "none"]);
    let report = run.ends_with(0).json();
    let read = |name: &str| fs::read_to_string(desk.path("o").join(name)).unwrap();
    let (u, lambda) = (read_vector(&desk.path("o/u.mtx")).unwrap(), read_vector(&desk.path("o/lambda.mtx")).unwrap());
    let dofs = read("dofs.csv");
    let quantity = |of: &str| dofs.lines().filter(|line| line.split(',').nth(1) == Some(of)).count();
    assert_eq!(dofs.lines().count() - 1, u.len());
    // The top has 8 triangles with 16 edges, and so 16 mid-side nodes.
    assert_eq!((quantity("coefficient"), quantity("z"), quantity("travel")), (3 * 16, 1, 1));
    assert!(dofs.lines().last().unwrap().contains("travel,obstacles[0],,,,0e0,0e0,-1e0"), "{dofs}");
    assert_eq!(*u.last().unwrap(), report["resultants"][0]["travel"].as_f64().unwrap());
    let (rows, contact) = (columns(&read("rows.csv")), columns(&read("contact.csv")));
    assert_eq!((rows["row"].len(), contact["row"].len()), (lambda.len(), lambda.len()));
    assert!((rows["tributary_area"].iter().sum::<f64>() - 1.0).abs() < 1e-12);
    assert!((contact["force"].iter().sum::<f64>() - 3.0).abs() < 1e-9);
    for (row, lambda) in lambda.iter().enumerate() {
        assert_eq!(contact["force"][row], 0.0 - lambda);
        assert!(contact["remaining_gap"][row] > -1e-12, "a node is inside the obstacle");
        assert!(contact["closed"][row] == 0.0 || contact["pressure"][row] >= 0.0);
    }
    assert!(report["strain_energy"].as_f64().unwrap() > 0.0);
}

#[test]
fn compare_writes_the_pressure_of_three_methods() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let run = desk.run(&["compare", "block.json", "--format", "json", "--out", "o"]).ends_with(0);
    let found = checked(&desk.path("o"));
    let wanted =
        names(&["pressure.svg", "pressure.png", "contact.svg", "iteration-1.png", "solution.vtu", "report.html"]);
    assert!(found.is_superset(&wanted), "{found:?}");
    let report: Value = serde_json::from_slice(&fs::read(desk.path("o/report.json")).unwrap()).unwrap();
    assert_eq!(report, run.json());
}

#[test]
fn sweep_writes_a_picture_for_each_gap_and_the_curves() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    desk.run(&["sweep", "block.json", "--gaps", "-0.01:-0.03:3", "--out", "o"]).ends_with(0);
    let stems = ["gap-01", "gap-02", "gap-03", "force-width"].map(String::from);
    let mut expected = pictures(stems);
    expected.extend(names(&["report.json", "report.html"]));
    assert_eq!(checked(&desk.path("o")), expected);
}

#[test]
fn the_pictures_of_every_example_fill_their_page() {
    let desk = Desk::new();
    for name in support::program::examples() {
        desk.run(&["compare", &example(&name), "--out", &name]).ends_with(0);
        let files = checked(&desk.path(&name));
        assert!(files.contains("contact.svg") && files.contains("contact.png"), "{name}: {files:?}");
        for stem in ["contact", "pressure"].iter().filter(|stem| files.contains(&format!("{stem}.png"))) {
            let [across, down] = filled(&desk.path(&name).join(format!("{stem}.png")));
            assert!(across.max(down) >= FILLED, "{name}/{stem}: {across:.2} of the width, {down:.2} of the height");
        }
    }
}

#[test]
fn solve_writes_the_answer_into_the_problem_directory() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    desk.run(&["solve", "p", "--out", "p"]).ends_with(0);
    assert_eq!(
        checked(&desk.path("p")),
        names(&["K.mtx", "f.mtx", "B.mtx", "g.mtx", "u.mtx", "lambda.mtx", "report.json", "report.html"])
    );
}

#[test]
fn exported_files_are_read_back_as_the_same_problem() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    desk.run(&["export", "block.json", "deep/er"]).ends_with(0);
    let expected = names(&["K.mtx", "f.mtx", "B.mtx", "g.mtx", "near_null.mtx", "dofs.csv", "rows.csv"]);
    assert_eq!(checked(&desk.path("deep/er")), expected);
    let model = signorini::Scene::read(desk.path("block.json")).unwrap().build().unwrap();
    assert_eq!(&read_problem(&desk.path("deep/er")).unwrap(), model.problem());
}

#[test]
fn a_second_run_replaces_the_files_of_the_first() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    desk.write("o/u.mtx", "something else");
    desk.write("o/notes.json", "{}");
    desk.run(&["solve", "block.json", "--out", "o"]).ends_with(0);
    desk.run(&["solve", "block.json", "--out", "o"]).ends_with(0);
    assert!(checked(&desk.path("o")).contains("notes.json"), "the run removed a file of the user");
}

#[test]
fn an_answer_that_is_not_certified_is_written_with_its_status() {
    let desk = Desk::new();
    let run = desk.run(&["solve", &example("indentation"), "--method", "penalty", "--out", "o"]);
    run.fails_with(4, &["not certified"]);
    checked(&desk.path("o"));
    let report: Value = serde_json::from_slice(&fs::read(desk.path("o/report.json")).unwrap()).unwrap();
    assert_eq!(report["status"], "not_certified");
}

#[test]
fn a_folder_that_cannot_be_made_causes_one_sentence_and_no_files() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    desk.write("file", "a regular file");
    desk.problem("p", &Problem::right());
    for (arguments, folder) in [
        (&["solve", "block.json", "--out", "file/below"][..], "file/below"),
        (&["solve", "block.json", "--out", "file"], "file"),
        (&["solve", "p", "--out", "file"], "file"),
        (&["compare", "block.json", "--out", "file/below"], "file/below"),
        (&["sweep", "block.json", "--gaps", "0:-0.01:2", "--out", "file"], "file"),
        (&["export", "block.json", "file/below"], "file/below"),
        (&["export", "block.json", "file"], "file"),
    ] {
        let run = desk.run(arguments).fails_with(1, &[&format!("cannot make the folder {folder}: ")]);
        assert_eq!(run.stdout, "");
    }
    assert_eq!(fs::read_to_string(desk.path("file")).unwrap(), "a regular file");
}

#[test]
fn a_file_that_cannot_be_replaced_causes_no_temporary_files() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    desk.write("o/lambda.mtx/occupied", "a folder in the place of a file");
    desk.run(&["solve", "block.json", "--out", "o"]).fails_with(1, &["cannot write o/lambda.mtx: "]);
    let left: Vec<_> = fs::read_dir(desk.path("o")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| name == "u.mtx" || name == "lambda.mtx"), "{left:?}");
}

#[test]
fn titles_and_units_with_any_characters_give_valid_pictures() {
    let desk = Desk::new();
    let mut odd = scene();
    let title = format!("<&>\"' \u{0}\u{1b}\n\u{fffe} \u{202e}\u{2067}\u{200f} Größe 接触 {}", "long ".repeat(500));
    odd["title"] = json!(title);
    odd["units"] = json!({"length": "<m>", "force": "&\u{0}\u{202e}"});
    desk.write("odd.json", odd.to_string());
    desk.run(&["compare", "odd.json", "--out", "o"]).ends_with(0);
    desk.run(&["sweep", "odd.json", "--gaps", "0:-0.01:2", "--out", "s"]).ends_with(0);
    for folder in ["o", "s"] {
        let pages = checked(&desk.path(folder))
            .into_iter()
            .filter(|name| [".svg", ".html", ".vtu"].iter().any(|ending| name.ends_with(ending)));
        for name in pages {
            let bytes = fs::read(desk.path(folder).join(&name)).unwrap();
            let text = String::from_utf8_lossy(&bytes);
            let turns = |character: &char| "\u{202e}\u{2067}\u{200f}".contains(*character);
            assert_eq!(text.chars().find(turns), None, "{folder}/{name} turns the direction of its text");
            assert!(!text.to_lowercase().contains("\\u202e"), "{folder}/{name} turns the direction of its text");
        }
    }
}

#[test]
fn only_the_requested_pictures_are_drawn() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let drawn = |arguments: &[&str], out: &str| {
        desk.run(&[arguments, &["--out", out]].concat()).ends_with(0);
        checked(&desk.path(out)).into_iter().filter(|name| name.ends_with(".png")).collect::<Vec<_>>()
    };
    assert_eq!(drawn(&["solve", "block.json"], "usual"), ["contact.png"]);
    assert!(drawn(&["solve", "block.json", "--pictures", "none"], "none").is_empty());
    assert!(desk.path("none/solution.vtu").exists());
    assert_eq!(drawn(&["compare", "block.json", "--pictures", "answer"], "compare"), ["contact.png", "pressure.png"]);
    let sweep = ["sweep", "block.json", "--gaps", "-0.01:-0.02:2"];
    assert_eq!(drawn(&[&sweep[..], &["--pictures", "answer"]].concat(), "sweep"), ["force-width.png"]);
    assert!(drawn(&[&sweep[..], &["--pictures", "none"]].concat(), "bare").is_empty());
    desk.run(&["solve", "block.json", "--pictures", "some"]).ends_with(2);
}

/// GOAL: a second run into a folder.
/// CONDITIONS: runs of each command with all pictures, then one without; a picture of the user lies in the folder.
/// REFERENCE: no picture or page of the first run stays, and every other file does.
#[test]
fn a_second_run_leaves_nothing_that_the_first_one_shows() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let names = || -> BTreeSet<String> {
        let entries = fs::read_dir(desk.path("o")).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    };
    let last = ["solve", "block.json", "--method", "qp", "--pictures", "none", "--out", "o"];
    let shown = |name: &String| [".svg", ".png", ".pdf", ".html"].iter().any(|ending| name.ends_with(ending));
    for first in [
        &["compare", "block.json", "--pictures", "all"][..],
        &["solve", "block.json", "--method", "penalty", "--pictures", "all", "--style", "paper"],
        &["sweep", "block.json", "--gaps", "-0.01:-0.02:2", "--pictures", "all"],
        &["solve", "block.json", "--total-error", "0.5", "--pictures", "all"],
        &["tradeoff", "block.json", "--refinements", "0"],
    ] {
        desk.run(&[first, &["--out", "o"]].concat());
        desk.write("o/contact-of-mine.png", "mine");
        let (before, page) = (names(), fs::read(desk.path("o/report.html")).unwrap());
        assert!(before.iter().filter(|name| shown(name)).count() > 3, "{first:?}: {before:?}");
        desk.run(&last).ends_with(0);
        let after = names();
        assert_eq!(after.iter().filter(|name| shown(name)).collect::<Vec<_>>(), ["contact-of-mine.png", "report.html"]);
        assert!(fs::read(desk.path("o/report.html")).unwrap() != page, "{first:?}");
        assert!(before.iter().filter(|name| !shown(name)).all(|name| after.contains(name)), "{before:?} {after:?}");
    }
}

/// The penalty loop has a picture for each penalty; of many iterations twelve are drawn, and each picture says so.
#[test]
fn penalties_have_pictures_with_common_colours() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    desk.run(&["solve", "block.json", "--method", "penalty", "--pictures", "all", "--out", "o"]);
    let files = checked(&desk.path("o"));
    let rungs: Vec<&String> = files.iter().filter(|name| name.starts_with("rung-") && name.ends_with(".svg")).collect();
    assert!((3..=12).contains(&rungs.len()), "{files:?}");
    // The label of the colour bar under the first panel; it is the same in all pictures.
    let label = |name: &str| {
        let svg = fs::read_to_string(desk.path("o").join(name)).unwrap();
        let (before, _) = svg.split_once(">second principal stress σ₂ (").map(|(a, b)| (a.to_string(), b)).unwrap();
        before.rsplit("<path").next().unwrap().to_string()
    };
    for rung in &rungs {
        assert_eq!(label(rung), label("contact.svg"), "{rung}");
    }
}

/// The PDF files contain their font, have the column width of a journal, and number their panels with letters.
#[test]
fn pictures_for_paper_are_pdf_files_of_the_right_width() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    desk.run(&["compare", "block.json", "--pictures", "answer", "--style", "paper", "--out", "o"]).ends_with(0);
    for (stem, millimetres) in [("contact", 170.0), ("pressure", 85.0)] {
        let pdf = fs::read(desk.path(&format!("o/{stem}.pdf"))).unwrap();
        assert!(pdf.starts_with(b"%PDF-") && pdf.ends_with(b"%%EOF"), "{stem}");
        let text = String::from_utf8_lossy(&pdf);
        assert!(text.contains("/FontFile2") && text.contains("/Identity-H"), "{stem} does not contain its font");
        let sides = text.split_once("/MediaBox [").unwrap().1.split(']').next().unwrap().to_string();
        let width: f64 = sides.split_whitespace().nth(2).unwrap().parse().unwrap();
        assert!((width - millimetres * 72.0 / 25.4).abs() < 0.1, "{stem} is {width} points wide");
        let svg = fs::read_to_string(desk.path(&format!("o/{stem}.svg"))).unwrap();
        assert!(svg.contains(&format!("width=\"{millimetres}mm\"")) && svg.contains("@font-face"), "{stem}");
    }
    let svg = fs::read_to_string(desk.path("o/contact.svg")).unwrap();
    assert!(["(a) ", "(b) ", "(c) "].iter().all(|letter| svg.contains(letter)));
    assert!(!desk.path("o/contact.png").exists());
}
