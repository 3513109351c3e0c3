//! Invalid arguments on the command line: exit code 2, a message, no files written.

use crate::kit::Place;

#[test]
fn flags() {
    let place = Place::new();
    place.refuses("tiny.toml --bogus", &["--bogus"]);
    place.refuses("tiny.toml --threads 0", &["--threads", "'0'", "from 1 to"]);
    place.refuses("tiny.toml --threads -1", &["--threads", "'-1'"]);
    place.refuses("tiny.toml --threads 1000000", &["--threads", "1024"]);
    place.refuses("tiny.toml --threads x", &["--threads", "'x'"]);
    place.refuses("tiny.toml --checkpoint 0", &["--checkpoint", "'0'"]);
    place.refuses("tiny.toml --precision f16", &["--precision", "f32, f64"]);
    place.refuses("tiny.toml --export obj,stl", &["--export", "'stl'", "usda"]);
    place.refuses("tiny.toml --preview jpg", &["--preview", "gif, png, none"]);
    place.refuses("tiny.toml other.toml", &["other.toml"]);
    place.refuses("", &["SCENE"]);
    place.muslin("rnu tiny.toml").expect(2);
}

#[test]
fn durations() {
    let place = Place::new();
    for duration in ["-1", "nan", "inf", "x", "1s"] {
        place.refuses(&format!("tiny.toml --duration {duration}"), &["--duration", duration, "seconds"]);
    }
}

#[test]
fn scenes_that_are_not_there() {
    let place = Place::new();
    place.refuses("flg", &["there is no file flg", "did you mean the built-in scene flag"]);
    place.refuses("hangin", &["built-in scene hanging"]);
    place.refuses("none.toml", &["none.toml", "built-in scenes are ball, cantilever, curtain, flag"]);
    place.refuses(".", &["cannot read ."]);
    place.write("binary.toml", [0xff; 100]);
    place.refuses("binary.toml", &["cannot read binary.toml", "UTF-8"]);
}

#[test]
fn overrides() {
    let place = Place::new();
    let refuses = |set: &str, parts: &[&str]| {
        let name = format!("--set {set}: ");
        place.refuses(&format!("tiny.toml --set {set}"), &[&[name.as_str()], parts].concat());
    };
    for set in ["step", "=3", "a..b=3", ".=1", "integrator.=1"] {
        refuses(set, &["KEY=VALUE"]);
    }
    refuses("cloth.densty=3", &["unknown field `densty`", "did you mean `density`?"]);
    refuses("integrator.metod=rk4", &["`metod`", "did you mean `method`?"]);
    refuses("integrator.method=rk5", &["`rk5`", "did you mean `rk4`?"]);
    refuses("durtion=3", &["did you mean `duration`?"]);
    refuses("gravity=3", &["expected [x, y, z], or { keys = [[time, x, y, z], ..] }"]);
    refuses("gravity={key=[[0,0,0,0]]}", &["unknown field `key`", "did you mean `keys`?"]);
    refuses("gravity={keys=[[0,0,0]]}", &["array of length 4"]);
    refuses("cloth.stretch={modl=\"spring\"}", &["unknown field `modl`", "did you mean `model`?"]);
    refuses("gravity=[0,0]", &["array of length 3"]);
    refuses("duration=\"x\"", &["expected a number"]);
    refuses("integrator=3", &["expected a section"]);
    refuses("integrator.step.x=3", &["x is inside a value that is not a section"]);
    refuses("cloth.1.density=3", &["there is no index 1", "from 0 to 0"]);
    refuses("cloth.grid.cells=[-1,4]", &["`-1`"]);
    refuses("contact.thicknes=0.01", &["`thicknes`", "did you mean `thickness`?"]);
    refuses("contact.friction=0.3", &["missing field `thickness`"]);
    // Of several overrides, the message names the one that is wrong.
    for (set, hint) in [
        ("density=0.3", "there is no key density; did you mean cloth.density or cloth.mass.density?"),
        ("stretch.stiffness=3", "did you mean cloth.stretch.stiffness?"),
        ("cloth.rigidity=1e-5", "did you mean cloth.bend.rigidity?"),
        ("thickness=0.01", "did you mean contact.thickness?"),
        // Keys of sections that are not in the scene, nor in a built-in one.
        ("step=0.001", "did you mean integrator.step?"),
        ("share=\"area\"", "did you mean cloth.load.share or cloth.mass.share?"),
        ("spin.rate=1", "did you mean cloth.spin.rate?"),
        ("wind.velocity=[1,0,0]", "did you mean drag.wind.velocity?"),
        ("cloth.keys=[[0,0,0,0]]", "did you mean gravity.keys or cloth.pin.motion.keys or cloth.load.force.keys or"),
    ] {
        place.refuses(&format!("tiny.toml --set {set}"), &[&format!("--set {set}: "), hint]);
    }
    place.refuses("tiny.toml --set integrator.step=0.02 --set nme=x --set duration=1", &["--set nme=x: ", "`name`"]);
}

#[test]
fn overrides_in_a_list_that_the_scene_lacks() {
    let place = Place::new();
    for (set, hint) in [
        (
            "collider.radius=0.1",
            "the scene has no collider; a new one needs all its keys: collider=[{ radius = 0.1, .. }]",
        ),
        ("collider.0.motion.turn.rate=3", "the scene has no collider; a new one needs all its keys"),
        (
            "cloth.0.load.share=area",
            "a cloth of the scene has no load; a new one needs all its keys: cloth.load=[{ share",
        ),
    ] {
        place.refuses(&format!("tiny.toml --set {set}"), &[&format!("--set {set}: "), hint]);
    }
}

#[test]
fn overrides_with_values_out_of_bounds() {
    let place = Place::new();
    let refuses = |set: &str, parts: &[&str]| {
        place.refuses(&format!("tiny.toml --set {set}"), &[&["tiny.toml: "], parts].concat());
    };
    refuses("cloth.density=-1", &["cloth.density = -1: must be greater than zero"]);
    refuses("integrator.step=0", &["integrator.step = 0: must be greater than zero"]);
    refuses("integrator.step=-0.1", &["integrator.step = -0.1"]);
    refuses("integrator.newton=0", &["integrator.newton"]);
    refuses("frame_rate=0", &["frame_rate = 0"]);
    refuses("contact.thickness=0", &["contact.thickness = 0: must be greater than zero"]);
    refuses("duration=-1", &["duration = -1: must not be negative"]);
}
