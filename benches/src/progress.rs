//! What is being done and how long it still takes, on stderr.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A line for each phase and, on a terminal, a bar with the time left below.
pub(crate) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    pub(crate) fn new() -> Self {
        let template = "[{bar:40}] {percent}% {elapsed}, {eta} left";
        let style = ProgressStyle::with_template(template).expect("the template is valid");
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        bar.set_style(style.progress_chars("=> "));
        Self { bar }
    }

    /// Begins work of a number of units.
    pub(crate) fn begin(&self, units: u64) {
        self.bar.set_length(units);
        self.bar.enable_steady_tick(Duration::from_millis(200));
    }

    /// One more unit is done.
    pub(crate) fn advance(&self) {
        self.bar.inc(1);
    }

    /// Says how many units are done.
    pub(crate) fn set(&self, units: u64) {
        self.bar.set_position(units);
    }

    /// Says what is done next.
    pub(crate) fn say(&self, what: &str) {
        self.say_that(&format!("measuring {what} ..."));
    }

    /// Says something above the bar.
    pub(crate) fn say_that(&self, what: &str) {
        self.bar.suspend(|| eprintln!("{what}"));
    }

    /// Takes the bar away.
    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }
}
