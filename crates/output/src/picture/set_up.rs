//! The picture of a scene before it is solved: body, mesh, supports, loads, and the obstacles at their gap.

use super::mark::Candidate;
use super::obstacle::{self, ObstacleLine};
use super::plane_scene::{PlaneScene, lines};
use super::space_scene::space_set_up;
use crate::draw::colour::{Colour, PALETTE, WHITE};
use crate::draw::drawing::{Drawing, Paint};
use crate::draw::typeface::{self, Weight};
use crate::plots::axes::{Frame, LINE, Labels, MARGIN, Plane, ROOM_BELOW, TITLE, draw_heading};
use crate::plots::legend::{self, Entry};
use crate::plots::ticks::{Quantity, amount, brief};
use crate::view::words::{headline, pressing_amounts, state};
use signorini_mechanics::Error;
use signorini_mechanics::fem::Boundary;
use signorini_mechanics::scene::{HeldNode, Hold, Model};

/// Largest width and height of the panel in pixels.
const PANEL: [f64; 2] = [860.0, 640.0];
/// A slender body gets white space around it rather than a smaller panel.
const SMALLEST: [f64; 2] = [560.0, 260.0];
/// White space on every side for symbols and arrows, as a share of the larger side.
const ROOM: f64 = 0.09;
/// Length of the longest arrow in pixels.
const LONGEST: f64 = 52.0;
/// Arrows below this share of the longest one are left out.
const SHORTEST: f64 = 0.02;
/// Nodes in one square of this many pixels share an arrow, and symbols are at least this far apart.
const APART: f64 = 22.0;
/// Size of a symbol in pixels.
const SYMBOL: f64 = 11.0;

const SUPPORT: Colour = PALETTE[2];
const SPRING: Colour = PALETTE[3];
const FACE: Colour = PALETTE[5];
const LOAD: Colour = PALETTE[1];
/// The width of the line along a surface that candidates of another body face, and its colour.
const OPPOSITE: (f64, Colour) = (4.0, Colour(0xc9, 0x9a, 0xd9));
/// As many opposite surfaces are named in the legend.
const MOST_NAMED: usize = 3;

impl Drawing {
    /// The picture of a scene before it is solved.
    ///
    /// # Errors
    /// [`Error::Scene`] for a bar, which has no such picture.
    pub fn of_set_up(model: &Model) -> Result<Drawing, Error> {
        set_up(model)
    }
}

fn set_up(model: &Model) -> Result<Drawing, Error> {
    let title = title(model);
    match model.mesh().dimension() {
        1 => {
            let message =
                "a bar has no picture of its set-up; only bodies in the plane, about an axis and in space have one"
                    .into();
            return Err(Error::Scene { path: "model".into(), message });
        }
        3 => return Ok(space_set_up(model, &title)),
        _ => {}
    }
    let scene = PlaneScene::of_model(model);
    let outlines = scene.obstacles(1.0);
    let lines = lines(&outlines);
    let picture = scene.picture(&[], &lines, 1.0);
    let (frame, title) = framed(obstacle::window(scene.nodes.iter().copied(), &lines), &scene, &title);
    let body = Outwards::of(model);
    let arrows = arrows(model, &body, &frame);
    let symbols = symbols(model, &body, &frame);
    let entries = entries(model, &symbols, !arrows.is_empty(), (&lines, &frame));

    let width = frame.corner[0] + frame.size[0] + MARGIN + frame.x.overhang();
    let below = frame.corner[1] + frame.size[1] + ROOM_BELOW + 18.0;
    let available = width - 2.0 * MARGIN;
    let mut drawing = Drawing::new(width, below + legend::rows_height(&entries, available) + MARGIN);
    draw_heading(&mut drawing, &title, 0.5 * width, MARGIN);
    picture.draw_moved(&mut drawing, &frame, &scene.nodes);
    drawing.clipped(frame.corner, frame.size, |drawing| {
        draw_opposite(drawing, model, &body, &frame);
        symbols.iter().for_each(|symbol| symbol.draw(drawing));
        arrows.iter().for_each(|[from, to]| draw_arrow(drawing, *from, *to));
    });
    frame.draw_axes(&mut drawing, Labels::Both);
    legend::draw_rows(&mut drawing, &entries, [0.5 * width, below], available);
    Ok(drawing)
}

/// Scene, forces of obstacles, and the smallest gap with its place: the gap of the scene says little if the shapes have
/// another one.
fn title(model: &Model) -> String {
    let smallest = model.rows().iter().min_by(|a, b| a.gap.total_cmp(&b.gap));
    let Some(row) = smallest else { return format!("{}, set-up", headline(model)) };
    let mesh = model.mesh();
    let place: Vec<String> = mesh.nodes()[row.node][..mesh.dimension()].iter().map(|&part| brief(part)).collect();
    let gap = format!("smallest gap {} at ({})", amount(row.gap, &model.units().length), place.join(", "));
    let forces = if pressing_amounts(model).is_empty() { String::new() } else { state(model) };
    let parts = [model.title(), &forces, &gap, "set-up"];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
}

