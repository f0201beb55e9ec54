//! The mark of a candidate node: filled if it is closed, hollow if it is open.

use crate::draw::colour::{Colour, WHITE};
use crate::draw::drawing::{Drawing, Paint};
use crate::plots::legend::Entry;

const CLOSED: Colour = Colour(0xd5, 0x2b, 0x1e);
const OPEN: Colour = Colour(0x5a, 0x64, 0x72);

#[derive(Clone, Copy, Debug)]
pub(crate) enum Candidate {
    Closed,
    Open,
}

impl Candidate {
    pub fn draw(self, drawing: &mut Drawing, place: [f64; 2], radius: f64) {
        match self {
            Candidate::Closed => drawing.circle(place, radius, &Paint::fill(CLOSED).with_stroke(WHITE, 0.8)),
            Candidate::Open => drawing.circle(place, 0.62 * radius, &Paint::fill(WHITE).with_stroke(OPEN, 1.1)),
        }
    }
}

/// An entry for the closed candidates and one for the open ones, with their numbers; `closed` has a flag for each
/// candidate.
pub(crate) fn entries(closed: &[bool]) -> Vec<Entry<'static>> {
    let count = closed.iter().filter(|&&closed| closed).count();
    let counts =
        [("closed nodes", count, Candidate::Closed), ("open candidates", closed.len() - count, Candidate::Open)];
    let entry = |(name, count, mark): (&str, usize, Candidate)| Entry {
        name: format!("{name} ({count})"),
        key_width: 12.0,
        key: Box::new(move |drawing, centre| mark.draw(drawing, centre, 5.0)),
    };
    counts.into_iter().filter(|&(_, count, _)| count > 0).map(entry).collect()
}
