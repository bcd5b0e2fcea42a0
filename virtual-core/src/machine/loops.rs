//! Loops that ran, found by the branches that jumped back.

use super::code::{Code, Region};

/// Loop inside one function, from the target of a branch that jumps back to the end of the branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Loop {
    /// Address of the first instruction.
    pub start: u32,
    /// Length in bytes, the branch included.
    ///
    /// A loop above 1024 bytes does not fit the instruction cache of an STM32F4.
    pub bytes: u32,
    /// Number of times that the branch jumped back: the passes through the loop, less one for each
    /// time that the loop was entered from above.
    pub iterations: u64,
    /// Number of instructions that ran in the loop. Those of inner loops are included, those of
    /// called functions are not.
    pub instructions: u64,
}

/// Returns all loops that ran, the one with most instructions first.
pub(super) fn found(code: &Code) -> Vec<Loop> {
    let mut loops: Vec<Loop> = code.regions().flat_map(in_region).collect();
    loops.sort_by_key(|found| (std::cmp::Reverse(found.instructions), found.start));
    loops
}

fn in_region(region: &Region) -> impl Iterator<Item = Loop> {
    let sites = region.counts.iter().enumerate().filter(|(_, count)| count.jumped_back != 0);
    sites.map(|(index, count)| {
        let instruction = &region.slots[index].instruction;
        let end = region.base + 2 * index as u32 + u32::from(instruction.bytes);
        let first = ((instruction.target - region.base) / 2) as usize;
        let instructions = region.counts[first..=index].iter().map(|count| count.executed).sum();
        Loop { start: instruction.target, bytes: end - instruction.target, iterations: count.jumped_back, instructions }
    })
}
