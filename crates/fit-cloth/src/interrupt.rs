//! Handling of Ctrl-C: the program tidies up its files and exits with code 130. A second Ctrl-C exits at once.

/// Installs the Ctrl-C handler. On systems without signals, Ctrl-C just ends the program.
///
/// # Errors
/// The operating system refuses the handler.
pub(crate) fn install() -> std::io::Result<()> {
    #[cfg(unix)]
    unix::install()?;
    Ok(())
}

/// Blocks until exit if Ctrl-C was pressed, so that a command finishing at the same moment does not hide the interrupt.
pub(crate) fn settle() {
    #[cfg(unix)]
    unix::settle();
}

#[cfg(unix)]
mod unix {
    use signal_hook::consts::SIGINT;
    use signal_hook::flag;
    use signal_hook::iterator::Signals;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{Arc, LazyLock};

    const EXIT_CODE: i32 = 130;

    /// Set by the signal handler, on any thread.
    static INTERRUPTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

    pub(super) fn install() -> std::io::Result<()> {
        let interrupted = || Arc::clone(&INTERRUPTED);
        // Order matters: the first signal sets the flag, the second finds it set and exits.
        flag::register_conditional_shutdown(SIGINT, EXIT_CODE, interrupted())?;
        flag::register(SIGINT, interrupted())?;
        let mut signals = Signals::new([SIGINT])?;
        std::thread::Builder::new().name("interrupt".into()).spawn(move || {
            if signals.forever().next().is_some() {
                crate::output::end(EXIT_CODE);
            }
        })?;
        Ok(())
    }

    pub(super) fn settle() {
        while INTERRUPTED.load(Ordering::SeqCst) {
            std::thread::park();
        }
    }
}
