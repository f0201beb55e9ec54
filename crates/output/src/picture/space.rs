//! The picture of a body in space: its surface in colour, transparent obstacles, and the contact in plan view.

use super::body::FieldPanel;
use super::mark;
use super::plan::Plan;
use crate::draw::colour::{Colour, INK};
use crate::draw::drawing::{Anchor, Drawing, Paint};
use crate::draw::typeface::{self, Weight};
use crate::plots::axes::{LARGE, LINE, ROOM_BELOW, SMALL, TITLE, draw_heading};
use crate::plots::colour_bar::ColourRange;
use crate::plots::legend::{self, Entry};
use crate::plots::medium::Medium;
use crate::plots::ticks::{Scale, amount};
use signorini_mechanics::fem::geometry::{cross, length, minus};
use signorini_qp::dot;

/// Room for the body, on a screen and on paper.
const VIEWS: [[f64; 2]; 2] = [[700.0, 560.0], [470.0, 420.0]];
/// A column is at least this wide.
const COLUMNS: [f64; 2] = [460.0, 370.0];
const BETWEEN: f64 = 40.0;
/// Room for the coordinate axes under the body.
const TRIAD: f64 = 34.0;

/// A face is divided into parts of one colour. Largest number of parts along an edge, and approximate number in all.
const MOST_PARTS: usize = 6;
const ALL_PARTS: usize = 12_000;

/// Edges of faces smaller than this many pixels would only darken the body.
const FINEST_MESH: f64 = 5.0;

const EDGE: Colour = Colour(0x2c, 0x33, 0x3d);
/// Transparency of an obstacle: 1 would be invisible.
const TRANSPARENCY: f64 = 0.72;
const OBSTACLE: Colour = Colour(0x80, 0x86, 0x90);
const OBSTACLE_EDGE: Colour = Colour(0x5c, 0x63, 0x6e);

/// A face of the surface of the body.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    /// Nodes around it, counterclockwise from outside.
    pub outline: Vec<usize>,
    /// The same in triangles and quadrilaterals.
    pub cells: Vec<Vec<usize>>,
}

/// A transparent part of an obstacle.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    /// Polygons in space.
    pub polygons: Vec<Vec<[f64; 3]>>,
    /// Direction from the body to the sheet.
    pub approach: [f64; 3],
}

