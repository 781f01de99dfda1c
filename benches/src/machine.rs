//! What machine this is.

use std::path::Path;
use std::process::Command;

use crate::report::Machine;

/// Describes the machine, as far as the system tells.
pub(crate) fn describe(threads: usize) -> Machine {
    let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    Machine {
        processor: processor(&information)
            .unwrap_or("unknown processor")
            .to_owned(),
        threads,
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        compiler: env!("TAHKO_BENCH_COMPILER").to_owned(),
        version: version(),
    }
}

/// The model name in the format of Linux.
fn processor(information: &str) -> Option<&str> {
    let mut lines = information.lines();
    let line = lines.find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim())
}

/// The version, and the commit where the sources are under git.
fn version() -> String {
    let version = env!("CARGO_PKG_VERSION");
    let output = Command::new("git")
        .args(["describe", "--always", "--dirty"])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")))
        .output();
    match output {
        Ok(output) if output.status.success() => {
            format!(
                "{version} ({})",
                String::from_utf8_lossy(&output.stdout).trim()
            )
        }
        _ => version.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_is_the_first_model_name() {
        let information = "processor\t: 0\nmodel name\t: Some CPU: 3 GHz\n\nmodel name\t: Other\n";
        assert_eq!(processor(information), Some("Some CPU: 3 GHz"));
        assert_eq!(processor(""), None);
    }
}
