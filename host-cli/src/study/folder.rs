//! The folder of a study and the results in it: a picture, numbers as JSON and a text.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::export::whole;
use crate::failure::{Failure, print_data, print_note};

/// The results of a study.
pub struct Results {
    /// The picture, if there is anything to show.
    pub svg: Option<String>,
    /// The numbers as one JSON document.
    pub json: String,
    /// The report as text.
    pub lines: String,
}

impl Results {
    /// Converts the numbers to JSON. An error means that they cannot be converted.
    pub fn new(svg: Option<String>, numbers: &impl Serialize, lines: String) -> Result<Self, Failure> {
        let json = serde_json::to_string_pretty(numbers).map_err(|error| Failure::Tool(error.to_string()))?;
        Ok(Self { svg, json, lines })
    }

    /// Prints the numbers or the text, and then the names of the written files.
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

/// The folder that a study writes to.
pub struct Folder {
    path: PathBuf,
    /// Folders that this study created, the innermost first.
    made: Vec<PathBuf>,
}

impl Folder {
    /// Creates the folder. A study does this first, so that a folder that cannot be created costs no computing
    /// time.
    pub fn make(path: PathBuf) -> Result<Self, Failure> {
        let missing = path.ancestors().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
        let made = missing.map(Path::to_path_buf).collect();
        fs::create_dir_all(&path)
            .map_err(|error| Failure::Tool(format!("cannot make the folder {}: {error}", path.display())))?;
        Ok(Self { path, made })
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a text to a file, either completely or not at all.
    pub fn write(&self, file: &str, text: &str) -> Result<PathBuf, Failure> {
        use std::io::Write;
        whole::write(self.path.join(file), |out| writeln!(out, "{text}"))
            .map_err(|error| Failure::Tool(error.to_string()))
    }

    /// Writes the results to files with one stem: `NAME.svg`, `NAME.json` and `NAME.txt`.
    pub fn keep(&self, name: &str, results: &Results) -> Result<Vec<PathBuf>, Failure> {
        let files = [("svg", results.svg.as_ref()), ("json", Some(&results.json)), ("txt", Some(&results.lines))];
        let files = files.into_iter().filter_map(|(kind, text)| Some((kind, text?)));
        files.map(|(kind, text)| self.write(&format!("{name}.{kind}"), text)).collect()
    }
}

impl Drop for Folder {
    /// Removes the created folders if they are empty, so that a study without results leaves no folder.
    fn drop(&mut self) {
        self.made.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}
