//! Memory in huge pages, where the system gives them to those who ask.
//!
//! A ray in a tree larger than the caches meets other pages at every step, and the processor knows only so many. Pages of 2 MiB in place
//! of 4 KiB spare it most of the looking up.
#![allow(unsafe_code, reason = "advice to the system about memory")]

/// Lists below this size, in bytes, stay in ordinary pages.
const WORTH_IT: usize = 4 << 20;

/// An empty list with room for `count` values, in huge pages if it is large and the system has them.
pub(crate) fn with_capacity<T>(count: usize) -> Vec<T> {
    let list: Vec<T> = Vec::with_capacity(count);
    let bytes = list.capacity() * size_of::<T>();
    if bytes >= WORTH_IT {
        advise(list.as_ptr().cast(), bytes);
    }
    list
}

#[cfg(target_os = "linux")]
fn advise(start: *const u8, bytes: usize) {
    use rustix::mm::{Advice, madvise};
    const PAGE: usize = 4096;
    // Whole pages only.
    let skipped = start.align_offset(PAGE).min(bytes);
    let length = (bytes - skipped) / PAGE * PAGE;
    let start = start.wrapping_add(skipped).cast_mut().cast();
    // SAFETY: the range lies within one allocation, and this advice changes nothing but the size of its pages.
    let advised = unsafe { madvise(start, length, Advice::LinuxHugepage) };
    // Where the system has no huge pages, or pages of other sizes, the memory is as good as any.
    let (Ok(()) | Err(_)) = advised;
}

#[cfg(not(target_os = "linux"))]
fn advise(_start: *const u8, _bytes: usize) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_any_size_have_room() {
        for count in [0, 1, 1000, WORTH_IT / 8, WORTH_IT / 8 + 12_345] {
            let mut list = with_capacity::<u64>(count);
            assert!(list.capacity() >= count, "{count}");
            list.extend(0..count as u64);
            assert!(list.iter().copied().eq(0..count as u64), "{count}");
        }
    }
}