/// The colours of a surface.
#[derive(Clone, Debug)]
pub(crate) enum Colouring<'a> {
    /// The colours of a field, with their bar.
    Field(FieldPanel<'a>),
    /// One colour for each face, and the names of the colours.
    Faces { colours: &'a [Colour], names: &'a [(&'static str, Colour)] },
}

/// A body in space, as plain data.
#[derive(Clone, Debug)]
pub(crate) struct SpacePicture<'a> {
    pub title: &'a str,
    pub heading: &'a str,
    pub length_unit: &'a str,
    /// Nodes of the displaced body.
    pub nodes: &'a [[f64; 3]],
    pub faces: &'a [Face],
    pub colouring: Colouring<'a>,
    pub sheets: &'a [Sheet],
    /// The name of the obstacles in the legend.
    pub obstacle_name: &'a str,
    /// Vector from the body to the eye, of any length.
    pub eye: [f64; 3],
    pub plan: Option<&'a Plan>,
    pub medium: Medium,
}

/// A view: two directions in the picture and the direction to the eye.
struct View {
    right: [f64; 3],
    up: [f64; 3],
    eye: [f64; 3],
}

impl View {
    fn from(eye: [f64; 3]) -> Self {
        let unit = |v: [f64; 3]| v.map(|part| part / length(v));
        let eye = unit(eye);
        let right = unit(cross([0.0, 0.0, 1.0], eye));
        View { right, up: cross(eye, right), eye }
    }

    fn flat(&self, point: [f64; 3]) -> [f64; 2] {
        [dot(&point, &self.right), dot(&point, &self.up)]
    }
}

/// Map from coordinates in the view to pixels.
struct Place {
    scale: f64,
    low: [f64; 2],
    corner: [f64; 2],
    height: f64,
}

impl Place {
    fn of(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.corner[0] + self.scale * (x - self.low[0]), self.corner[1] + self.height - self.scale * (y - self.low[1])]
    }
}

impl SpacePicture<'_> {
    /// Draws the body and the obstacles as seen from the eye.
    pub fn draw(&self) -> Drawing {
        let view = View::from(self.eye);
        let points = || self.nodes.iter().copied().chain(self.sheets.iter().flat_map(|sheet| sheet.polygons.concat()));
        let ends = |axis: usize| {
            let flat = points().map(|point| view.flat(point)[axis]).filter(|&value| Scale::Linear.shows(value));
            Scale::Linear.range(flat, 0.0)
        };
        let window = [ends(0), ends(1)];
        let span = window.map(|[low, high]| high - low);
        let room = VIEWS[self.medium as usize];
        let scale = (room[0] / span[0]).min(room[1] / span[1]);
        let size = span.map(|side| scale * side);
        let column = size[0].max(self.column());
        let plan = self.plan.map(|plan| (plan, plan.frame(self.length_unit, self.medium)));
        let plan_room =
            plan.as_ref().map_or(0.0, |(_, frame)| frame.corner[0] + frame.size[0].max(self.column()) + BETWEEN);
        let margin = self.medium.margin();
        let needed = 2.0 * margin + column + plan_room;
        let width = self.medium.width(2, needed).max(needed);
        let title = self.medium.title(typeface::wrapped(self.title, TITLE, Weight::Bold, width - 2.0 * margin));
        let top = margin + TITLE * LINE * title.len() as f64 + LARGE * LINE + 14.0;
        let down = (size[1] + TRIAD).max(plan.as_ref().map_or(0.0, |(_, frame)| frame.size[1] + ROOM_BELOW));
        let below = top + down + 18.0;
        let mut entries = plan.as_ref().map_or_else(Vec::new, |(plan, _)| mark::entries(&plan.closed));
        if let Colouring::Faces { names, .. } = self.colouring {
            entries.extend(names.iter().map(|&(name, colour)| face_entry(name, colour)));
        }
        if !self.sheets.is_empty() {
            entries.push(Entry { name: self.obstacle_name.into(), key: Box::new(draw_obstacle_key), key_width: 30.0 });
        }
        let legend = legend::rows_height(&entries, self.column());
        let bar = self.column() - 90.0;
        let field = match &self.colouring {
            Colouring::Field(field) => Some((field, ColourRange::new(&field.quantity, field.shown_limits(), bar))),
            Colouring::Faces { .. } => None,
        };
        let room = |field: &FieldPanel| field.outside(field.shown_limits()).room() + 8.0;
        let of_plan = plan.as_ref().map_or(0.0, |(plan, _)| room(&plan.field()));
        let bar_room = field.as_ref().map_or(0.0, |(field, _)| room(field)).max(of_plan);
        let mut drawing = Drawing::new(width, below + bar_room + legend + 4.0 + margin);
        draw_heading(&mut drawing, &title, 0.5 * width, margin);

        let corner = [margin + 0.5 * (column - size[0]), top + 0.5 * (down - TRIAD - size[1])];
        let place = Place { scale, low: [window[0][0], window[1][0]], corner, height: size[1] };
        let is_in_front = |sheet: &&Sheet| dot(&sheet.approach, &view.eye) > 0.0;
        self.draw_sheets(&mut drawing, &view, &place, |sheet| !is_in_front(sheet));
        self.draw_body(&mut drawing, &view, &place, field.as_ref().map(|(_, range)| range));
        self.draw_sheets(&mut drawing, &view, &place, is_in_front);
        draw_triad(&mut drawing, &view, [margin + 46.0, top + down - 30.0]);
        self.draw_ruler(&mut drawing, scale, [margin + column - 10.0, top + down - 8.0]);
        let middle = margin + 0.5 * column;
        let panels = 1 + usize::from(plan.is_some());
        let heading = self.medium.panel_title(0, panels, self.heading);
        panel_title(&mut drawing, &heading, [middle, top - 12.0], column);
        if let Some((field, range)) = &field {
            range.draw(&mut drawing, [middle - 0.5 * bar, below], bar, field.outside(field.shown_limits()));
        }

        if let Some((plan, mut frame)) = plan {
            let left = margin + column + BETWEEN + frame.corner[0];
            let aside = 0.5 * (frame.size[0].max(self.column()) - frame.size[0]);
            frame.corner = [left + aside, top + 0.5 * (down - ROOM_BELOW - frame.size[1])];
            let middle = frame.corner[0] + 0.5 * frame.size[0];
            let title = self.medium.panel_title(1, 2, &plan.title);
            panel_title(&mut drawing, &title, [middle, frame.corner[1] - 12.0], frame.size[0].max(self.column()));
            plan.draw(&mut drawing, &frame, self.length_unit, [middle - 0.5 * bar, below], bar);
            legend::draw_rows(&mut drawing, &entries, [middle, below + bar_room], self.column());
        } else if field.is_none() {
            legend::draw_rows(&mut drawing, &entries, [middle, below], self.column());
        }
        drawing.on_paper(self.medium.millimetres(2))
    }

    fn column(&self) -> f64 {
        COLUMNS[self.medium as usize]
    }

    /// Draws the visible faces from far to near, in the colours of the field or their own. Faces that turn away from
    /// the light are darker.
    fn draw_body(&self, drawing: &mut Drawing, view: &View, place: &Place, range: Option<&ColourRange>) {
        let light = {
            let towards = [0, 1, 2].map(|axis| view.eye[axis] + 0.5 * view.up[axis] - 0.35 * view.right[axis]);
            towards.map(|part| part / length(towards))
        };
        let mut seen: Vec<(f64, f64, usize)> = Vec::new();
        for (index, face) in self.faces.iter().enumerate() {
            let corners: Vec<[f64; 3]> = face.outline.iter().map(|&node| self.nodes[node]).collect();
            let normal = normal(&corners);
            if dot(&normal, &view.eye) <= 0.0 || corners.iter().flatten().any(|x| !Scale::Linear.shows(*x)) {
                continue;
            }
            let depth = corners.iter().map(|&corner| dot(&corner, &view.eye)).sum::<f64>() / corners.len() as f64;
            let bright = 0.78 + 0.22 * (dot(&normal, &light) / length(normal)).max(0.0);
            seen.push((depth, bright, index));
        }
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        let cells: usize = seen.iter().map(|&(_, _, index)| self.faces[index].cells.len()).sum();
        let parts = ((ALL_PARTS / cells.max(1)) as f64).sqrt().floor().clamp(1.0, MOST_PARTS as f64) as usize;
        let edge = (place.scale * place.scale * self.seen_area(view, &seen) / seen.len().max(1) as f64).sqrt();
        for (_, bright, index) in seen {
            let face = &self.faces[index];
            let mut painted: Vec<(Colour, Vec<Vec<[f64; 2]>>)> = Vec::new();
            for cell in &face.cells {
                for (polygon, colour) in self.coloured(cell, parts, index, range) {
                    let colour = shaded(colour, bright);
                    let flat = polygon.iter().map(|&point| place.of(view.flat(point))).collect();
                    match painted.iter_mut().find(|entry| entry.0 == colour) {
                        Some(entry) => entry.1.push(flat),
                        None => painted.push((colour, vec![flat])),
                    }
                }
            }
            for (colour, polygons) in painted {
                // A line of the same colour closes the seams between neighbours.
                drawing.polygons(&polygons, &Paint::fill(colour).with_stroke(colour, 0.7));
            }
            if edge >= FINEST_MESH {
                let outline: Vec<[f64; 2]> =
                    face.outline.iter().map(|&node| place.of(view.flat(self.nodes[node]))).collect();
                drawing.polygon(&outline, &Paint::stroke(EDGE, (0.03 * edge).clamp(0.25, 0.7)));
            }
        }
    }

    /// The parts of a cell of a face with their colours.
    fn coloured(
        &self,
        cell: &[usize],
        parts: usize,
        face: usize,
        range: Option<&ColourRange>,
    ) -> Vec<(Vec<[f64; 3]>, Colour)> {
        match (&self.colouring, range) {
            (Colouring::Field(field), Some(range)) => {
                let parts = self.parts(cell, parts, field.values).into_iter();
                parts.map(|(polygon, value)| (polygon, range.colour(value))).collect()
            }
            (Colouring::Faces { colours, .. }, _) => {
                vec![(cell.iter().map(|&node| self.nodes[node]).collect(), colours[face])]
            }
            (Colouring::Field(_), None) => Vec::new(),
        }
    }

    fn seen_area(&self, view: &View, seen: &[(f64, f64, usize)]) -> f64 {
        let area = |face: &Face| {
            let flat: Vec<[f64; 3]> = face.outline.iter().map(|&node| self.nodes[node]).collect();
            0.5 * dot(&normal(&flat), &view.eye).abs()
        };
        seen.iter().map(|&(_, _, index)| area(&self.faces[index])).sum()
    }

    /// A triangle or a quadrilateral divided into `parts` along each edge, each part with the value at its centre.
    fn parts(&self, cell: &[usize], parts: usize, values: &[f64]) -> Vec<(Vec<[f64; 3]>, f64)> {
        let weights = |s: f64, t: f64| -> Vec<f64> {
            match cell.len() {
                3 => vec![1.0 - s - t, s, t],
                _ => vec![(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t],
            }
        };
        let point = |s: f64, t: f64| {
            let weights = weights(s, t);
            [0, 1, 2].map(|axis| cell.iter().zip(&weights).map(|(&node, w)| w * self.nodes[node][axis]).sum())
        };
        let value = |s: f64, t: f64| -> f64 {
            cell.iter().zip(weights(s, t)).map(|(&node, weight)| weight * values[node]).sum()
        };
        let step = 1.0 / parts as f64;
        let mut all = Vec::with_capacity(parts * parts);
        for (i, j) in (0..parts).flat_map(|i| (0..parts).map(move |j| (i, j))) {
            let (s, t) = (i as f64 * step, j as f64 * step);
            if cell.len() != 3 {
                let corners = [point(s, t), point(s + step, t), point(s + step, t + step), point(s, t + step)];
                all.push((corners.to_vec(), value(s + 0.5 * step, t + 0.5 * step)));
                continue;
            }
            if i + j < parts {
                let corners = [point(s, t), point(s + step, t), point(s, t + step)];
                all.push((corners.to_vec(), value(s + step / 3.0, t + step / 3.0)));
            }
            if i + j + 1 < parts {
                let corners = [point(s + step, t), point(s + step, t + step), point(s, t + step)];
                all.push((corners.to_vec(), value(s + 2.0 * step / 3.0, t + 2.0 * step / 3.0)));
            }
        }
        all
    }

    fn draw_sheets(&self, drawing: &mut Drawing, view: &View, place: &Place, chosen: impl Fn(&&Sheet) -> bool) {
        for sheet in self.sheets.iter().filter(chosen) {
            let mut polygons: Vec<&Vec<[f64; 3]>> = sheet.polygons.iter().collect();
            let depth = |polygon: &[[f64; 3]]| {
                polygon.iter().map(|&point| dot(&point, &view.eye)).sum::<f64>() / polygon.len().max(1) as f64
            };
            polygons.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
            for polygon in polygons {
                let flat: Vec<[f64; 2]> = polygon.iter().map(|&point| place.of(view.flat(point))).collect();
                drawing.polygon(&flat, &Paint { transparency: TRANSPARENCY, ..Paint::fill(OBSTACLE) });
                drawing.polygon(&flat, &Paint::stroke(OBSTACLE_EDGE, 0.35));
            }
        }
    }

    /// A length in the plane of the picture.
    fn draw_ruler(&self, drawing: &mut Drawing, scale: f64, [right, y]: [f64; 2]) {
        let length = crate::view::magnified::rounded_length(150.0 / scale);
        let text = amount(length, self.length_unit);
        let from = right - scale * length;
        let paint = Paint::stroke(INK, 1.6);
        drawing.line([from, y], [right, y], &paint);
        for end in [from, right] {
            drawing.line([end, y - 5.0], [end, y + 5.0], &paint);
        }
        drawing.text([0.5 * (from + right), y - 9.0], &text, SMALL, Anchor::Middle);
    }
}

/// The entry of a colour of faces in the legend.
fn face_entry(name: &str, colour: Colour) -> Entry<'static> {
    let key = Box::new(move |drawing: &mut Drawing, [x, y]: [f64; 2]| {
        drawing.rect([x - 14.0, y - 6.0], [28.0, 12.0], &Paint::fill(colour).with_stroke(EDGE, 0.6));
    });
    Entry { name: name.to_owned(), key, key_width: 30.0 }
}

