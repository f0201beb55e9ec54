//! The picture of a contact answer: a field on the body as it was, and the moved mesh under its obstacle.

use super::{
    axes::{Axis, Frame, LARGE, LINE, Labels, MARGIN, ROOM_BELOW, TITLE, draw_heading},
    colour_bar::{self, ColourRange, Outside},
    drawing::{Anchor, Drawing},
    legend::{self, Entry},
    mark::Candidate,
    obstacle::{self, Look},
    ticks::{Quantity, Scale, brief, common_exponent},
    typeface::{self, Weight},
};
use crate::error::Error;

pub use super::obstacle::ObstacleLine;

/// Largest width and height of a panel in pixels.
const PANEL: [f64; 2] = [580.0, 600.0];
/// A slender body gets white space around it rather than a panel smaller than this.
const SMALLEST: [f64; 2] = [180.0, 130.0];
/// A column is at least this wide, for the colour bar and the legend.
const COLUMN: f64 = 440.0;
/// A contact answer as plain data, to be drawn as two panels of the same scale.
///
/// Left a nodal field (usually the second principal stress) on the undeformed body with its colour bar; right the mesh
/// moved by its displacement, with the obstacles, the closed candidates as filled dots and the open ones as hollow
/// dots.
#[derive(Clone, Debug)]
pub struct ContactPicture<'a> {
    /// What the picture shows: scene, gap, iteration, number of closed nodes.
    pub title: &'a str,
    /// Unit of length of the nodes; empty where there is none.
    pub length_unit: &'a str,
    /// Coordinates of the nodes.
    pub nodes: &'a [[f64; 2]],
    /// The corner nodes of every element in order around it, indices from 0.
    pub elements: &'a [Vec<usize>],
    /// Nodal displacements, length `2 * n_nodes`, order `[u_x0, u_y0, u_x1, ...]`, in the unit of length.
    pub displacement: &'a [f64],
    /// By what the displacement is multiplied before it is drawn; 1 shows it as it is. Only then do body and obstacle
    /// touch where they touch; otherwise the obstacle is drawn as a dashed line that says so.
    pub magnification: f64,
    /// The field, one value per node.
    pub field: &'a [f64],
    /// What the field is, with its unit.
    pub quantity: Quantity,
    /// Values at the two ends of the colours; see [`common_limits`]. Where they are not finite, the field sets them.
    pub limits: [f64; 2],
    /// Obstacles; let their edges reach beyond the body at both sides, where the picture ends.
    pub obstacles: &'a [ObstacleLine<'a>],
    /// Candidate nodes, indices from 0.
    pub candidates: &'a [usize],
    /// Which candidates are closed, one flag per candidate.
    pub closed: &'a [bool],
    /// The visible rectangle `[[x from, x to], [y from, y to]]`; `None` for body and obstacle with a margin. A series
    /// of pictures shares the [`common_window`] of its [windows](ContactPicture::window).
    pub window: Option<[[f64; 2]; 2]>,
}

/// The smallest and the largest finite value of all fields of a series, so that its pictures share their colours.
///
/// `[0, 1]` where there is no finite value.
///
/// ```
/// use signorini::internals::common_limits;
/// let limits = common_limits([&[-3.0, 0.0][..], &[-5.0, f64::NAN, 1.0][..]]);
/// assert_eq!(limits, [-5.0, 1.0]);
/// ```
pub fn common_limits<'a>(fields: impl IntoIterator<Item = &'a [f64]>) -> [f64; 2] {
    let values = fields.into_iter().flatten().copied().filter(|&value| Scale::Linear.shows(value));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low <= high { [low, high] } else { [0.0, 1.0] }
}

/// The smallest rectangle that holds all windows of a series; `[[0, 1], [0, 1]]` where there is none.
pub fn common_window(windows: impl IntoIterator<Item = [[f64; 2]; 2]>) -> [[f64; 2]; 2] {
    let join = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    windows.into_iter().reduce(|a, b| [join(a[0], b[0]), join(a[1], b[1])]).unwrap_or([[0.0, 1.0]; 2])
}

