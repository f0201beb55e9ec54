//! Line plots: named series on linear or logarithmic axes, one panel or several side by side.

use super::axes::{Axis, Frame, LARGE, LINE, Labels, NORMAL, ROOM_BELOW, SMALL, TITLE, draw_heading};
use super::beside::{Taken, darker};
use super::legend::{self, Entry, Key};
use super::medium::Medium;
use super::style::{self, Style};
use super::ticks::{Quantity, Scale};
use crate::draw::colour::{Colour, FAINT, GRID, PALETTE, WHITE};
use crate::draw::drawing::{Anchor, Drawing, Paint};
use crate::draw::typeface::{self, Weight};

/// Width of a picture with one panel, and of one with several.
const WIDTH: [f64; 2] = [1200.0, 1400.0];
const HEIGHT: f64 = 520.0;
const PAPER_HEIGHT: f64 = 300.0;
/// The same with names beside the lines.
const WIDTH_BESIDE: [f64; 2] = [1000.0, 1400.0];
const HEIGHT_BESIDE: f64 = 600.0;
/// Room under the smallest value of a logarithmic axis for those that it cannot show.
const EXACT_ROOM: f64 = 56.0;
/// Width of a band.
const WIDE: f64 = 22.0;
/// Markers closer than this many pixels would hide the line.
const MARKER_DISTANCE: f64 = 16.0;
/// Space between a legend and the frame.
const INSET: f64 = 14.0;

const BAND: Colour = Colour(0xf6, 0xdd, 0x9a);
const BAND_INK: Colour = Colour(0x8a, 0x62, 0x00);
const LEVEL: Colour = Colour(0x5a, 0x64, 0x72);

/// One line of a plot: points that are joined in their order, with a name for the legend.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// Its name in the legend; empty for none.
    pub name: String,
    /// Its points `[x, y]`, in the units of the two axes, in the order in which they are joined; the line is
    /// interrupted if a coordinate is not finite, or not positive on a logarithmic axis.
    pub points: Vec<[f64; 2]>,
}

impl Series {
    /// A named line through points `[x, y]`, in the units of the two axes, in the order in which they are joined.
    pub fn new(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Series { name: name.into(), points }
    }
}

/// One panel of a picture: its two axes and the lines in them. [`line_plots`](crate::line_plots) draws several
/// side by side.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// A heading over the panel; empty for none.
    pub title: String,
    /// Quantity of the horizontal axis.
    pub x: Quantity,
    /// Quantity of the vertical axis.
    pub y: Quantity,
    /// Scales of the horizontal and the vertical axis.
    pub scales: [Scale; 2],
    /// The lines, in the order of the legend, which names them if there are several.
    pub series: Vec<Series>,
    /// The linear vertical axis begins, or ends, at zero.
    pub y_from_zero: bool,
    /// Draws the lines from wide and pale to thin and dark, so that lines that coincide can all be seen.
    pub nested: bool,
    /// Writes the names beside the lines and not in a legend; the first line is drawn over all others.
    pub names_beside: bool,
    /// A wide band under the lines; only with names beside them.
    pub band: Option<Series>,
    /// A named value of the vertical axis to compare with; only with names beside the lines.
    pub level: Option<(String, f64)>,
    /// Values from zero to this lie in a strip, called `exact`, below a logarithmic vertical axis; zero for no strip.
    pub exact: f64,
}

impl Plot {
    /// Linear axes with the given lines.
    pub fn new(x: Quantity, y: Quantity, series: Vec<Series>) -> Self {
        Plot { x, y, series, ..Plot::default() }
    }

    fn shows(&self, [x, y]: [f64; 2]) -> bool {
        self.scales[0].shows(x) && (self.scales[1].shows(y) || self.is_exact(y))
    }

    fn is_exact(&self, y: f64) -> bool {
        self.exact > 0.0 && (0.0..=self.exact).contains(&y)
    }

    fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let points = self.series.iter().chain(&self.band).flat_map(|series| &series.points);
        points.copied().filter(|&point| self.shows(point))
    }

    /// The values that set the range of an axis.
    fn values(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        let of_points = self.points().map(move |point| point[axis]).filter(move |&y| axis == 0 || !self.is_exact(y));
        of_points.chain(self.level.iter().filter(move |_| axis == 1).map(|level| level.1))
    }

    fn is_empty(&self) -> bool {
        self.points().next().is_none()
    }

    /// Height of the strip below the vertical axis.
    fn strip(&self) -> f64 {
        if self.points().any(|point| self.is_exact(point[1])) { EXACT_ROOM } else { 0.0 }
    }

    /// The pixels of the points that can be shown; not numbers for others.
    fn places(&self, frame: &Frame, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let place = |&[x, y]: &[f64; 2]| match self.is_exact(y) {
            true => {
                let [along, _] = frame.place([x, frame.y.range[0]]);
                [along, frame.corner[1] + frame.size[1] + 0.5 * EXACT_ROOM]
            }
            false => frame.place([x, y]),
        };
        points.iter().map(place).collect()
    }

    /// The entries of the legend; empty for a single line, which its axis names.
    fn entries(&self) -> Vec<Entry<'_>> {
        if self.series.len() < 2 || self.names_beside {
            return Vec::new();
        }
        let named = self.series.iter().enumerate().filter(|(_, series)| !series.name.trim().is_empty());
        let entry = |(index, series): (usize, &Series)| {
            let style = self.style(index);
            let has_points = series.points.iter().any(|&point| self.shows(point));
            let name = if has_points { series.name.clone() } else { format!("{} (no data)", series.name) };
            // Marks that no line joins have no line in the legend either.
            let joins = |pair: &[[f64; 2]]| pair.iter().all(|&point| self.shows(point));
            let key: Key = match series.points.windows(2).any(joins) {
                true => Box::new(move |drawing, centre| style.key(drawing, centre)),
                false => Box::new(move |drawing, centre| style.mark(drawing, centre)),
            };
            Entry { name, key_width: style::KEY, key }
        };
        named.map(entry).collect()
    }

    fn style(&self, index: usize) -> Style {
        if self.nested { Style::nested(index) } else { Style::of(index) }
    }

    fn axes(&self, size: [f64; 2]) -> [Axis; 2] {
        let [x, mut y] = [0, 1].map(|axis| self.scales[axis].range(self.values(axis), [0.03, 0.06][axis]));
        if self.y_from_zero && self.scales[1] == Scale::Linear && !self.is_empty() {
            let (low, high) = self.values(1).fold((0.0, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
            if low < high {
                y = [low, high].map(|end| 1.06 * end);
            }
        }
        [Axis::horizontal(&self.x, self.scales[0], x, size[0]), Axis::vertical(&self.y, self.scales[1], y, size[1])]
    }

    fn draw(&self, drawing: &mut Drawing, frame: &Frame, title: &str) {
        frame.draw_grid(drawing);
        let lines: Vec<Vec<[f64; 2]>> = self.series.iter().map(|series| self.places(frame, &series.points)).collect();
        self.draw_below(drawing, frame);
        let order = 0..lines.len();
        let order: Vec<usize> = if self.names_beside { order.rev().collect() } else { order.collect() };
        for index in order {
            let every = (MARKER_DISTANCE * lines[index].len() as f64 / frame.size[0]).ceil() as usize;
            self.style(index).draw(drawing, &lines[index], every);
        }
        if self.names_beside {
            self.draw_names(drawing, frame, &lines);
        }
        if self.is_empty() {
            let middle = [frame.corner[0] + 0.5 * frame.size[0], frame.corner[1] + 0.5 * frame.size[1]];
            drawing.text(middle, "no data", NORMAL, Anchor::Middle);
        }
        self.draw_axes(drawing, frame);
        let (title, size) = typeface::fitted(title, LARGE, Weight::Regular, frame.size[0]);
        drawing.text([frame.corner[0] + 0.5 * frame.size[0], frame.corner[1] - 12.0], &title, size, Anchor::Middle);
    }

    fn with_strip(&self, frame: &Frame) -> Frame {
        Frame { size: [frame.size[0], frame.size[1] + self.strip()], ..frame.clone() }
    }

    fn draw_axes(&self, drawing: &mut Drawing, frame: &Frame) {
        if self.strip() == 0.0 {
            return frame.draw_axes(drawing, Labels::Both);
        }
        let [left, y] = [frame.corner[0], frame.corner[1] + frame.size[1]];
        drawing.line([left, y], [left + frame.size[0], y], &Paint::stroke(FAINT, 1.0));
        drawing.text([left - 11.0, y + 0.5 * EXACT_ROOM + 6.0], "exact", SMALL, Anchor::End);
        // The vertical axis ends at the strip; the horizontal axis is below both.
        let without_x = Axis { ticks: Default::default(), label: String::new(), ..frame.x.clone() };
        Frame { x: without_x, ..frame.clone() }.draw_axes(drawing, Labels::Both);
        let without_y = Axis { ticks: Default::default(), ..frame.y.clone() };
        Frame { y: without_y, ..self.with_strip(frame) }.draw_axes(drawing, Labels::Horizontal);
    }

    /// The band and the level, below all lines.
    fn draw_below(&self, drawing: &mut Drawing, frame: &Frame) {
        if let Some(band) = &self.band {
            let places = self.places(frame, &band.points);
            drawing.polyline(&places, &Paint::stroke(BAND, WIDE));
            places.iter().for_each(|&place| drawing.circle(place, 0.5 * WIDE, &Paint::fill(BAND)));
        }
        if let Some([left, right]) = self.ends_of_level(frame) {
            drawing.line(left, right, &Paint::stroke(LEVEL, 1.6).dashed(&[8.0, 5.0]));
        }
    }

    fn ends_of_level(&self, frame: &Frame) -> Option<[[f64; 2]; 2]> {
        let (_, value) = self.level.as_ref()?;
        let y = frame.place([frame.x.range[0], *value])[1];
        Some([[frame.corner[0], y], [frame.corner[0] + frame.size[0], y]])
    }

    /// The names of level, lines and band beside them.
    fn draw_names(&self, drawing: &mut Drawing, frame: &Frame, lines: &[Vec<[f64; 2]>]) {
        let mut taken = Taken::new(&self.with_strip(frame));
        lines.iter().for_each(|places| taken.add_line(places));
        if let (Some((name, _)), Some([left, right])) = (&self.level, self.ends_of_level(frame)) {
            taken.add_line(&[left, right]);
            taken.label(drawing, name, LEVEL, &[[right[0] - 6.0, right[1]], [left[0] + 6.0, left[1]]]);
        }
        for (index, (series, places)) in self.series.iter().zip(lines).enumerate() {
            taken.label(drawing, &series.name, darker(PALETTE[index % PALETTE.len()]), places);
        }
        if let Some(band) = &self.band {
            taken.label(drawing, &band.name, BAND_INK, &self.places(frame, &band.points));
        }
    }

    /// The upper left corner of a box of `size` within the frame that covers no line; `None` if there is no such box.
    fn free_place(&self, frame: &Frame, size: [f64; 2]) -> Option<[f64; 2]> {
        let room = [0, 1].map(|axis| frame.size[axis] - size[axis] - 2.0 * INSET);
        if room[0] < 0.0 || room[1] < 0.0 {
            return None;
        }
        let mut taken: Vec<[f64; 2]> = Vec::new();
        for series in &self.series {
            let places = self.places(frame, &series.points);
            taken.extend(places.iter().filter(|place| place[0].is_finite()));
            for pair in places.windows(2) {
                let step = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
                let length = step[0].hypot(step[1]);
                let parts = if length.is_finite() { (length / 6.0).ceil() as usize } else { 0 };
                taken.extend(
                    (1..parts).map(|k| [0, 1].map(|axis| pair[0][axis] + step[axis] * k as f64 / parts as f64)),
                );
            }
        }
        // Corners first: upper right, upper left, lower right, lower left; then the middles of the sides.
        let shares = [[1.0, 0.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0], [0.5, 1.0], [1.0, 0.5], [0.0, 0.5]];
        let corners = shares.map(|share| [0, 1].map(|axis| frame.corner[axis] + INSET + share[axis] * room[axis]));
        let free = |corner: &[f64; 2]| {
            let inside = |place: &[f64; 2]| {
                (0..2).all(|axis| (-INSET..size[axis] + INSET).contains(&(place[axis] - corner[axis])))
            };
            !taken.iter().any(inside)
        };
        corners.into_iter().find(free)
    }
}

/// Draws the plots side by side under one title.
///
/// The legend is placed so that it covers no line, or below the axes if that is not possible. Values that cannot be
/// shown (not finite, or not positive on a logarithmic axis) interrupt their line; a plot without any says `no data`.
///
/// ```
/// use signorini_output::{Plot, Quantity, Series, line_plots};
///
/// let force = Series::new("force", vec![[-0.01, 1.0e4], [-0.02, 2.5e4]]);
/// let plot = Plot::new(Quantity::new("gap", "m"), Quantity::new("contact force", "N/m"), vec![force]);
/// assert!(line_plots("Indentation", &[plot]).svg().contains("contact force (kN/m)"));
/// ```
pub fn line_plots(title: &str, plots: &[Plot]) -> Drawing {
    line_plots_for(Medium::Screen, title, plots)
}

/// As [`line_plots`], for a screen or for paper.
pub(crate) fn line_plots_for(medium: Medium, title: &str, plots: &[Plot]) -> Drawing {
    let margin = medium.margin();
    let beside = plots.iter().any(|plot| plot.names_beside);
    // Names beside the lines take the room of two columns.
    let columns = if beside { 2 } else { plots.len() };
    let width = medium.width(columns, if beside { WIDTH_BESIDE } else { WIDTH }[usize::from(plots.len() > 1)]);
    let height = match medium {
        _ if beside => HEIGHT_BESIDE,
        Medium::Paper => PAPER_HEIGHT,
        Medium::Screen => HEIGHT,
    };
    let title = medium.title(typeface::wrapped(title, TITLE, Weight::Bold, width - 2.0 * margin));
    let titles: Vec<String> =
        plots.iter().enumerate().map(|(k, plot)| medium.panel_title(k, plots.len(), &plot.title)).collect();
    let heading = if titles.iter().any(|title| !title.trim().is_empty()) { LARGE * LINE + 14.0 } else { 14.0 };
    let top = margin + TITLE * LINE * title.len() as f64 + heading;
    let column = (width - 2.0 * margin) / plots.len().max(1) as f64;
    let panels: Vec<(&Plot, Frame)> = plots
        .iter()
        .enumerate()
        .map(|(k, plot)| {
            // The room for the tick labels depends on the ticks, and the ticks depend only on the height.
            let height = height - plot.strip();
            let [x, y] = plot.axes([column, height]);
            let room = y.room_left() + if k > 0 { 26.0 } else { 0.0 };
            let across = (column - room - x.overhang().max(12.0)).max(120.0);
            let [x, y] = plot.axes([across, height]);
            let corner = [margin + column * k as f64 + room, top];
            (plot, Frame { corner, size: [across, height], x, y })
        })
        .collect();
    let mut below = 0.0f64;
    let mut legends = Vec::new();
    for (plot, frame) in &panels {
        let entries = plot.entries();
        let [across, down] = legend::column_size(&entries);
        let place = plot.free_place(frame, [across + 2.0 * INSET, down + INSET]);
        if place.is_none() && !entries.is_empty() {
            below = below.max(legend::rows_height(&entries, frame.size[0]) + 12.0);
        }
        legends.push((entries, place));
    }
    let under = top + height + ROOM_BELOW + 12.0;
    let mut drawing = Drawing::new(width, under - 12.0 + below + margin);
    draw_heading(&mut drawing, &title, 0.5 * width, margin);
    for (((plot, frame), (entries, place)), panel_title) in panels.iter().zip(&legends).zip(&titles) {
        plot.draw(&mut drawing, frame, panel_title);
        match place {
            _ if entries.is_empty() => {}
            Some([x, y]) => {
                let [across, down] = legend::column_size(entries);
                let paint = Paint::fill(WHITE).with_stroke(GRID, 1.2);
                drawing.rect([*x, *y], [across + 2.0 * INSET, down + INSET], &paint);
                legend::draw_column(&mut drawing, entries, [x + INSET, y + 0.5 * INSET], across + 1.0);
            }
            None => {
                let middle = frame.corner[0] + 0.5 * frame.size[0];
                legend::draw_rows(&mut drawing, entries, [middle, under], frame.size[0]);
            }
        }
    }
    drawing.on_paper(medium.millimetres(columns))
}
