//! The loops that ran, found from the branches that jumped back.

use super::code::{Code, Region};

/// A loop: from the target of a branch that jumps back, inside one function, to the end of that branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Loop {
    /// Address of its first instruction.
    pub start: u32,
    /// Its length in bytes, the branch included. Above 1024 it does not fit the instruction cache of an STM32F4.
    pub bytes: u32,
    /// How often the branch jumped back: the passes through the loop, less one for each time it was entered from above.
    pub iterations: u64,
    /// Instructions that ran between its ends, those of inner loops included, those of called functions not.
    pub instructions: u64,
}

/// All loops that ran, the one with most instructions first.
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