/// The nodes of a body, each with the vector from the mean of the centroids of the cells around it; it points out of
/// the body at nodes of the boundary.
struct Outwards {
    nodes: Vec<[f64; 2]>,
    out: Vec<[f64; 2]>,
}

impl Outwards {
    fn of(model: &Model) -> Self {
        let mesh = model.mesh();
        let nodes: Vec<[f64; 2]> = mesh.nodes().iter().map(|&[x, y, _]| [x, y]).collect();
        let (mut sums, mut counts) = (vec![[0.0; 2]; nodes.len()], vec![0.0_f64; nodes.len()]);
        for element in mesh.elements() {
            let share = 1.0 / element.len().max(1) as f64;
            let centroid = [0, 1].map(|axis| element.iter().map(|&node| share * nodes[node][axis]).sum::<f64>());
            for &node in element {
                counts[node] += 1.0;
                (0..2).for_each(|axis| sums[node][axis] += centroid[axis]);
            }
        }
        let out = |((node, sum), count): ((&[f64; 2], [f64; 2]), f64)| {
            [0, 1].map(|axis| node[axis] - sum[axis] / count.max(1.0))
        };
        let out = nodes.iter().zip(sums).zip(counts).map(out).collect();
        Outwards { nodes, out }
    }
}

/// The frame of a window with room around it, under a title in lines.
fn framed(window: [[f64; 2]; 2], scene: &PlaneScene, title: &str) -> (Frame, Vec<String>) {
    let longest = window.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
    let with_room = window.map(|[low, high]| [low - ROOM * longest, high + ROOM * longest]);
    let names = scene.axes.map(|name| Quantity::new(name, &scene.length_unit));
    let Plane { size, x: horizontal, y: vertical } = Plane::of(with_room, [PANEL, SMALLEST], &names);
    let left = MARGIN + vertical.room_left();
    let title = typeface::wrapped(title, TITLE, Weight::Bold, left + size[0]);
    let top = MARGIN + TITLE * LINE * title.len() as f64 + 8.0;
    (Frame { corner: [left, top], size, x: horizontal, y: vertical }, title)
}

/// The arrows of the loads in pixels, from tail to tip; the loads of nodes in one square share an arrow.
///
/// A pulling force begins at its point of application; a pressing force ends there.
fn arrows(model: &Model, body: &Outwards, frame: &Frame) -> Vec<[[f64; 2]; 2]> {
    let mut squares = std::collections::BTreeMap::<[i64; 2], Gathered>::new();
    for (node, load) in model.loaded_nodes() {
        let (size, place) = (load[0].hypot(load[1]), frame.place(body.nodes[node]));
        if size > 0.0 && place.iter().all(|part| part.is_finite()) {
            let square = place.map(|part| (part / APART).floor() as i64);
            squares.entry(square).or_default().add(place, [load[0], load[1]], body.out[node]);
        }
    }
    let gathered = merged(squares.into_values());
    let longest = gathered.iter().map(Gathered::length).fold(0.0, f64::max);
    let shown = gathered.iter().filter(|gathered| gathered.length() > SHORTEST * longest);
    shown.map(|gathered| gathered.arrow(LONGEST / longest)).collect()
}

/// The same loads; those closer to each other than half a square, on both sides of a border between squares, share an
/// arrow.
fn merged(squares: impl Iterator<Item = Gathered>) -> Vec<Gathered> {
    let mut merged: Vec<Gathered> = Vec::new();
    for one in squares {
        let [x, y] = one.place();
        let is_near = |other: &&mut Gathered| (other.place()[0] - x).hypot(other.place()[1] - y) < 0.5 * APART;
        match merged.iter_mut().find(is_near) {
            Some(other) => other.join(&one),
            None => merged.push(one),
        }
    }
    merged
}

/// The sum of the loads of several nodes.
#[derive(Default)]
struct Gathered {
    force: [f64; 2],
    weight: f64,
    moment: [f64; 2],
    /// Positive if the forces point out of the body.
    outwards: f64,
}

impl Gathered {
    fn add(&mut self, place: [f64; 2], force: [f64; 2], out: [f64; 2]) {
        let size = force[0].hypot(force[1]);
        self.force = [self.force[0] + force[0], self.force[1] + force[1]];
        self.moment = [self.moment[0] + size * place[0], self.moment[1] + size * place[1]];
        self.weight += size;
        self.outwards += force[0] * out[0] + force[1] * out[1];
    }

