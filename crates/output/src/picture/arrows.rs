//! Forces on the body as arrows.

use crate::draw::colour::{Colour, WHITE};
use crate::draw::drawing::{Drawing, Paint};
use crate::plots::axes::Frame;
use crate::plots::legend::Entry;
use crate::plots::ticks::amount;

/// Length of the arrow of the largest force, as a share of the shorter side of the panel, and of the smallest one in
/// pixels.
const LONGEST: f64 = 0.17;
const SHORTEST: f64 = 16.0;
/// Arrows closer to each other than this, in pixels, are drawn side by side.
const BESIDE: f64 = 13.0;
/// A force below this share of the largest has no arrow.
const NOTHING: f64 = 1e-9;

/// The origin of a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrowKind {
    /// An obstacle, or another body.
    Contact,
    Load,
    /// A support, a spring or a rigid face.
    Support,
}

impl ArrowKind {
    const ALL: [ArrowKind; 3] = [ArrowKind::Contact, ArrowKind::Load, ArrowKind::Support];

    fn name(self) -> &'static str {
        match self {
            ArrowKind::Contact => "contact force",
            ArrowKind::Load => "load",
            ArrowKind::Support => "support force",
        }
    }

    fn colour(self) -> Colour {
        match self {
            ArrowKind::Contact => Colour(0x8e, 0x12, 0x6b),
            ArrowKind::Load => Colour(0x00, 0x5f, 0x9e),
            ArrowKind::Support => Colour(0x00, 0x7a, 0x55),
        }
    }
}

/// A force on the body.
#[derive(Clone, Debug)]
pub struct Arrow {
    /// Its origin.
    pub kind: ArrowKind,
    /// Its point of application on the undeformed body, in length.
    pub at: [f64; 2],
    /// The displacement of that point, in length.
    pub moved: [f64; 2],
    /// Its components, in force.
    pub force: [f64; 2],
    /// The unit of the components.
    pub unit: String,
}

impl Arrow {
    fn size(&self) -> f64 {
        let size = self.force[0].hypot(self.force[1]);
        if size.is_finite() { size } else { 0.0 }
    }
}

fn largest(arrows: &[Arrow]) -> f64 {
    arrows.iter().map(Arrow::size).fold(0.0, f64::max)
}

/// Draws the forces that are more than rounding and act within the frame. Pushing arrows stand outside the body if the
/// frame has room for them.
pub(crate) fn draw(drawing: &mut Drawing, frame: &Frame, arrows: &[Arrow], magnification: f64) {
    let largest = largest(arrows);
    let mut drawn: Vec<[f64; 2]> = Vec::new();
    let inside =
        |point: [f64; 2]| (0..2).all(|axis| (0.0..=frame.size[axis]).contains(&(point[axis] - frame.corner[axis])));
    for arrow in arrows.iter().filter(|arrow| arrow.size() > NOTHING * largest) {
        let share = arrow.size() / largest;
        let length = (LONGEST * frame.size[0].min(frame.size[1]) * share).max(SHORTEST);
        let at = frame.place([0, 1].map(|axis| arrow.at[axis] + magnification * arrow.moved[axis]));
        if !inside(at) {
            continue;
        }
        let direction = [arrow.force[0] / arrow.size(), -arrow.force[1] / arrow.size()];
        let along = |from: [f64; 2], by: f64| [0, 1].map(|axis| from[axis] + by * direction[axis]);
        let middle = [0, 1].map(|axis| frame.corner[axis] + 0.5 * frame.size[axis]);
        let far = |point: [f64; 2]| (point[0] - middle[0]).hypot(point[1] - middle[1]);
        // The tip or the tail is at the point of application: the arrow farther from the middle of the body, if it fits
        // in the frame.
        let [push, pull] = [[along(at, -length), at], [at, along(at, length)]];
        let is_push = match (inside(push[0]), inside(pull[1])) {
            (true, false) => true,
            (false, true) => false,
            _ => far(push[0]) >= far(pull[1]),
        };
        let ends = if is_push { push } else { pull };
        // Arrows that would cover each other stand side by side.
        let aside = |by: f64| ends.map(|[x, y]| [x - by * direction[1], y + by * direction[0]]);
        let middle_of = |[tail, tip]: [[f64; 2]; 2]| [0, 1].map(|axis| 0.5 * (tail[axis] + tip[axis]));
        let is_free = |by: &f64| {
            let [x, y] = middle_of(aside(*by));
            drawn.iter().all(|other| (x - other[0]).hypot(y - other[1]) > BESIDE)
        };
        let by = [0.0, 1.0, -1.0, 2.0, -2.0].map(|times| times * BESIDE * 1.1).into_iter().find(is_free).unwrap_or(0.0);
        drawn.push(middle_of(aside(by)));
        let [tail, tip] = aside(by);
        draw_one(drawing, tail, tip, arrow.kind.colour());
    }
}

