//! A picture in host memory.

use std::io::Write;

/// A picture in host memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Number of pixels in a row.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Red, green, blue and opacity of every pixel in sRGB, row by row from the top.
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// Writes the picture as a PNG file.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_png(&self, to: impl Write) -> std::io::Result<()> {
        self.write_compressed(to, png::Compression::High)
    }

    /// [`Picture::write_png`] in a fraction of the time, for a file that is a little larger.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn write_fast_png(&self, to: impl Write) -> std::io::Result<()> {
        self.write_compressed(to, png::Compression::Fast)
    }

    fn write_compressed(&self, to: impl Write, compression: png::Compression) -> std::io::Result<()> {
        let mut encoder = png::Encoder::new(to, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(compression);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb())?;
        Ok(writer.finish()?)
    }

    /// Reads a PNG file that [`Picture::write_png`] wrote.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn read_png(from: &[u8]) -> std::io::Result<Self> {
        let mut reader = png::Decoder::new(std::io::Cursor::new(from)).read_info()?;
        let mut bytes = vec![0; reader.output_buffer_size().unwrap_or(0)];
        let info = reader.next_frame(&mut bytes)?;
        let pixels = bytes.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2], 255]).collect();
        Ok(Self { width: info.width, height: info.height, pixels })
    }

    /// Writes the picture as a JPEG file; `quality` is from 1 to 100.
    ///
    /// # Errors
    /// Those of the writer, and [`std::io::ErrorKind::InvalidInput`] for a picture with more than 65,535 pixels a side.
    pub fn write_jpeg(&self, to: impl Write, quality: u8) -> std::io::Result<()> {
        let sides = u16::try_from(self.width).ok().zip(u16::try_from(self.height).ok());
        let (width, height) = sides
            .ok_or_else(|| std::io::Error::new(std::io::ErrorKind::InvalidInput, "a JPEG has at most 65535 pixels a side"))?;
        let mut encoder = jpeg_encoder::Encoder::new(to, quality.clamp(1, 100));
        // Full resolution of colour: thin coloured lines would otherwise fade.
        encoder.set_sampling_factor(jpeg_encoder::SamplingFactor::R_4_4_4);
        encoder.encode(&self.rgb(), width, height, jpeg_encoder::ColorType::Rgb).map_err(|error| match error {
            jpeg_encoder::EncodingError::IoError(error) => error,
            other => std::io::Error::other(other),
        })
    }

    /// Returns the picture with an even number of rows and columns. The last row and the last column are repeated where that is
    /// necessary.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn with_even_sides(self) -> Self {
        let [width, height] = [self.width, self.height].map(|side| side.next_multiple_of(2));
        if [width, height] == [self.width, self.height] {
            return self;
        }
        let row = |y: u32| {
            let start = (y.min(self.height - 1) * self.width) as usize;
            (0..width).map(move |x| start + x.min(self.width - 1) as usize)
        };
        let pixels = (0..height).flat_map(row).map(|index| self.pixels[index]).collect();
        Self { width, height, pixels }
    }

    /// Returns red, green and blue of every pixel, one after the other.
    pub fn rgb(&self) -> Vec<u8> {
        self.pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_sides_become_even_with_the_colours_at_the_edges() {
        let grey = |value: u8| [value, value, value, 255];
        let odd = Picture { width: 3, height: 1, pixels: [1, 2, 3].map(grey).to_vec() };
        let even = Picture { width: 4, height: 2, pixels: [1, 2, 3, 3, 1, 2, 3, 3].map(grey).to_vec() };
        assert_eq!(odd.with_even_sides(), even);
        assert_eq!(even.clone().with_even_sides(), even);
    }
}
