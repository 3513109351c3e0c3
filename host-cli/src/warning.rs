//! Warnings for the user of a run that goes on or has ended.

use serde::Serialize;

use crate::failure::print_note;

/// A warning.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// Its kind, for programs.
    pub code: &'static str,
    /// What is the matter and what to do, for people.
    pub text: String,
    /// Whether the result of the run is probably wrong.
    #[serde(skip)]
    pub is_doubtful: bool,
}

impl Warning {
    /// A warning of a kind.
    pub fn new(code: &'static str, text: impl Into<String>) -> Self {
        Self { code, text: text.into(), is_doubtful: false }
    }

    /// Prints the text for a person.
    pub fn print(&self) {
        print_note(&self.text);
    }
}
