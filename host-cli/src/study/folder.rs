//! The folder of a study, and the results in it: a picture, the numbers and the words.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::export::whole;
use crate::failure::{Failure, print_data, print_note};

/// What a study found.
pub struct Results {
    /// The picture, where there is something to show.
    pub svg: Option<String>,
    /// The numbers as one JSON document.
    pub json: String,
    /// For people.
    pub lines: String,
}

impl Results {
    /// Of numbers that can be written.
    pub fn new(svg: Option<String>, numbers: &impl Serialize, lines: String) -> Result<Self, Failure> {
        let json = serde_json::to_string_pretty(numbers).map_err(|error| Failure::Tool(error.to_string()))?;
        Ok(Self { svg, json, lines })
    }

    /// Prints the numbers or the words, and says what was written.
    pub fn print(&self, json: bool, quiet: bool, written: &[PathBuf]) -> Result<(), Failure> {
        if json {
            print_data(&self.json)?;
        } else if !quiet {
            print_data(&self.lines)?;
        }
        if !quiet {
            let names: Vec<_> = written.iter().map(|path| path.display().to_string()).collect();
            print_note(&format!("wrote {}", names.join(", ")));
        }
        Ok(())
    }
}

/// Where a study writes.
pub struct Folder {
    path: PathBuf,
    /// Folders that were not there, the innermost first.
    made: Vec<PathBuf>,
}

impl Folder {
    /// Makes a folder before the time is spent that ends in it.
    pub fn make(path: PathBuf) -> Result<Self, Failure> {
        let missing = path.ancestors().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
        let made = missing.map(Path::to_path_buf).collect();
        fs::create_dir_all(&path)
            .map_err(|error| Failure::Tool(format!("cannot make the folder {}: {error}", path.display())))?;
        Ok(Self { path, made })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a whole file.
    pub fn write(&self, file: &str, text: &str) -> Result<PathBuf, Failure> {
        use std::io::Write;
        whole::write(self.path.join(file), |out| writeln!(out, "{text}"))
            .map_err(|error| Failure::Tool(error.to_string()))
    }

    /// Writes results to files of one name.
    pub fn keep(&self, name: &str, results: &Results) -> Result<Vec<PathBuf>, Failure> {
        let files = [("svg", results.svg.as_ref()), ("json", Some(&results.json)), ("txt", Some(&results.lines))];
        let files = files.into_iter().filter_map(|(kind, text)| Some((kind, text?)));
        files.map(|(kind, text)| self.write(&format!("{name}.{kind}"), text)).collect()
    }
}

impl Drop for Folder {
    /// A study without results leaves no folder: only empty ones can be removed.
    fn drop(&mut self) {
        self.made.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}
