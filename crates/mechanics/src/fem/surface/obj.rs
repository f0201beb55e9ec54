//! Wavefront OBJ: only lines `v` (vertices) and `f` (faces) are read; a polygon is cut into a fan from its first
//! corner.

use std::path::Path;

use super::facets::{Facets, Unit, three_numbers};
use crate::error::Error;

/// Reads the bytes of a file.
pub(super) fn read(file: &Path, bytes: &[u8]) -> Result<Facets, Error> {
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