    fn join(&mut self, other: &Gathered) {
        (0..2).for_each(|axis| {
            self.force[axis] += other.force[axis];
            self.moment[axis] += other.moment[axis];
        });
        self.weight += other.weight;
        self.outwards += other.outwards;
    }

    /// The centre of the loads, in pixels.
    fn place(&self) -> [f64; 2] {
        self.moment.map(|part| part / self.weight)
    }

    fn length(&self) -> f64 {
        self.force[0].hypot(self.force[1])
    }

    fn arrow(&self, pixels: f64) -> [[f64; 2]; 2] {
        let place = self.place();
        // Pixels count downwards.
        let along = [pixels * self.force[0], -pixels * self.force[1]];
        match self.outwards < 0.0 {
            true => [[place[0] - along[0], place[1] - along[1]], place],
            false => [place, [place[0] + along[0], place[1] + along[1]]],
        }
    }
}

fn draw_arrow(drawing: &mut Drawing, from: [f64; 2], to: [f64; 2]) {
    let [along, down] = [to[0] - from[0], to[1] - from[1]];
    let length = along.hypot(down);
    if length < 1.0 {
        return;
    }
    let unit = [along / length, down / length];
    let head = (0.4 * length).clamp(3.0, 9.0);
    let base = [to[0] - head * unit[0], to[1] - head * unit[1]];
    let aside = [-0.4 * head * unit[1], 0.4 * head * unit[0]];
    drawing.line(from, base, &Paint::stroke(LOAD, 1.6));
    let corners = [to, [base[0] + aside[0], base[1] + aside[1]], [base[0] - aside[0], base[1] - aside[1]]];
    drawing.polygon(&corners, &Paint::fill(LOAD));
}

/// The symbol of a held node, in pixels.
#[derive(Clone, Copy, Debug)]
struct Symbol {
    hold: Hold,
    place: [f64; 2],
    /// Unit vector from the node to its support.
    towards: [f64; 2],
}

/// One symbol for each held node, unless another symbol is too close.
fn symbols(model: &Model, body: &Outwards, frame: &Frame) -> Vec<Symbol> {
    let mut symbols: Vec<Symbol> = Vec::new();
    for HeldNode { node, hold, directions } in model.held_nodes() {
        let direction = directions.first().copied().unwrap_or_default();
        let place = frame.place(body.nodes[node]);
        let is_near =
            |other: &Symbol| other.hold == hold && (other.place[0] - place[0]).hypot(other.place[1] - place[1]) < APART;
        if place.iter().any(|part| !part.is_finite()) || symbols.iter().any(is_near) {
            continue;
        }
        symbols.push(Symbol { hold, place, towards: towards(body.out[node], direction, hold) });
    }
    symbols
}

/// Direction from a node to its support, in pixels: along the held direction, or, if both are held, out of the body.
fn towards(out: [f64; 2], direction: [f64; 3], hold: Hold) -> [f64; 2] {
    let along = match hold {
        Hold::Guided | Hold::Spring => [direction[0], direction[1]],
        Hold::Fixed | Hold::RigidFace => out,
    };
    let length = along[0].hypot(along[1]);
    if length == 0.0 {
        return [0.0, 1.0];
    }
    let sense = if along[0] * out[0] + along[1] * out[1] < 0.0 { -1.0 } else { 1.0 };
    // Pixels count downwards.
    [sense * along[0] / length, -sense * along[1] / length]
}

impl Symbol {
    fn draw(&self, drawing: &mut Drawing) {
        let [x, y] = self.place;
        let [along, down] = self.towards;
        let at = |out: f64, aside: f64| [x + out * along - aside * down, y + out * down + aside * along];
        let half = 0.5 * SYMBOL;
        let triangle = [at(0.0, 0.0), at(SYMBOL, half), at(SYMBOL, -half)];
        match self.hold {
            Hold::Fixed => drawing.polygon(&triangle, &Paint::fill(SUPPORT).with_stroke(WHITE, 0.6)),
            Hold::Guided => {
                drawing.polygon(&triangle, &Paint::fill(WHITE).with_stroke(SUPPORT, 1.4));
                drawing.line(at(SYMBOL + 3.0, half), at(SYMBOL + 3.0, -half), &Paint::stroke(SUPPORT, 1.4));
            }
            Hold::Spring => {
                let turns: Vec<[f64; 2]> = (0..=6)
                    .map(|turn| {
                        let aside = if turn % 6 == 0 { 0.0 } else { half * if turn % 2 == 0 { 1.0 } else { -1.0 } };
                        at(1.5 * SYMBOL * f64::from(turn) / 6.0, aside)
                    })
                    .collect();
                drawing.polyline(&turns, &Paint::stroke(SPRING, 1.4));
            }
            Hold::RigidFace => {
                drawing.rect([x - 0.4 * SYMBOL, y - 0.4 * SYMBOL], [0.8 * SYMBOL; 2], &Paint::fill(FACE))
            }
        }
    }
}

