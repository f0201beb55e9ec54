//! Legends: keys with their names, in lines that fit.

use super::axes::{LINE, SMALL};
use crate::draw::drawing::{Anchor, Drawing};
use crate::draw::typeface::{self, Weight};

const SPACE: f64 = 8.0;
const BETWEEN: f64 = 26.0;
/// Height of a line.
pub(crate) const ROW: f64 = SMALL * LINE + 4.0;

/// Draws a key around a centre.
pub(crate) type Key<'a> = Box<dyn Fn(&mut Drawing, [f64; 2]) + 'a>;

/// One entry: its name and its key, drawn around a centre.
pub(crate) struct Entry<'a> {
    pub name: String,
    pub key: Key<'a>,
    /// Width of the key in pixels.
    pub key_width: f64,
}

impl Entry<'_> {
    fn width(&self) -> f64 {
        self.key_width + SPACE + typeface::width(&self.name, SMALL, Weight::Regular)
    }

    fn draw(&self, drawing: &mut Drawing, [x, middle]: [f64; 2], available: f64) {
        (self.key)(drawing, [x + 0.5 * self.key_width, middle]);
        let (name, size) = typeface::fitted(&self.name, SMALL, Weight::Regular, available - self.key_width - SPACE);
        drawing.text([x + self.key_width + SPACE, middle + 0.36 * SMALL], &name, size, Anchor::Start);
    }
}

/// Width and height of the entries one below the other.
pub(crate) fn column_size(entries: &[Entry]) -> [f64; 2] {
    [entries.iter().map(Entry::width).fold(0.0, f64::max), ROW * entries.len() as f64]
}

/// Draws the entries one below the other, cut to `available` pixels.
pub(crate) fn draw_column(drawing: &mut Drawing, entries: &[Entry], [x, y]: [f64; 2], available: f64) {
    for (k, entry) in entries.iter().enumerate() {
        entry.draw(drawing, [x, y + ROW * (k as f64 + 0.5)], available);
    }
}

/// The entries in lines of at most `available` pixels, by their indices.
fn lines(entries: &[Entry], available: f64) -> Vec<Vec<usize>> {
    let mut lines: Vec<Vec<usize>> = Vec::new();
    let mut used = f64::INFINITY;
    for (index, entry) in entries.iter().enumerate() {
        let width = entry.width();
        match lines.last_mut() {
            Some(line) if used + BETWEEN + width <= available => {
                line.push(index);
                used += BETWEEN + width;
            }
            _ => {
                lines.push(vec![index]);
                used = width;
            }
        }
    }
    lines
}

/// Height of the entries side by side in lines of at most `available` pixels.
pub(crate) fn rows_height(entries: &[Entry], available: f64) -> f64 {
    ROW * lines(entries, available).len() as f64
}

/// Draws the entries side by side in lines of at most `available` pixels, each line centred at `x`.
pub(crate) fn draw_rows(drawing: &mut Drawing, entries: &[Entry], [x, y]: [f64; 2], available: f64) {
    for (k, line) in lines(entries, available).iter().enumerate() {
        let widths: Vec<f64> = line.iter().map(|&index| entries[index].width().min(available)).collect();
        let total = widths.iter().sum::<f64>() + BETWEEN * (line.len() - 1) as f64;
        let mut left = x - 0.5 * total;
        for (&index, width) in line.iter().zip(widths) {
            entries[index].draw(drawing, [left, y + ROW * (k as f64 + 0.5)], width + 1.0);
            left += width + BETWEEN;
        }
    }
}
