//! The triangles of a file of STL or OBJ, with equal vertices merged, and the position of each in the file.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::geometry::{cross, distance, dot, length, minus, shifted, unit};
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

// Wavefront OBJ: only lines `v` (vertices) and `f` (faces) are read; a polygon is cut into a fan from its first
// corner.

pub(super) fn read_obj(file: &Path, bytes: &[u8]) -> Result<Facets, Error> {
    let text = String::from_utf8_lossy(bytes);
    let mut facets = Facets::new(file, Unit::Lines);
    let mut numbers: Vec<u32> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let place = index + 1;
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let at = three_numbers(&mut words);
                let at = at.ok_or_else(|| facets.fault(place, "a vertex needs three numbers"))?;
                numbers.push(facets.vertex(at, place)?);
            }
            Some("f") => {
                let mut corner = |word: &str| {
                    let found = word.split('/').next().and_then(|first| first.parse::<i64>().ok());
                    let number = found.and_then(|index| among(&numbers, index));
                    let allowed = format!("a vertex among the {} so far, from 1, or from -1 backwards", numbers.len());
                    number.ok_or_else(|| facets.fault(place, format!("a corner of the face is not {allowed}")))
                };
                let corners = words.by_ref().map(&mut corner).collect::<Result<Vec<u32>, Error>>()?;
                let [first, others @ ..] = corners.as_slice() else {
                    return Err(facets.fault(place, "a face needs at least three corners, but this has none"));
                };
                if others.len() < 2 {
                    let found = corners.len();
                    return Err(
                        facets.fault(place, format!("a face needs at least three corners, but this has {found}"))
                    );
                }
                for pair in others.windows(2) {
                    facets.add([*first, pair[0], pair[1]], place);
                }
            }
            _ => {}
        }
    }
    Ok(facets)
}

/// The vertex of an index from 1, or from -1 backwards.
fn among(numbers: &[u32], index: i64) -> Option<u32> {
    let behind = i64::try_from(numbers.len()).ok()?;
    let place = if index > 0 { index - 1 } else { behind + index };
    // 0 would mean the vertex after the last.
    usize::try_from(place).ok().and_then(|place| numbers.get(place)).copied()
}

// STL: binary, 84 bytes and then 50 for each triangle, or ASCII. Stored normals are ignored: the order of the corners
// gives the outside.

/// Bytes before the first triangle: a title and the number of triangles.
const HEADER: usize = 84;

/// Bytes of a triangle: its normal, three vertices, an attribute.
const RECORD: usize = 50;

/// Reads the bytes of a file: binary if its length agrees with its header.
pub(super) fn read_stl(file: &Path, bytes: &[u8]) -> Result<Facets, Error> {
    let announced =
        bytes.get(HEADER - 4..HEADER).map(|count| u32::from_le_bytes([count[0], count[1], count[2], count[3]]));
    let expected = announced.map(|count| HEADER as u64 + RECORD as u64 * u64::from(count));
    if expected == Some(bytes.len() as u64) {
        return binary(file, bytes);
    }
    // Some binary files begin with the word too, but no text has a zero byte.
    if bytes.trim_ascii_start().starts_with(b"solid") && !bytes.iter().take(HEADER).any(|&byte| byte == 0) {
        return ascii(file, bytes);
    }
    let fault = |byte, message| Err(Facets::new(file, Unit::Bytes).fault(byte, message));
    match (announced, expected) {
        (Some(count), Some(expected)) => {
            let found = bytes.len();
            let message = format!(
                "the header announces {count} triangles, which take {expected} bytes, but the file has {found}; and it does not \
                 begin with `solid`, as an ASCII file does"
            );
            fault(HEADER - 4, message)
        }
        _ => fault(
            0,
            format!("it is not an STL file: it has {} bytes, but the header alone takes {HEADER}", bytes.len()),
        ),
    }
}

fn binary(file: &Path, bytes: &[u8]) -> Result<Facets, Error> {
    let mut facets = Facets::new(file, Unit::Bytes);
    for (index, record) in bytes[HEADER..].chunks_exact(RECORD).enumerate() {
        let place = HEADER + RECORD * index;
        let coordinate = |index: usize| {
            let at = 12 + 4 * index;
            f64::from(f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]]))
        };
        let mut corners = [0; 3];
        for (corner, number) in corners.iter_mut().enumerate() {
            *number = facets.vertex([0, 1, 2].map(|axis| coordinate(3 * corner + axis)), place + 12 + 12 * corner)?;
        }
        facets.add(corners, place);
    }
    Ok(facets)
}

