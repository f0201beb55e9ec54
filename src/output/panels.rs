//! What the two panels of a contact picture show: the field, and the moved mesh with its candidates.

use super::{
    axes::Frame,
    body::ContactPicture,
    colour::{Colour, NO_VALUE},
    colour_bar::ColourRange,
    contour::Field,
    drawing::{Drawing, Paint},
    mark::Candidate,
    ticks::Scale,
};

/// Mesh lines closer than this many pixels would only darken the body.
const FINEST_MESH: f64 = 1.6;

const BODY: Colour = Colour(0xf1, 0xf4, 0xf8);
const MESH: Colour = Colour(0x9a, 0xa4, 0xb2);
const OUTLINE: Colour = Colour(0x3a, 0x42, 0x4e);

impl ContactPicture<'_> {
    /// Left: paints the field level over level; says whether some elements have no value.
    pub(crate) fn draw_field(&self, drawing: &mut Drawing, frame: &Frame, range: &ColourRange) -> bool {
        let place = |node: usize| {
            let place = frame.place(self.nodes[node]);
            place[0].is_finite().then_some(place)
        };
        let body = Field::new(self.elements, |node| Some((place(node)?, 0.0)));
        let field = Field::new(self.elements, |node| {
            let value = self.field[node];
            Some((place(node)?, Scale::Linear.shows(value).then_some(value)?))
        });
        let missing = field.count() < body.count();
        let outline = body.at_least(f64::NEG_INFINITY);
        drawing.clipped(frame.corner, frame.size, |drawing| {
            if missing {
                drawing.polygons(&outline, &Paint::fill(NO_VALUE));
            }
            for (level, colour) in range.bands() {
                drawing.polygons(&field.at_least(level), &Paint::fill(colour));
            }
            drawing.polygons(&outline, &Paint::stroke(OUTLINE, 1.4));
        });
        missing
    }

    /// Right: the moved mesh, the obstacles over it, and the candidates.
    pub(crate) fn draw_moved(&self, drawing: &mut Drawing, frame: &Frame, moved: &[[f64; 2]]) {
        let places: Vec<[f64; 2]> = moved.iter().map(|&point| frame.place(point)).collect();
        let place = |node: usize| places[node][0].is_finite().then_some((places[node], 0.0));
        let outline = Field::new(self.elements, place).at_least(f64::NEG_INFINITY);
        drawing.clipped(frame.corner, frame.size, |drawing| {
            drawing.polygons(&outline, &Paint::fill(BODY));
            let (lines, spacing) = mesh_lines(self.elements, &places);
            drawing.polylines(&lines, &Paint::stroke(MESH, (0.08 * spacing).clamp(0.3, 0.8)));
            drawing.polygons(&outline, &Paint::stroke(OUTLINE, 1.4));
            for obstacle in self.obstacles {
                obstacle.draw(drawing, frame, self.obstacle_look());
            }
        });
        let radius = self.dot_radius(&places);
        let seen =
            |place: [f64; 2]| (0..2).all(|axis| (0.0..=frame.size[axis]).contains(&(place[axis] - frame.corner[axis])));
        // Closed nodes last, so that no open one covers them.
        for (mark, shown) in [(Candidate::Open, false), (Candidate::Closed, true)] {
            for (&node, _) in self
                .candidates
                .iter()
                .zip(self.closed)
                .filter(|&(&node, &closed)| closed == shown && seen(places[node]))
            {
                mark.draw(drawing, places[node], radius);
            }
        }
    }

    /// Dots as large as the distance of the candidates allows.
    fn dot_radius(&self, places: &[[f64; 2]]) -> f64 {
        let steps = self.candidates.windows(2).map(|pair| {
            let [from, to] = [places[pair[0]], places[pair[1]]];
            (to[0] - from[0]).hypot(to[1] - from[1])
        });
        let mut steps: Vec<f64> = steps.filter(|step| step.is_finite()).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).map_or(5.0, |median| (0.42 * median).clamp(1.8, 5.0))
    }
}

/// Every edge of the mesh once, none where they would be too dense to be seen apart, and their mean length.
fn mesh_lines(elements: &[Vec<usize>], places: &[[f64; 2]]) -> (Vec<[[f64; 2]; 2]>, f64) {
    let mut edges: Vec<[usize; 2]> = elements
        .iter()
        .flat_map(|element| element.iter().enumerate().map(|(k, &from)| [from, element[(k + 1) % element.len()]]))
        .map(|[from, to]| [from.min(to), from.max(to)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let lines: Vec<[[f64; 2]; 2]> = edges
        .into_iter()
        .map(|edge| edge.map(|node| places[node]))
        .filter(|ends| ends.iter().flatten().all(|coordinate| coordinate.is_finite()))
        .collect();
    let total: f64 = lines.iter().map(|[from, to]| (to[0] - from[0]).hypot(to[1] - from[1])).sum();
    let mean = total / lines.len().max(1) as f64;
    if mean < FINEST_MESH { (Vec::new(), mean) } else { (lines, mean) }
}
