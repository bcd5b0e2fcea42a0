//! Memory of the virtual core after a load, kept for the process.
//!
//! A load derives coefficients in software `f64`, which takes hundreds of millions of instructions
//! for the kits of the tests. The tests load few kits many times.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use virtual_core::{CCM_ADDRESS, CCM_BYTES, Call, Machine, RAM_ADDRESS, RAM_BYTES};

use super::OnChipError;

/// Memories that a load fills: address and bytes.
const MEMORIES: [(u32, u32); 2] = [(RAM_ADDRESS, RAM_BYTES), (CCM_ADDRESS, CCM_BYTES)];

/// Call of a load, and the memories after it.
struct Loaded {
    call: Call,
    memories: [Vec<u8>; MEMORIES.len()],
}

static LOADS: Mutex<Option<HashMap<Vec<u8>, Arc<Loaded>>>> = Mutex::new(None);

/// Runs a load, or restores the memories and the call of the first load with the same key.
///
/// The key holds the image's name and all that the load depends on. The load may not depend on
/// RAM or CCM. A restored load leaves no counts in the machine's profile.
pub(super) fn load_once(
    machine: &mut Machine,
    key: Vec<u8>,
    load: impl FnOnce(&mut Machine) -> Result<Call, OnChipError>,
) -> Result<Call, OnChipError> {
    let known = LOADS.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_default().get(&key).cloned();
    if let Some(known) = known {
        for ((address, _), bytes) in MEMORIES.into_iter().zip(&known.memories) {
            machine.write(address, bytes)?;
        }
        return Ok(known.call);
    }
    let call = load(machine)?;
    let mut memories = MEMORIES.map(|(_, bytes)| vec![0; bytes as usize]);
    for ((address, _), bytes) in MEMORIES.into_iter().zip(&mut memories) {
        machine.read(address, bytes)?;
    }
    let mut loads = LOADS.lock().unwrap_or_else(PoisonError::into_inner);
    loads.get_or_insert_default().insert(key, Arc::new(Loaded { call, memories }));
    Ok(call)
}