fn ascii(file: &Path, bytes: &[u8]) -> Result<Facets, Error> {
    let text = String::from_utf8_lossy(bytes);
    let mut facets = Facets::new(file, Unit::Lines);
    // The line that begins a facet, and its corners so far.
    let mut open: Option<(usize, Vec<u32>)> = None;
    let mut last = 1;
    for (index, line) in text.lines().enumerate() {
        last = index + 1;
        let mut words = line.split_ascii_whitespace();
        let Some(word) = words.next() else { continue };
        match (word.to_ascii_lowercase().as_str(), &mut open) {
            ("facet", None) => open = Some((last, Vec::with_capacity(3))),
            ("vertex", Some((_, corners))) if corners.len() < 3 => {
                let at = three_numbers(&mut words).filter(|_| words.next().is_none());
                let at = at.ok_or_else(|| facets.fault(last, "a vertex needs three numbers"))?;
                corners.push(facets.vertex(at, last)?);
            }
            ("vertex", Some(_)) => return Err(facets.fault(last, "a fourth vertex; a facet has three")),
            ("endfacet", Some((begin, corners))) => {
                let [a, b, c] = corners[..] else {
                    let found = corners.len();
                    return Err(facets.fault(last, format!("the facet ends after {found} vertices; it needs three")));
                };
                facets.add([a, b, c], *begin);
                open = None;
            }
            ("facet", Some((begin, _))) => {
                let message = format!("a facet begins before the one of line {begin} has ended");
                return Err(facets.fault(last, message));
            }
            ("vertex" | "endfacet", None) => return Err(facets.fault(last, "it stands outside any facet")),
            ("solid" | "endsolid", None) | ("outer" | "endloop", Some(_)) => {}
            _ => {
                let message = "an ASCII STL has lines of solid, facet, outer loop, vertex, endloop, endfacet and \
                               endsolid in this order; this line begins with another word, or breaks the order";
                return Err(facets.fault(last, message));
            }
        }
    }
    match open {
        Some((begin, _)) => Err(facets.fault(last, format!("the file ends in the facet that begins in line {begin}"))),
        None => Ok(facets),
    }
}

/// A triangle with a height below this share of its longest side is treated as its sides only: rounding turns its
/// normal by 1e-7, and no other choice moves a closest point by more.
const FLAT: f64 = 1e-9;

/// The closest part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum TrianglePart {
    /// Its inside.
    Face,
    /// The inside of the side from this corner, 0 to 2, to the next.
    Side(usize),
    /// A corner, 0 to 2.
    Corner(usize),
}

/// The distance of a point from an edge of two corners, or from a face of three or four, cut into triangles, all in
/// length.
pub fn distance_from(corners: &[[f64; 3]], point: [f64; 3]) -> f64 {
    let last = corners.len() - 1;
    // An edge is a triangle without height.
    let triangles = (1..last.max(2)).map(|at| Triangle([corners[0], corners[at], corners[(at + 1).min(last)]]));
    triangles.map(|triangle| distance(triangle.closest(point).0, point)).fold(f64::INFINITY, f64::min)
}

/// The corners of a triangle, counterclockwise seen from outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle(pub [[f64; 3]; 3]);

impl Triangle {
    /// Normal to the outside; its length is twice the area.
    pub fn area_normal(&self) -> [f64; 3] {
        let [a, b, c] = self.0;
        cross(minus(b, a), minus(c, a))
    }

    /// Unit normal to the outside; zero for a flat triangle.
    pub fn normal(&self) -> [f64; 3] {
        let (normal, [a, b, c]) = (self.area_normal(), self.0);
        let longest = distance(a, b).max(distance(b, c)).max(distance(c, a));
        if length(normal) <= FLAT * longest * longest { [0.0; 3] } else { unit(normal) }
    }

    pub fn angle(&self, corner: usize) -> f64 {
        let [at, next, last] = [0, 1, 2].map(|step| self.0[(corner + step) % 3]);
        let (a, b) = (minus(next, at), minus(last, at));
        length(cross(a, b)).atan2(dot(a, b))
    }

    /// The closest point to `node`, and the part on which it lies.
    pub fn closest(&self, node: [f64; 3]) -> ([f64; 3], TrianglePart) {
        let [a, b, c] = self.0;
        let normal = self.normal();
        if normal != [0.0; 3] {
            let (to_node, ab, ac) = (minus(node, a), minus(b, a), minus(c, a));
            let area = dot(cross(ab, ac), normal);
            let (of_b, of_c) = (dot(cross(to_node, ac), normal) / area, dot(cross(ab, to_node), normal) / area);
            if of_b > 0.0 && of_c > 0.0 && of_b + of_c < 1.0 {
                return ([0, 1, 2].map(|axis| a[axis] + of_b * ab[axis] + of_c * ac[axis]), TrianglePart::Face);
            }
        }
        let sides = [0, 1, 2].map(|corner| {
            let (from, along) = (self.0[corner], minus(self.0[(corner + 1) % 3], self.0[corner]));
            let share = dot(minus(node, from), along) / dot(along, along);
            if share >= 1.0 {
                return (self.0[(corner + 1) % 3], TrianglePart::Corner((corner + 1) % 3));
            }
            // A side so short that its square is zero gives NaN as share.
            if share > 0.0 {
                return (shifted(from, share, along), TrianglePart::Side(corner));
            }
            (from, TrianglePart::Corner(corner))
        });
        let far = |at: [f64; 3]| dot(minus(at, node), minus(at, node));
        let [first, second, third] = sides;
        let nearer = if far(second.0) < far(first.0) { second } else { first };
        if far(third.0) < far(nearer.0) { third } else { nearer }
    }
}
