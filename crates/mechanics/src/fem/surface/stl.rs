//! STL: binary, 84 bytes and then 50 for each triangle, or ASCII. Stored normals are ignored: the order of the corners
//! gives the outside.

use std::path::Path;

use super::facets::{Facets, Unit, three_numbers};
use crate::error::Error;

/// Bytes before the first triangle: a title and the number of triangles.
const HEADER: usize = 84;

/// Bytes of a triangle: its normal, three vertices, an attribute.
const RECORD: usize = 50;

/// Reads the bytes of a file: binary if its length agrees with its header.
pub(super) fn read(file: &Path, bytes: &[u8]) -> Result<Facets, Error> {
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
