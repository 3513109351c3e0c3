//! The results of a study: a picture, numbers as JSON and a text.

use std::path::PathBuf;

use serde::Serialize;

use crate::failure::{Failure, print_data, print_note};
use crate::folder::Folder;

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

    /// Writes files with one stem: `NAME.svg`, `NAME.json` and `NAME.txt`.
    pub fn write(&self, folder: &Folder, name: &str) -> Result<Vec<PathBuf>, Failure> {
        let files = [("svg", self.svg.as_ref()), ("json", Some(&self.json)), ("txt", Some(&self.lines))];
        let files = files.into_iter().filter_map(|(kind, text)| Some((kind, text?)));
        files.map(|(kind, text)| folder.write(&format!("{name}.{kind}"), text)).collect()
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
