//! Error over time on logarithmic axes: curves with their names, the Pareto front as a band, and an error level as a line.

use super::axes::{Axis, Frame, LARGE, LINE, Labels, NORMAL, ROOM_BELOW, SMALL, TITLE, draw_heading};
use super::colour::{Colour, FAINT, PALETTE, WHITE};
use super::drawing::{Anchor, Drawing, Paint};
use super::medium::Medium;
use super::style::Style;
use super::ticks::{Quantity, Scale};
use super::typeface::{self, Weight};

/// Width of a picture with one panel, and of one with several.
const WIDTHS: [f64; 2] = [1000.0, 1400.0];
const HEIGHT: f64 = 600.0;
/// An error below this is rounding: the answer is exact for its mesh.
pub(super) const EXACT: f64 = 3e-16;
/// Room under the smallest error for exact answers.
const EXACT_ROOM: f64 = 56.0;

/// Possible positions of a name beside a point: pixels to the right (negative to the left, zero centred), and the distance of its upper
/// edge below the point in multiples of its height.
const BESIDE: [(f64, f64); 14] = [
    (12.0, -0.5),
    (-12.0, -0.5),
    (0.0, -1.6),
    (0.0, 0.6),
    (12.0, -1.5),
    (-12.0, -1.5),
    (12.0, 0.5),
    (-12.0, 0.5),
    (8.0, -2.6),
    (-8.0, -2.6),
    (8.0, 1.6),
    (-8.0, 1.6),
    (24.0, 2.7),
    (-24.0, 2.7),
];

const BAND: Colour = Colour(0xf6, 0xdd, 0x9a);
const BAND_INK: Colour = Colour(0x8a, 0x62, 0x00);
const LEVEL: Colour = Colour(0x5a, 0x64, 0x72);

/// A named curve through points [time, error].
#[derive(Clone, Debug)]
pub(super) struct Curve {
    pub name: String,
    pub points: Vec<[f64; 2]>,
}

/// Axes with curves.
#[derive(Clone, Debug)]
pub(super) struct CurvePanel {
    pub title: String,
    pub x: Quantity,
    pub y: Quantity,
    /// In the order of drawing: later curves cover earlier ones.
    pub curves: Vec<Curve>,
    /// The Pareto front, by increasing time.
    pub band: (String, Vec<[f64; 2]>),
    /// An error to compare with.
    pub level: Option<(String, f64)>,
}

/// Draws the panels side by side under one title.
pub(super) fn draw_curves(medium: Medium, title: &str, panels: &[CurvePanel]) -> Drawing {
    let margin = medium.margin();
    // Names beside the curves take the room of two columns.
    let width = medium.width(2, WIDTHS[usize::from(panels.len() > 1)]);
    let lines = medium.title(typeface::wrapped(title, TITLE, Weight::Bold, width - 2.0 * margin));
    let top = margin + TITLE * LINE * lines.len() as f64 + LARGE * LINE + 14.0;
    let column = (width - 2.0 * margin) / panels.len().max(1) as f64;
    let mut drawing = Drawing::new(width, top + HEIGHT + ROOM_BELOW + margin);
    draw_heading(&mut drawing, &lines, 0.5 * width, margin);
    for (index, panel) in panels.iter().enumerate() {
        let [x, y] = panel.ranges();
        let vertical = Axis::vertical(&panel.y, Scale::Logarithmic, y, HEIGHT - panel.exact_room());
        let room = vertical.room_left().max(70.0);
        let across = (column - room - 16.0).max(120.0);
        let horizontal = Axis::horizontal(&panel.x, Scale::Logarithmic, x, across);
        let corner = [margin + column * index as f64 + room, top];
        let frame = Frame { corner, size: [across, HEIGHT - panel.exact_room()], x: horizontal, y: vertical };
        panel.draw(&mut drawing, &frame, &medium.panel_title(index, panels.len(), &panel.title));
    }
    drawing.on_paper(medium.millimetres(2))
}

