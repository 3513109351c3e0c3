//! A record of the changes in a folder, and the files that a loss of power after any of them may leave.
//!
//! The model allows all that T. Pillai et al. found in file systems (*All file systems are not created equal*, OSDI
//! 2014), except that a rename is atomic. The data of a file are safe at its last sync. Each block that changed since
//! is there in an old or a new version. Names are safe at the last sync of their folder. Of the changes since, any are
//! there, in any combination.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A change on the disk.
#[derive(Clone, Debug)]
pub enum Event {
    /// A folder was created.
    NewFolder(PathBuf),
    /// An empty file was created.
    NewFile(PathBuf),
    /// A file contains these bytes from now on.
    Changed(PathBuf, Vec<u8>),
    /// The data of a file reached the disk.
    Synced(PathBuf),
    /// The names in a folder reached the disk.
    SyncedFolder(PathBuf),
    /// A file has another name.
    Renamed(PathBuf, PathBuf),
    /// A file was removed.
    Removed(PathBuf),
}

static JOURNAL: Mutex<Option<(PathBuf, Vec<Event>)>> = Mutex::new(None);

/// Notes an event, if it is in the folder that is recorded.
pub fn note(event: Event) {
    if let Some((root, events)) = &mut *JOURNAL.lock().unwrap_or_else(PoisonError::into_inner)
        && event.path().starts_with(root)
    {
        events.push(event);
    }
}

/// Runs `act` and returns the events in a folder. One folder at a time is recorded.
pub fn record(root: &Path, act: impl FnOnce()) -> Vec<Event> {
    let journal = || JOURNAL.lock().unwrap_or_else(PoisonError::into_inner);
    *journal() = Some((root.into(), Vec::new()));
    act();
    journal().take().unwrap().1
}

impl Event {
    /// The file or folder, by its new name.
    pub fn path(&self) -> &Path {
        let (Self::NewFolder(path)
        | Self::NewFile(path)
        | Self::Changed(path, _)
        | Self::Synced(path)
        | Self::SyncedFolder(path)
        | Self::Renamed(_, path)
        | Self::Removed(path)) = self;
        path
    }
}

/// Files and their bytes.
pub type Files = BTreeMap<PathBuf, Vec<u8>>;

/// A name in a folder: of a file, by its number, or of a folder.
type Node = Option<usize>;

/// A change of names.
#[derive(Clone)]
enum Change {
    Add(PathBuf, Node),
    Rename(PathBuf, PathBuf, usize),
    Remove(PathBuf),
}

impl Change {
    fn path(&self) -> &Path {
        let (Self::Add(path, _) | Self::Rename(_, path, _) | Self::Remove(path)) = self;
        path
    }

    fn apply(self, names: &mut BTreeMap<PathBuf, Node>) {
        match self {
            Self::Add(path, node) => drop(names.insert(path, node)),
            Self::Rename(from, to, file) => {
                // If the name was not on the disk yet, the file gets its new one all the same.
                names.remove(&from);
                names.insert(to, Some(file));
            }
            Self::Remove(path) => drop(names.remove(&path)),
        }
    }
}

/// The names and data on the disk, and those on their way there.
pub struct Disk {
    root: PathBuf,
    /// Names on the disk.
    names: BTreeMap<PathBuf, Node>,
    /// Changes of names that are not on the disk.
    changes: Vec<Change>,
    /// Versions of each file; the first one is on the disk.
    versions: Vec<Vec<Vec<u8>>>,
}

/// Size in which data reach the disk, bytes.
const BLOCK: usize = 512;

impl Disk {
    /// A disk that has these files in a folder and nothing else.
    pub fn new(root: &Path, files: &Files) -> Self {
        let mut disk = Self { root: root.into(), names: BTreeMap::new(), changes: Vec::new(), versions: Vec::new() };
        for (path, bytes) in files {
            let folders = path.ancestors().skip(1).take_while(|folder| *folder != root);
            disk.names.extend(folders.map(|folder| (folder.into(), None)));
            disk.names.insert(path.clone(), Some(disk.versions.len()));
            disk.versions.push(vec![bytes.clone()]);
        }
        disk
    }

    /// Adds an event.
    pub fn add(&mut self, event: &Event) {
        match event {
            Event::NewFolder(path) => self.changes.push(Change::Add(path.clone(), None)),
            Event::NewFile(path) => {
                self.changes.push(Change::Add(path.clone(), Some(self.versions.len())));
                self.versions.push(vec![Vec::new()]);
            }
            Event::Changed(path, bytes) => {
                let file = self.file(path);
                self.versions[file].push(bytes.clone());
            }
            Event::Synced(path) => {
                let file = self.file(path);
                let last = self.versions[file].len() - 1;
                self.versions[file].drain(..last);
            }
            Event::SyncedFolder(folder) => {
                let is_in = |change: &mut Change| change.path().parent() == Some(folder);
                for change in self.changes.extract_if(.., is_in) {
                    change.apply(&mut self.names);
                }
            }
            Event::Renamed(from, to) => self.changes.push(Change::Rename(from.clone(), to.clone(), self.file(from))),
            Event::Removed(path) => self.changes.push(Change::Remove(path.clone())),
        }
    }

    /// The file that a program finds under a name.
    fn file(&self, path: &Path) -> usize {
        let mut names = self.names.clone();
        self.changes.iter().cloned().for_each(|change| change.apply(&mut names));
        names[path].unwrap()
    }

    /// The files that a loss of power leaves. `keeps` decides for each change of a name, `choose` takes one of so many
    /// versions of a block.
    pub fn lose(&self, mut keeps: impl FnMut() -> bool, mut choose: impl FnMut(usize) -> usize) -> Files {
        let mut names = self.names.clone();
        self.changes.iter().filter(|_| keeps()).cloned().for_each(|change| change.apply(&mut names));
        let folders: BTreeSet<_> =
            names.iter().filter(|(_, node)| node.is_none()).map(|(path, _)| path.as_path()).collect();
        let is_there = |path: &Path| {
            path.ancestors().skip(1).take_while(|folder| *folder != self.root).all(|folder| folders.contains(folder))
        };
        let files = names.iter().filter_map(|(path, node)| Some((path, (*node)?)));
        let files = files.filter(|(path, _)| is_there(path));
        files.map(|(path, file)| (path.clone(), mixture(&self.versions[file], &mut choose))).collect()
    }
}

/// A file whose blocks are of different versions. Where a version has no such block, it contains zeros.
fn mixture(versions: &[Vec<u8>], choose: &mut impl FnMut(usize) -> usize) -> Vec<u8> {
    let length = versions[choose(versions.len())].len();
    let mut bytes = vec![0; length];
    for (number, block) in bytes.chunks_mut(BLOCK).enumerate() {
        let version = &versions[choose(versions.len())];
        let from = version.get(number * BLOCK..).unwrap_or_default();
        let common = from.len().min(block.len());
        block[..common].copy_from_slice(&from[..common]);
    }
    bytes
}
