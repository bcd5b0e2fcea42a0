//! A queue from one interrupt to one task, of which neither waits for the other.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};

/// Room for `N` items, a power of two. (`heapless` has one too, whose length is known at run time only: its remainder by that length could panic, and
/// nothing in the audio path may.)
pub struct Queue<T, const N: usize> {
    items: [UnsafeCell<MaybeUninit<T>>; N],
    /// Items pushed and taken so far, modulo 2^32.
    pushed: AtomicU32,
    taken: AtomicU32,
}

// SAFETY: an item belongs to whoever pushes until `pushed` has been stored, and to whoever takes until `taken` has been; there is one of each.
unsafe impl<T: Send, const N: usize> Sync for Queue<T, N> {}

impl<T: Copy, const N: usize> Queue<T, N> {
    /// An empty queue.
    pub const fn new() -> Self {
        assert!(N.is_power_of_two());
        Self {
            items: [const { UnsafeCell::new(MaybeUninit::uninit()) }; N],
            pushed: AtomicU32::new(0),
            taken: AtomicU32::new(0),
        }
    }

    /// Appends an item; `false` where there is no room.
    ///
    /// # Safety
    /// Called from one context only.
    pub unsafe fn push(&self, item: T) -> bool {
        let pushed = self.pushed.load(Ordering::Relaxed);
        if pushed.wrapping_sub(self.taken.load(Ordering::Acquire)) as usize >= N {
            return false;
        }
        let Some(place) = self.items.get(pushed as usize % N) else { return false };
        // SAFETY: the place is free, and nobody else fills it.
        unsafe { (*place.get()).write(item) };
        self.pushed.store(pushed.wrapping_add(1), Ordering::Release);
        true
    }

    /// Takes the oldest item.
    ///
    /// # Safety
    /// Called from one context only.
    pub unsafe fn take(&self) -> Option<T> {
        let taken = self.taken.load(Ordering::Relaxed);
        if self.pushed.load(Ordering::Acquire) == taken {
            return None;
        }
        let place = self.items.get(taken as usize % N)?;
        // SAFETY: the place was filled before `pushed` was stored.
        let item = unsafe { (*place.get()).assume_init() };
        self.taken.store(taken.wrapping_add(1), Ordering::Release);
        Some(item)
    }
}

impl<T: Copy, const N: usize> Default for Queue<T, N> {
    fn default() -> Self {
        Self::new()
    }
}