impl ContactPicture<'_> {
    /// The rectangle that the picture shows: its `window`, or body, moved body and the near part of the obstacle with a
    /// margin.
    pub fn window(&self) -> [[f64; 2]; 2] {
        let usable = |[from, to]: [f64; 2]| Scale::Linear.shows(from) && Scale::Linear.shows(to) && from < to;
        match self.window {
            Some(window) if window.into_iter().all(usable) => window,
            _ => {
                let moved = self.displacement.chunks_exact(2).zip(self.nodes).map(|(u, node)| self.move_by(node, u));
                obstacle::window(self.nodes.iter().copied().chain(moved), self.obstacles)
            }
        }
    }

    /// Draws the picture.
    ///
    /// Values that are not finite do not stop it: elements without a value are grey, elements without a place are left
    /// out.
    ///
    /// # Errors
    /// [`Error::Length`] where an array does not fit the number of nodes or candidates, [`Error::Setting`] where an
    /// element or a candidate names a node that does not exist.
    pub fn draw(&self) -> Result<Drawing, Error> {
        self.check()?;
        let moved: Vec<[f64; 2]> =
            self.displacement.chunks_exact(2).zip(self.nodes).map(|(u, node)| self.move_by(node, u)).collect();
        let frames = self.frames(self.window());
        let [left, right] = &frames.panels;
        let entries = self.legend(right);

        let below = left.corner[1] + left.size[1] + ROOM_BELOW + 18.0;
        let room = legend::rows_height(&entries, frames.column).max(colour_bar::ROOM);
        let mut drawing = Drawing::new(frames.width, below + room + MARGIN);
        draw_heading(&mut drawing, &frames.title, 0.5 * frames.width, MARGIN);

        let bar = (frames.column - 90.0).min(460.0);
        let limits =
            if self.limits.iter().all(|limit| limit.is_finite()) { self.limits } else { common_limits([self.field]) };
        let range = ColourRange::new(&self.quantity, Scale::Linear.range(limits, 0.0), bar);
        let missing = self.draw_field(&mut drawing, left, &range);
        self.draw_moved(&mut drawing, right, &moved);
        for (frame, text) in [(left, self.field_title()), (right, self.moved_title())] {
            let (text, size) = typeface::fitted(&text, LARGE, Weight::Regular, frames.column);
            let middle = frame.corner[0] + 0.5 * frame.size[0];
            drawing.text([middle, frame.corner[1] - 12.0], &text, size, Anchor::Middle);
        }
        left.draw_axes(&mut drawing, Labels::Both);
        right.draw_axes(&mut drawing, Labels::Horizontal);

        let [under_left, under_right] = [left, right].map(|frame| frame.corner[0] + 0.5 * frame.size[0]);
        let [low, high] = common_limits([self.field]);
        let slack = 1e-9 * (limits[1] - limits[0]).abs();
        let outside = Outside {
            below: low < limits[0].min(limits[1]) - slack,
            above: high > limits[1].max(limits[0]) + slack,
            missing,
        };
        range.draw(&mut drawing, [under_left - 0.5 * bar, below], bar, outside);
        legend::draw_rows(&mut drawing, &entries, [under_right, below - 4.0], frames.column);
        Ok(drawing)
    }

    fn check(&self) -> Result<(), Error> {
        let nodes = self.nodes.len();
        let lengths = [
            ("displacement of a picture", self.displacement.len(), 2 * nodes, "nodal displacements (two per node)"),
            ("field of a picture", self.field.len(), nodes, "nodes"),
            ("closed flags of a picture", self.closed.len(), self.candidates.len(), "candidate nodes"),
        ];
        for (name, found, expected, of) in lengths {
            if found != expected {
                return Err(Error::Length { name, found, expected, of });
            }
        }
        match self.elements.iter().flatten().chain(self.candidates).find(|&&node| node >= nodes) {
            Some(&node) => {
                let allowed = "smaller than the number of nodes (indices from 0)";
                Err(Error::Setting { name: "node index in a picture", value: node as f64, allowed })
            }
            None => Ok(()),
        }
    }

    fn move_by(&self, node: &[f64; 2], displacement: &[f64]) -> [f64; 2] {
        [0, 1].map(|axis| node[axis] + self.magnification * displacement[axis])
    }

    fn is_displaced(&self) -> bool {
        self.displacement.iter().any(|&component| component != 0.0)
    }

    pub(crate) fn obstacle_look(&self) -> Look {
        if self.magnification == 1.0 { Look::Solid } else { Look::Dashed }
    }

    fn field_title(&self) -> String {
        // Where nothing is displaced, the nodes are where the body is.
        let of = if self.is_displaced() { "the undeformed body" } else { "the body" };
        format!("{} on {of}", self.quantity.name)
    }

    fn moved_title(&self) -> String {
        match self.is_displaced() {
            true => format!("moved mesh, displacement × {}", brief(self.magnification)),
            false => "mesh".into(),
        }
    }

    /// Two frames with the same window and the same scale in both directions.
    fn frames(&self, [mut x, mut y]: [[f64; 2]; 2]) -> Layout {
        let scale = (PANEL[0] / (x[1] - x[0])).min(PANEL[1] / (y[1] - y[0]));
        for (range, smallest) in [(&mut x, SMALLEST[0]), (&mut y, SMALLEST[1])] {
            let missing = 0.5 * (smallest / scale - (range[1] - range[0])).max(0.0);
            *range = [range[0] - missing, range[1] + missing];
        }
        let size = [x, y].map(|range| scale * (range[1] - range[0]));
        let names = ["x", "y"].map(|name| Quantity::new(name, self.length_unit));
        // One factor for both axes, or the same length would carry two different numbers.
        let exponent = common_exponent([x, y].as_flattened().iter().fold(0.0, |largest, end| end.abs().max(largest)));
        let horizontal = Axis::horizontal(&names[0], Scale::Linear, x, size[0]).in_powers_of(&names[0], exponent);
        let vertical = Axis::vertical(&names[1], Scale::Linear, y, size[1]).in_powers_of(&names[1], exponent);
        let overhang = horizontal.overhang();
        let column = size[0].max(COLUMN);
        let aside = 0.5 * (column - size[0]);
        let before = MARGIN + (vertical.room_left() - aside).max(0.0);
        let between = (2.0 * (overhang - aside) + 12.0).max(48.0);
        let width = before + column + between + column + MARGIN.max(overhang - aside + 8.0);
        let title = typeface::wrapped(self.title, TITLE, Weight::Bold, width - 2.0 * MARGIN);
        let top = MARGIN + TITLE * LINE * title.len() as f64 + LARGE * LINE + 14.0;
        let panels = [before + aside, before + column + between + aside].map(|x| Frame {
            corner: [x, top],
            size,
            x: horizontal.clone(),
            y: vertical.clone(),
        });
        Layout { title, panels, column, width }
    }

    fn legend(&self, frame: &Frame) -> Vec<Entry<'_>> {
        let closed = self.closed.iter().filter(|&&closed| closed).count();
        let open = self.closed.len() - closed;
        let counts = [("closed nodes", closed, Candidate::Closed), ("open candidates", open, Candidate::Open)];
        let mut entries: Vec<Entry> = counts
            .into_iter()
            .filter(|&(_, count, _)| count > 0)
            .map(|(name, count, mark)| Entry {
                name: format!("{name} ({count})"),
                key_width: 12.0,
                key: Box::new(move |drawing, centre| mark.draw(drawing, centre, 5.0)),
            })
            .collect();
        if !self.obstacles.is_empty() {
            let look = self.obstacle_look();
            let name = match self.obstacles.iter().any(|obstacle| obstacle.is_seen(frame)) {
                true if look == Look::Solid => "obstacle",
                true => "obstacle, where it is without magnification",
                false => "obstacle: outside the picture",
            };
            let key = Box::new(move |drawing: &mut Drawing, centre| obstacle::draw_key(drawing, centre, look));
            entries.push(Entry { name: name.to_owned(), key, key_width: 30.0 });
        }
        entries
    }
}

struct Layout {
    title: Vec<String>,
    panels: [Frame; 2],
    column: f64,
    width: f64,
}
