//! The lines of a sweep: a file that is only appended to, one whole JSON line for each run.
//!
//! A line is written by a single write while the file is locked, so that several processes may share
//! it. A process that is killed, or a full disk, leaves at most one torn line at the end; whoever comes
//! next cuts it off.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::failure::Failure;

/// How each line begins.
const OPENING: &[u8] = b"{\"key\":";

/// What is told again of a run that has its line.
#[derive(Clone, Debug, Deserialize)]
pub struct Told {
    /// As summaries spell it.
    pub verdict: String,
    /// Taken.
    pub steps: u64,
    /// s.
    pub wall_s: f64,
    /// Length over rest length of edges.
    pub stretch: Stretch,
}

/// Of edges over all frames.
#[derive(Clone, Debug, Deserialize)]
pub struct Stretch {
    /// The largest; none where it is not finite.
    pub max_of_all_frames: Option<f64>,
}

#[derive(Deserialize)]
struct Line {
    key: String,
    #[serde(flatten)]
    told: Told,
}

/// The runs that have lines, by their keys.
pub type Runs = HashMap<String, Told>;

/// An open file of lines.
pub struct Ledger {
    path: PathBuf,
    file: File,
    /// Bytes that have been read.
    read: u64,
    /// All that has been read.
    pub runs: Runs,
}

/// The runs that a file has, if there is one; nothing is changed.
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
    /// Opens a file to append to it; it and its folder are made if need be.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let open = || {
            path.parent().map_or(Ok(()), fs::create_dir_all)?;
            OpenOptions::new().read(true).append(true).create(true).open(path)
        };
        let file = open().map_err(|error| cannot_write(path, &error))?;
        let mut ledger = Self { path: path.into(), file, read: 0, runs: Runs::new() };
        ledger.locked(Self::catch_up)?;
        Ok(ledger)
    }

    /// Whether a run has its line, by this process or another.
    pub fn has(&mut self, key: &str) -> Result<bool, Failure> {
        self.locked(Self::catch_up)?;
        Ok(self.runs.contains_key(key))
    }

    /// Appends the line of a run, unless another process has been faster.
    pub fn append(&mut self, key: &str, line: &str) -> Result<(), Failure> {
        self.locked(|ledger| {
            ledger.catch_up()?;
            if !ledger.runs.contains_key(key) {
                ledger.write(line).map_err(|error| cannot_write(&ledger.path, &error))?;
            }
            ledger.catch_up()
        })
    }

    fn write(&mut self, line: &str) -> io::Result<()> {
        let written = self.file.write_all(format!("{line}\n").as_bytes()).and_then(|()| self.file.sync_data());
        if written.is_err() {
            // What is left of it is no line: the failure to write is what matters.
            let _ = self.file.set_len(self.read);
        }
        written
    }

    /// Does something while no other process does. Without locks, as on some network file systems, the
    /// file is this process's own.
    fn locked<T>(&mut self, act: impl FnOnce(&mut Self) -> Result<T, Failure>) -> Result<T, Failure> {
        match self.file.lock() {
            Err(error) if error.kind() == ErrorKind::Unsupported => return act(self),
            locked => locked.map_err(|error| cannot_write(&self.path, &error))?,
        }
        let acted = act(self);
        let unlocked = self.file.unlock().map_err(|error| cannot_write(&self.path, &error));
        acted.and_then(|value| unlocked.map(|()| value))
    }

    /// Reads what has been appended since, and cuts off a torn line.
    fn catch_up(&mut self) -> Result<(), Failure> {
        let mut bytes = Vec::new();
        let read = self.file.seek(SeekFrom::Start(self.read)).and_then(|_| self.file.read_to_end(&mut bytes));
        read.map_err(|error| Failure::Tool(format!("cannot read {}: {error}", self.path.display())))?;
        let whole = take_lines(&bytes, &mut self.runs).map_err(|what| foreign(&self.path, &what))?;
        self.read += whole as u64;
        if whole < bytes.len() {
            self.file.set_len(self.read).map_err(|error| cannot_write(&self.path, &error))?;
        }
        Ok(())
    }
}

/// Takes the runs of whole lines and returns how many bytes those are; what follows is the beginning of
/// a line. An error is a line that no sweep has written.
fn take_lines(bytes: &[u8], runs: &mut Runs) -> Result<usize, String> {
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    let shown = |line: &[u8]| String::from_utf8_lossy(line).chars().take(40).collect::<String>();
    for line in bytes[..whole].split_inclusive(|&byte| byte == b'\n') {
        let Line { key, told } = serde_json::from_slice(line).map_err(|_| shown(line.trim_ascii_end()))?;
        runs.insert(key, told);
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

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::Tool(format!(
        "cannot write {}: {error}; check that its folder exists, is writable and has room",
        path.display()
    ))
}
