//! The preview pictures decode and show the cloth in motion.

use std::collections::HashSet;

use crate::decode;
use crate::kit::Place;

/// Lower limit on the number of pixels that must change between two pictures: more than noise.
const LEAST_CHANGED: usize = 500;

fn changed(a: &[[u8; 3]], b: &[[u8; 3]]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

#[test]
fn the_gif_moves() {
    let place = Place::new();
    place.muslin("run tiny.toml --out out").expect(0);
    let frames = decode::gif(&place.read("out/preview.gif"));
    assert_eq!(frames.len(), 5);
    assert_eq!(frames.iter().map(|frame| frame.delay).collect::<Vec<_>>(), [5, 5, 5, 5, 80], "in real time");
    for pair in frames.windows(2) {
        let changed = changed(&pair[0].pixels, &pair[1].pixels);
        assert!(changed > LEAST_CHANGED, "only {changed} pixels change");
    }
    let colours: HashSet<_> = frames[0].pixels.iter().collect();
    assert!(colours.len() > 20, "the cloth is not shaded: {} colours", colours.len());
}

#[test]
fn the_png_shows_different_moments() {
    let place = Place::new();
    place.muslin("run tiny.toml --out out --preview png").expect(0);
    assert!(!place.path("out/preview.gif").exists());
    let sheet = decode::png(&place.read("out/preview.png"));
    let [width, height] = [sheet.size[0] / 3, sheet.size[1] / 2];
    let tile = |column: usize, row: usize| -> Vec<[u8; 3]> {
        let rows = sheet.pixels.chunks_exact(sheet.size[0]).skip(row * (height + 2)).take(350);
        rows.flat_map(|row| &row[column * (width + 2)..][..470]).copied().collect()
    };
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
