//! Format in which the host hands over data: plain memory with a fixed layout, little-endian.

/// Slice that the host has laid at an address.
///
/// # Safety
/// `count` valid and aligned values lie there, and nothing else uses them during the call. The host
/// writes them before the call, to memory that the image leaves alone.
pub unsafe fn slice<'a, T>(address: *const T, count: usize) -> &'a [T] {
    // SAFETY: the caller keeps the rule above.
    unsafe { core::slice::from_raw_parts(address, count) }
}
