//! Runs shortened versions of the commands in the manuals: each must end with an expected exit code.

use crate::kit::{Outcome, Place, blocks};

const README: &str = include_str!("../../README.md");
const RUNNING: &str = include_str!("../../host-cli/manual/running.md");
const DETECT: &str = include_str!("../../host-cli/manual/detect.md");
const STUDIES: &str = include_str!("../../host-cli/manual/studies.md");
const SWEEP: &str = include_str!("../../host-cli/manual/sweep.md");
const VALIDATE: &str = include_str!("../../host-cli/manual/validate.md");
const COST: &str = include_str!("../../host-cli/manual/cost.md");

/// Commands that take minutes and have no option that shortens them. They are skipped.
const LONG: [&str; 4] = ["bench", "bench crumpled", "validate", "validate --only \"Gamma 10\""];

/// Two frames of a mesh of two triangles: file name and position of the vertex that moves through the first.
const FRAMES: [(&str, &str); 2] = [("frame1.ply", "0 0 1"), ("frame2.ply", "0 0 -1")];

/// The arguments of every `muslin` command of a manual, without comments. Commands with shell variables are left out.
fn commands(manual: &str) -> Vec<&str> {
    let lines = blocks(manual, "sh").into_iter().flat_map(str::lines);
    let commands = lines.filter_map(|line| line.split(" #").next()?.trim().strip_prefix("muslin "));
    commands.filter(|command| !command.contains('$')).collect()
}

/// Adds an option that the command does not have yet.
fn with(command: &mut String, option: &str) {
    let name = option.split(' ').next().unwrap_or_default();
    if !command.contains(name) {
        *command += &format!(" {option}");
    }
}

/// The command with a short duration or a small budget.
fn shortened(command: &str) -> String {
    let mut short = command.to_owned();
    match command.split(' ').next() {
        // This duration is long enough for a checkpoint after 100 steps.
        Some("run") if command.contains("curtain") => with(&mut short, "--duration 1.8"),
        Some("run") => with(&mut short, "--duration 0.05"),
        Some("needs" | "choose" | "chart" | "stability") => {
            let budget = short.find("--budget ").map(|at| at + "--budget ".len());
            if let Some(at) = budget {
                let end = short[at..].find(' ').map_or(short.len(), |length| at + length);
                short.replace_range(at..end, "5");
            }
            with(&mut short, "--budget 5");
        }
        _ => {}
    }
    short
}

/// Runs a `muslin` command by the shell in the given folder, with `muslin` on the path.
fn shell(place: &Place, command: &str) -> Outcome {
    let mut shell = std::process::Command::new("sh");
    let folder = std::path::Path::new(env!("CARGO_BIN_EXE_muslin")).parent().unwrap();
    let path = format!("{}:{}", folder.display(), std::env::var("PATH").unwrap_or_default());
    shell.args(["-c", &format!("muslin {command}")]).current_dir(place.path("")).env("PATH", path);
    place.finish(shell)
}

#[test]
#[ignore = "slow"]
fn every_command_of_the_manuals_runs() {
    let mut ran = 0;
    for manual in [README, RUNNING, DETECT, STUDIES, SWEEP, VALIDATE, COST] {
        let place = Place::new();
        shell(&place, "run tiny.toml --out mesh --export obj --preview none --quiet").expect(0);
        let mesh = place.files("mesh").into_iter().find(|file| file.ends_with(".obj")).unwrap();
        place.write("dress.obj", place.read(&format!("mesh/{mesh}")));
        for (name, top) in FRAMES {
            let header = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
                          element face 2\nproperty list uchar int vertex_indices\nend_header\n";
            let corners = format!("-1 -1 0\n1 -1 0\n0 1 0\n{top}\n1 0 2\n0 1 2\n3 0 1 2\n3 3 4 5\n");
            place.write(name, header.to_owned() + &corners);
        }
        shell(&place, "scenes swing > my.toml").expect(0);
        place.write("my-sweep.toml", blocks(SWEEP, "toml")[0]);
        for command in commands(manual).into_iter().filter(|command| !LONG.contains(command)) {
            let outcome = shell(&place, &shortened(command));
            let allowed: &[i32] = match command.split(' ').next() {
                // A budget of five seconds may be too small for a result.
                Some("needs" | "choose" | "chart" | "stability") => &[0, 3],
                _ if command.contains("--backend gpu") => &[0, 4],
                _ => &[0],
            };
            assert!(outcome.code.is_some_and(|code| allowed.contains(&code)), "muslin {command}: {outcome:?}");
            ran += 1;
        }
    }
    assert!(ran > 25, "{ran} commands: the blocks are no longer found");
}
