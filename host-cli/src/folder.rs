//! An output folder, which one command at a time writes to.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use same_file::Handle;

use crate::disk;
use crate::export::whole::{self, WriteError};
use crate::failure::Failure;

/// Name of the lock file.
const LOCK: &str = ".muslin.lock";

/// A folder that no other command can take until this value is dropped.
pub struct Folder {
    path: PathBuf,
    /// Folders that were created, the innermost first.
    made: Vec<PathBuf>,
    /// The locked file. The system unlocks it when the process ends, however it ends.
    _lock: File,
}

impl Folder {
    /// Creates and locks the folder. A command does this first, so that a folder that cannot be used costs no
    /// computing time.
    pub fn take(path: PathBuf) -> Result<Self, Failure> {
        if path.exists() && !path.is_dir() {
            return Err(Failure::Usage(format!("{} is a file; give a folder by --out", path.display())));
        }
        let failed = |cause| WriteError { path: path.join(LOCK), cause };
        let made = disk::create_folders(&path).map_err(failed)?;
        // Through a link, the lock would make or lock a file elsewhere.
        if fs::symlink_metadata(path.join(LOCK)).is_ok_and(|found| !found.is_file()) {
            return Err(Failure::Tool(format!(
                "{} is a link or no file; remove it, or give another folder by --out",
                path.join(LOCK).display()
            )));
        }
        match lock(&path.join(LOCK)).map_err(failed)? {
            Some(lock) => Ok(Self { path, made, _lock: lock }),
            None => Err(Failure::Tool(format!(
                "another muslin is writing to the folder {}; wait until it ends, or give another folder by --out",
                path.display()
            ))),
        }
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a text to a file, either completely or not at all.
    pub fn write(&self, file: &str, text: &str) -> Result<PathBuf, Failure> {
        use io::Write;
        Ok(whole::write(self.path.join(file), |out| writeln!(out, "{text}"))?)
    }
}

impl Drop for Folder {
    /// Removes the lock file, and the created folders if they are empty: a command without results leaves no folder.
    fn drop(&mut self) {
        let _ = fs::remove_file(self.path.join(LOCK));
        self.made.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}

/// Creates and locks a file; `None` if another process has locked it.
fn lock(path: &Path) -> io::Result<Option<File>> {
    loop {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => return Ok(None),
            // Some network file systems have no locks. There, nothing keeps two commands apart.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => return Ok(Some(file)),
            Err(TryLockError::Error(error)) => return Err(error),
            Ok(()) => {}
        }
        // A process that ended in between has removed the file, and yet another one may have locked a new one.
        match Handle::from_path(path) {
            Ok(there) if there == Handle::from_file(file.try_clone()?)? => return Ok(Some(file)),
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
}