fn draw_obstacle_key(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    let paint = Paint { transparency: TRANSPARENCY, ..Paint::fill(OBSTACLE) }.with_stroke(OBSTACLE_EDGE, 0.6);
    drawing.rect([x - 14.0, y - 6.0], [28.0, 12.0], &paint);
}

fn panel_title(drawing: &mut Drawing, title: &str, at: [f64; 2], room: f64) {
    let (text, size) = typeface::fitted(title, LARGE, Weight::Regular, room);
    drawing.text(at, &text, size, Anchor::Middle);
}

/// The three coordinate axes in the view, around `centre`.
fn draw_triad(drawing: &mut Drawing, view: &View, [x, y]: [f64; 2]) {
    const LENGTH: f64 = 30.0;
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let mut along = [0.0; 3];
        along[axis] = 1.0;
        let [right, up] = view.flat(along);
        let tip = [x + LENGTH * right, y - LENGTH * up];
        drawing.line([x, y], tip, &Paint::stroke(INK, 1.6));
        let beyond = [x + (LENGTH + 10.0) * right, y - (LENGTH + 10.0) * up + 5.0];
        drawing.text(beyond, name, SMALL, Anchor::Middle);
    }
}

/// The normal of a polygon; its length is twice the area of the polygon.
fn normal(corners: &[[f64; 3]]) -> [f64; 3] {
    let Some(&first) = corners.first() else { return [0.0; 3] };
    corners.windows(2).fold([0.0; 3], |sum, pair| {
        let part = cross(minus(pair[0], first), minus(pair[1], first));
        [0, 1, 2].map(|axis| sum[axis] + part[axis])
    })
}

fn shaded(Colour(red, green, blue): Colour, bright: f64) -> Colour {
    // Few levels of brightness, so that parts of one face share their colour.
    let part = |channel: u8| (f64::from(channel) * bright).round().clamp(0.0, 255.0) as u8;
    Colour(part(red), part(green), part(blue))
}
