//! The progress line on standard error, shown only on a terminal.

use cloth_fit::equilibria::Meter;
use cloth_fit::stage::{Event, Watch};
use indicatif::{ProgressBar, ProgressStyle, WeakProgressBar};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// The line on screen.
static SHOWN: Mutex<Option<WeakProgressBar>> = Mutex::new(None);

/// Removes the line on screen, if any.
#[cfg(unix)]
pub(crate) fn clear() {
    let shown = SHOWN.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(bar) = shown.and_then(|bar| bar.upgrade()) {
        bar.finish_and_clear();
    }
}

/// Shows a line and starts its spinner.
fn show(bar: &ProgressBar) {
    bar.enable_steady_tick(Duration::from_millis(100));
    *SHOWN.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.downgrade());
}

/// A progress line that counts steps.
pub struct StepBar {
    bar: ProgressBar,
}

impl StepBar {
    /// Starts a line.
    pub fn new(what: &str, visible: bool) -> Self {
        let bar = if visible { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
        let style = ProgressStyle::with_template("{spinner} {prefix}: {msg} [{elapsed}]");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        bar.set_prefix(what.to_string());
        show(&bar);
        Self { bar }
    }

    /// Shows the number of the last step, and the total if known.
    pub fn at(&self, step: usize, steps: Option<usize>) {
        self.bar.set_message(match steps {
            Some(steps) => format!("step {step} of {steps}"),
            None => format!("step {step}"),
        });
    }

    /// Removes the line.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}

/// A progress line for a fit, a validation, a study or a rig run.
pub struct Progress {
    bar: ProgressBar,
    meter: Arc<Meter>,
}

impl Progress {
    /// Starts a line.
    pub fn new(what: &str, visible: bool) -> Self {
        let meter: Arc<Meter> = Arc::default();
        let bar = if visible { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
        let seen = Arc::clone(&meter);
        let style = ProgressStyle::with_template("{spinner} {prefix}{msg}, {solved} [{elapsed}]")
            .unwrap_or_else(|_| ProgressStyle::default_spinner())
            .with_key("solved", move |_: &indicatif::ProgressState, text: &mut dyn std::fmt::Write| {
                let _ = write!(text, "{} equilibria", seen.read().equilibria);
            });
        bar.set_style(style);
        bar.set_prefix(what.to_string());
        show(&bar);
        Self { bar, meter }
    }

    /// The watch that a fit reports its progress to.
    pub fn watch(&self) -> Watch<'_> {
        let mut level = String::new();
        let mut tried = 0;
        Watch {
            meter: Arc::clone(&self.meter),
            observe: Box::new(move |event| {
                let message = match event {
                    Event::Level { component, points } => {
                        tried = 0;
                        level = format!(", {component}: {points} control points");
                        level.clone()
                    }
                    Event::Iteration { rms, .. } => {
                        tried += 1;
                        format!("{level}, iteration {tried}, residual {rms:.3e}")
                    }
                };
                self.bar.set_message(message);
            }),
        }
    }

    /// Removes the line.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}

impl cloth_study::progress::Progress for Progress {
    fn note(&self, what: &str) {
        self.bar.set_message(format!(": {what}"));
    }

    fn meter(&self) -> Arc<Meter> {
        Arc::clone(&self.meter)
    }
}
