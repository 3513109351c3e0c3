//! The results of a sweep: a file to which one complete JSON line is appended for each run.
//!
//! Each line is a single write while the file is locked, so that several processes may share the file. A killed
//! process or a full disk leaves at most one incomplete line at the end; the next process removes it.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::export::whole::WriteError;
use crate::failure::Failure;

/// The beginning of each line.
const OPENING: &[u8] = b"{\"key\":";

/// The fields of an existing line that reports show again.
#[derive(Clone, Debug, Deserialize)]
pub struct RunLine {
    /// Verdict as in a summary.
    pub verdict: String,
    /// Steps taken.
    pub steps: u64,
    /// Computing time, s.
    pub wall_s: f64,
    /// Ratio of length to rest length of edges.
    pub stretch: Stretch,
}

/// Stretch of the edges over all frames.
#[derive(Clone, Debug, Deserialize)]
pub struct Stretch {
    /// The largest ratio; `None` if it is not finite.
    pub max_of_all_frames: Option<f64>,
}

#[derive(Deserialize)]
struct Line {
    key: String,
    #[serde(flatten)]
    run: RunLine,
}

/// The runs that have lines, by their keys.
pub type Runs = HashMap<String, RunLine>;

/// An open results file.
pub struct Ledger {
    path: PathBuf,
    file: File,
    /// Number of bytes that have been read.
    read: u64,
    /// All runs that have been read.
    pub runs: Runs,
}

/// The runs in a file, if it exists; the file is not changed.
pub fn peek(path: &Path) -> Result<Runs, Failure> {
    let mut runs = Runs::new();
    match fs::metadata(path) {
        Ok(found) if !found.is_file() => return Err(Failure::Usage(format!("{} is no file", path.display()))),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(runs),
        _ => {}
    }
    let bytes = fs::read(path).map_err(|error| Failure::Tool(format!("cannot read {}: {error}", path.display())))?;
    take_lines(&bytes, &mut runs).map_err(|what| foreign(path, &what))?;
    Ok(runs)
}

impl Ledger {
    /// Opens a file for appending. The file and its folder are created if necessary.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let open = || {
            path.parent().map_or(Ok(()), fs::create_dir_all)?;
            OpenOptions::new().read(true).append(true).create(true).open(path)
        };
        let file = open().map_err(|error| cannot_write(path, error))?;
        let mut ledger = Self { path: path.into(), file, read: 0, runs: Runs::new() };
        ledger.locked(Self::catch_up)?;
        Ok(ledger)
    }

    /// Whether a run has a line, from this process or another.
    pub fn has(&mut self, key: &str) -> Result<bool, Failure> {
        self.locked(Self::catch_up)?;
        Ok(self.runs.contains_key(key))
    }

    /// Appends the line of a run, unless another process has already done so.
    pub fn append(&mut self, key: &str, line: &str) -> Result<(), Failure> {
        self.locked(|ledger| {
            ledger.catch_up()?;
            if !ledger.runs.contains_key(key) {
                ledger.write(line).map_err(|error| cannot_write(&ledger.path, error))?;
            }
            ledger.catch_up()
        })
    }

    fn write(&mut self, line: &str) -> io::Result<()> {
        let written = self.file.write_all(format!("{line}\n").as_bytes()).and_then(|()| self.file.sync_data());
        if written.is_err() {
            // This removes an incomplete line. Its result is ignored, because the failed write is the error to
            // report.
            let _ = self.file.set_len(self.read);
        }
        written
    }

    /// Runs `act` while the file is locked. Where locks are not supported, as on some network file systems, no
    /// other process may use the file.
    fn locked<T>(&mut self, act: impl FnOnce(&mut Self) -> Result<T, Failure>) -> Result<T, Failure> {
        match self.file.lock() {
            Err(error) if error.kind() == ErrorKind::Unsupported => return act(self),
            locked => locked.map_err(|error| cannot_write(&self.path, error))?,
        }
        let acted = act(self);
        let unlocked = self.file.unlock().map_err(|error| cannot_write(&self.path, error));
        acted.and_then(|value| unlocked.map(|()| value))
    }

    /// Reads the lines that were appended since the last call, and removes an incomplete line.
    fn catch_up(&mut self) -> Result<(), Failure> {
        let mut bytes = Vec::new();
        let read = self.file.seek(SeekFrom::Start(self.read)).and_then(|_| self.file.read_to_end(&mut bytes));
        read.map_err(|error| Failure::Tool(format!("cannot read {}: {error}", self.path.display())))?;
        let whole = take_lines(&bytes, &mut self.runs).map_err(|what| foreign(&self.path, &what))?;
        self.read += whole as u64;
        if whole < bytes.len() {
            self.file.set_len(self.read).map_err(|error| cannot_write(&self.path, error))?;
        }
        Ok(())
    }
}

/// Adds the runs of the complete lines and returns the number of bytes of these lines; the rest is the beginning of
/// a line. An error contains a line that no sweep has written.
fn take_lines(bytes: &[u8], runs: &mut Runs) -> Result<usize, String> {
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    let shown = |line: &[u8]| String::from_utf8_lossy(line).chars().take(40).collect::<String>();
    for line in bytes[..whole].split_inclusive(|&byte| byte == b'\n') {
        let Line { key, run } = serde_json::from_slice(line).map_err(|_| shown(line.trim_ascii_end()))?;
        runs.insert(key, run);
    }
    let torn = &bytes[whole..];
    match torn.starts_with(OPENING) || OPENING.starts_with(torn) {
        true => Ok(whole),
        false => Err(shown(torn)),
    }
}

fn foreign(path: &Path, line: &str) -> Failure {
    Failure::Usage(format!(
        "{} has a line that no sweep has written: {line:?}; name another file by --out, or take that line out",
        path.display()
    ))
}

fn cannot_write(path: &Path, cause: io::Error) -> Failure {
    WriteError { path: path.into(), cause }.into()
}
