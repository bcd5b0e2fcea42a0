//! The fixed-point bank with one mode, run as the engine runs it: ticks, guards, block exponent.

use dsp_core::fixed::ONE_Q27;
use dsp_core::resonator::{Bank, BankTable, TICK_FRAMES};
use dsp_core::table::layout::{GainRecord, ModeRecord};

use super::Case;
use crate::lent;

/// Bank of one mode that a unit impulse strikes in the first tick.
#[derive(Debug)]
pub struct StruckMode {
    bank: Bank<'static>,
    force: Vec<i32>,
}

impl StruckMode {
    /// Bank with the mode of a case. An impulse of 1.0 makes it ring at the case's level.
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
        let size = Bank::size(&table, case.rate).expect("one mode can be played");
        let mut bank = lent!(lender => Bank::take(lender, size));
        bank.load(&table, case.rate).expect("one mode can be played");
        Self { bank, force: vec![ONE_Q27] }
    }

    /// Bus samples of the next tick, 1.0 = full scale.
    pub fn tick(&mut self) -> [f64; TICK_FRAMES] {
        self.bank.tick(None);
        let mut out = [0; TICK_FRAMES];
        self.force.resize(TICK_FRAMES, 0);
        self.bank.render(Some(&self.force), false, true, &mut out);
        self.force.clear();
        out.map(|sample| f64::from(sample) / f64::from(ONE_Q27))
    }

    /// Present amplitude of the mode, 1.0 = full scale. It comes from state and block exponent,
    /// which are finer than the bus.
    pub fn amplitude(&self) -> f64 {
        let ([mode], [group]) = (self.bank.modes(), self.bank.groups()) else { return 0.0 };
        let orbit = dsp_core::resonator::coefficient::Orbit::new(group.form(), mode.coefficients);
        let (sine, cosine) = orbit.phases(mode.state.u as f32, mode.state.v as f32);
        f64::from(sine).hypot(f64::from(cosine)) * 2f64.powi(-group.exponent()) / f64::from(ONE_Q27)
    }

    /// True if the state is exactly zero.
    pub fn is_zero(&self) -> bool {
        self.bank.modes().iter().all(|mode| mode.state == Default::default())
    }
}

/// Sound of a case over its frames.
///
/// Parameters pass through the `f32` of a table as a kit's do, so only cases that `f32` holds are
/// exact.
pub fn render(case: &Case) -> Vec<f64> {
    let mut mode = StruckMode::new(case);
    let mut sound = Vec::with_capacity(case.frames() + TICK_FRAMES);
    while sound.len() < case.frames() {
        sound.extend(mode.tick());
    }
    sound.truncate(case.frames());
    sound
}
