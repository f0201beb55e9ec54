//! The picture of a contact answer: fields on the undeformed body, and the displaced mesh under its obstacle.

use std::borrow::Cow;

use super::arrows::{self, Arrow};
use super::{mark, obstacle};
use crate::draw::drawing::{Anchor, Drawing};
use crate::draw::typeface::{self, Weight};
use crate::plots::axes::{Frame, LARGE, LINE, Labels, Plane, ROOM_BELOW, TITLE, draw_heading};
use crate::plots::colour_bar::{ColourRange, Outside};
use crate::plots::legend::{self, Entry};
use crate::plots::medium::Medium;
use crate::plots::ticks::{Quantity, Scale, brief};
use crate::view::limits::{ROUNDING, common_limits};
use crate::view::magnified::obstacle_name;
use signorini_mechanics::Error;
use signorini_qp as qp;

pub use super::obstacle::ObstacleLine;

/// Largest width and height of a panel in pixels, of two panels and of three.
const PANELS: [[f64; 2]; 2] = [[580.0, 600.0], [440.0, 520.0]];
/// The same on paper, with two panels side by side.
const PAPER_PANEL: [f64; 2] = [400.0, 420.0];
/// A slender body gets white space around it rather than a panel smaller than this.
const SMALLEST: [f64; 2] = [180.0, 130.0];
/// A column is at least this wide, for the colour bar and the legend.
const COLUMN: f64 = 440.0;
/// Values outside the colours by less than this share of their range, which is less than a band, are not noted.
const UNNOTED: f64 = 0.02;

/// A nodal field, to be painted on the body.
#[derive(Clone, Debug)]
pub struct FieldPanel<'a> {
    /// One value per node.
    pub values: &'a [f64],
    /// The quantity with its unit.
    pub quantity: Quantity,
    /// Values at the two ends of the colours, see [`common_limits`]; if they are not finite, the range of the field.
    pub limits: [f64; 2],
}

/// A contact answer as plain data, to be drawn as panels of the same scale side by side.
///
/// On the left are nodal fields (usually the second principal stress, then the von Mises stress), each on the
/// undeformed body with its colour bar. On the right is the displaced mesh with the obstacles, the forces, the closed
/// candidates as filled dots and the open ones as hollow dots. A contact that is small beside the body is shown
/// enlarged in a corner.
#[derive(Clone, Debug)]
pub struct ContactPicture<'a> {
    /// The title: scene, gap, iteration, number of closed nodes.
    pub title: &'a str,
    /// Names of the horizontal and the vertical coordinate of the picture.
    pub axes: [&'a str; 2],
    /// Unit of length of the nodes; empty without units.
    pub length_unit: &'a str,
    /// Coordinates of the nodes.
    pub nodes: &'a [[f64; 2]],
    /// The nodes of every element in order around it, indices from 0; a curved edge has nodes between its corners.
    pub elements: &'a [Vec<usize>],
    /// Nodal displacements, length `2 * n_nodes`, order `[u_x0, u_y0, u_x1, ...]`, in the unit of length.
    pub displacement: &'a [f64],
    /// Magnification of the displacement in the picture; 1 shows the true displacement.
    pub magnification: f64,
    /// The fields, a panel each.
    pub fields: &'a [FieldPanel<'a>],
    /// Obstacles. Their edges should reach beyond the body at both sides, to the ends of the picture. If the
    /// displacement is magnified, they are shifted with their contact.
    pub obstacles: &'a [ObstacleLine<'a>],
    /// Candidate nodes, indices from 0.
    pub candidates: &'a [usize],
    /// One flag per candidate, `true` if it is closed.
    pub closed: &'a [bool],
    /// Forces on the body.
    pub arrows: &'a [Arrow],
    /// The medium: screen or paper.
    pub medium: Medium,
    /// The visible rectangle `[[x from, x to], [y from, y to]]`; `None` for body and obstacle with a margin. The
    /// pictures of a series share the [`common_window`] of their [windows](ContactPicture::window).
    pub window: Option<[[f64; 2]; 2]>,
}

