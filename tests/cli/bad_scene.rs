//! Scene files that cannot be run: exit code 2, a message with the location and the error, no files written.

use crate::kit::{Place, TINY};

/// Asserts that the tiny scene is refused after `old` in it is replaced by `new`.
#[track_caller]
fn refuses(old: &str, new: &str, parts: &[&str]) {
    assert!(TINY.contains(old), "{old} is not in the scene");
    let place = Place::new();
    place.write("bad.toml", TINY.replace(old, new));
    place.refuses("bad.toml", &[&["bad.toml: "], parts].concat());
}

const GRID: &str = "grid = { size = [0.3, 0.3], cells = [4, 4] }";
const PIN: &str = "corners = [0, 1]";

#[test]
fn keys_that_are_not_known() {
    refuses("density =", "densty =", &["line 9, column 1", "`densty`", "did you mean `density`?"]);
    refuses("[cloth.shear]", "[cloth.sher]", &["line 15, column 8", "`sher`", "did you mean `shear`?"]);
    refuses("corners", "cornrs", &["line 23, column 12", "did you mean `corners`?"]);
    refuses("step = 0.01", "stp = 0.01", &["line 26, column 1", "did you mean `step`?"]);
    refuses("\"membrane\"", "\"membran\"", &["line 12, column 9", "did you mean `membrane`?"]);
    refuses("step = 0.01", "method = \"runge-kutta\"", &["`runge-kutta`", "`rk4`", "line 26"]);
}

#[test]
fn values_of_the_wrong_kind() {
    refuses("density = 0.2", "density = \"x\"", &["line 9, column 11", "expected a number"]);
    refuses("density = 0.2", "density = [1]", &["line 9, column 11"]);
    refuses("gravity = [0.0, -9.81, 0.0]", "gravity = -9.81", &["line 4, column 11"]);
    refuses("duration = 0.2\n", "", &["missing field `duration`"]);
    refuses("density = 0.2\n", "", &["missing field `density`", "line 6"]);
    refuses("duration = 0.2", "duration 0.2", &["line 2", "expected `=`"]);
    refuses("cells = [4, 4]", "cells = [4, -4]", &["line 7", "`-4`"]);
    refuses("cells = [4, 4]", "cells = [4, 99999999999]", &["line 7"]);
}

#[test]
fn numbers_that_are_none() {
    for bad in ["nan", "inf", "-inf", "-nan"] {
        let number = |key: &str, value: &str| refuses(&format!("{key} = {value}"), &format!("{key} = {bad}"), &[key]);
        number("duration", "0.2");
        number("frame_rate", "20");
        number("density", "0.2");
        number("step", "0.01");
        number("rigidity", "1e-5");
        refuses("-9.81", bad, &["gravity"]);
        refuses("[0.3, 0.3]", &format!("[0.3, {bad}]"), &["size"]);
        refuses("[0.0, 1.0, 0.0]", &format!("[0.0, {bad}, 0.0]"), &["position"]);
        refuses("stiffness = 100.0", &format!("stiffness = {bad}"), &["cloth.stretch.stiffness"]);
        refuses("stiffness = 50.0", &format!("stiffness = {bad}"), &["cloth.shear.stiffness"]);
    }
}

#[test]
fn numbers_of_the_wrong_sign() {
    for bad in ["0.0", "-0.5"] {
        refuses("density = 0.2", &format!("density = {bad}"), &["cloth.density", "greater than zero"]);
        refuses("step = 0.01", &format!("step = {bad}"), &["integrator.step", "greater than zero"]);
        refuses("frame_rate = 20", &format!("frame_rate = {bad}"), &["frame_rate", "greater than zero"]);
        refuses("[0.3, 0.3]", &format!("[0.3, {bad}]"), &["grid.size", "greater than zero"]);
    }
    refuses("[4, 4]", "[4, 0]", &["grid.cells: must be at least 1"]);
}

#[test]
fn more_than_can_be_run() {
    refuses(
        "[4, 4]",
        "[4000000000, 4000000000]",
        &["the scene would have 16000000010000000001 vertices", "at most 2^28"],
    );
    refuses("[4, 4]", "[4294967295, 1]", &["vertices", "at most 2^28"]);
    let generator = |new: &str| refuses(GRID, new, &["vertices", "at most 2^28"]);
    generator("tube = { radius = 0.2, height = 0.6, cells = [4000000000, 4000000000] }");
    generator("disc = { radius = 0.5, rings = 4000000000 }");
    generator("disc = { radius = 0.5, hole = 0.4999999999, rings = 1 }");
    refuses("duration = 0.2", "duration = 1e300", &["duration = 1e300", "too many frames"]);
    refuses("duration = 0.2", "duration = 1e10", &["too many frames"]);
    refuses("frame_rate = 20", "frame_rate = 1e-300", &["frame_rate = 1e-300", "too many steps"]);
    refuses("frame_rate = 20", "frame_rate = 1e300", &["frame_rate = 1e300", "too many frames"]);
    refuses("step = 0.01", "step = 1e-300", &["integrator.step = 1e-300", "longer step"]);
    refuses("step = 0.01", "step = 5e-324", &["too many steps"]);
    refuses("[0.0, 1.0, 0.0]", "[1e30, 0.0, 0.0]", &["too far away", "nearer to the origin"]);
    refuses("[0.0, 1.0, 0.0]", "[1e300, 0.0, 0.0]", &["cloth.position", "finite"]);
}

