//! Files that are either complete or absent, also after a loss of power: they are written to `NAME.partial` and then
//! renamed.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::disk;
#[cfg(test)]
use crate::disk::journal::{Event, note};

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {cause}; check that its folder exists, is writable and has room", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The system's error.
    pub cause: io::Error,
}

/// A file under its partial name, open for reading and writing.
pub struct Partial {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Partial {
    /// Creates an empty file that will become `path`; its folder is created if necessary.
    pub fn create(path: PathBuf) -> Result<Partial, WriteError> {
        let create = || {
            path.parent().map_or(Ok(Vec::new()), disk::create_folders)?;
            disk::create(&partial_name(&path))
        };
        Partial::new(create(), path)
    }

    /// Opens the partial file that an interrupted run left, or else a copy of the complete file; `None` if neither
    /// exists. A partial file that is a link counts as absent.
    pub fn reopen(path: &Path) -> Result<Option<Partial>, WriteError> {
        let name = partial_name(path);
        if fs::symlink_metadata(&name).is_ok_and(|found| found.is_file()) {
            return Partial::new(OpenOptions::new().read(true).write(true).open(name), path.into()).map(Some);
        }
        if !path.is_file() {
            return Ok(None);
        }
        // The copy is whole or absent too: of a short one, frames would be missing.
        write(name.clone(), |file| io::copy(&mut File::open(path)?, file).map(drop))?;
        Partial::new(OpenOptions::new().read(true).write(true).open(name), path.into()).map(Some)
    }

    fn new(opened: io::Result<File>, path: PathBuf) -> Result<Partial, WriteError> {
        match opened {
            Ok(file) => Ok(Partial { path, file: BufWriter::new(file) }),
            Err(cause) => Err(WriteError { path, cause }),
        }
    }

    /// The final path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads or writes the file; an error names the file.
    pub fn with<T>(&mut self, act: impl FnOnce(&mut BufWriter<File>) -> io::Result<T>) -> Result<T, WriteError> {
        let done = act(&mut self.file).map_err(|cause| WriteError { path: self.path.clone(), cause });
        #[cfg(test)]
        note(Event::Changed(partial_name(&self.path), fs::read(partial_name(&self.path)).unwrap_or_default()));
        done
    }

    /// Writes buffered data and the partial name to the disk, so that not even a loss of power takes them.
    pub fn sync(&mut self) -> Result<(), WriteError> {
        self.sync_data()?;
        let partial = partial_name(&self.path);
        self.with(|_| disk::sync_folder_of(&partial))
    }

    fn sync_data(&mut self) -> Result<(), WriteError> {
        self.with(|file| {
            file.flush()?;
            file.get_ref().sync_all()
        })?;
        #[cfg(test)]
        note(Event::Synced(partial_name(&self.path)));
        Ok(())
    }

    /// Gives the file its final name; returns the path. The data reach the disk before the name does, and both are
    /// there when this returns.
    pub fn finish(mut self) -> Result<PathBuf, WriteError> {
        self.sync_data()?;
        let Partial { path, file } = self;
        drop(file);
        match disk::rename(&partial_name(&path), &path) {
            Ok(()) => Ok(path),
            Err(cause) => Err(WriteError { path, cause }),
        }
    }
}

/// Writes a whole file at once.
pub fn write(path: PathBuf, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<PathBuf, WriteError> {
    let mut partial = Partial::create(path)?;
    if let Err(error) = partial.with(fill) {
        // The error above is the one to report, so an error of the removal is ignored.
        let _ = disk::remove(&partial_name(partial.path()));
        return Err(error);
    }
    partial.finish()
}

/// The name of a file while it is not complete.
pub fn partial_name(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".partial");
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/a.txt");
        let failed = write(path.clone(), |_| Err(io::Error::other("no more")));
        assert!(failed.unwrap_err().to_string().contains("a.txt: no more; check"));
        assert_eq!(fs::read_dir(folder.path().join("deep")).unwrap().count(), 0);

        write(path.clone(), |file| file.write_all(b"whole")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        assert_eq!(fs::read_dir(folder.path().join("deep")).unwrap().count(), 1);
    }

    #[test]
    fn a_partial_file_can_be_reopened() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        assert!(Partial::reopen(&path).unwrap().is_none());
        let mut partial = Partial::create(path.clone()).unwrap();
        partial.with(|file| file.write_all(b"one")).unwrap();
        partial.sync().unwrap();
        assert!(!path.exists());
        assert_eq!(Partial::reopen(&path).unwrap().unwrap().finish().unwrap(), path);
        assert_eq!(fs::read(&path).unwrap(), b"one");
    }

    #[test]
    fn a_complete_file_is_reopened_as_a_copy() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "one").unwrap();
        let mut partial = Partial::reopen(&path).unwrap().unwrap();
        partial.with(|file| file.write_all(b"two")).unwrap();
        partial.sync().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one");
    }
}
