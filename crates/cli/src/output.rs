//! Outputs: files are checked before any work is done, and written whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Error, Result, anyhow, bail};
use tahko_tracer::write_atomically;

use crate::interrupt;

/// Checks that a file can be written in its folder, and that it is none of the `others`, which the same command
/// reads or writes. Leaves no file in the folder.
pub(crate) fn check(path: &Path, others: &[&Path]) -> Result<()> {
    let name = path.display();
    if path.metadata().is_ok_and(|metadata| !metadata.is_file()) {
        bail!("{name}: exists and is not a regular file");
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        bail!("{name}: there is no folder '{}'", folder.display());
    }
    if others.iter().any(|other| resolve(path) == resolve(other)) {
        bail!("{name}: the same file is given for two purposes");
    }
    // Whether a folder can be written is known best by writing: the file has no name, or loses it at once.
    interrupt::shielded(|| tempfile::tempfile_in(folder)).map_err(|source| {
        let folder = folder.display();
        anyhow!("{name}: the folder '{folder}' cannot be written: {source}")
    })?;
    Ok(())
}

/// Writes a file, whole or not at all. An [`io::Error`] of `write` is taken to be about this file.
pub(crate) fn write_file<T>(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<T>,
) -> Result<T> {
    let mut outcome = None;
    let written = interrupt::shielded(|| {
        write_atomically(path, |writer| {
            let outcome = outcome.insert(write(writer));
            match outcome {
                Ok(_) => Ok(()),
                Err(_) => Err(io::Error::other("the contents are incomplete")),
            }
        })
    });
    let named = |source: io::Error| anyhow!("{}: {source}", path.display());
    match (outcome, written) {
        (Some(Err(error)), _) => Err(error
            .downcast::<io::Error>()
            .map_or_else(|other| other, named)),
        (_, Err(source)) => Err(named(source)),
        (Some(Ok(value)), Ok(())) => Ok(value),
        (None, Ok(())) => unreachable!("what was written came from `write`"),
    }
}

/// Writes to standard output. An [`io::Error`] of `write` is taken to be about it.
pub(crate) fn write_stdout<T>(write: impl FnOnce(&mut dyn Write) -> Result<T>) -> Result<T> {
    let mut writer = BufWriter::new(io::stdout().lock());
    let outcome = write(&mut writer).and_then(|value| {
        writer.flush()?;
        Ok(value)
    });
    outcome.map_err(|error| match error.downcast::<io::Error>() {
        Ok(source) => {
            let message = format!("standard output: {source}");
            Error::new(source).context(message)
        }
        Err(other) => other,
    })
}

/// Whether an error says that the reader of standard output has gone.
pub(crate) fn is_closed_pipe(error: &Error) -> bool {
    let io_error = error.downcast_ref::<io::Error>();
    io_error.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// The path with links resolved, as far as it exists.
fn resolve(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let folder = folder_of(path).canonicalize();
        folder.map_or_else(
            |_| path.to_owned(),
            |folder| folder.join(path.file_name().unwrap_or_default()),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_leaves_nothing_and_names_what_is_missing() {
        let folder = tempfile::tempdir().unwrap();
        check(&folder.path().join("a.png"), &[]).unwrap();
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
        let error = check(&folder.path().join("none/a.png"), &[]).unwrap_err();
        assert!(error.to_string().contains("there is no folder"), "{error}");
        let error = check(folder.path(), &[]).unwrap_err();
        assert!(error.to_string().contains("not a regular file"), "{error}");
    }

    #[test]
    fn different_spellings_of_one_file_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let (path, other) = (folder.path().join("a"), folder.path().join("b"));
        std::fs::create_dir(folder.path().join("sub")).unwrap();
        let same = folder.path().join("sub/../a");
        check(&path, &[&other]).unwrap();
        check(&path, &[&other, &same]).unwrap_err();
        std::fs::write(&path, "").unwrap();
        check(&same, &[&path]).unwrap_err();
    }

    #[test]
    fn the_reason_of_incomplete_contents_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let error = write_file(&path, |_| -> Result<()> { bail!("line 3 is wrong") });
        assert_eq!(error.unwrap_err().to_string(), "line 3 is wrong");
        let full = || io::Error::other("disk full");
        let error = write_file(&path, |_| -> Result<()> { Err(full().into()) });
        let message = format!("{}: disk full", path.display());
        assert_eq!(error.unwrap_err().to_string(), message);
        assert!(!path.exists(), "nothing was written");
    }

    #[test]
    fn a_closed_pipe_is_told_from_a_full_disk() {
        let error = |kind| write_stdout(|_| -> Result<()> { Err(io::Error::from(kind).into()) });
        let error = |kind| error(kind).unwrap_err();
        assert!(is_closed_pipe(&error(io::ErrorKind::BrokenPipe)), "closed");
        assert!(!is_closed_pipe(&error(io::ErrorKind::StorageFull)), "full");
    }
}
