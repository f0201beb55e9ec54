//! Meshes of a search side by side.

use crate::draw::colour::Colour;
use crate::draw::drawing::{Anchor, Drawing, Paint};
use crate::text::printable;
use signorini_mechanics::scene::Units;
use signorini_study::{Level, TotalError};

/// Number of panels: the first mesh, the last, and some between.
const PANELS: usize = 4;
/// Width of a panel, and the space around it.
const PANEL: f64 = 520.0;
const SPACE: f64 = 24.0;
const HEADING: f64 = 40.0;
const LINE: Colour = Colour(0x2f, 0x4b, 0x6e);

/// One mesh: its heading, and its cells as polygons.
pub(crate) struct MeshPanel {
    pub heading: String,
    pub cells: Vec<Vec<[f64; 2]>>,
}

/// Some of the meshes side by side, two in a row, all in one scale; `length` is the name of its unit.
pub(crate) fn mesh_series(title: &str, meshes: &[MeshPanel], length: &str) -> Drawing {
    let count = meshes.len();
    let panels = count.min(PANELS);
    let chosen = (0..panels).map(|panel| if panels > 1 { panel * (count - 1) / (panels - 1) } else { 0 });
    let places = || meshes.iter().flat_map(|mesh| mesh.cells.iter().flatten());
    let low = [0, 1].map(|axis| places().fold(f64::INFINITY, |low, place| low.min(place[axis])));
    let high = [0, 1].map(|axis| places().fold(f64::NEG_INFINITY, |high, place| high.max(place[axis])));
    let scale = (PANEL / (high[0] - low[0])).min(PANEL / (high[1] - low[1]));
    let size = [PANEL + SPACE, (high[1] - low[1]) * scale + HEADING + SPACE];
    let (across, down) = (panels.min(2), panels.div_ceil(2));
    let mut drawing = Drawing::new(size[0] * across as f64 + SPACE, size[1] * down as f64 + HEADING + SPACE);
    drawing.bold_text([SPACE, HEADING - 12.0], &printable(title), 20.0, Anchor::Start);
    for (panel, index) in chosen.enumerate() {
        let corner = [SPACE + size[0] * (panel % 2) as f64, HEADING + size[1] * (panel / 2) as f64];
        drawing.text([corner[0], corner[1] + HEADING - 14.0], &meshes[index].heading, 16.0, Anchor::Start);
        let place =
            |&[x, y]: &[f64; 2]| [corner[0] + (x - low[0]) * scale, corner[1] + HEADING + (high[1] - y) * scale];
        let cells: Vec<Vec<[f64; 2]>> =
            meshes[index].cells.iter().map(|cell| cell.iter().map(place).collect()).collect();
        drawing.polygons(&cells, &Paint::stroke(LINE, 0.5));
    }
    let width = format!("width {} {length}", high[0] - low[0]);
    drawing.text([SPACE, drawing.height() - 8.0], &width, 14.0, Anchor::Start);
    drawing
}

/// The meshes of the levels; `None` for a bar.
pub(crate) fn meshes_picture(title: &str, found: &TotalError, units: &Units) -> Option<Drawing> {
    let elements = found.name_of_elements();
    let words = if found.total_error.guaranteed { "guaranteed" } else { "estimated" };
    let panel = |(cells, level): (&Vec<Vec<[f64; 2]>>, &Level)| MeshPanel {
        heading: format!("{} {elements}, {words} {:.2} %", level.elements, 100.0 * level.total_error),
        cells: cells.clone(),
    };
    let panels: Vec<MeshPanel> = found.meshes.iter().zip(&found.levels).map(panel).collect();
    let is_drawn = panels.iter().all(|panel| !panel.cells.is_empty());
    is_drawn.then(|| mesh_series(title, &panels, &units.length))
}
