//! The kernels of the virtual core, run and timed on the PC.

use std::hint::black_box;
use std::time::Instant;

use dsp_core::fixed::ONE_Q27;
use dsp_core::resonator::{Bank, BankTable, TICK_FRAMES};
use float_forms::modal::{self, FloatMode};

use super::chip::table;
use super::rows::Driven;
use crate::lent;
use crate::single_mode::Case;

/// Fixed-point bank with memory of its own.
#[derive(Debug)]
pub struct BankOnPc {
    bank: Bank<'static>,
}

impl BankOnPc {
    /// Bank of cases at one rate, at rest; `None` if a case cannot be played.
    ///
    /// Modes have sine gains, and if `phase` cosine gains too.
    pub fn new(cases: &[Case], phase: bool) -> Option<Self> {
        let (modes, gains) = table(cases, phase);
        let table = BankTable {
            modes: &modes,
            gains: &gains,
            positions: 1,
            weight: 1.0,
            choke_t60_s: 0.0,
            is_balanced: false,
            typical_contact: (1e-3, 1e-3),
        };
        let rate = cases.first()?.rate;
        let size = Bank::size(&table, rate).ok()?;
        let mut bank = lent!(lender => Bank::take(lender, size));
        bank.load(&table, rate).ok()?;
        Some(Self { bank })
    }

    /// Does the bookkeeping of a tick without retirement, and renders its sound.
    pub fn tick(&mut self, force: Option<&[i32]>) -> [i32; TICK_FRAMES] {
        self.bank.tick(None);
        let mut out = [0; TICK_FRAMES];
        self.bank.render(force, false, true, &mut out);
        out
    }
}

/// Time of a bank's ticks, bookkeeping included, in ns a mode and sample.
pub fn bank_ns(cases: &[Case], driven: Driven, ticks: usize) -> Option<f64> {
    let mut bank = BankOnPc::new(cases, driven == Driven::GainAndPhase)?;
    let force = [ONE_Q27 / 8; TICK_FRAMES];
    bank.tick(Some(&force));
    let force = (driven != Driven::Free).then_some(&force[..]);
    Some(quickest_ns(cases.len(), ticks, || {
        black_box(bank.tick(black_box(force)));
    }))
}

/// Time of the single-precision modes, in ns a mode and sample.
pub fn float_ns(cases: &[Case], driven: Driven, ticks: usize) -> f64 {
    let mut modes: Vec<FloatMode> =
        cases.iter().map(|case| FloatMode::new(case.frequency_hz, case.decay_per_s(), case.rate.hz())).collect();
    modes.iter_mut().for_each(|mode| mode.gain = 0.01);
    let force = [0.125; TICK_FRAMES];
    let mut out = [0.0; TICK_FRAMES];
    modal::driven(&mut modes, &force, &mut out);
    quickest_ns(cases.len(), ticks, || {
        out.fill(0.0);
        if driven == Driven::Free {
            modal::free(&mut modes, &mut out);
        } else {
            modal::driven(&mut modes, black_box(&force), &mut out);
        }
        black_box(&mut out);
    })
}

/// Time of the quickest of five runs of `ticks` ticks, in ns a mode and sample.
///
/// Other programs can only make a run slower.
pub fn quickest_ns(modes: usize, ticks: usize, mut tick: impl FnMut()) -> f64 {
    let mut run = || {
        let begin = Instant::now();
        (0..ticks).for_each(|_| tick());
        begin.elapsed().as_secs_f64() * 1e9 / (modes * ticks * TICK_FRAMES) as f64
    };
    (0..5).map(|_| run()).fold(f64::INFINITY, f64::min)
}