fn draw_one(drawing: &mut Drawing, tail: [f64; 2], tip: [f64; 2], colour: Colour) {
    let length = (tip[0] - tail[0]).hypot(tip[1] - tail[1]);
    let [right, down] = [(tip[0] - tail[0]) / length, (tip[1] - tail[1]) / length];
    let head = (0.4 * length).clamp(8.0, 13.0);
    let neck = [tip[0] - head * right, tip[1] - head * down];
    let wing = 0.42 * head;
    let corners =
        [tip, [neck[0] - wing * down, neck[1] + wing * right], [neck[0] + wing * down, neck[1] - wing * right]];
    // A white seam, so that an arrow is seen on any ground.
    drawing.line(tail, neck, &Paint::stroke(WHITE, 5.5));
    drawing.polygon(&corners, &Paint::fill(WHITE).with_stroke(WHITE, 3.0));
    drawing.line(tail, neck, &Paint::stroke(colour, 3.0));
    drawing.polygon(&corners, &Paint::fill(colour));
}

/// An entry for each kind of force, with the largest of its kind.
pub(crate) fn entries(arrows: &[Arrow]) -> Vec<Entry<'static>> {
    let floor = NOTHING * largest(arrows);
    let entry = |kind: ArrowKind| {
        let own: Vec<&Arrow> = arrows.iter().filter(|arrow| arrow.kind == kind && arrow.size() > floor).collect();
        let largest = own.iter().max_by(|a, b| a.size().total_cmp(&b.size()))?;
        let amount = amount(largest.size(), &largest.unit);
        let name = match own.len() {
            1 => format!("{} {amount}", kind.name()),
            _ => format!("{}s, at most {amount}", kind.name()),
        };
        let key = move |drawing: &mut Drawing, [x, y]: [f64; 2]| {
            draw_one(drawing, [x - 14.0, y], [x + 14.0, y], kind.colour());
        };
        Some(Entry { name, key: Box::new(key), key_width: 30.0 })
    };
    ArrowKind::ALL.into_iter().filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plots::axes::Axis;
    use crate::plots::ticks::{Quantity, Scale};

    #[test]
    fn a_force_outside_its_panel_is_not_drawn_in_the_panel_beside() {
        let place = Quantity::new("x", "m");
        let (x, y) = (
            Axis::horizontal(&place, Scale::Linear, [0.0, 1.0], 100.0),
            Axis::vertical(&place, Scale::Linear, [0.0, 1.0], 100.0),
        );
        let frame = Frame { corner: [150.0, 0.0], size: [100.0; 2], x, y };
        let drawn = |at: [f64; 2]| {
            let mut drawing = Drawing::new(300.0, 100.0);
            let arrow = Arrow { kind: ArrowKind::Contact, at, moved: [0.0; 2], force: [0.0, -1.0], unit: "N".into() };
            draw(&mut drawing, &frame, &[arrow], 1.0);
            drawing.svg()
        };
        let empty = Drawing::new(300.0, 100.0).svg();
        assert!(drawn([0.5, 0.5]) != empty);
        assert_eq!(drawn([-0.9, 0.5]), empty);
    }
}
