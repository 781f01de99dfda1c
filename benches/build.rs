//! Tells the program which compiler made it: figures without that mean little.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=RUSTC");
    println!("cargo::rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");
    let version = env::var_os("RUSTC").and_then(|rustc| {
        let output = Command::new(rustc).arg("--version").output().ok()?;
        String::from_utf8(output.stdout).ok()
    });
    let version = version.as_deref().map_or("an unknown compiler", str::trim);
    let flags = env::var("CARGO_ENCODED_RUSTFLAGS")
        .unwrap_or_default()
        .replace('\u{1f}', " ");
    let compiler = format!("{version} {flags}");
    println!("cargo::rustc-env=TAHKO_BENCH_COMPILER={}", compiler.trim());
}
