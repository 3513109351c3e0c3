//! `muslin`: the command-line host.
#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    muslin_cli::main()
}
