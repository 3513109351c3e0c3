//! `muslin scenes`: lists the built-in scenes.

use muslin_core::scene::{BUILT_IN, SceneDesc};
use serde::Serialize;

use crate::args::ScenesArguments;
use crate::failure::{Failure, print_data, print_json};

#[derive(Serialize)]
struct Row {
    name: &'static str,
    description: String,
}

/// Prints the list of built-in scenes, or one scene's file.
pub fn print(arguments: &ScenesArguments) -> Result<(), Failure> {
    if let Some(wanted) = &arguments.name {
        let found = BUILT_IN.iter().find(|(name, _)| name == wanted);
        let (_, text) = found.ok_or_else(|| {
            let names: Vec<_> = BUILT_IN.iter().map(|(name, _)| *name).collect();
            Failure::Usage(format!("there is no built-in scene {wanted}; there are {}", names.join(", ")))
        })?;
        return print_data(text.trim_end());
    }
    let row = |&(name, text): &(&'static str, &str)| {
        let desc: SceneDesc = toml::from_str(text).map_err(|error| Failure::Tool(format!("{name}: {error}")))?;
        Ok(Row { name, description: desc.description })
    };
    let rows = BUILT_IN.iter().map(row).collect::<Result<Vec<Row>, Failure>>()?;
    if arguments.json {
        return print_json(&rows);
    }
    let width = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
    let lines: Vec<_> = rows.iter().map(|row| format!("{:width$}  {}", row.name, row.description)).collect();
    print_data(&lines.join("\n"))
}
