//! A board whose flash, settings and faults a test can look into.

use std::collections::BTreeMap;

use boards::{BlackpillF411, Board};
use cable::{Content, Identity, Job, Key, LeftOut, Refusal, Store, Text, Value};
use dsp_core::SampleRate;

/// Bytes of a slot.
pub(crate) const CAPACITY: usize = 64 * 1024;

/// Board with two slots of flash.
pub(crate) struct TestBoard {
    /// Number of slots that the board tells of, 1 or 2.
    pub(crate) slot_count: u8,
    pub(crate) slots: [Vec<u8>; 2],
    pub(crate) playing: Option<u8>,
    pub(crate) settings: BTreeMap<Key, Value>,
    pub(crate) erases: usize,
    pub(crate) is_in_dfu: bool,
    /// Number of writes after which the flash takes half of one and fails, if it does.
    pub(crate) writes_left: Option<usize>,
}

impl TestBoard {
    pub(crate) fn new() -> Self {
        Self {
            slot_count: 2,
            slots: [vec![0xFF; CAPACITY], vec![0xFF; CAPACITY]],
            playing: None,
            settings: BTreeMap::new(),
            erases: 0,
            is_in_dfu: false,
            writes_left: None,
        }
    }

    /// Board that plays a kit from slot 0.
    pub(crate) fn playing(kit: &[u8]) -> Self {
        let mut board = Self::new();
        board.slots[0][..kit.len()].copy_from_slice(kit);
        board.playing = Some(0);
        board
    }

    /// True if a slot holds a kit and nothing else.
    pub(crate) fn holds(&self, slot: u8, kit: &[u8]) -> bool {
        let (held, rest) = self.slots[usize::from(slot)].split_at(kit.len());
        held == kit && rest.iter().all(|&byte| byte == 0xFF)
    }
}

impl Store for TestBoard {
    fn identity(&self) -> Identity {
        Identity {
            firmware: Text::new("0.1.0"),
            revision: Text::new("74990db"),
            board: Text::new(BlackpillF411::NAME),
            // The image of the BlackPill tells its clock and divider, which are 48 kHz.
            rate: SampleRate::new(76_800_000, 1_600).expect("48 kHz"),
        }
    }

    fn playing(&self) -> Option<u8> {
        self.playing
    }

    fn slots(&self) -> u8 {
        self.slot_count
    }

    fn bytes(&self, slot: u8) -> Option<&[u8]> {
        self.slots.get(usize::from(slot)).map(Vec::as_slice)
    }

    fn uploaded(&self, slot: u8) -> Option<&[u8]> {
        self.bytes(slot)
    }

    fn content(&self, bytes: &[u8], tell: &mut dyn FnMut(LeftOut)) -> Content {
        Content::of(bytes, |kit, tell| BlackpillF411::plan(kit, tell).map(drop), tell)
    }

    fn longest_ms(&self, job: Job) -> u16 {
        match job {
            Job::Prepare(_) | Job::Erase(_) => 2000,
            _ => 1000,
        }
    }

    fn erase(&mut self, slot: u8) -> Result<(), Refusal> {
        self.slots[usize::from(slot)].fill(0xFF);
        self.playing = self.playing.filter(|&playing| playing != slot);
        self.erases += 1;
        Ok(())
    }

    fn prepare(&mut self, slot: u8) -> Result<(), Refusal> {
        self.erase(slot)
    }

    fn commit(&mut self, _slot: u8) -> Result<(), Refusal> {
        Ok(())
    }

    fn write(&mut self, slot: u8, offset: usize, bytes: &[u8]) -> Result<(), Refusal> {
        let fails = self.writes_left == Some(0);
        self.writes_left = self.writes_left.map(|left| left.saturating_sub(1));
        let written = if fails { bytes.len() / 2 } else { bytes.len() };
        let flash = &mut self.slots[usize::from(slot)][offset..][..written];
        assert!(flash.iter().all(|&byte| byte == 0xFF), "flash is written twice at byte {offset}");
        flash.copy_from_slice(&bytes[..written]);
        if fails { Err(Refusal::Flash { offset: offset as u32 }) } else { Ok(()) }
    }

    fn setting(&self, key: Key) -> Result<Option<Value>, Refusal> {
        refuse_input(key)?;
        Ok(self.settings.get(&key).copied())
    }

    fn set(&mut self, key: Key, value: Option<Value>) -> Result<(), Refusal> {
        refuse_input(key)?;
        match value {
            Some(value) => self.settings.insert(key, value),
            None => self.settings.remove(&key),
        };
        Ok(())
    }

    fn start(&mut self, slot: Option<u8>) -> Result<(), Refusal> {
        self.playing = slot;
        Ok(())
    }

    fn enter_dfu(&mut self) {
        self.is_in_dfu = true;
    }
}

/// Refuses the settings of piezos that the board does not have.
fn refuse_input(key: Key) -> Result<(), Refusal> {
    match key {
        Key::Threshold { piezo: 4.. } | Key::Curve { piezo: 4.. } => Err(Refusal::SettingRange { key: key.parts().0 }),
        _ => Ok(()),
    }
}
