//! The preview pictures decode and show the cloth in motion.

use std::collections::HashSet;

use crate::decode;
use crate::kit::{Place, TINY};

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

/// Pixels as dark as a pin; neither cloth nor wall is.
fn dark(pixels: &[[u8; 3]]) -> usize {
    pixels.iter().filter(|pixel| pixel.iter().all(|&channel| channel < 60)).count()
}

/// A pin is drawn while it holds: not before its `from`, nor after its `until`.
#[test]
fn only_the_pins_that_hold_are_drawn() {
    let place = Place::new();
    let dots = |when: &str| -> Vec<bool> {
        let pin = "select = { corners = [0, 1] }";
        place.write("pins.toml", TINY.replace(pin, &format!("{pin}\n{when}")));
        place.muslin("run pins.toml --out out --set gravity=[0,-1,0]").expect(0);
        decode::gif(&place.read("out/preview.gif")).iter().map(|frame| dark(&frame.pixels) > 0).collect()
    };
    assert_eq!(dots(""), [true; 5]);
    // Frames at 0, 0.05, 0.1, 0.15 and 0.2 s. Just before a step the pin holds as in the step before.
    assert_eq!(dots("until = 0.07"), [true, true, false, false, false]);
    assert_eq!(dots("from = 0.12"), [false, false, false, true, true]);
}

/// The wall is the same along a row of pixels; a floor has lines and a shadow.
#[test]
fn a_floor_is_drawn_where_the_scene_has_one() {
    let place = Place::new();
    let floor =
        "\n[[collider]]\nshape = \"plane\"\npoint = [0, 0.6, 0]\nnormal = [0, 1, 0]\n[contact]\nthickness = 0.001\n";
    place.write("floor.toml", TINY.to_owned() + floor);
    let below = |scene: &str| {
        place.muslin(&format!("run {scene} --out out --preview png")).expect(0);
        let sheet = decode::png(&place.read("out/preview.png"));
        // Of the first picture, rows below the cloth and above the bar.
        let rows = sheet.pixels.chunks_exact(sheet.size[0]).skip(330).take(20);
        rows.flat_map(|row| row[..480].iter().map(|pixel| *pixel != row[0])).filter(|&differs| differs).count()
    };
    assert_eq!(below("tiny.toml"), 0);
    assert!(below("floor.toml") > LEAST_CHANGED);
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
