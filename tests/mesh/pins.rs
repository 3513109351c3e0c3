//! The vertices that a pin holds, its axes and its targets.

use std::collections::BTreeSet;

use glam::DVec3;
use harness::kit::double as kit;
use muslin_core_f64::integrate::pins::{AT_REST, JumpSide};
use muslin_core_f64::scene::BuiltScene;

use super::cloth;

/// 3 x 3 vertices, numbered along x and then along z from (-1, -1), turned upright by a quarter
/// turn about x, which brings z to -y, and moved up by 5.
fn pinned(pin: &str) -> BuiltScene {
    cloth(&format!(
        "grid = {{ size = [2.0, 2.0], cells = [2, 2], pattern = \"diagonal\" }}\n\
         position = [0.0, 5.0, 0.0]\nrotation = [90.0, 0.0, 0.0]\npin = [{pin}]"
    ))
}

fn held(select: &str) -> Vec<u32> {
    pinned(&format!("{{ select = {{ {select} }} }}")).pins.vertices
}

#[test]
fn corners_are_those_before_placing() {
    assert_eq!(held("corners = [0]"), [0], "(-x, -z)");
    assert_eq!(held("corners = [1]"), [2], "(+x, -z)");
    assert_eq!(held("corners = [2]"), [6], "(-x, +z)");
    assert_eq!(held("corners = [3]"), [8], "(+x, +z)");
    assert_eq!(held("corners = [3, 0, 3]"), [0, 8], "in ascending order, each once");
}

#[test]
fn edges_are_sides_before_placing() {
    assert_eq!(held("edge = \"left\""), [0, 3, 6], "-x");
    assert_eq!(held("edge = \"right\""), [2, 5, 8], "+x");
    assert_eq!(held("edge = \"back\""), [0, 1, 2], "-z");
    assert_eq!(held("edge = \"front\""), [6, 7, 8], "+z");
}

/// In the equilateral pattern every second row has one vertex more.
#[test]
fn sides_of_shifted_rows_are_complete() {
    let grid = "grid = { size = [1.0, 1.0], cells = [3, 4] }";
    for (side, axis, at) in [("left", 0, -0.5), ("right", 0, 0.5), ("back", 2, -0.5), ("front", 2, 0.5)] {
        let built = cloth(&format!("{grid}\npin = [{{ select = {{ edge = \"{side}\" }} }}]"));
        let x = kit::positions(&built);
        let expected: Vec<u32> = (0..x.len() as u32).filter(|&v| x[v as usize][axis] == at).collect();
        assert_eq!(built.pins.vertices, expected, "{side}");
        assert_eq!(expected.len(), if axis == 0 { 5 } else { 4 }, "vertices of the side {side}");
    }
}

#[test]
fn boxes_select_among_placed_vertices() {
    assert_eq!(held("box = [[-1.5, 5.5, -0.1], [0.5, 6.5, 0.1]]"), [0, 1], "upper left");
    assert_eq!(
        held("box = [[-1.0, 4.0, 0.0], [-1.0, 6.0, 0.0]]"),
        [0, 3, 6],
        "a box without width, its faces included"
    );
}

#[test]
fn nearest_selects_among_placed_vertices() {
    assert_eq!(held("nearest = [9.0, -9.0, 0.0]"), [8], "lower right");
    assert_eq!(held("nearest = [0.1, 5.1, 3.0]"), [4], "the middle");
    assert_eq!(held("nearest = [-0.5, 6.0, 0.0]"), [0], "the first of two as near");
}

#[test]
fn vertices_are_taken_as_numbered() {
    assert_eq!(held("vertices = [7, 2, 7]"), [2, 7]);
}

#[test]
fn rings_are_those_of_a_disc() {
    let held = |disc: &str, ring: u32| {
        let built = cloth(&format!("disc = {{ {disc} }}\npin = [{{ select = {{ ring = {ring} }} }}]"));
        let x = kit::positions(&built);
        let on_ring = |&v: &u32| (x[v as usize].length() - f64::from(ring)).abs() < 1e-12;
        let expected: Vec<u32> = (0..x.len() as u32).filter(on_ring).collect();
        assert_eq!(built.pins.vertices, expected, "ring {ring}");
        expected.len()
    };
    for (index, count) in [(0, 1), (1, 6), (3, 18)] {
        assert_eq!(held("radius = 3.0, rings = 3", index), count, "vertices of ring {index}");
    }
    let hole = cloth("disc = { radius = 3.0, hole = 1.0, rings = 2 }\npin = [{ select = { ring = 0 } }]");
    assert_eq!(hole.pins.vertices, [0, 1, 2, 3, 4, 5], "the border of the hole");
}

#[test]
fn borders_are_all_of_the_mesh() {
    assert_eq!(held("border = true"), [0, 1, 2, 3, 5, 6, 7, 8], "all but the middle");
    let disc = cloth("disc = { radius = 3.0, hole = 1.0, rings = 2 }\npin = [{ select = { border = true } }]");
    assert_eq!(disc.pins.vertices.len(), 6 + 18, "outside and at the hole");
}

