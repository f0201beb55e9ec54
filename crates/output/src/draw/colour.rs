//! Colours: the ink of axes, a palette for lines, a perceptually uniform map for fields.

/// An opaque sRGB colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

pub(crate) const WHITE: Colour = Colour(255, 255, 255);
/// Text and axes: a little softer than black on white.
pub(crate) const INK: Colour = Colour(0x22, 0x22, 0x22);
/// Frames and minor ticks.
pub(crate) const FAINT: Colour = Colour(0x8a, 0x8f, 0x98);
/// Grid lines.
pub(crate) const GRID: Colour = Colour(0xe3, 0xe5, 0xe9);
/// Values that are not numbers.
pub(crate) const NO_VALUE: Colour = Colour(0xb9, 0xbd, 0xc4);

/// Line colours that remain distinct under the common colour-vision deficiencies.
///
/// # Source
/// Okabe and Ito, 2008, "Color universal design", without the yellow that is too pale for lines on white.
pub(crate) const PALETTE: [Colour; 7] = [
    Colour(0x00, 0x72, 0xb2),
    Colour(0xd5, 0x5e, 0x00),
    Colour(0x00, 0x9e, 0x73),
    Colour(0xcc, 0x79, 0xa7),
    Colour(0x56, 0xb4, 0xe9),
    Colour(0xe6, 0x9f, 0x00),
    Colour(0x00, 0x00, 0x00),
];

/// Viridis at seventeen equidistant points.
///
/// # Source
/// Smith and van der Walt, 2015, matplotlib's default colour map, released under CC0.
const VIRIDIS: [u32; 17] = [
    0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c, 0x1fa088, 0x28ae80,
    0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725,
];

/// The colour of a field at `fraction` of its range, 0 the lowest value, 1 the highest; clamped outside.
///
/// Viridis is sequential on purpose, although stress has a sign: the second principal stress under contact is
/// compressive nearly everywhere, so a diverging map would spend half its colours on values that do not occur. Its
/// dark end is the strongest compression, its light end the stress-free rest of the body.
pub(crate) fn field_colour(fraction: f64) -> Colour {
    let fraction = if fraction.is_nan() { 0.0 } else { fraction.clamp(0.0, 1.0) };
    let position = fraction * (VIRIDIS.len() - 1) as f64;
    let below = (position.floor() as usize).min(VIRIDIS.len() - 2);
    let part = position - below as f64;
    let channel = |shift: u32| {
        let [low, high] = [VIRIDIS[below], VIRIDIS[below + 1]].map(|rgb| f64::from(rgb >> shift & 0xff));
        (low + part * (high - low)).round() as u8
    };
    Colour(channel(16), channel(8), channel(0))
}
