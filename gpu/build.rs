//! Copies the shaders to `OUT_DIR`, where `shaders.rs` includes them. For wasm32 it strips comments and
//! indentation, because they would be sent over the network.

use std::path::Path;
use std::{env, fs, io};

const FOLDERS: [&str; 4] = ["shared", "geometry", "broad_phase", "narrow_phase"];

fn main() -> io::Result<()> {
    let sent = env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "wasm32");
    let out = env::var("OUT_DIR").map_err(io::Error::other)?;
    for folder in FOLDERS {
        let (from, to) = (Path::new("src").join(folder), Path::new(&out).join(folder));
        println!("cargo::rerun-if-changed={}", from.display());
        fs::create_dir_all(&to)?;
        for file in fs::read_dir(&from)? {
            let file = file?;
            let text = fs::read_to_string(file.path())?;
            fs::write(to.join(file.file_name()), if sent { bare(&text) } else { text })?;
        }
    }
    Ok(())
}

/// The text without comments, indentation and empty lines. WGSL has no strings, so two slashes always begin a comment.
fn bare(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim());
    lines.filter(|line| !line.is_empty()).flat_map(|line| [line, "\n"]).collect()
}