impl CurvePanel {
    fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let shows = |point: &[f64; 2]| Scale::Logarithmic.shows(point[0]) && point[1] >= 0.0 && point[1] < 1e290;
        self.curves.iter().flat_map(|curve| &curve.points).chain(&self.band.1).copied().filter(shows)
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        let errors = self.points().map(|point| point[1]).filter(|&error| error > EXACT);
        let errors = errors.chain(self.level.iter().map(|level| level.1));
        [Scale::Logarithmic.range(self.points().map(|point| point[0]), 0.05), Scale::Logarithmic.range(errors, 0.05)]
    }

    fn exact_room(&self) -> f64 {
        if self.points().any(|point| point[1] <= EXACT) { EXACT_ROOM } else { 0.0 }
    }

    /// The pixel of a point; exact answers lie in the strip below the axis of the errors.
    fn place(&self, frame: &Frame, [time, error]: [f64; 2]) -> [f64; 2] {
        if (0.0..=EXACT).contains(&error) {
            let [x, _] = frame.place([time, frame.y.range[0]]);
            return [x, frame.corner[1] + frame.size[1] + 0.5 * EXACT_ROOM];
        }
        frame.place([time, error])
    }

    fn draw(&self, drawing: &mut Drawing, frame: &Frame, title: &str) {
        frame.draw_grid(drawing);
        let whole = Frame { size: [frame.size[0], frame.size[1] + self.exact_room()], ..frame.clone() };
        let places = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
            points.iter().map(|&point| self.place(frame, point)).filter(|place| place[0].is_finite()).collect()
        };
        let front = places(&self.band.1);
        drawing.polyline(&front, &Paint::stroke(BAND, 22.0));
        front.iter().for_each(|&place| drawing.circle(place, 11.0, &Paint::fill(BAND)));
        let mut taken = Taken::new(&whole);
        let curves: Vec<Vec<[f64; 2]>> = self.curves.iter().map(|curve| places(&curve.points)).collect();
        curves.iter().for_each(|places| taken.add_line(places));
        if let Some((name, error)) = &self.level {
            let y = frame.place([frame.x.range[0], *error])[1];
            let ends = [frame.corner[0], frame.corner[0] + frame.size[0]];
            drawing.line([ends[0], y], [ends[1], y], &Paint::stroke(LEVEL, 1.6).dashed(&[8.0, 5.0]));
            taken.add_line(&[[ends[0], y], [ends[1], y]]);
            taken.label(drawing, name, LEVEL, &[[ends[1] - 6.0, y], [ends[0] + 6.0, y]]);
        }
        if self.exact_room() > 0.0 {
            let y = frame.corner[1] + frame.size[1];
            drawing.line([frame.corner[0], y], [frame.corner[0] + frame.size[0], y], &Paint::stroke(FAINT, 1.0));
            drawing.text([frame.corner[0] - 11.0, y + 0.5 * EXACT_ROOM + 6.0], "exact", SMALL, Anchor::End);
        }
        for (index, places) in curves.iter().enumerate() {
            // The best are drawn last and take the first colours.
            Style::of(curves.len() - 1 - index).draw(drawing, places, 1);
        }
        let names = self.curves.iter().zip(&curves).enumerate();
        for (index, (curve, places)) in names.collect::<Vec<_>>().into_iter().rev() {
            let colour = PALETTE[(curves.len() - 1 - index) % PALETTE.len()];
            taken.label(drawing, &curve.name, darker(colour), places);
        }
        if !front.is_empty() {
            taken.label(drawing, &self.band.0, BAND_INK, &front);
        }
        self.draw_axes(drawing, frame, &whole, title);
    }

    fn draw_axes(&self, drawing: &mut Drawing, frame: &Frame, whole: &Frame, title: &str) {
        if self.points().next().is_none() {
            let middle = [0, 1].map(|axis| frame.corner[axis] + 0.5 * frame.size[axis]);
            drawing.text(middle, "no data", NORMAL, Anchor::Middle);
        }
        // The axis of the errors ends at the strip of exact answers; the axis of times is below both.
        let without =
            Frame { x: Axis { ticks: Default::default(), label: String::new(), ..frame.x.clone() }, ..frame.clone() };
        without.draw_axes(drawing, Labels::Both);
        let under = Frame { y: Axis { ticks: Default::default(), ..frame.y.clone() }, ..whole.clone() };
        under.draw_axes(drawing, Labels::Horizontal);
        let (title, size) = typeface::fitted(title, LARGE, Weight::Regular, frame.size[0]);
        drawing.text([frame.corner[0] + 0.5 * frame.size[0], frame.corner[1] - 12.0], &title, size, Anchor::Middle);
    }
}

