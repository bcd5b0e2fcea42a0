//! Static memory that belongs to one interrupt.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

/// Memory that `main` fills before it enables an interrupt, whose handler alone uses it afterwards.
///
/// It is not read before it is filled, so a `static` of it may lie in memory that is not
/// initialised at the start.
pub struct Owned<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: `fill` and `get` are unsafe and ask for one user at a time. The user is an interrupt, and
// another fills the memory, so the content must be `Send`.
unsafe impl<T: Send> Sync for Owned<T> {}

impl<T> Owned<T> {
    /// Makes empty memory.
    pub const fn empty() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }

    /// Fills the memory and returns its content.
    ///
    /// # Safety
    /// Nothing else uses the content, now or while the reference lives.
    // Inlined, it lets a large value be made in place instead of on the stack.
    #[expect(clippy::mut_from_ref, reason = "the caller promises to be alone")]
    #[inline(always)]
    pub unsafe fn fill(&self, value: T) -> &mut T {
        // SAFETY: the caller promises to be alone.
        unsafe { (*self.0.get()).write(value) }
    }

    /// Returns the content.
    ///
    /// # Safety
    /// The memory has been filled, and nothing else uses the content while the reference lives.
    #[expect(clippy::mut_from_ref, reason = "the caller promises to be alone")]
    pub unsafe fn get(&self) -> &mut T {
        // SAFETY: the caller promises to be alone.
        unsafe { (*self.0.get()).assume_init_mut() }
    }
}

impl<T: Copy, const COUNT: usize> Owned<[MaybeUninit<T>; COUNT]> {
    /// Returns the memory as it is, whose words may be uninitialised.
    ///
    /// # Safety
    /// Nothing else uses the memory, now or while the reference lives.
    #[expect(clippy::mut_from_ref, reason = "the caller promises to be alone")]
    pub unsafe fn lend(&self) -> &mut [MaybeUninit<T>; COUNT] {
        // SAFETY: the caller promises to be alone; `MaybeUninit` words need no initialisation.
        unsafe { (*self.0.get()).assume_init_mut() }
    }
}
