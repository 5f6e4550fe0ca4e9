//! Ctrl-C: the program ends with code 130, but first puts its files in order. A second one ends it at once.

/// Installs what happens on Ctrl-C. Where there are no signals it just ends the program.
///
/// # Errors
/// The operating system refuses.
pub(crate) fn install() -> std::io::Result<()> {
    #[cfg(unix)]
    unix::install()?;
    Ok(())
}

/// Waits for the end, if Ctrl-C came before: then it must not be missed because the command was just as quick.
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

    /// Set by the signal itself, on whatever thread.
    static INTERRUPTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

    pub(super) fn install() -> std::io::Result<()> {
        let interrupted = || Arc::clone(&INTERRUPTED);
        // In this order: the first signal sets the flag, the second finds it set.
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
