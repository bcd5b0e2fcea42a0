//! The fixed-point bank with one mode, as the engine runs it: ticks, guards, block exponent.

use dsp_core::fixed::ONE_Q27;
use dsp_core::resonator::{Bank, BankTable, Group, Memory, Mode, Origin, TICK_FRAMES, Used};
use dsp_core::table::layout::{GainRecord, ModeRecord};

use super::Case;

/// A bank of one mode that has taken a unit impulse, to be advanced tick by tick.
#[derive(Debug)]
pub struct StruckMode {
    bank: Bank,
    modes: [Mode; 1],
    groups: [Group; 1],
    force: Vec<i32>,
}

impl StruckMode {
    /// The mode of a case; its gain makes an impulse of 1.0 ring at the case's level.
    pub fn new(case: &Case) -> Self {
        let modes = [ModeRecord {
            frequency_hz: (case.frequency_hz as f32).into(),
            decay_per_s: (case.decay_per_s() as f32).into(),
        }];
        let gains = [GainRecord { sine: ((case.level * case.rate.hz()) as f32).into(), cosine: 0.0.into() }];
        let table = BankTable {
            modes: &modes,
            gains: &gains,
            positions: 1,
            weight: 1.0,
            choke_t60_s: 0.0,
            is_balanced: false,
            typical_contact: (1e-3, 1e-3),
        };
        let (mut modes, mut groups) = ([Mode::SILENT], [Group::EMPTY]);
        let mut origins: [Origin; 0] = [];
        let mut memory = Memory { modes: &mut modes, groups: &mut groups, origins: &mut origins };
        let bank = Bank::load(&table, case.rate, &mut memory, &mut Used::default()).expect("one mode fits");
        Self { bank, modes, groups, force: vec![ONE_Q27] }
    }

    /// The next tick of bus samples, 1.0 = full scale.
    pub fn tick(&mut self) -> [f64; TICK_FRAMES] {
        let mut origins: [Origin; 0] = [];
        let mut memory = Memory { modes: &mut self.modes, groups: &mut self.groups, origins: &mut origins };
        self.bank.tick(&mut memory, None);
        let mut out = [0; TICK_FRAMES];
        self.force.resize(TICK_FRAMES, 0);
        self.bank.render(&mut memory, Some(&self.force), false, true, &mut out);
        self.force.clear();
        out.map(|sample| f64::from(sample) / f64::from(ONE_Q27))
    }

    /// The mode's amplitude now, 1.0 = full scale, from its state and block exponent: finer than the bus.
    pub fn amplitude(&self) -> f64 {
        let [mode] = &self.modes;
        let [group] = &self.groups;
        let orbit = dsp_core::resonator::coefficient::Orbit::new(group.form(), mode.coefficients);
        let (sine, cosine) = orbit.phases(mode.state.u as f32, mode.state.v as f32);
        f64::from(sine).hypot(f64::from(cosine)) * 2f64.powi(-group.exponent()) / f64::from(ONE_Q27)
    }

    /// Whether the state is exactly zero.
    pub fn is_zero(&self) -> bool {
        self.modes.iter().all(|mode| mode.state == Default::default())
    }
}

/// The case's sound over its frames. Parameters pass through the table's `f32` exactly as a kit's do; give cases that `f32` holds.
pub fn render(case: &Case) -> Vec<f64> {
    let mut mode = StruckMode::new(case);
    let mut sound = Vec::with_capacity(case.frames() + TICK_FRAMES);
    while sound.len() < case.frames() {
        sound.extend(mode.tick());
    }
    sound.truncate(case.frames());
    sound
}
