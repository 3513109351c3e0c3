//! A temporary folder to run `muslin` in, the outcome of a command, and readers for its output files.

use std::fs::{self, File};
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

/// A small sheet that hangs from two corners: 27 vertices, 36 triangles, 4 frames of 5 steps.
pub const TINY: &str = r#"name = "tiny"
duration = 0.2
frame_rate = 20
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.3, 0.3], cells = [4, 4] }
position = [0.0, 1.0, 0.0]
density = 0.2

[cloth.stretch]
model = "membrane"
stiffness = 100.0

[cloth.shear]
stiffness = 50.0

[cloth.bend]
model = "hinge"
rigidity = 1e-5

[[cloth.pin]]
select = { corners = [0, 1] }

[integrator]
step = 0.01
"#;

/// A soft, damped sheet: explicit methods may take long steps, and the short ones of a study resolve its fastest mode.
pub const SOFT: &str = r#"name = "soft"
duration = 0.4
frame_rate = 20
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.4, 0.35], cells = [4, 4] }
density = 0.2
stretch = { model = "membrane", stiffness = 5.0, damping = 0.01 }
shear = { stiffness = 2.0 }
bend = { model = "hinge", rigidity = 1e-4 }
pin = [{ select = { corners = [0, 1] } }]

[integrator]
step = 0.005
"#;

/// The same sheet with drag.
pub fn soft_in_air(linear: f64) -> String {
    format!("{SOFT}\n[drag]\nlinear = {linear:?}\n")
}

/// A stiff sheet that swings from two corners.
pub const STIFF: &str = r#"duration = 0.3
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.3, 0.3], cells = [8, 8] }
density = 0.2
stretch = { model = "membrane", stiffness = 2000.0, damping = 0.0005 }
shear = { stiffness = 500.0 }
bend = { model = "hinge", rigidity = 2e-5, damping = 0.001 }
pin = [{ select = { corners = [0, 1] } }]
"#;

/// A command that runs longer counts as hung. The limit is long because machines may be slow and busy.
const PATIENCE: Duration = Duration::from_secs(1800);

/// The exit code and the output of a command.
#[derive(Debug)]
pub struct Outcome {
    /// Exit code; `None` if a signal ended the command.
    pub code: Option<i32>,
    /// The data that it printed.
    pub stdout: String,
    /// The notes and error messages that it printed.
    pub stderr: String,
}

impl Outcome {
    /// The JSON document on stdout; panics if stdout contains anything else.
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error} in {self:?}"))
    }

    /// Returns itself if it ended with this exit code, else panics.
    #[track_caller]
    pub fn expect(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{self:?}");
        self
    }
}

/// A temporary folder that contains `tiny.toml`.
pub struct Place {
    folder: TempDir,
}

impl Place {
    /// Creates the folder and writes [`TINY`] into it.
    pub fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        place.write("tiny.toml", TINY);
        place
    }

    /// The path of a file or folder inside.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file inside.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    /// Reads the bytes of a file inside.
    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The sorted paths of all files under a folder, relative to that folder.
    pub fn files(&self, folder: &str) -> Vec<String> {
        let mut files = Vec::new();
        for entry in fs::read_dir(self.path(folder)).unwrap() {
            let entry = entry.unwrap();
            let name = entry.file_name().into_string().unwrap();
            if entry.file_type().unwrap().is_dir() {
                let inner = self.files(&format!("{folder}/{name}"));
                files.extend(inner.iter().map(|file| format!("{name}/{file}")));
            } else {
                files.push(name);
            }
        }
        files.sort();
        files
    }

    /// Asserts that two folders contain the same files with the same bytes, except for `summary.json`, which
    /// contains times.
    #[track_caller]
    pub fn same_files(&self, one: &str, other: &str) {
        self.same_files_but(one, other, &["summary.json"]);
    }

    /// Asserts that two folders contain the same files, with the same bytes except for those with these names.
    #[track_caller]
    pub fn same_files_but(&self, one: &str, other: &str, names: &[&str]) {
        let files = self.files(one);
        assert_eq!(files, self.files(other));
        for file in files.iter().filter(|file| !names.contains(&file.as_str())) {
            let [a, b] = [one, other].map(|folder| self.read(&format!("{folder}/{file}")));
            assert!(a == b, "{file} differs: {} and {} bytes", a.len(), b.len());
        }
    }

    /// The `muslin` command with these space-separated arguments and this folder as its working directory.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_muslin"));
        command.args(words.split(' ').filter(|word| !word.is_empty())).current_dir(self.folder.path());
        command.env("RUST_BACKTRACE", "0").env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE").stdin(Stdio::null());
        command
    }

    /// Runs `muslin` with these arguments to its end; a command that hangs fails the test.
    #[track_caller]
    pub fn muslin(&self, words: &str) -> Outcome {
        self.finish(self.command(words))
    }

    /// Runs a prepared command to its end, like [`muslin`](Self::muslin); a panic message fails the test.
    #[track_caller]
    pub fn finish(&self, mut command: Command) -> Outcome {
        let [stdout, stderr] = [tempfile::NamedTempFile::new().unwrap(), tempfile::NamedTempFile::new().unwrap()];
        let to = |file: &tempfile::NamedTempFile| File::create(file.path()).unwrap();
        let mut child = command.stdout(to(&stdout)).stderr(to(&stderr)).spawn().unwrap();
        let status = wait(&mut child, &command);
        let text = |file: &tempfile::NamedTempFile| String::from_utf8(fs::read(file.path()).unwrap()).unwrap();
        let outcome = Outcome { code: status.code(), stdout: text(&stdout), stderr: text(&stderr) };
        assert!(!outcome.stderr.contains("panicked"), "{command:?}: {}", outcome.stderr);
        outcome
    }

    /// Runs a scene into `out` without a preview, expects success and returns the summary.
    #[track_caller]
    pub fn run(&self, words: &str) -> Value {
        self.muslin(&format!("run --out out --preview none --json {words}")).expect(0).json()
    }

    /// Asserts that `muslin run` refuses these arguments: exit code 2, a message with these parts, no files written.
    #[track_caller]
    pub fn refuses(&self, words: &str, parts: &[&str]) {
        let before = self.files(".");
        let outcome = self.muslin(&format!("run --out out --json {words}")).expect(2);
        assert_eq!(outcome.stdout, "");
        for part in parts {
            assert!(outcome.stderr.contains(part), "{words}: {part:?} is not in {}", outcome.stderr);
        }
        assert_eq!(self.files("."), before, "{words} has written");
        assert!(!self.path("out").exists(), "{words} has made its folder");
    }
}

