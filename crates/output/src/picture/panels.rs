//! The panels of a contact picture: a field, and the displaced mesh with its candidates and forces.

use super::arrows;
use super::body::ContactPicture;
use super::contour::Field;
use super::inset::Inset;
use super::mark::Candidate;
use crate::draw::colour::{Colour, NO_VALUE};
use crate::draw::drawing::{Drawing, Paint};
use crate::plots::axes::Frame;
use crate::plots::colour_bar::ColourRange;
use crate::plots::ticks::Scale;

/// Mesh lines closer than this many pixels would only darken the body.
const FINEST_MESH: f64 = 3.0;

/// The radius of the dot of a candidate: as a share of the distance to the next candidate, and at least and at most in
/// pixels.
type Dot = [f64; 3];
const DOT: Dot = [0.42, 1.8, 5.0];
/// Over a field: dots cover at most a twentieth of it.
const SMALL_DOT: Dot = [0.12, 0.8, 2.2];

const BODY: Colour = Colour(0xf1, 0xf4, 0xf8);
const MESH: Colour = Colour(0x9a, 0xa4, 0xb2);
const OUTLINE: Colour = Colour(0x3a, 0x42, 0x4e);

impl ContactPicture<'_> {
    /// Paints a field, level over level; returns `true` if some elements have no value.
    pub(crate) fn draw_field(&self, drawing: &mut Drawing, frame: &Frame, values: &[f64], range: &ColourRange) -> bool {
        let place = |node: usize| {
            let place = frame.place(self.nodes[node]);
            place[0].is_finite().then_some(place)
        };
        let field = Field::new(self.elements, |node| {
            let value = values[node];
            Some((place(node)?, Scale::Linear.shows(value).then_some(value)?))
        });
        let missing = self.elements.iter().flatten().any(|&node| !Scale::Linear.shows(values[node]));
        let outline = match missing {
            true => Field::new(self.elements, |node| Some((place(node)?, 0.0))).at_least(f64::NEG_INFINITY),
            false => field.at_least(f64::NEG_INFINITY),
        };
        drawing.clipped(frame.corner, frame.size, |drawing| {
            if missing {
                drawing.polygons(&outline, &Paint::fill(NO_VALUE));
            }
            for &(level, colour) in range.bands() {
                drawing.polygons(&field.at_least(level), &Paint::fill(colour));
            }
            drawing.polygons(&outline, &Paint::stroke(OUTLINE, 1.4));
        });
        missing
    }

    /// The displaced mesh, the obstacles over it, the candidates and the forces; a small contact enlarged in a corner.
    pub(crate) fn draw_moved(&self, drawing: &mut Drawing, frame: &Frame, moved: &[[f64; 2]]) {
        self.draw_mesh(drawing, frame, moved);
        arrows::draw(drawing, frame, self.arrows, self.magnification);
        let closed: Vec<[f64; 2]> =
            self.candidates.iter().zip(self.closed).filter(|entry| *entry.1).map(|entry| moved[*entry.0]).collect();
        let open = self.candidates.iter().map(|&node| moved[node]);
        if let Some(inset) = Inset::of(frame, &closed, open, moved) {
            inset.draw_ground(drawing, frame);
            self.draw_mesh(drawing, &inset.frame, moved);
            inset.draw_frame(drawing, self.length_unit);
        }
    }

    fn draw_mesh(&self, drawing: &mut Drawing, frame: &Frame, moved: &[[f64; 2]]) {
        let places: Vec<[f64; 2]> = moved.iter().map(|&point| frame.place(point)).collect();
        let place = |node: usize| places[node][0].is_finite().then_some((places[node], 0.0));
        let outline = Field::new(self.elements, place).at_least(f64::NEG_INFINITY);
        drawing.clipped(frame.corner, frame.size, |drawing| {
            drawing.polygons(&outline, &Paint::fill(BODY));
            let (lines, spacing) = mesh_lines(self.elements, &places, frame);
            drawing.polylines(&lines, &Paint::stroke(MESH, (0.08 * spacing).clamp(0.3, 0.8)));
            drawing.polygons(&outline, &Paint::stroke(OUTLINE, 1.4));
            for obstacle in self.obstacles {
                obstacle.draw(drawing, frame);
            }
        });
        self.draw_candidates(drawing, frame, &places, DOT);
    }

    /// Draws cells and candidates over the field of a plan view, with marks that leave the field visible.
    pub(crate) fn draw_plan(&self, drawing: &mut Drawing, frame: &Frame) {
        let places: Vec<[f64; 2]> = self.nodes.iter().map(|&point| frame.place(point)).collect();
        drawing.clipped(frame.corner, frame.size, |drawing| {
            let (lines, spacing) = mesh_lines(self.elements, &places, frame);
            drawing.polylines(&lines, &Paint::stroke(MESH, (0.05 * spacing).clamp(0.2, 0.6)));
        });
        self.draw_candidates(drawing, frame, &places, SMALL_DOT);
    }

    fn draw_candidates(&self, drawing: &mut Drawing, frame: &Frame, places: &[[f64; 2]], dot: Dot) {
        let seen =
            |place: [f64; 2]| (0..2).all(|axis| (0.0..=frame.size[axis]).contains(&(place[axis] - frame.corner[axis])));
        let radius = self.dot_radius(places, &seen, dot);
        // Closed nodes last, so that no open node covers them.
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

    /// The largest radius of dots that the distance of the candidates allows.
    fn dot_radius(&self, places: &[[f64; 2]], seen: &impl Fn([f64; 2]) -> bool, [share, least, most]: Dot) -> f64 {
        let steps = self.candidates.windows(2).map(|pair| [places[pair[0]], places[pair[1]]]);
        let steps = steps.filter(|pair| pair.iter().all(|&place| seen(place)));
        let steps = steps.map(|[from, to]| (to[0] - from[0]).hypot(to[1] - from[1]));
        let mut steps: Vec<f64> = steps.filter(|step| step.is_finite()).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).map_or(most, |median| (share * median).clamp(least, most))
    }
}

/// The edges of the mesh in the frame, each once, and the mean size of an element there; no edges if they would be too
/// dense to distinguish.
fn mesh_lines(elements: &[Vec<usize>], places: &[[f64; 2]], frame: &Frame) -> (Vec<[[f64; 2]; 2]>, f64) {
    let far = [0, 1].map(|axis| frame.corner[axis] + frame.size[axis]);
    let is_seen = |element: &&Vec<usize>| {
        let spans = [0, 1].map(|axis| {
            let along = element.iter().map(|&node| places[node][axis]);
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
        });
        (0..2).all(|axis| spans[axis][0] <= far[axis] && spans[axis][1] >= frame.corner[axis])
    };
    let shown: Vec<&Vec<usize>> = elements.iter().filter(is_seen).collect();
    let mean = (frame.size[0] * frame.size[1] / shown.len().max(1) as f64).sqrt();
    if mean < FINEST_MESH {
        return (Vec::new(), mean);
    }
    let mut edges: Vec<[usize; 2]> = shown
        .into_iter()
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
    (lines, mean)
}
