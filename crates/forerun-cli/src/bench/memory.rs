//! Memory of this process, where the system tells it (Linux).

use std::fs;

/// Lets the peak start again from what is in use now, so that scenes measured before do not count.
pub(crate) fn restart_peak() {
    // A system without this file has no peak to tell either, or one that counts from the start of the program.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Most memory that was resident since the peak was restarted. Bytes.
pub(crate) fn peak_bytes() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}
