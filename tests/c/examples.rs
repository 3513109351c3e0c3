//! The header is current, and the C and C++ examples compile, link and run, by hand, by pkg-config and by CMake.
//!
//! Run: `cargo test -p muslin-c --test c_examples`. `MUSLIN_BLESS=1` writes the header anew.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use muslin_core::cooked::{Room, cook};
use muslin_core::scene::SceneDesc;
use muslin_core::simulation::Simulation;

fn own() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

#[test]
fn the_header_is_current() {
    let config = cbindgen::Config::from_file(own().join("cbindgen.toml")).expect("the settings are valid");
    let bindings = cbindgen::Builder::new();
    let files = ["handle", "live", "read", "snapshot", "status", "step"];
    let bindings = files.iter().fold(bindings, |all, file| all.with_src(own().join(format!("src/{file}.rs"))));
    let mut written = Vec::new();
    bindings.with_config(config).generate().expect("the sources are valid").write(&mut written);
    let written = String::from_utf8(written).expect("it is text").replace("# Safety", "Requires:");
    let file = own().join("include/muslin.h");
    if env::var_os("MUSLIN_BLESS").is_some() {
        fs::write(&file, &written).expect("the header can be written");
    }
    let kept = fs::read_to_string(&file).unwrap_or_default();
    assert!(
        kept == written,
        "include/muslin.h is old; MUSLIN_BLESS=1 cargo test -p muslin-c --test c_examples writes it"
    );
}

/// Runs a command and returns its output.
fn run(command: &mut Command) -> String {
    let done = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let told = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(done.status.success(), "{command:?}\n{told}{}", String::from_utf8_lossy(&done.stderr));
    told
}

/// A folder with the cooked scene and the installed library.
fn place(name: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&place).expect("it can be made");
    let text = fs::read_to_string(own().join("examples/drape.toml")).expect("it is there");
    let desc: SceneDesc = toml::from_str(&text).expect("it is valid");
    let simulation = Simulation::new(&desc, &[]).expect("it builds");
    let room = Room { pairs: 20_000, contacts: 2_000, hands: 1, impulses: true, ..Room::default() };
    fs::write(place.join("drape.bin"), cook(&simulation, room)).expect("it can be written");
    place
}

/// The flags by which pkg-config links.
fn flags(place: &Path, kind: &[&str]) -> Vec<String> {
    let mut ask = Command::new("pkg-config");
    ask.env("PKG_CONFIG_PATH", place.join("lib/pkgconfig")).args(kind).arg("muslin");
    run(&mut ask).split_whitespace().map(str::to_owned).collect()
}

#[test]
fn the_examples_compile_and_run() {
    let place = place("installed");
    run(Command::new("sh").arg(own().join("install.sh")).arg(&place).env("CARGO_TARGET_DIR", place.join("target")));
    fs::write(place.join("empty.cpp"), "#include <muslin.h>\nint main() {}\n").expect("it can be written");
    compile(&place, "c++", "-std=c++17", &place.join("empty.cpp"));
    let sources = [("cc", "-std=c11", "drape.c"), ("c++", "-std=c++17", "drape.cpp")];
    let told = sources.map(|(compiler, standard, source)| {
        let program = compile(&place, compiler, standard, &own().join("examples").join(source));
        let mut program = Command::new(program);
        let said = run(program.arg("drape.bin").current_dir(&place).env("LD_LIBRARY_PATH", place.join("lib")));
        println!("{said}");
        said
    });
    let (vertices, hash) = expected();
    assert!(told[0].contains(&format!("hash {hash:016x}")), "{}", told[0]);
    assert!(told[1].starts_with(&format!("{vertices} vertices, hash ")), "{}", told[1]);
    let picture = fs::read_to_string(place.join("drape.obj")).expect("it is written");
    assert_eq!(picture.lines().filter(|line| line.starts_with("v ")).count(), vertices);
}

/// Compiles a program with all warnings, and links it as pkg-config says.
fn compile(place: &Path, compiler: &str, standard: &str, source: &Path) -> PathBuf {
    let program = place.join(source.file_name().expect("it is a file")).with_extension(format!("{compiler}.out"));
    let words = [standard, "-pedantic", "-O1", "-Wall", "-Wextra", "-Werror", "-o"];
    let mut command = Command::new(compiler);
    run(command.args(words).arg(&program).arg(source).args(flags(place, &["--cflags", "--libs"])));
    program
}

/// Number of vertices, and the hash that the steps of the C example give in Rust.
fn expected() -> (usize, u64) {
    use muslin_core::diagnostics::StateHash;
    use muslin_core::dispatch::Serial;
    use muslin_core::kinematic::Pose;
    use muslin_core::live::Live as _;
    let text = fs::read_to_string(own().join("examples/drape.toml")).expect("it is there");
    let mut sim = Simulation::new(&toml::from_str(&text).expect("it is valid"), &[]).expect("it builds");
    let step = f64::from(sim.step_length());
    for n in 1..=120 {
        sim.move_collider(0, Pose::at([0.0, 0.1 * f64::from(n) * step, 0.0]), step).expect("it moves");
        sim.step(&Serial).expect("it steps");
    }
    let mut hash = StateHash::default();
    hash.add(sim.positions(), sim.velocities());
    (sim.positions().len(), hash.0)
}

#[test]
fn a_program_finds_the_library_by_cmake() {
    if Command::new("cmake").arg("--version").output().is_err() {
        assert!(env::var_os("MUSLIN_REQUIRE_CMAKE").is_none(), "cmake is needed");
        println!("skipped: there is no cmake");
        return;
    }
    let place = place("cmake");
    let text = format!(
        "cmake_minimum_required(VERSION 3.16)\nproject(game C)\nadd_subdirectory({} muslin)\n\
         add_executable(game {})\ntarget_link_libraries(game PRIVATE muslin::muslin)\n",
        own().display(),
        own().join("examples/drape.c").display()
    );
    fs::write(place.join("CMakeLists.txt"), text).expect("it can be written");
    run(Command::new("cmake").args(["-S", ".", "-B", "build"]).current_dir(&place));
    run(Command::new("cmake").args(["--build", "build"]).current_dir(&place));
    let said = run(Command::new(place.join("build/game")).arg("drape.bin").current_dir(&place));
    assert!(said.contains("hash "), "{said}");
}
