//! Turns the sources of `muslin-core` into their double-precision twin.
fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-cfg=double");
}