#[test]
fn lines_and_planes_select_among_placed_vertices() {
    assert_eq!(held("line = { a = [-1, 5, 0], b = [1, 5, 0], within = 1e-9 }"), [3, 4, 5], "the middle row");
    assert_eq!(held("line = { a = [-1, 5, 0], b = [0, 5, 0], within = 0.5 }"), [3, 4], "a line ends");
    assert_eq!(held("line = { a = [1, 5, 0], b = [1, 5, 0], within = 1.0 }"), [2, 4, 5, 8], "of no length, a point");
    assert_eq!(held("plane = { point = [7, 4, 0], normal = [0, -3, 0], within = 0.1 }"), [6, 7, 8], "the lowest row");
    assert_eq!(held("plane = { point = [0, 5, 0], normal = [1, 1, 0], within = 1e-9 }"), [0, 4, 8], "a diagonal");
}

#[test]
fn axes_are_those_named() {
    for (axes, bits) in [("x", 1), ("y", 2), ("z", 4), ("zx", 5), ("xyz", 7)] {
        let pins = pinned(&format!("{{ select = {{ corners = [0] }}, axes = \"{axes}\" }}")).pins;
        assert_eq!(pins.axes, [bits], "{axes}");
    }
    assert_eq!(pinned("{ select = { corners = [0] } }").pins.axes, [7], "all where none are named");
}

#[test]
fn pins_hold_where_the_sheet_is_placed() {
    let built = pinned("{ select = { corners = [0, 3] } }");
    let anchors: Vec<_> = built.pins.anchors.iter().map(|x| x.to_array()).collect();
    assert_eq!(anchors, [[-1.0, 6.0, 0.0], [1.0, 4.0, 0.0]]);
    assert_eq!(built.pins.motions, [AT_REST; 2], "without motion");
}

/// Times before, between and after the keys; the pin turns about the centre of the selection and then stops.
#[test]
fn pins_follow_keys_and_turn() {
    let built = pinned(
        "{ select = { corners = [0, 1] }, motion = { keys = [[1.0, 0, 0, 0], [3.0, 0, 0, 8]], \
           turn = { axis = [0, 0, 2], rate = 0.5, until = 3.141592653589793 } } }",
    );
    let pins = built.pins.view();
    // Corners (-1, 6, 0) and (1, 6, 0) turn about (0, 6, 0).
    let cases = [
        (0.0, [-1.0, 6.0, 0.0], [0.0, -0.5, 0.0]),
        (2.0, [-(1.0_f64.cos()), 6.0 - 1.0_f64.sin(), 4.0], [0.5 * 1.0_f64.sin(), -0.5 * 1.0_f64.cos(), 4.0]),
        (2.0 * std::f64::consts::PI, [0.0, 5.0, 8.0], [0.0; 3]),
    ];
    for (time, position, velocity) in cases {
        let (x, v) = pins.target(0, time, JumpSide::After);
        assert!((x - DVec3::from(position)).length() < 1e-14, "at {time} s: {x}, expected {position:?}");
        assert!((v - DVec3::from(velocity)).length() < 1e-14, "at {time} s: {v} m/s, expected {velocity:?}");
    }
}

#[test]
fn pins_of_later_cloths_name_vertices_of_the_scene() {
    let one = "grid = { size = [1.0, 1.0], cells = [1, 1] }\npin = [{ select = { edge = \"left\" } }]";
    let built = cloth(&format!("{one}\n[[cloth]]\ndensity = 1.0\n{one}"));
    let offset = built.cloths[1].vertices.start;
    let (first, second) = built.pins.vertices.split_at(built.pins.vertices.len() / 2);
    let shifted: BTreeSet<u32> = first.iter().map(|v| v + offset).collect();
    assert_eq!(second.iter().copied().collect::<BTreeSet<_>>(), shifted);
    assert_eq!(built.cloths[1].vertices.end as usize, built.particles.positions.len());
}

/// Velocities are one-sided at a key; there is no jump at keys on a straight line, nor where the velocity
/// changes by less than a quarter.
#[test]
fn velocities_jump_at_keys_that_turn() {
    let built = pinned(
        "{ select = { corners = [0] }, motion = { keys = [[0.0, 0, 0, 0], [0.1, 0.01, 0, 0], [0.3, 0.03, 0, 0], \
           [0.4, 0.042, 0, 0], [0.5, 0.03, 0, 0], [0.6, 0.03, 0, 0]] } }",
    );
    let pins = built.pins.view();
    let speed = |time, side| pins.target(0, time, side).1.x;
    for (time, before, after, jumps) in [
        (0.0, 0.0, 0.1, true),
        (0.05, 0.1, 0.1, false),
        (0.1, 0.1, 0.1, false),
        (0.3, 0.1, 0.12, false),
        (0.4, 0.12, -0.12, true),
        (0.5, -0.12, 0.0, true),
        (0.6, 0.0, 0.0, false),
    ] {
        let speeds = [speed(time, JumpSide::Before), speed(time, JumpSide::After)];
        let off = (speeds[0] - before).abs().max((speeds[1] - after).abs());
        assert!(off < 1e-12, "at {time} s: {speeds:?}, expected {before} and {after}");
        assert_eq!(pins.jump(time), jumps, "at {time} s");
    }
}
