//! Canvas: an image, and the PNG file that it becomes.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use crate::failure::Failure;

/// An image of bytes, red, green and blue, row by row from the top.
pub(crate) struct Canvas {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) bytes: Vec<u8>,
}

impl Canvas {
    /// A white image.
    pub(crate) fn new(width: u32, height: u32) -> Canvas {
        Canvas { width, height, bytes: vec![255; width as usize * height as usize * 3] }
    }

    /// Colours a pixel; nothing happens beside the image.
    pub(crate) fn set(&mut self, x: u32, y: u32, colour: [u8; 3]) {
        if x < self.width && y < self.height {
            let at = (y as usize * self.width as usize + x as usize) * 3;
            self.bytes[at..at + 3].copy_from_slice(&colour);
        }
    }

    /// Puts another image into this one, its upper left corner at (`left`, `top`).
    pub(crate) fn paste(&mut self, other: &Canvas, left: u32, top: u32) {
        for y in 0..other.height {
            for x in 0..other.width {
                let at = (y as usize * other.width as usize + x as usize) * 3;
                let pixel = [other.bytes[at], other.bytes[at + 1], other.bytes[at + 2]];
                self.set(left + x, top + y, pixel);
            }
        }
    }

    /// Writes a PNG file.
    pub(crate) fn write(&self, path: &Path) -> Result<(), Failure> {
        let failed = |error: png::EncodingError| Failure::picture(path, &error.to_string());
        let file = File::create(path).map_err(|error| Failure::picture(path, &error.to_string()))?;
        let mut encoder = png::Encoder::new(BufWriter::new(file), self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(failed)?;
        writer.write_image_data(&self.bytes).map_err(failed)?;
        writer.finish().map_err(failed)
    }
}
