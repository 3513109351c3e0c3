//! Copies the shaders to `OUT_DIR`, where `shaders.rs` includes them. For wasm32 it strips comments and
//! spaces, because they would be sent over the network.

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

/// The text without comments, indentation, empty lines and the spaces that separate nothing. WGSL has no strings, so two
/// slashes always begin a comment.
fn bare(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim());
    let mut bare = String::new();
    for line in lines.filter(|line| !line.is_empty()) {
        let mut characters = line.chars().peekable();
        while let Some(character) = characters.next() {
            if character != ' ' || separates(bare.chars().next_back(), characters.peek().copied()) {
                bare.push(character);
            }
        }
        if !line.ends_with([';', '{', '}', ',']) {
            bare.push('\n');
        }
    }
    bare
}

/// Whether a space between two characters separates two names, or two signs that are no operator together.
fn separates(before: Option<char>, after: Option<char>) -> bool {
    let both = |are: fn(char) -> bool| before.is_some_and(are) && after.is_some_and(are);
    both(|c| c.is_alphanumeric() || "_@".contains(c)) || both(|c| "+-".contains(c))
}
