//! Ctrl-C: ends the program at once, but never between the beginning and the end of an output file.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use anyhow::{Result, anyhow};

use crate::progress::Progress;

/// The exit code after Ctrl-C: 128 plus the number of the signal.
pub(crate) const EXIT_CODE: u8 = 130;

static REQUESTED: AtomicBool = AtomicBool::new(false);
static WRITING: Mutex<()> = Mutex::new(());

/// From now on, Ctrl-C takes the progress line away and ends the program.
pub(crate) fn install(progress: Progress) -> Result<()> {
    ctrlc::set_handler(move || {
        REQUESTED.store(true, Ordering::Relaxed);
        let _nobody_writes = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
        progress.clear();
        process::exit(EXIT_CODE.into());
    })
    .map_err(|source| anyhow!("cannot listen to Ctrl-C: {source}"))
}

/// Whether Ctrl-C was pressed. Then long [`shielded`] work should end soon.
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// Does work that Ctrl-C has to wait for: the writing of a file, from the moment it has a temporary name.
pub(crate) fn shielded<T>(write: impl FnOnce() -> T) -> T {
    let _writing = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    write()
}
