//! How the host hands things over: plain memory with a fixed layout, little-endian.

/// A slice that the host has laid at an address.
///
/// # Safety
/// `count` valid values lie there, aligned, and nothing else uses them during the call: the host
/// writes them before it, to memory that the image leaves alone.
pub unsafe fn slice<'a, T>(address: *const T, count: usize) -> &'a [T] {
    // SAFETY: the caller's.
    unsafe { core::slice::from_raw_parts(address, count) }
}
