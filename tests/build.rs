//! Whether tests that need a graphics adapter are run or reported as ignored: `gpu` is set where a driver
//! is installed, or one is required. Whether it works only those tests can tell. For both packages of tests.

use std::path::Path;

/// Where Linux looks for Vulkan drivers.
const DRIVERS: [&str; 3] = ["/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"];

/// Variables that name drivers elsewhere, or ask for one.
const VARIABLES: [&str; 3] = ["MUSLIN_REQUIRE_GPU", "VK_DRIVER_FILES", "VK_ICD_FILENAMES"];

fn main() {
    println!("cargo::rustc-check-cfg=cfg(gpu)");
    VARIABLES.iter().for_each(|name| println!("cargo::rerun-if-env-changed={name}"));
    // What is not there would be looked at again each time.
    let folders = || DRIVERS.iter().filter(|folder| Path::new(folder).is_dir());
    folders().for_each(|folder| println!("cargo::rerun-if-changed={folder}"));
    let holds_one = |folder: &&str| std::fs::read_dir(folder).is_ok_and(|mut files| files.next().is_some());
    let is_named = VARIABLES.iter().any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()));
    if !cfg!(target_os = "linux") || is_named || folders().any(holds_one) {
        println!("cargo::rustc-cfg=gpu");
    }
}
