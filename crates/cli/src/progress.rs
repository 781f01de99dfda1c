//! A progress line on terminals, and nothing anywhere else.

use std::io::{IsTerminal, stderr};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::terminal::printable;

/// How often the line is drawn.
const INTERVAL: Duration = Duration::from_millis(100);

/// The progress line; clones show the same line.
#[derive(Clone, Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    pub(crate) fn new(quiet: bool) -> Self {
        let is_dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let bar = if quiet || is_dumb || !stderr().is_terminal() {
            ProgressBar::hidden()
        } else {
            ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr())
        };
        Self { bar }
    }

    /// Shows that something of unknown length is going on.
    pub(crate) fn phase(&self, name: &str) {
        self.bar.unset_length();
        self.start("{spinner} {msg} {elapsed}", name);
    }

    /// Shows how much of `total` is done, and the time left.
    pub(crate) fn count(&self, name: &str, total: u64) {
        let template = "{msg} [{bar:40}] {percent}% {elapsed}, {eta} left";
        self.bar.set_length(total);
        self.start(template, name);
    }

    /// Shows what is going on, without starting anew.
    pub(crate) fn rename(&self, name: &str) {
        self.bar.set_message(printable(name));
    }

    /// Sets how much is done.
    pub(crate) fn set(&self, position: u64) {
        self.bar.set_position(position);
    }

    /// Does some work and asks meanwhile, from another thread, how much of it is done.
    pub(crate) fn watch<T>(
        &self,
        position: impl Fn() -> u64 + Send,
        work: impl FnOnce() -> T,
    ) -> T {
        if self.bar.is_hidden() {
            return work();
        }
        thread::scope(|scope| {
            let (running, ended) = mpsc::channel::<()>();
            scope.spawn(move || {
                while ended.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                    self.set(position());
                }
            });
            let result = work();
            drop(running);
            result
        })
    }

    /// Takes the line away while something else is printed.
    pub(crate) fn suspend(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    /// Takes the line away.
    pub(crate) fn clear(&self) {
        self.bar.disable_steady_tick();
        self.bar.finish_and_clear();
    }

    fn start(&self, template: &str, message: &str) {
        let style = ProgressStyle::with_template(template).expect("the template is valid");
        self.bar.set_style(style.progress_chars("=> "));
        self.bar.set_message(printable(message));
        self.bar.reset();
        self.bar.enable_steady_tick(INTERVAL);
    }
}