/// The values of a text take far more memory than the text, so its length has a limit.
#[test]
fn a_text_longer_than_a_scene_can_be() {
    let place = Place::new();
    place.write("long.toml", TINY.replace(PIN, &format!("vertices = [{}1]", "0,".repeat(600_000))));
    place.refuses("long.toml", &["cannot read long.toml", "larger than 1 MiB"]);
    let refused = place.muslin("sweep long.toml").expect(2);
    assert!(refused.stderr.contains("larger than 1 MiB"), "{}", refused.stderr);
    #[cfg(unix)]
    place.refuses("/dev/zero", &["cannot read /dev/zero", "larger than 1 MiB"]);
}

#[test]
fn sections_that_do_not_fit() {
    refuses(GRID, "", &["cloth 0", "exactly one of grid, tube, disc or mesh"]);
    refuses(GRID, &format!("{GRID}\ndisc = {{ radius = 0.5, rings = 4 }}"), &["exactly one of"]);
    refuses("rigidity = 1e-5", "stiffness = 1e-5", &["cloth.bend.rigidity is needed"]);
    refuses("model = \"membrane\"", "model = \"spring\"", &["cloth.shear has no meaning"]);
}

#[test]
fn contact_and_colliders() {
    let sections = |text: &str, parts: &[&str]| refuses("[integrator]", &format!("{text}\n[integrator]"), parts);
    sections("[contact]\n", &["missing field `thickness`"]);
    sections("[contact]\nthickness = .002\n", &["line", "invalid mantissa", "digits on both sides of the point"]);
    sections("[contact]\nthickness = 2.\n", &["line", "digits on both sides of the point"]);
    sections("[contact]\nthickness = 0.002\nfrction = 0.3\n", &["`frction`", "did you mean `friction`?"]);
    sections("[[collider]]\nshape = \"plane\"\n", &["[[collider]] but no [contact]", "thickness"]);
    let collider = |keys: &str, parts: &[&str]| {
        sections(&format!("[contact]\nthickness = 0.002\n[[collider]]\n{keys}\n"), parts);
    };
    collider("shape = \"ball\"", &["`ball`", "`sphere`"]);
    collider("shape = \"sphere\"\nradius = 1", &["collider 0: center is needed with shape = \"sphere\""]);
    collider("shape = \"plane\"\nradius = 1", &["collider 0: radius has no meaning with shape = \"plane\""]);
    collider("shape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0", &["collider.radius = 0: must be greater"]);
    collider("shape = \"mesh\"\nfile = \"none.obj\"", &["cannot read none.obj"]);
    let sphere = "shape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.1\nmotion = ";
    collider(&format!("{sphere}{{ turn = {{ axs = [0, 1, 0], rate = 1 }} }}"), &["`axs`", "did you mean `axis`?"]);
    collider(&format!("{sphere}3"), &["the name of a point cache, or { keys"]);
}

#[test]
fn pins() {
    refuses(PIN, "box = [[9, 9, 9], [10, 10, 10]]", &["pin 0: selects no vertex; the cloth lies between [-0.15, "]);
    refuses(PIN, "corners = []", &["cloth 0, pin 0: selects no vertex"]);
    refuses(PIN, "corners = [4]", &["cloth 0, pin 0", "4"]);
    refuses(PIN, "vertices = [3, 27]", &["cloth 0, pin 0", "27"]);
    refuses(PIN, "corners = [0], edge = \"left\"", &["exactly one of corners"]);
    refuses(PIN, "border = false", &["border = false selects nothing; write border = true, or another selection"]);
    refuses(&format!("{{ {PIN} }}"), "{}", &["exactly one of corners"]);
    refuses(&format!("{{ {PIN} }}"), &format!("{{ {PIN} }}\naxes = \"w\""), &["axes must be a combination"]);
}

#[test]
fn files_without_a_scene() {
    let place = Place::new();
    for text in ["", "# nothing\n", "name = \"a\"\n", "name = \"a\"\nduration = 1\n", "[[cloth]]\n", "}{"] {
        place.write("empty.toml", text);
        place.refuses("empty.toml", &["empty.toml: "]);
    }
    place.write("empty.toml", "name = \"a\"\nduration = 1\ncloth = []\n");
    place.refuses("empty.toml", &["no [[cloth]]"]);
}
