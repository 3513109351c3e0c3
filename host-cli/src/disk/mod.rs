//! The changes that outputs make on the disk. A loss of power takes data of a file that was not synced, and names that
//! were made, changed or removed in a folder that was not synced.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

#[cfg(test)]
pub mod journal;
#[cfg(test)]
use journal::{Event, note};

/// Creates a folder and those above it. Their names are on the disk when this returns. Returns the folders that were
/// missing, the innermost first.
pub fn create_folders(path: &Path) -> io::Result<Vec<PathBuf>> {
    let missing = path.ancestors().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    let missing: Vec<_> = missing.map(Path::to_path_buf).collect();
    fs::create_dir_all(path)?;
    for folder in missing.iter().rev() {
        #[cfg(test)]
        note(Event::NewFolder(folder.clone()));
        sync_folder_of(folder)?;
    }
    Ok(missing)
}

/// Creates a file for reading and writing. An older file is removed, not overwritten: it may be a link to a file
/// elsewhere.
pub fn create(path: &Path) -> io::Result<File> {
    remove(path)?;
    let file = OpenOptions::new().read(true).write(true).create_new(true).open(path)?;
    #[cfg(test)]
    note(Event::NewFile(path.into()));
    Ok(file)
}

/// Waits until the names in the folder of a file are on the disk, on the systems that can do this.
pub fn sync_folder_of(path: &Path) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if cfg!(unix) {
        // Some file systems refuse this, and some folders may be written to but not be opened.
        let refused = [ErrorKind::InvalidInput, ErrorKind::Unsupported, ErrorKind::PermissionDenied];
        match File::open(folder).and_then(|folder| folder.sync_all()) {
            Err(error) if !refused.contains(&error.kind()) => return Err(error),
            _ => {}
        }
    }
    #[cfg(test)]
    note(Event::SyncedFolder(folder.into()));
    Ok(())
}

/// Gives a file another name in its folder. The name is on the disk when this returns.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    fs::rename(from, to)?;
    #[cfg(test)]
    note(Event::Renamed(from.into(), to.into()));
    sync_folder_of(to)
}

/// Removes a file if it exists. A link is removed itself, not the file that it leads to.
pub fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        removed => removed?,
    }
    #[cfg(test)]
    note(Event::Removed(path.into()));
    Ok(())
}

/// Removes a folder if it is empty.
pub fn remove_folder(path: &Path) -> io::Result<()> {
    fs::remove_dir(path)?;
    #[cfg(test)]
    note(Event::Removed(path.into()));
    Ok(())
}
