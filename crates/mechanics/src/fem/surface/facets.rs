//! The triangles of a file, with equal vertices merged, and the position of each in the file.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::error::Error;
use signorini_linear as linear;

/// Coordinates larger than this are refused: products of three would overflow.
const LARGEST: f64 = 1e90;

/// Triangles in the order of the file.
#[derive(Debug)]
pub(super) struct Facets {
    file: PathBuf,
    pub vertices: Vec<[f64; 3]>,
    /// Three different vertices of each triangle. A triangle that is only an edge or a point is left out; its edges
    /// coincide, so that this opens no surface.
    pub corners: Vec<[u32; 3]>,
    places: Vec<u32>,
    unit: Unit,
    welded: HashMap<[u64; 3], u32>,
}

/// The unit of positions in a file.
#[derive(Clone, Copy, Debug)]
pub(super) enum Unit {
    /// Lines, from 1.
    Lines,
    /// Bytes, from 0.
    Bytes,
}

impl Facets {
    pub fn new(file: &Path, unit: Unit) -> Self {
        Facets {
            file: file.into(),
            vertices: Vec::new(),
            corners: Vec::new(),
            places: Vec::new(),
            unit,
            welded: HashMap::new(),
        }
    }

    /// The number of the vertex with bitwise equal coordinates; -0 counts as 0.
    pub fn vertex(&mut self, at: [f64; 3], place: usize) -> Result<u32, Error> {
        if let Some(bad) = at.iter().find(|coordinate| !coordinate.is_finite()) {
            return Err(self.fault(place, format!("a coordinate of the vertex is {bad}; it must be finite")));
        }
        let at = at.map(|coordinate| coordinate + 0.0);
        let next = self.vertices.len() as u32;
        let number = *self.welded.entry(at.map(f64::to_bits)).or_insert(next);
        if number == next {
            self.vertices.push(at);
        }
        Ok(number)
    }

    /// Adds a triangle at position `place` of the file.
    pub fn add(&mut self, [a, b, c]: [u32; 3], place: usize) {
        if a != b && b != c && c != a {
            self.corners.push([a, b, c]);
            self.places.push(place as u32);
        }
    }

    /// The position of a triangle in the file.
    pub fn place(&self, triangle: usize) -> usize {
        self.places.get(triangle).map_or(0, |&place| place as usize)
    }

    /// An error of the file at a position.
    pub fn fault(&self, place: usize, message: impl Into<String>) -> Error {
        let (file, message) = (self.file.clone(), message.into());
        match self.unit {
            Unit::Lines => linear::Error::FileSyntax { file, line: place.max(1), message }.into(),
            Unit::Bytes => linear::Error::FileBytes { file, byte: place, message }.into(),
        }
    }

    /// The same surface, scaled and moved to its position in a scene.
    pub fn placed(mut self, scale: f64, origin: [f64; 3]) -> Result<Self, Error> {
        // Merging is finished.
        self.welded = HashMap::new();
        for vertex in &mut self.vertices {
            *vertex = [0, 1, 2].map(|axis| scale * vertex[axis] + origin[axis]);
        }
        let is_large = |vertex: &[f64; 3]| vertex.iter().any(|part| part.is_nan() || part.abs() > LARGEST);
        let large =
            self.corners.iter().position(|corners| corners.iter().any(|&at| is_large(&self.vertices[at as usize])));
        match large {
            Some(triangle) => {
                let message =
                    format!("a scaled coordinate of this triangle lies beyond {LARGEST:e}; take a smaller scale");
                Err(self.fault(self.place(triangle), message))
            }
            None => Ok(self),
        }
    }
}

/// The next three words of a line, as numbers.
pub(super) fn three_numbers<'a>(words: &mut impl Iterator<Item = &'a str>) -> Option<[f64; 3]> {
    let mut numbers = [0.0; 3];
    for number in &mut numbers {
        *number = words.next()?.parse().ok()?;
    }
    Some(numbers)
}
