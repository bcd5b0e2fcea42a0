//! Queue from one interrupt to one task, in which neither waits for the other.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};

/// Queue of at most `N` items, a power of two.
///
/// It stands in for the queue of `heapless`, whose length is known only at run time: a remainder by
/// that length could panic, and nothing in the audio path may.
pub struct Queue<T, const N: usize> {
    items: [UnsafeCell<MaybeUninit<T>>; N],
    /// Number of items pushed so far, modulo 2^32.
    pushed: AtomicU32,
    /// Number of items taken so far, modulo 2^32.
    taken: AtomicU32,
}

// SAFETY: an item belongs to the one producer until `pushed` is stored, and then to the one
// consumer until `taken` is stored.
unsafe impl<T: Send, const N: usize> Sync for Queue<T, N> {}

impl<T: Copy, const N: usize> Queue<T, N> {
    /// Makes an empty queue.
    pub const fn new() -> Self {
        assert!(N.is_power_of_two());
        Self {
            items: [const { UnsafeCell::new(MaybeUninit::uninit()) }; N],
            pushed: AtomicU32::new(0),
            taken: AtomicU32::new(0),
        }
    }

    /// Appends an item; returns `false` if the queue is full.
    ///
    /// # Safety
    /// One context alone calls this.
    pub unsafe fn push(&self, item: T) -> bool {
        let pushed = self.pushed.load(Ordering::Relaxed);
        if pushed.wrapping_sub(self.taken.load(Ordering::Acquire)) as usize >= N {
            return false;
        }
        let Some(place) = self.items.get(pushed as usize % N) else { return false };
        // SAFETY: the place is free, and the one producer fills it.
        unsafe { (*place.get()).write(item) };
        self.pushed.store(pushed.wrapping_add(1), Ordering::Release);
        true
    }

    /// Removes and returns the oldest item, or `None` if the queue is empty.
    ///
    /// # Safety
    /// One context alone calls this.
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
