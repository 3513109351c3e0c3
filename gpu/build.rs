//! Copies the shaders to where `stages.rs` takes them from; without remarks and indents where they are sent over
//! the net.

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

/// WGSL knows no strings, so that two slashes always begin a remark.
fn bare(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim());
    lines.filter(|line| !line.is_empty()).flat_map(|line| [line, "\n"]).collect()
}
