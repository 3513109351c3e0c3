//! Failures of a command, and their exit codes.

use std::io;
use std::process::ExitCode;

use crate::export::ExportError;
use crate::export::whole::WriteError;
use crate::preview::PreviewError;

/// A failed command.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The tool itself failed, for example to write a file.
    #[error("{0}")]
    Tool(String),
    /// Bad usage or a bad scene.
    #[error("{0}")]
    Usage(String),
    /// The simulation diverged; the outputs up to the divergence are valid.
    #[error("{0}")]
    Diverged(String),
    /// The result is doubtful; the outputs are valid.
    #[error("{0}")]
    Doubtful(String),
    /// Surfaces intersect; the outputs are valid.
    #[error("{0}")]
    Intersecting(String),
    /// A check missed its tolerance; the outputs are valid.
    #[error("{0}")]
    Missed(String),
    /// There is no suitable device, or it failed.
    #[error("{0}")]
    NoDevice(String),
    /// Interrupted by the user; a checkpoint is written.
    #[error("{0}")]
    Interrupted(String),
}

impl Failure {
    /// Prints the message for a person.
    pub fn report(&self) {
        print_note(&format!("muslin: {self}"));
    }

    /// The exit code: 1 tool failure, 2 bad usage or scene, 3 diverged, intersecting, doubtful or missed tolerance,
    /// 4 no device, 130 interrupted.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Tool(_) => 1,
            Self::Usage(_) => 2,
            Self::Diverged(_) | Self::Intersecting(_) | Self::Doubtful(_) | Self::Missed(_) => 3,
            Self::NoDevice(_) => 4,
            Self::Interrupted(_) => 130,
        })
    }
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        Self::Tool(error.to_string())
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        Self::Tool(error.to_string())
    }
}

impl From<PreviewError> for Failure {
    fn from(error: PreviewError) -> Self {
        Self::Tool(error.to_string())
    }
}

/// Prints a note for a person to stderr; write errors are ignored.
pub fn print_note(text: &str) {
    use io::Write;
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Prints data to stdout. It is an error if nobody reads them.
pub fn print_data(text: &str) -> Result<(), Failure> {
    use io::Write;
    writeln!(io::stdout().lock(), "{text}").map_err(|error| unprinted(&error))
}

/// Prints one JSON document to stdout. It is an error if nobody reads it.
pub fn print_json(data: &impl serde::Serialize) -> Result<(), Failure> {
    print_data(&serde_json::to_string_pretty(data).map_err(|error| Failure::Tool(error.to_string()))?)
}

/// The failure to print data to stdout.
pub fn unprinted(error: &io::Error) -> Failure {
    Failure::Tool(format!("cannot write to stdout: {error}"))
}
