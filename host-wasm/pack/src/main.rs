//! Builds the npm package with its page: `cargo run -p muslin-pack [-- [--count] FOLDER]`.
#![forbid(unsafe_code)]

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::{env, fs};

use wasm_bindgen_cli_support::{Bindgen, Output};

const TARGET: &str = "wasm32-unknown-unknown";

/// Compiler flags. The module uses vectors of four lanes. Panics abort without message or location, because nobody
/// could read them; debug output is left out for the same reason. Unrolled loops take twice the space and are not
/// faster. A higher level of MIR optimisation saves 1.4 kB, and set-up code that is optimised for size (`small`)
/// saves 3 kB.
const FLAGS: &str = "--cfg=small -Ctarget-feature=+simd128 -Zunstable-options -Cpanic=immediate-abort -Zlocation-detail=none \
                     -Zmir-opt-level=3 -Zfmt-debug=none -Cllvm-args=-unroll-threshold=25";

/// Flags that build the standard library with the module, for size and without panic messages. They are unstable,
/// hence `RUSTC_BOOTSTRAP`.
const STANDARD: [&str; 2] = ["-Zbuild-std=std,panic_abort", "-Zbuild-std-features=optimize_for_size"];

/// Files that are bundled with their imports: the source below `web` and the path in the package.
const BUNDLES: [(&str, &str); 6] = [
    ("muslin.ts", "muslin.js"),
    (INLINE.0, INLINE.1),
    ("page/page.js", "page/page.js"),
    ("page/simulator.js", "page/simulator.js"),
    ("page/worker.js", "page/worker.js"),
    ("page/style.css", "page/style.css"),
];

/// The bundle that has the module inside it.
const INLINE: (&str, &str) = ("inline.ts", "inline.js");

/// The address of the module as bundles have it. Bundlers that see it copy the module.
const ADDRESS: &str = r#"new URL("muslin_wasm_bg.wasm",import.meta.url)"#;

/// Files that are copied unchanged: the source and the path in the package.
const COPIED: [(&str, &str); 7] = [
    ("package.json", "package.json"),
    ("README.md", "README.md"),
    ("pictures/page.png", "pictures/page.png"),
    ("pictures/cape.png", "pictures/cape.png"),
    ("web/scene_types.d.ts", "types/scene_types.d.ts"),
    ("../LICENSE-MIT", "LICENSE-MIT"),
    ("../LICENSE-APACHE", "LICENSE-APACHE"),
];

/// The examples. In the package, other packages lie beside it.
const EXAMPLES: [&str; 8] = [
    "three.html",
    "cape.html",
    "walker.gltf",
    "playcanvas.html",
    "worker.html",
    "worker.js",
    "react/flag.jsx",
    "react/index.html",
];

fn main() -> ExitCode {
    let (options, folders): (Vec<_>, Vec<_>) = env::args().skip(1).partition(|argument| argument.starts_with("--"));
    if options.iter().any(|option| option != "--count") || folders.len() > 1 {
        println!(
            "cargo run -p muslin-pack [-- [--count] FOLDER]\n\n\
             Makes the npm package and its page in FOLDER, host-wasm/dist by default.\n\
             --count  a module that counts its allocations, for tests"
        );
        return ExitCode::from(2);
    }
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = folders.first().map_or_else(|| own.join("dist"), PathBuf::from);
    match pack(&own, &folder, !options.is_empty()) {
        Ok(()) => {
            println!("{}", folder.display());
            ExitCode::SUCCESS
        }
        Err(why) => {
            println!("cannot make {}: {why}", folder.display());
            ExitCode::FAILURE
        }
    }
}

