//! Pictures in memory, and the files that they are written to.

use std::borrow::Cow;
use std::io::{self, Write};

/// A picture: rows of pixels from the top, each pixel red, green and blue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// Row by row.
    pub pixels: Vec<[u8; 3]>,
}

impl Image {
    /// A picture of one colour.
    pub fn filled(size: [usize; 2], colour: [u8; 3]) -> Self {
        Self { size, pixels: vec![colour; size[0] * size[1]] }
    }

    /// Copies a smaller picture into this one, with its upper left corner at `at`.
    pub fn put(&mut self, tile: &Image, at: [usize; 2]) {
        for (y, row) in tile.pixels.chunks_exact(tile.size[0]).enumerate() {
            self.pixels[(at[1] + y) * self.size[0] + at[0]..][..tile.size[0]].copy_from_slice(row);
        }
    }

    /// Writes the picture as PNG.
    pub fn write_png(&self, file: impl Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(file, self.size[0] as u32, self.size[1] as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header()?.write_image_data(self.pixels.as_flattened())?;
        Ok(())
    }
}

/// A looping GIF.
pub struct Animation<W: Write> {
    encoder: gif::Encoder<W>,
    size: [u16; 2],
}

impl<W: Write> Animation<W> {
    /// An animation without pictures. All its pictures have this size and these colours, at most 256.
    pub fn new(file: W, size: [usize; 2], colours: &[[u8; 3]]) -> io::Result<Self> {
        let size = size.map(|side| side as u16);
        let mut encoder = gif::Encoder::new(file, size[0], size[1], colours.as_flattened()).map_err(io_error)?;
        encoder.set_repeat(gif::Repeat::Infinite).map_err(io_error)?;
        Ok(Self { encoder, size })
    }

    /// Adds a picture: the colour index of each pixel, and how long it is shown, hundredths of a second.
    pub fn add(&mut self, pixels: Vec<u8>, delay: u16) -> io::Result<()> {
        let [width, height] = self.size;
        let frame = gif::Frame { width, height, delay, buffer: Cow::Owned(pixels), ..gif::Frame::default() };
        self.encoder.write_frame(&frame).map_err(io_error)
    }
}

fn io_error(error: gif::EncodingError) -> io::Error {
    match error {
        gif::EncodingError::Io(error) => error,
        other => io::Error::other(other),
    }
}
