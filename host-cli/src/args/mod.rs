//! The command line.

mod detect;
mod run;
mod studies;
mod tools;
mod values;

use clap::{Parser, Subcommand};

pub use detect::DetectArguments;
pub use run::{RunArguments, SceneArguments};
pub use studies::{
    ChartArguments, ChooseArguments, NeedsArguments, StabilityArguments, StudyArguments, SweepArguments,
    ValidateArguments,
};
pub use tools::{BenchArguments, CookArguments, DevicesArguments, ScenesArguments};
pub use values::{Backend, Cost, DetectStage, Method, Precision, PreviewKind, series_name};

/// A cloth simulator that says what each method costs and how large its error is.
#[derive(Debug, Parser)]
#[command(
    name = "muslin",
    version,
    arg_required_else_help = true,
    after_help = help(include_str!("help/muslin.txt"))
)]
pub struct Arguments {
    /// The command
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulate a scene; write frames, a picture and a summary
    Run(RunArguments),
    /// Count contacts, impacts or intersections in a mesh
    Detect(DetectArguments),
    /// Chart error against cost: every method, both precisions, on a scene
    Chart(ChartArguments),
    /// Map where each method fails: step against stiffness and damping
    Stability(StabilityArguments),
    /// Measure the effect and the cost of each modelled term of a scene
    Needs(NeedsArguments),
    /// Run a scene over a grid of overrides: resumable, one JSON line per run
    Sweep(SweepArguments),
    /// Compare the simulator with known answers
    Validate(ValidateArguments),
    /// Choose the cheapest method, step and terms that meet a tolerance on a scene
    Choose(ChooseArguments),
    /// Write a scene as one block of bytes for programs without a heap
    Cook(CookArguments),
    /// List the built-in scenes, or print one
    Scenes(ScenesArguments),
    /// List the processor and the graphics adapters
    Devices(DevicesArguments),
    /// Measure the cost of each stage on this machine
    Bench(BenchArguments),
}

/// Prepares a text of `help/` for clap, which wraps lines itself: joins the lines of each paragraph and keeps indented
/// lines.
fn help(text: &str) -> String {
    let mut joined = String::new();
    let mut open = false;
    for line in text.lines() {
        let flows = !line.is_empty() && !line.starts_with(' ');
        match (open, flows) {
            (true, true) => joined.push(' '),
            _ if joined.is_empty() => {}
            _ => joined.push('\n'),
        }
        joined.push_str(line);
        open = flows && !line.ends_with(':');
    }
    joined
}

#[cfg(test)]
mod tests {
    use clap::error::ErrorKind;

    use super::*;

    const MANUALS: [&str; 12] = [
        include_str!("../../../README.md"),
        include_str!("../../README.md"),
        include_str!("../../../core/manual/driving.md"),
        include_str!("../../../core/manual/no_heap.md"),
        include_str!("../../manual/cost.md"),
        include_str!("../../manual/detect.md"),
        include_str!("../../manual/methods.md"),
        include_str!("../../manual/running.md"),
        include_str!("../../manual/scene.md"),
        include_str!("../../manual/studies.md"),
        include_str!("../../manual/sweep.md"),
        include_str!("../../manual/validate.md"),
    ];

    /// The words of a command line up to its comment; quotes keep words together.
    fn words(line: &str) -> Vec<String> {
        let mut words = vec![String::new()];
        let mut quoted = false;
        for c in line.split(" #").next().unwrap_or("").split(" >").next().unwrap_or("").chars() {
            match c {
                '"' | '\'' => quoted = !quoted,
                ' ' if !quoted => words.push(String::new()),
                c => words.last_mut().expect("there is one").push(c),
            }
        }
        words.retain(|word| !word.is_empty());
        words
    }

    #[test]
    fn every_command_of_the_manuals_is_understood() {
        let mut count = 0;
        for manual in MANUALS {
            for (place, part) in manual.split("```").enumerate() {
                // Outside of blocks, commands stand between backquotes, and some lack their arguments.
                let lines: Vec<String> = match (place % 2, part.strip_prefix("sh\n")) {
                    (1, Some(block)) => block.lines().map(str::to_owned).collect(),
                    (1, None) => Vec::new(),
                    _ => part.split('`').skip(1).step_by(2).map(|code| code.replace('\n', " ")).collect(),
                };
                // A shell's variables are not known here.
                for line in lines.iter().filter(|line| line.starts_with("muslin ") && !line.contains('$')) {
                    let kind = Arguments::try_parse_from(words(line)).err().map(|error| error.kind());
                    let incomplete = place % 2 == 0 && kind == Some(ErrorKind::MissingRequiredArgument);
                    let fine = matches!(kind, None | Some(ErrorKind::DisplayHelp)) || incomplete;
                    assert!(fine, "the manual has {line:?}, which is {kind:?}");
                    count += 1;
                }
            }
        }
        assert!(count > 50, "{count} commands: the blocks are no longer found");
    }
}
