//! Drawings as the frames of an animated PNG, which any viewer of PNG files shows in full colour.

use signorini_qp as qp;
use tiny_skia::Pixmap;

use super::drawing::Drawing;
use signorini_mechanics::Error;

/// An animated PNG of drawings, each shown for `milliseconds`, in the size of the first one, with `scale` pixels of the
/// image for one pixel of a drawing. `frame(index)` draws each when it is needed, so that only one is in memory at a
/// time.
pub fn animate(
    count: usize,
    scale: f64,
    milliseconds: u16,
    mut frame: impl FnMut(usize) -> Result<Drawing, Error>,
) -> Result<Vec<u8>, Error> {
    let failed = |reason: String| qp::LinearError::Numerical { step: "writing an animation", reason };
    let mut bytes = Vec::new();
    if count == 0 {
        return Err(failed("it has no frames".into()).into());
    }
    let first = frame(0)?.pixels(scale)?;
    let (width, height) = (first.width(), first.height());
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let frames = u32::try_from(count).map_err(|error| failed(error.to_string()))?;
    encoder.set_animated(frames, 0).map_err(|error| failed(error.to_string()))?;
    encoder.set_frame_delay(milliseconds, 1000).map_err(|error| failed(error.to_string()))?;
    let mut writer = encoder.write_header().map_err(|error| failed(error.to_string()))?;
    for index in 0..count {
        let pixels = if index == 0 { first.clone() } else { frame(index)?.pixels(scale)? };
        writer.write_image_data(&cut(&pixels, width, height)).map_err(|error| failed(error.to_string()))?;
    }
    writer.finish().map_err(|error| failed(error.to_string()))?;
    Ok(bytes)
}

/// Red, green and blue of each pixel of the upper left `width` x `height`; white outside the image.
fn cut(pixels: &Pixmap, width: u32, height: u32) -> Vec<u8> {
    let pixel =
        |x: u32, y: u32| pixels.pixel(x, y).map_or([255; 3], |colour| [colour.red(), colour.green(), colour.blue()]);
    (0..height).flat_map(|y| (0..width).flat_map(move |x| pixel(x, y))).collect()
}