/// The attributes and elements of an SVG picture as the HTML page of its study embeds them: the study's name prefixes
/// every id.
pub fn in_page(svg: &str, study: &str) -> String {
    let after_tag_name = svg.trim().strip_prefix("<svg ").expect("a picture");
    after_tag_name.replace(" id=\"", &format!(" id=\"{study}-")).replace("url(#", &format!("url(#{study}-"))
}

/// The code blocks of a manual in a language.
pub fn blocks<'a>(manual: &'a str, language: &str) -> Vec<&'a str> {
    let blocks = manual.split("```").skip(1).step_by(2);
    blocks.filter_map(|block| block.strip_prefix(language)?.strip_prefix('\n')).collect()
}

/// Waits for a process to end; kills it and panics if it hangs.
pub fn wait(child: &mut Child, what: &Command) -> ExitStatus {
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if started.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("hangs: {what:?}");
        }
        sleep(Duration::from_millis(2));
    }
}

/// Waits until a condition is true; panics if it takes too long.
#[track_caller]
pub fn wait_until(mut is_so: impl FnMut() -> bool, what: &str) {
    let started = Instant::now();
    while !is_so() {
        assert!(started.elapsed() < PATIENCE, "{what}: that does not come");
        sleep(Duration::from_millis(1));
    }
}

/// The contents of a point cache (PC2 file).
pub struct PointCache {
    /// Number of points per frame.
    pub points: usize,
    /// Number of the first frame.
    pub start: f32,
    /// Positions, frame after frame.
    pub frames: Vec<Vec<[f32; 3]>>,
}

impl PointCache {
    /// Parses a whole file; panics if its header and its length disagree.
    pub fn parse(bytes: &[u8]) -> Self {
        let word = |at: usize| bytes[at..at + 4].try_into().unwrap();
        assert_eq!(&bytes[..12], b"POINTCACHE2\0");
        assert_eq!((i32::from_le_bytes(word(12)), f32::from_le_bytes(word(24))), (1, 1.0));
        let (points, samples) = (i32::from_le_bytes(word(16)) as usize, i32::from_le_bytes(word(28)) as usize);
        assert_eq!(bytes.len(), 32 + samples * points * 12);
        let scalars: Vec<f32> = bytes[32..].chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
        let frames = scalars.chunks(3 * points).map(|frame| frame.as_chunks::<3>().0.to_vec()).collect();
        Self { points, start: f32::from_le_bytes(word(20)), frames }
    }
}

/// Vertices, rounded to single precision, and faces (counted from 1) of an OBJ file as `muslin` writes it.
pub fn obj(bytes: &[u8]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    fn three<T: std::str::FromStr<Err: std::fmt::Debug>>(line: &str) -> [T; 3] {
        let words: Vec<T> = line.split(' ').skip(1).map(|word| word.parse().unwrap()).collect();
        words.try_into().unwrap_or_else(|_| panic!("not three numbers: {line}"))
    }
    let text = str::from_utf8(bytes).unwrap();
    let of = |letter: &str| text.lines().filter(move |line| line.starts_with(letter)).collect::<Vec<_>>();
    let vertices = of("v ").into_iter().map(|line| three::<f64>(line).map(|x| x as f32));
    (vertices.collect(), of("f ").into_iter().map(three).collect())
}