/// The smallest rectangle that holds all windows of a series; `[[0, 1], [0, 1]]` without a window.
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

    /// Draws the panels of the answer side by side.
    ///
    /// Values that are not finite are no error: elements without a value are grey, elements with a coordinate that is
    /// not finite are left out.
    pub fn draw(&self) -> Result<Drawing, Error> {
        self.check()?;
        let moved: Vec<[f64; 2]> =
            self.displacement.chunks_exact(2).zip(self.nodes).map(|(u, node)| self.move_by(node, u)).collect();
        let Layout { title, panels, column, width, pitch } = self.layout(self.window());
        let [fields @ .., mesh] = &panels[..] else { return Ok(Drawing::new(width, pitch)) };
        let entries = self.legend(mesh);
        let room = legend::rows_height(&entries, column).max(self.bar_room());
        let under = |frame: &Frame| frame.corner[1] + frame.size[1] + ROOM_BELOW + 18.0;
        let margin = self.medium.margin();
        let mut drawing = Drawing::new(width, under(mesh) + room + margin);
        draw_heading(&mut drawing, &title, 0.5 * width, margin);

        let bar = (column - 90.0).min(460.0);
        let labels =
            |index: usize| if index.is_multiple_of(self.columns()) { Labels::Both } else { Labels::Horizontal };
        let middle = |frame: &Frame| frame.corner[0] + 0.5 * frame.size[0];
        for (index, (field, frame)) in self.fields.iter().zip(fields).enumerate() {
            let limits = field.shown_limits();
            let range = ColourRange::new(&field.quantity, limits, bar);
            let missing = self.draw_field(&mut drawing, frame, &field.shown_values(limits), &range);
            self.draw_panel_title(&mut drawing, frame, index, &self.field_title(field), column);
            frame.draw_axes(&mut drawing, labels(index));
            let outside = Outside { missing, ..field.outside(limits) };
            range.draw(&mut drawing, [middle(frame) - 0.5 * bar, under(frame)], bar, outside);
        }
        self.draw_moved(&mut drawing, mesh, &moved);
        self.draw_panel_title(&mut drawing, mesh, fields.len(), &self.moved_title(), column);
        mesh.draw_axes(&mut drawing, labels(fields.len()));
        legend::draw_rows(&mut drawing, &entries, [middle(mesh), under(mesh) - 4.0], column);
        Ok(drawing.on_paper(self.medium.millimetres(self.fields.len() + 1)))
    }

    fn draw_panel_title(&self, drawing: &mut Drawing, frame: &Frame, index: usize, title: &str, column: f64) {
        let title = self.medium.panel_title(index, self.fields.len() + 1, title);
        let (text, size) = typeface::fitted(&title, LARGE, Weight::Regular, column);
        drawing.text([frame.corner[0] + 0.5 * frame.size[0], frame.corner[1] - 12.0], &text, size, Anchor::Middle);
    }

    fn check(&self) -> Result<(), Error> {
        let nodes = self.nodes.len();
        let displaced =
            ("displacement of a picture", self.displacement.len(), 2 * nodes, "nodal displacements (two per node)");
        let fields = self.fields.iter().map(|field| ("field of a picture", field.values.len(), nodes, "nodes"));
        let lengths =
            [displaced, ("closed flags of a picture", self.closed.len(), self.candidates.len(), "candidate nodes")];
        for (name, found, expected, of) in lengths.into_iter().chain(fields) {
            if found != expected {
                return Err(qp::LinearError::Length { name, found, expected, of }.into());
            }
        }
        match self.elements.iter().flatten().chain(self.candidates).find(|&&node| node >= nodes) {
            Some(&node) => {
                let allowed = "smaller than the number of nodes (indices from 0)";
                Err(qp::LinearError::Setting { name: "node index in a picture", value: node as f64, allowed }.into())
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

    fn field_title(&self, field: &FieldPanel) -> String {
        // Without a displacement, the nodes are on the undeformed body.
        let of = if self.is_displaced() { "on the undeformed body" } else { "on the body" };
        match self.fields.len() {
            1 => format!("{} {of}", field.quantity.name),
            _ => field.quantity.name.clone(),
        }
    }

    fn moved_title(&self) -> String {
        match (self.is_displaced(), self.magnification == 1.0) {
            (false, _) => "mesh".into(),
            (true, true) => "displaced mesh, to scale".into(),
            (true, false) => format!("displaced mesh, displacement × {}", brief(self.magnification)),
        }
    }

    /// Room for the highest of the colour bars; none without a field.
    fn bar_room(&self) -> f64 {
        self.fields.iter().map(|field| field.outside(field.shown_limits()).room()).fold(0.0, f64::max)
    }

    /// Number of panels side by side: all on a screen, two on paper.
    fn columns(&self) -> usize {
        match self.medium {
            Medium::Screen => self.fields.len() + 1,
            Medium::Paper => 2,
        }
    }

    /// Frames with the same window and the same scale in both directions: one for each field, then that of the
    /// displaced mesh.
    fn layout(&self, window: [[f64; 2]; 2]) -> Layout {
        let (count, columns, margin) = (self.fields.len() + 1, self.columns(), self.medium.margin());
        let most = match self.medium {
            Medium::Screen => PANELS[usize::from(count > 2)],
            Medium::Paper => PAPER_PANEL,
        };
        let names = self.axes.map(|name| Quantity::new(name, self.length_unit));
        let Plane { size, x: horizontal, y: vertical } = Plane::of(window, [most, SMALLEST], &names);
        let overhang = horizontal.overhang();
        let column = size[0].max(if self.medium == Medium::Paper { PAPER_PANEL[0] } else { COLUMN });
        let aside = 0.5 * (column - size[0]);
        let before = margin + (vertical.room_left() - aside).max(0.0);
        let between = (2.0 * (overhang - aside) + 12.0).max(48.0);
        let needed = before + columns as f64 * (column + between) - between + margin.max(overhang - aside + 8.0);
        let width = self.medium.width(count, needed).max(needed);
        let title = self.medium.title(typeface::wrapped(self.title, TITLE, Weight::Bold, width - 2.0 * margin));
        let over = LARGE * LINE + 14.0;
        let top = margin + TITLE * LINE * title.len() as f64 + over;
        let pitch = size[1] + ROOM_BELOW + 18.0 + self.bar_room() + over + 6.0;
        let before = before + 0.5 * (width - needed);
        let frame = |panel: usize| Frame {
            corner: [
                before + aside + (panel % columns) as f64 * (column + between),
                top + (panel / columns) as f64 * pitch,
            ],
            size,
            x: horizontal.clone(),
            y: vertical.clone(),
        };
        Layout { title, panels: (0..count).map(frame).collect(), column, width, pitch }
    }

    fn legend(&self, frame: &Frame) -> Vec<Entry<'_>> {
        let mut entries = mark::entries(self.closed);
        if !self.obstacles.is_empty() {
            let is_seen = self.obstacles.iter().any(|obstacle| obstacle.is_seen(frame));
            let name = if is_seen { obstacle_name(self.magnification) } else { "obstacle: outside the picture" };
            entries.push(Entry { name: name.to_owned(), key: Box::new(obstacle::draw_key), key_width: 30.0 });
        }
        entries.extend(arrows::entries(self.arrows));
        entries
    }
}

impl FieldPanel<'_> {
    /// The ends of the colours: the given limits, or the range of the values, widened if all values are equal.
    pub(crate) fn shown_limits(&self) -> [f64; 2] {
        let limits =
            if self.limits.iter().all(|limit| limit.is_finite()) { self.limits } else { common_limits([self.values]) };
        let largest = limits[0].abs().max(limits[1].abs());
        match (limits[1] - limits[0]).abs() <= ROUNDING * largest {
            true => Scale::Linear.range([0.5 * limits[0], 1.5 * limits[0]], 0.0),
            false => Scale::Linear.range(limits, 0.0),
        }
    }

    /// The values; if they differ by rounding alone, one value for all, so that no edge of a band runs through noise.
    fn shown_values(&self, limits: [f64; 2]) -> Cow<'_, [f64]> {
        let [low, high] = common_limits([self.values]);
        if high - low > ROUNDING * limits[0].abs().max(limits[1].abs()) {
            return Cow::Borrowed(self.values);
        }
        let same = |&value: &f64| if Scale::Linear.shows(value) { low } else { value };
        Cow::Owned(self.values.iter().map(same).collect())
    }

    /// The kinds of values outside the limits.
    pub(crate) fn outside(&self, limits: [f64; 2]) -> Outside {
        let [low, high] = common_limits([self.values]);
        let slack = UNNOTED * (limits[1] - limits[0]).abs();
        Outside {
            below: (low < limits[0] - slack).then_some(low),
            above: (high > limits[1] + slack).then_some(high),
            missing: false,
        }
    }
}

struct Layout {
    title: Vec<String>,
    panels: Vec<Frame>,
    column: f64,
    width: f64,
    /// Distance from one row of panels to the next.
    pitch: f64,
}
