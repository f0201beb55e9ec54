//! The contact of a body in space with an obstacle, in plan view.

use super::body::{ContactPicture, FieldPanel};
use crate::draw::drawing::Drawing;
use crate::plots::axes::{Frame, Labels, Plane, ROOM_BELOW};
use crate::plots::colour_bar::ColourRange;
use crate::plots::medium::Medium;
use crate::plots::ticks::Quantity;

/// Room for the plan view, on a screen and on paper.
const PLANS: [[f64; 2]; 2] = [[460.0, 560.0], [370.0, 420.0]];

/// The contact with one obstacle, seen along its approach direction.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub title: String,
    /// Names of the two coordinates across the approach direction.
    pub axes: [&'static str; 2],
    pub nodes: Vec<[f64; 2]>,
    pub cells: Vec<Vec<usize>>,
    /// Pressure at the nodes.
    pub pressure: Vec<f64>,
    pub unit: String,
    /// Ends of the colours; if they are not finite, the range of the pressure.
    pub limits: [f64; 2],
    pub candidates: Vec<usize>,
    pub closed: Vec<bool>,
    /// The visible part: the contact with a margin.
    pub window: [[f64; 2]; 2],
}

impl Plan {
    /// The frame of the plan view; its corner gives the room left of the frame.
    pub fn frame(&self, length_unit: &str, medium: Medium) -> Frame {
        let [across, down] = PLANS[medium as usize];
        let names = self.axes.map(|name| Quantity::new(name, length_unit));
        let Plane { size, x, y } = Plane::of(self.window, [[across, down - ROOM_BELOW], [0.0; 2]], &names);
        Frame { corner: [y.room_left(), 0.0], size, x, y }
    }

    fn picture<'a>(
        &'a self,
        fields: &'a [FieldPanel<'a>],
        displacement: &'a [f64],
        length_unit: &'a str,
    ) -> ContactPicture<'a> {
        ContactPicture {
            title: "",
            axes: self.axes,
            length_unit,
            nodes: &self.nodes,
            elements: &self.cells,
            displacement,
            magnification: 1.0,
            fields,
            obstacles: &[],
            candidates: &self.candidates,
            closed: &self.closed,
            arrows: &[],
            medium: Medium::Screen,
            window: Some(self.window),
        }
    }

    /// The contact pressure.
    pub fn field(&self) -> FieldPanel<'_> {
        let quantity = Quantity::new("contact pressure p", &self.unit);
        FieldPanel { values: &self.pressure, quantity, limits: self.limits }
    }

    pub fn draw(&self, drawing: &mut Drawing, frame: &Frame, length_unit: &str, bar_at: [f64; 2], bar: f64) {
        let fields = [self.field()];
        let still = vec![0.0; 2 * self.nodes.len()];
        let picture = self.picture(&fields, &still, length_unit);
        let limits = fields[0].shown_limits();
        let range = ColourRange::new(&fields[0].quantity, [limits[0].min(0.0), limits[1]], bar);
        picture.draw_field(drawing, frame, &self.pressure, &range);
        picture.draw_plan(drawing, frame);
        frame.draw_axes(drawing, Labels::Both);
        range.draw(drawing, bar_at, bar, fields[0].outside(limits));
    }
}