/// The surfaces of other bodies that candidates face.
fn opposite(model: &Model) -> impl Iterator<Item = &Boundary> {
    model.obstacles().iter().filter_map(|obstacle| model.mesh().boundary(obstacle.other_body()?.0))
}

/// Draws lines along the surfaces that candidates face, inside their bodies.
fn draw_opposite(drawing: &mut Drawing, model: &Model, body: &Outwards, frame: &Frame) {
    let (width, colour) = OPPOSITE;
    let inside = |node: usize| {
        // Pixels count downwards.
        let ([x, y], [out_x, out_y]) = (frame.place(body.nodes[node]), body.out[node]);
        let share = width / out_x.hypot(out_y).max(f64::MIN_POSITIVE);
        [x - share * out_x, y + share * out_y]
    };
    for boundary in opposite(model) {
        for edge in boundary.facets().flat_map(|facet| boundary.kind.straight_cells(facet)) {
            let ends: Vec<[f64; 2]> = edge.into_iter().map(inside).collect();
            drawing.polyline(&ends, &Paint::stroke(colour, width));
        }
    }
}

/// The entries of the legend, with their numbers.
fn entries<'a>(
    model: &Model,
    symbols: &[Symbol],
    has_loads: bool,
    (lines, frame): (&[ObstacleLine], &Frame),
) -> Vec<Entry<'a>> {
    let mut entries: Vec<Entry> = Vec::new();
    for (hold, name) in [
        (Hold::Fixed, "held in both directions"),
        (Hold::Guided, "held along one direction"),
        (Hold::Spring, "spring"),
        (Hold::RigidFace, "rigid face"),
    ] {
        if symbols.iter().any(|symbol| symbol.hold == hold) {
            let key = Box::new(move |drawing: &mut Drawing, [x, y]: [f64; 2]| {
                Symbol { hold, place: [x, y - 0.5 * SYMBOL], towards: [0.0, 1.0] }.draw(drawing);
            });
            entries.push(Entry { name: name.to_owned(), key, key_width: 1.4 * SYMBOL });
        }
    }
    if has_loads {
        let key = Box::new(|drawing: &mut Drawing, [x, y]: [f64; 2]| draw_arrow(drawing, [x - 14.0, y], [x + 14.0, y]));
        entries.push(Entry { name: "load".to_owned(), key, key_width: 30.0 });
    }
    let candidates = model.rows().len();
    if candidates > 0 {
        let key = Box::new(|drawing: &mut Drawing, centre| Candidate::Open.draw(drawing, centre, 5.0));
        entries.push(Entry { name: format!("candidates for contact ({candidates})"), key, key_width: 12.0 });
    }
    let names: Vec<&str> = opposite(model).map(|boundary| &*boundary.name).collect();
    if !names.is_empty() {
        let shown = names[..names.len().min(MOST_NAMED)].join(", ");
        let more = names.len().saturating_sub(MOST_NAMED);
        let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
        let key = Box::new(|drawing: &mut Drawing, [x, y]: [f64; 2]| {
            let (width, colour) = OPPOSITE;
            drawing.polyline(&[[x - 14.0, y], [x + 14.0, y]], &Paint::stroke(colour, width));
        });
        entries.push(Entry { name: format!("opposite surface: {shown}{rest}"), key, key_width: 30.0 });
    }
    if !lines.is_empty() {
        let unit = &model.units().length;
        let amounts = pressing_amounts(model);
        let place = match &amounts[..] {
            [] => format!("at gap {} {unit}", brief(model.gap())),
            amounts => format!("pressed by {}", amounts.join(" and ")),
        };
        let seen = if lines.iter().any(|line| line.is_seen(frame)) { "" } else { ": outside the picture" };
        let key = Box::new(|drawing: &mut Drawing, centre| obstacle::draw_key(drawing, centre));
        entries.push(Entry { name: format!("obstacle {}{seen}", place.trim_end()), key, key_width: 30.0 });
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::{APART, Gathered, merged};

    #[test]
    fn loads_on_both_sides_of_a_border_between_squares_share_an_arrow() {
        let at = |x: f64| {
            let mut gathered = Gathered::default();
            gathered.add([x, 0.0], [0.0, -1.0], [0.0, 1.0]);
            gathered
        };
        let arrows = merged([APART - 1.0, APART + 1.0, 2.0 * APART].map(at).into_iter());
        assert_eq!(arrows.len(), 2);
        assert_eq!((arrows[0].place(), arrows[0].force, arrows[1].weight), ([APART, 0.0], [0.0, -2.0], 1.0));
    }
}