fn pack(own: &Path, folder: &Path, count: bool) -> Result<(), String> {
    install_sources(own)?;
    install(own)?;
    let module = build(own, count)?;
    let web = own.join("web");
    bind(&module, &web)?;
    shrink(own, &web.join("muslin_wasm_bg.wasm"))?;
    write_scene_types(own, &web)?;
    let failed = |path: &Path| {
        let path = path.display().to_string();
        move |why| format!("{path}: {why}")
    };
    for part in ["page", "pictures", "examples/react"] {
        fs::create_dir_all(folder.join(part)).map_err(failed(folder))?;
    }
    for (from, to) in BUNDLES {
        bundle(own, &web.join(from), &folder.join(to))?;
    }
    without_address(&folder.join(INLINE.1))?;
    declare(own, &folder.join("types"))?;
    for (from, to) in COPIED {
        fs::copy(own.join(from), folder.join(to)).map_err(failed(&own.join(from)))?;
    }
    for name in EXAMPLES {
        let from = own.join("examples").join(name);
        let text = fs::read_to_string(&from).map_err(failed(&from))?;
        let text = text.replace("../dist/", "../").replace("../node_modules/", "../../");
        fs::write(folder.join("examples").join(name), text).map_err(failed(folder))?;
    }
    let page = web.join("page/index.html");
    let text = fs::read_to_string(&page).map_err(failed(&page))?;
    let text: String = text.lines().map(|line| format!("{}\n", line.trim())).collect();
    fs::write(folder.join("page/index.html"), text).map_err(failed(&page))?;
    let bound = web.join("muslin_wasm_bg.wasm");
    fs::copy(&bound, folder.join("muslin_wasm_bg.wasm")).map_err(failed(&bound))?;
    fs::remove_file(&bound).map_err(failed(&bound))
}

/// Installs the sources of the standard library, unless they are there.
fn install_sources(own: &Path) -> Result<(), String> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let told = Command::new(rustc).args(["--print", "sysroot"]).current_dir(own).output();
    let root = told.map_err(|why| format!("rustc: {why}"))?;
    let root = PathBuf::from(String::from_utf8_lossy(&root.stdout).trim());
    if root.join("lib/rustlib/src/rust/library/std/Cargo.toml").is_file() {
        return Ok(());
    }
    println!("The sources of Rust's standard library are missing. rustup installs them:");
    let mut rustup = Command::new("rustup");
    rustup.args(["component", "add", "rust-src"]).current_dir(own);
    run(rustup, "install the component rust-src of this toolchain, with rustup (https://rustup.rs) or from your system")
}

/// Installs the tools that `package-lock.json` names, unless the installed ones are newer than this file.
fn install(own: &Path) -> Result<(), String> {
    let written = |path: &str| fs::metadata(own.join(path)).and_then(|file| file.modified()).ok();
    if written("node_modules/.package-lock.json") > written("package-lock.json") {
        return Ok(());
    }
    let mut npm = Command::new("npm");
    npm.args(["ci", "--no-audit", "--no-fund"]).current_dir(own);
    run(npm, "npm is needed: install Node.js 20 or newer (https://nodejs.org)")
}

fn build(own: &Path, count: bool) -> Result<PathBuf, String> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args(["build", "--package", "muslin-wasm", "--lib", "--profile", "wasm", "--target", TARGET])
        .args(STANDARD)
        .args(["--features", if count { "instructions,count" } else { "instructions" }])
        .env("RUSTC_BOOTSTRAP", "1")
        .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", FLAGS)
        .current_dir(own);
    run(cargo, "the error is above")?;
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| own.join("../target"), PathBuf::from);
    Ok(target.join(TARGET).join("wasm/muslin_wasm.wasm"))
}

/// Writes the module in the form that pages load, and `muslin_wasm.js`, which loads it.
fn bind(module: &Path, to: &Path) -> Result<(), String> {
    let failed = |why: anyhow::Error| format!("{}: {why:#}", module.display());
    let mut bindgen = Bindgen::new();
    bindgen.input_path(module).web(true).map_err(failed)?;
    bindgen.omit_default_module_path(false).typescript(true).remove_name_section(true).remove_producers_section(true);
    let mut output = bindgen.generate_output().map_err(failed)?;
    // Nobody reads this section after linking.
    output.wasm_mut().customs.remove_raw("target_features");
    let names = shorten(&mut output);
    output.emit(to).map_err(failed)?;
    let script = to.join("muslin_wasm.js");
    let told = |why| format!("{}: {why}", script.display());
    let text = fs::read_to_string(&script).map_err(told)?;
    let text = names.iter().fold(text, |text, (long, short)| text.replace(long, short));
    fs::write(&script, text).map_err(told)
}

