//! Memory of the virtual core after a load, kept for the process.
//!
//! A load derives coefficients in software `f64`, which takes hundreds of millions of instructions
//! for the kits of the tests. The tests load few kits many times.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use virtual_core::{Call, Machine, RAM_ADDRESS, RAM_BYTES};

use super::OnChipError;

/// Call of a load, and the RAM after it.
struct Loaded {
    call: Call,
    ram: Vec<u8>,
}

static LOADS: Mutex<Option<HashMap<Vec<u8>, Arc<Loaded>>>> = Mutex::new(None);

/// Runs a load, or restores the RAM and the call of the first load with the same key.
///
/// The key holds the image's name and all that the load depends on. The load may not depend on
/// RAM. A restored load leaves no counts in the machine's profile.
pub(super) fn load_once(
    machine: &mut Machine,
    key: Vec<u8>,
    load: impl FnOnce(&mut Machine) -> Result<Call, OnChipError>,
) -> Result<Call, OnChipError> {
    let known = LOADS.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_default().get(&key).cloned();
    if let Some(known) = known {
        machine.write(RAM_ADDRESS, &known.ram)?;
        return Ok(known.call);
    }
    let call = load(machine)?;
    let mut ram = vec![0; RAM_BYTES as usize];
    machine.read(RAM_ADDRESS, &mut ram)?;
    let mut loads = LOADS.lock().unwrap_or_else(PoisonError::into_inner);
    loads.get_or_insert_default().insert(key, Arc::new(Loaded { call, ram }));
    Ok(call)
}
