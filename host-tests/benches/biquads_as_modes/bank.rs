//! The modal bank that plays fitted chains.

use dsp_core::SampleRate;
use dsp_core::radiation::Acceleration;
use dsp_core::resonator::{Bank, BankTable, Retirement, TICK_FRAMES};
use dsp_core::table::layout::{GainRecord, ModeRecord};
use host_tests::lent;

use super::fit::Fit;
use super::plan::parameters;

/// Plays the modes of all fits in one modal bank at 48 kHz. The sum of their direct terms plays as
/// acceleration sound.
///
/// Modes retire as they do on a pad at 0 dB. The bank rings on after the end of the input.
pub(crate) fn render(fits: &[Fit], input: &[i32], frames: usize) -> Vec<i32> {
    let rate = SampleRate::HZ_48000;
    let (mut poles, mut gains, mut alpha) = (Vec::new(), Vec::new(), 0.0);
    for fit in fits {
        alpha += fit.direct;
        for &(pole, c) in &fit.modes {
            let [hz, decay, sine, cosine] = parameters(pole, c, rate.hz());
            alpha += c.re;
            poles.push(ModeRecord { frequency_hz: (hz as f32).into(), decay_per_s: (decay as f32).into() });
            gains.push(GainRecord { sine: (sine as f32).into(), cosine: (cosine as f32).into() });
        }
    }
    let table = BankTable {
        modes: &poles,
        gains: &gains,
        positions: 1,
        weight: 1.0,
        choke_t60_s: 0.0,
        is_balanced: false,
        typical_contact: (1e-3, 1e-3),
    };
    let size = Bank::size(&table, rate).expect("the modes can be played");
    let mut bank = lent!(lender => Bank::take(lender, size));
    bank.load(&table, rate).expect("the modes can be played");
    let acceleration = Acceleration::new(alpha as f32, 1.0);
    let mut out = vec![0; frames];
    for (tick, out) in out.chunks_mut(TICK_FRAMES).enumerate() {
        let mut retirement = Retirement::new(bank.retired_amplitude(), 2f32.powi(-27));
        bank.tick(Some(&mut retirement));
        let force = input.get(tick * TICK_FRAMES..).map(|rest| &rest[..rest.len().min(out.len())]);
        let force = force.filter(|force| !force.is_empty()).map(|force| {
            let mut whole = force.to_vec();
            whole.resize(out.len(), 0);
            whole
        });
        bank.render(force.as_deref(), false, true, out);
        if let Some(force) = &force {
            acceleration.render(force, out);
        }
    }
    out
}
