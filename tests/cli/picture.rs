//! The preview pictures decode and show the cloth in motion.

use std::collections::HashSet;
use std::io::Cursor;

use image::codecs::gif::GifDecoder;
use image::{AnimationDecoder, ImageFormat, RgbaImage};

use crate::kit::Place;

/// More than noise: the cloth covers a good part of the picture, and as much changes.
const LEAST_CHANGED: usize = 500;

fn changed(a: &RgbaImage, b: &RgbaImage) -> usize {
    a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

#[test]
fn the_gif_moves() {
    let place = Place::new();
    place.muslin("run tiny.toml --out out").expect(0);
    let decoder = GifDecoder::new(Cursor::new(place.read("out/preview.gif"))).unwrap();
    let frames: Vec<RgbaImage> = decoder.into_frames().map(|frame| frame.unwrap().into_buffer()).collect();
    assert_eq!(frames.len(), 5);
    for pair in frames.windows(2) {
        let changed = changed(&pair[0], &pair[1]);
        assert!(changed > LEAST_CHANGED, "only {changed} pixels change");
    }
    let colours: HashSet<_> = frames[0].pixels().collect();
    assert!(colours.len() > 20, "the cloth is not shaded: {} colours", colours.len());
}

#[test]
fn the_png_shows_different_moments() {
    let place = Place::new();
    place.muslin("run tiny.toml --out out --preview png").expect(0);
    assert!(!place.path("out/preview.gif").exists());
    let sheet = image::load_from_memory_with_format(&place.read("out/preview.png"), ImageFormat::Png).unwrap();
    let (width, height) = (sheet.width() / 3, sheet.height() / 2);
    let tile = |column: u32, row: u32| sheet.crop_imm(column * (width + 2), row * (height + 2), 470, 350).into_rgba8();
    assert!(changed(&tile(0, 0), &tile(2, 0)) > LEAST_CHANGED);
    assert!(changed(&tile(0, 0), &tile(2, 1)) > LEAST_CHANGED);
}

#[test]
fn cloth_far_away_or_flying_apart_is_drawn_without_a_fault() {
    let place = Place::new();
    for far in ["cloth.position=[0,-1e5,0]", "cloth.position=[0,-1e9,0]", "cloth.grid.size=[1e15,1e15]"] {
        let outcome = place.muslin(&format!("run tiny.toml --out out --set {far} --duration 0.05"));
        assert!(matches!(outcome.code, Some(0 | 3)), "{far}: {outcome:?}");
    }
}