/// The same hue, dark enough for letters on white.
fn darker(Colour(red, green, blue): Colour) -> Colour {
    let part = |channel: u8| (f64::from(channel) * 0.72) as u8;
    Colour(part(red), part(green), part(blue))
}

/// The areas that lines and names already cover.
struct Taken {
    low: [f64; 2],
    high: [f64; 2],
    points: Vec<[f64; 2]>,
    marks: Vec<[f64; 2]>,
    boxes: Vec<[[f64; 2]; 2]>,
}

impl Taken {
    fn new(frame: &Frame) -> Self {
        let high = [0, 1].map(|axis| frame.corner[axis] + frame.size[axis]);
        Taken { low: frame.corner, high, points: Vec::new(), marks: Vec::new(), boxes: Vec::new() }
    }

    fn add_line(&mut self, places: &[[f64; 2]]) {
        self.marks.extend(places);
        for pair in places.windows(2) {
            let step = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let parts = (step[0].hypot(step[1]) / 8.0).ceil().min(500.0) as usize;
            self.points
                .extend((1..parts).map(|k| [0, 1].map(|axis| pair[0][axis] + step[axis] * k as f64 / parts as f64)));
        }
    }

    /// Writes a name beside one of the points of its line, at the position that covers the least.
    fn label(&mut self, drawing: &mut Drawing, name: &str, colour: Colour, places: &[[f64; 2]]) {
        let (text, size) = typeface::fitted(name, SMALL, Weight::Regular, 0.6 * (self.high[0] - self.low[0]));
        let (width, height) = (typeface::width(&text, size, Weight::Regular), 1.15 * size);
        let mut best: Option<(f64, [f64; 2])> = None;
        for &[x, y] in places {
            for (right, down) in BESIDE {
                let left = match right {
                    right if right > 0.0 => x + right,
                    right if right < 0.0 => x + right - width,
                    _ => x - 0.5 * width,
                };
                let low = [left, y + down * height];
                let cost = self.cost(low, [left + width, low[1] + height]);
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, low));
                }
            }
        }
        let Some((_, low)) = best else { return };
        let high = [low[0] + width, low[1] + height];
        self.boxes.push([low, high]);
        drawing.rect(
            [low[0] - 3.0, low[1]],
            [width + 6.0, height],
            &Paint { transparency: 0.25, ..Paint::fill(WHITE) },
        );
        drawing.coloured_text([low[0], high[1] - 0.28 * size], &text, size, Anchor::Start, colour);
    }

    fn cost(&self, low: [f64; 2], high: [f64; 2]) -> f64 {
        let outside = (0..2).any(|axis| low[axis] < self.low[axis] + 4.0 || high[axis] > self.high[axis] - 4.0);
        let crosses = |other: &&[[f64; 2]; 2]| {
            // A line of text includes white space: texts may touch vertically, but not horizontally.
            let apart = [4.0, -2.0];
            (0..2).all(|axis| low[axis] < other[1][axis] + apart[axis] && other[0][axis] < high[axis] + apart[axis])
        };
        let covers = |point: &&[f64; 2]| (0..2).all(|axis| (low[axis] - 5.0..high[axis] + 5.0).contains(&point[axis]));
        let boxes = self.boxes.iter().filter(crosses).count();
        let points = self.points.iter().filter(covers).count();
        let marks = self.marks.iter().filter(covers).count();
        if outside { 1e6 } else { 1e3 * boxes as f64 + 60.0 * marks as f64 + points as f64 }
    }
}
