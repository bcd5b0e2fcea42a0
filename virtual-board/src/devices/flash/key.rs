//! Locks that open by two keys in order.

use super::misuse;
use crate::devices::Access;

/// Lock of FLASH_CR or FLASH_OPTCR.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Key {
    #[default]
    Locked,
    /// The first key was written.
    Half,
    Open,
    /// A wrong key was written: the lock stays until a reset.
    Stuck,
}

impl Key {
    pub(super) fn is_open(self) -> bool {
        self == Key::Open
    }

    pub(super) fn lock(&mut self) {
        *self = Key::Locked;
    }

    /// Takes a key.
    ///
    /// A wrong one locks until the next reset and makes a bus error, which ends the run.
    pub(super) fn take(&mut self, value: u32, keys: [u32; 2], register: &str) -> Access<()> {
        *self = match *self {
            Key::Locked if value == keys[0] => Key::Half,
            Key::Half if value == keys[1] => Key::Open,
            _ => Key::Stuck,
        };
        if *self == Key::Stuck {
            return misuse(&format!(
                "{register}: {value:#010x} is not the next key, which locks until a reset; write {:#010x}, then {:#010x}",
                keys[0], keys[1]
            ));
        }
        Ok(())
    }
}
