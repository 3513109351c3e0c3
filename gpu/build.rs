//! Copies the shaders to `OUT_DIR`, where `shaders.rs` includes them. For wasm32 it strips comments and
//! spaces, because they would be sent over the network.

#[path = "minify.rs"]
mod minify;

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
            fs::write(to.join(file.file_name()), if sent { minify::minify(&text) } else { text })?;
        }
    }
    Ok(())
}
