//! A static that belongs to one interrupt.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

/// Memory that `main` fills before it lets an interrupt come, and that the interrupt's handler has to itself from then on.
///
/// In a `static` it may lie where nothing is set up at start: it is not read before it is filled.
pub struct Owned<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: `fill` and `get` are unsafe and ask for one user at a time.
unsafe impl<T> Sync for Owned<T> {}

impl<T> Owned<T> {
    /// Empty.
    pub const fn empty() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }

    /// Fills the memory and hands it out.
    ///
    /// # Safety
    /// Nobody uses the contents, now or while the reference lives.
    #[expect(clippy::mut_from_ref, reason = "the caller promises to be alone")]
    #[inline(always)] // so that what is large is made in its place, not on the stack
    pub unsafe fn fill(&self, value: T) -> &mut T {
        // SAFETY: the caller's word.
        unsafe { (*self.0.get()).write(value) }
    }

    /// The contents.
    ///
    /// # Safety
    /// It has been filled, and nobody else uses the contents while the reference lives.
    #[expect(clippy::mut_from_ref, reason = "the caller promises to be alone")]
    pub unsafe fn get(&self) -> &mut T {
        // SAFETY: the caller's word.
        unsafe { (*self.0.get()).assume_init_mut() }
    }
}

impl<T, const COUNT: usize> Owned<[T; COUNT]> {
    /// As [`Owned::fill`], one after the other: what all of them are like lies in flash once.
    ///
    /// # Safety
    /// As [`Owned::fill`].
    #[expect(clippy::mut_from_ref, reason = "the caller promises to be alone")]
    #[inline(always)] // so that each is made in its place, not on the stack
    pub unsafe fn fill_each(&self, value: impl Fn() -> T) -> &mut [T; COUNT] {
        // SAFETY: the caller's word.
        let memory = unsafe { &mut *self.0.get() };
        for index in 0..COUNT {
            // SAFETY: the index is within the array.
            unsafe { memory.as_mut_ptr().cast::<T>().add(index).write(value()) };
        }
        // SAFETY: all of them have just been written.
        unsafe { memory.assume_init_mut() }
    }
}
