//! The largest memory that the program has held since it was last asked, where Linux tells it.

use std::fs;

/// Forgets the largest so far. Where the system knows no such thing, nothing happens, and nothing is told later.
pub(crate) fn reset_peak() {
    // 5 resets the high-water mark (proc(5)).
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Largest resident memory since then, MiB; `None` where the system does not tell.
pub(crate) fn peak_mib() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes / 1024.0)
}
