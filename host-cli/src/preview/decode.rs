//! Decodes pictures, for the unit tests and for the tests of the program.

use std::io::Cursor;

/// A decoded picture.
pub struct Decoded {
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// Row by row; red, green and blue.
    pub pixels: Vec<[u8; 3]>,
    /// How long the picture is shown, hundredths of a second; 0 for a still picture.
    pub delay: u16,
}

/// The picture in a PNG.
pub fn png(bytes: &[u8]) -> Decoded {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    Decoded { size: [info.width, info.height].map(|side| side as usize), pixels: pixels.as_chunks().0.into(), delay: 0 }
}

/// The pictures in a GIF.
pub fn gif(bytes: &[u8]) -> Vec<Decoded> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).unwrap();
    let mut pictures = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        let pixels = frame.buffer.as_chunks::<4>().0.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        pictures.push(Decoded { size: [frame.width, frame.height].map(usize::from), pixels, delay: frame.delay });
    }
    pictures
}
