//! Arrays in few bytes: quantised or exact, byte planes of differences, all in one deflated block.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde::Serialize;
use signorini_qp as qp;

use signorini_mechanics::Error;

/// The largest integer code of a value; the next one is the code of a value that is not finite.
const MOST: f64 = 65_534.0;
const NO_VALUE: u16 = u16::MAX;

/// The form of a packed array.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Form {
    /// 16 bits a value, evenly between the lowest and the highest of its component; differences in two byte planes.
    Quantised,
    /// 32-bit whole numbers; differences in four byte planes.
    Whole,
    /// 64-bit floating-point numbers in eight byte planes.
    Exact,
    /// Whole numbers from 0 to 255, unchanged.
    Bytes,
}

/// The position of an array in the block, and its form.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Packed {
    form: Form,
    /// Offset of its first byte.
    at: usize,
    count: usize,
    /// Components of an item; all values of the first component stand before those of the second.
    stride: usize,
    /// The lowest and the highest value of each component, of a quantised array.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ranges: Vec<[f64; 2]>,
}

/// The block, as it grows.
#[derive(Debug, Default)]
pub(super) struct Packer {
    bytes: Vec<u8>,
}

impl Packer {
    /// Values in items of `stride` components, each to a 65,534th of the range of its component.
    pub fn quantised(&mut self, values: &[f64], stride: usize) -> Packed {
        let (at, stride) = (self.bytes.len(), stride.max(1));
        let mut ranges = Vec::with_capacity(stride);
        for component in 0..stride {
            let own = || values.iter().skip(component).step_by(stride).copied();
            let range @ [low, high] = range(own());
            let scale = if high > low { MOST / (high - low) } else { 0.0 };
            let whole = own().map(|value| match value.is_finite() {
                true => ((value - low) * scale).round() as u16,
                false => NO_VALUE,
            });
            let mut last = 0_u16;
            let differences: Vec<u16> =
                whole.map(|value| value.wrapping_sub(std::mem::replace(&mut last, value))).collect();
            self.planes(&differences, u16::to_le_bytes);
            ranges.push(range);
        }
        Packed { form: Form::Quantised, at, count: values.len(), stride, ranges }
    }

    /// Numbers of nodes and the like, in items of `stride` components; a number that does not fit into 32 bits becomes
    /// the largest that does.
    pub fn whole(&mut self, values: &[usize], stride: usize) -> Packed {
        let (at, stride) = (self.bytes.len(), stride.max(1));
        for component in 0..stride {
            let mut last = 0_u32;
            let own = values.iter().skip(component).step_by(stride);
            let differences: Vec<u32> = own
                .map(|&value| {
                    let value = u32::try_from(value).unwrap_or(u32::MAX);
                    value.wrapping_sub(std::mem::replace(&mut last, value))
                })
                .collect();
            self.planes(&differences, u32::to_le_bytes);
        }
        Packed { form: Form::Whole, at, count: values.len(), stride, ranges: Vec::new() }
    }

    /// Values as they are, in items of `stride` components.
    pub fn exact(&mut self, values: &[f64], stride: usize) -> Packed {
        let (at, stride) = (self.bytes.len(), stride.max(1));
        for component in 0..stride {
            let own: Vec<f64> = values.iter().skip(component).step_by(stride).copied().collect();
            self.planes(&own, f64::to_le_bytes);
        }
        Packed { form: Form::Exact, at, count: values.len(), stride, ranges: Vec::new() }
    }

    pub fn bytes(&mut self, values: impl IntoIterator<Item = u8>) -> Packed {
        let at = self.bytes.len();
        self.bytes.extend(values);
        Packed { form: Form::Bytes, at, count: self.bytes.len() - at, stride: 1, ranges: Vec::new() }
    }

    /// The first bytes of all values, then the second bytes, and so on: neighbouring bytes are then similar.
    fn planes<T: Copy, const N: usize>(&mut self, values: &[T], bytes_of: fn(T) -> [u8; N]) {
        for plane in 0..N {
            self.bytes.extend(values.iter().map(|&value| bytes_of(value)[plane]));
        }
    }

    /// The block, deflated without a header, in base64.
    pub fn finished(self) -> Result<String, Error> {
        let failed =
            |error: std::io::Error| qp::LinearError::Numerical { step: "packing a page", reason: error.to_string() };
        let mut deflated = DeflateEncoder::new(Vec::new(), Compression::default());
        deflated.write_all(&self.bytes).map_err(failed)?;
        Ok(STANDARD.encode(deflated.finish().map_err(failed)?))
    }
}

/// The lowest and the highest finite value; zeros without a finite value.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|value| value.is_finite());
    let [low, high] =
        finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    if low <= high { [low, high] } else { [0.0; 2] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The differences of a quantised component, added up again.
    fn read_back(packer: &Packer, packed: &Packed) -> Vec<f64> {
        let items = packed.count / packed.stride;
        let mut values = vec![0.0; packed.count];
        for (component, [low, high]) in packed.ranges.iter().enumerate() {
            let planes = &packer.bytes[packed.at + 2 * component * items..][..2 * items];
            let mut whole = 0_u16;
            for item in 0..items {
                whole = whole.wrapping_add(u16::from_le_bytes([planes[item], planes[items + item]]));
                values[packed.stride * item + component] = match whole {
                    NO_VALUE => f64::NAN,
                    whole => low + f64::from(whole) * (high - low) / MOST,
                };
            }
        }
        values
    }

    #[test]
    fn a_quantised_value_is_off_by_half_a_step_of_its_range_at_most() {
        let values = [3.0, -1e9, 7.5, f64::NAN, -2.25, 1e9, 3.0, 5.0];
        let mut packer = Packer::default();
        packer.bytes([1, 2, 3]);
        let packed = packer.quantised(&values, 2);
        let read = read_back(&packer, &packed);
        for (index, (found, expected)) in read.iter().zip(values).enumerate() {
            let [low, high] = packed.ranges[index % 2];
            let off = (found - expected).abs();
            assert!(off <= 0.5001 * (high - low) / MOST || expected.is_nan() && found.is_nan(), "{found} {expected}");
        }
        assert_eq!((packed.at, packed.ranges[0]), (3, [-2.25, 7.5]));
    }

    #[test]
    fn a_constant_and_an_empty_array_have_ranges_without_extent() {
        let mut packer = Packer::default();
        assert_eq!(packer.quantised(&[4.0, 4.0], 1).ranges, [[4.0; 2]]);
        assert_eq!(packer.quantised(&[], 1).ranges, [[0.0; 2]]);
    }
}
