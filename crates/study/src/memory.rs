//! Peak memory of the program since the last reset, where Linux reports it.

use std::fs;

/// Resets the peak. Has no effect on other systems, where no peak is reported later.
pub(crate) fn reset_peak() {
    // 5 resets the high-water mark (proc(5)).
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Peak resident memory since the reset, MiB; `None` if the system does not report it.
pub(crate) fn peak_mib() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes / 1024.0)
}