/// Shortens the names of imports and exports in the module, and returns the replacements for the script. The two
/// hundred imports have names of fifty letters, in the module and in the script; exported closures have longer ones.
fn shorten(output: &mut Output) -> Vec<(String, String)> {
    let module = output.wasm_mut();
    let imports = module.imports.iter_mut().filter(|import| import.name.starts_with("__wb"));
    let imports = imports.enumerate().map(|(k, import)| {
        let short = format!("i{k}");
        let long = std::mem::replace(&mut import.name, short.clone());
        (format!("{long}: function"), format!("{short}: function"))
    });
    let exports = module.exports.iter_mut().filter(|export| export.name.starts_with("wasm_bindgen_"));
    let exports = exports.enumerate().map(|(k, export)| {
        let short = format!("e{k}");
        let long = std::mem::replace(&mut export.name, short.clone());
        (format!("wasm.{long}("), format!("wasm.{short}("))
    });
    imports.chain(exports).collect()
}

/// Passes over the linked module. Together they save 8 kB of 252 kB gzipped; higher levels make it larger. Alignments
/// are hints that engines ignore.
const PASSES: [&str; 9] = [
    "-O1",
    "--rse",
    "--duplicate-function-elimination",
    "-O1",
    "--rse",
    "--dae-optimizing",
    "-O1",
    "--duplicate-function-elimination",
    "--dealign",
];

/// Features of WebAssembly that the module uses.
const FEATURES: [&str; 7] = [
    "--enable-simd",
    "--enable-bulk-memory",
    "--enable-sign-ext",
    "--enable-mutable-globals",
    "--enable-nontrapping-float-to-int",
    "--enable-reference-types",
    "--enable-multivalue",
];

/// Shrinks a module in place.
fn shrink(own: &Path, module: &Path) -> Result<(), String> {
    let mut optimizer = Command::new(own.join("node_modules/.bin/wasm-opt"));
    optimizer.args(FEATURES).args(PASSES).arg(module).arg("-o").arg(module);
    run(optimizer, "remove host-wasm/node_modules and try again")
}

/// Writes the types of scenes, which are made from the types that read them.
fn write_scene_types(own: &Path, web: &Path) -> Result<(), String> {
    let (schema, types) = (web.join("scene.schema.json"), web.join("scene_types.d.ts"));
    let text = serde_json::to_string(&muslin_core::scene::schema()).map_err(|why| why.to_string())?;
    fs::write(&schema, text).map_err(|why| format!("{}: {why}", schema.display()))?;
    let mut json2ts = Command::new(own.join("node_modules/.bin/json2ts"));
    json2ts
        .args(["--bannerComment", "// The keys of a scene file, by json-schema-to-typescript from the core's types."]);
    json2ts.arg(&schema).arg(&types);
    run(json2ts, "remove host-wasm/node_modules and try again")?;
    fs::remove_file(&schema).map_err(|why| format!("{}: {why}", schema.display()))
}

/// Checks the types of the package and writes its declarations.
fn declare(own: &Path, to: &Path) -> Result<(), String> {
    let mut tsc = Command::new(own.join("node_modules/.bin/tsc"));
    tsc.arg("--project").arg(own).arg("--outDir").arg(to);
    run(tsc, "the types of host-wasm/web do not fit")
}

/// Removes the address of the module from the bundle that has the module inside it.
fn without_address(bundle: &Path) -> Result<(), String> {
    let told = |why| format!("{}: {why}", bundle.display());
    let text = fs::read_to_string(bundle).map_err(told)?;
    if text.matches(ADDRESS).count() != 1 {
        return Err(format!("{}: expected {ADDRESS} once", bundle.display()));
    }
    fs::write(bundle, text.replace(ADDRESS, "undefined")).map_err(told)
}

/// Bundles a file and all its imports into one file. A page's import of the package itself stays an import.
fn bundle(own: &Path, entry: &Path, to: &Path) -> Result<(), String> {
    let mut esbuild = Command::new(own.join("node_modules/.bin/esbuild"));
    esbuild
        .arg(entry)
        .args([
            "--bundle",
            "--minify",
            "--format=esm",
            "--target=es2022",
            "--log-level=warning",
            "--legal-comments=external",
            "--loader:.wasm=binary",
        ])
        .args(["--external:../muslin.js"])
        .arg(format!("--outfile={}", to.display()));
    run(esbuild, "remove host-wasm/node_modules and try again")
}

fn run(mut command: Command, hint: &str) -> Result<(), String> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{} failed ({status}); {hint}", command.get_program().display())),
        Err(why) => Err(format!("{}: {why}; {hint}", command.get_program().display())),
    }
}
