//! Queue from one interrupt to one task, in which neither waits for the other.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

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
    is_split: AtomicBool,
}

/// End of a queue at which items are appended. Each queue has one.
pub struct Sender<T: 'static, const N: usize>(&'static Queue<T, N>);

/// End of a queue at which items are removed. Each queue has one.
pub struct Receiver<T: 'static, const N: usize>(&'static Queue<T, N>);

// SAFETY: an item belongs to the one sender until `pushed` is stored, and then to the one receiver
// until `taken` is stored.
unsafe impl<T: Send, const N: usize> Sync for Queue<T, N> {}

impl<T: Copy, const N: usize> Queue<T, N> {
    /// Makes an empty queue.
    pub const fn new() -> Self {
        assert!(N.is_power_of_two());
        Self {
            items: [const { UnsafeCell::new(MaybeUninit::uninit()) }; N],
            pushed: AtomicU32::new(0),
            taken: AtomicU32::new(0),
            is_split: AtomicBool::new(false),
        }
    }

    /// Gives both ends of the queue, or `None` if it has been split before.
    pub fn split(&'static self) -> Option<(Sender<T, N>, Receiver<T, N>)> {
        (!self.is_split.swap(true, Ordering::Relaxed)).then_some((Sender(self), Receiver(self)))
    }
}

impl<T: Copy, const N: usize> Sender<T, N> {
    /// Appends an item; returns `false` if the queue is full.
    pub fn push(&mut self, item: T) -> bool {
        let queue = self.0;
        let pushed = queue.pushed.load(Ordering::Relaxed);
        if pushed.wrapping_sub(queue.taken.load(Ordering::Acquire)) as usize >= N {
            return false;
        }
        let Some(place) = queue.items.get(pushed as usize % N) else { return false };
        // SAFETY: the place is free, and the one sender fills it.
        unsafe { (*place.get()).write(item) };
        queue.pushed.store(pushed.wrapping_add(1), Ordering::Release);
        true
    }
}

impl<T: Copy, const N: usize> Receiver<T, N> {
    /// Returns true if no item waits.
    pub fn is_empty(&self) -> bool {
        self.0.pushed.load(Ordering::Relaxed) == self.0.taken.load(Ordering::Relaxed)
    }

    /// Removes and returns the oldest item, or `None` if the queue is empty.
    pub fn take(&mut self) -> Option<T> {
        let queue = self.0;
        let taken = queue.taken.load(Ordering::Relaxed);
        if queue.pushed.load(Ordering::Acquire) == taken {
            return None;
        }
        let place = queue.items.get(taken as usize % N)?;
        // SAFETY: the place was filled before `pushed` was stored, and the one receiver reads it.
        let item = unsafe { (*place.get()).assume_init() };
        queue.taken.store(taken.wrapping_add(1), Ordering::Release);
        Some(item)
    }
}

impl<T: Copy, const N: usize> Default for Queue<T, N> {
    fn default() -> Self {
        Self::new()
    }
}
