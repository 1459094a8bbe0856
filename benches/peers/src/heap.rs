//! Heap: how much memory this process has asked for and not given back, in whatever language.
#![cfg_attr(target_env = "gnu", allow(unsafe_code, reason = "mallinfo2 is C"))]

/// Bytes; none where the C library does not tell (it is glibc that does).
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub(crate) fn in_use() -> Option<u64> {
    // SAFETY: reads the allocator's own books under its locks.
    let info = unsafe { libc::mallinfo2() };
    Some((info.uordblks + info.hblkhd) as u64)
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub(crate) fn in_use() -> Option<u64> {
    None
}

#[cfg(test)]
mod tests {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    #[test]
    fn what_is_held_is_counted() {
        let before = super::in_use().unwrap();
        // Small pieces and one that gets pages of its own. Other tests run beside this one.
        let held: Vec<Vec<u8>> = (0..1000).map(|_| vec![1; 10_000]).chain([vec![1; 1 << 26]]).collect();
        let with = super::in_use().unwrap();
        assert!(with - before > 70_000_000 && with - before < 120_000_000, "{}", with - before);
        drop(held);
    }
}
