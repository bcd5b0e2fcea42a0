//! The assembly kernels on the virtual core against their portable twins: every form, every group
//! size, cut ticks, skipped groups.

use dsp_core::SampleRate;
use dsp_core::resonator::{Bank, BankTable, Retirement, TICK_FRAMES};
use dsp_core::table::layout::{GainRecord, ModeRecord};
use host_tests::lent;
use host_tests::on_chip::BankOnChip;

/// Bank on the PC.
struct OnPc {
    bank: Bank<'static>,
}

impl OnPc {
    fn new(modes: &[ModeRecord], gains: &[GainRecord]) -> Self {
        let table = BankTable {
            modes,
            gains,
            positions: 1,
            weight: 1.0,
            choke_t60_s: 0.0,
            is_balanced: false,
            typical_contact: (1e-3, 1e-3),
        };
        let size = Bank::size(&table, SampleRate::HZ_48000).expect("the modes can be played");
        let mut bank = lent!(lender => Bank::take(lender, size));
        bank.load(&table, SampleRate::HZ_48000).expect("the modes can be played");
        Self { bank }
    }

    fn tick(&mut self, retire: bool) -> u32 {
        let mut retirement = Retirement::new(0.0, 1.0 / 134_217_728.0);
        self.bank.tick(retire.then_some(&mut retirement));
        self.bank.ringing_modes()
    }

    fn render(&mut self, force: Option<&[i32]>, frames: usize) -> Vec<i32> {
        let mut out = vec![0; frames];
        self.bank.render(force, false, true, &mut out);
        out
    }
}

/// Generator of deterministic numbers from 0 to 1.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 0x2545_f491_4f6c_dd1du64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn table(hz: impl Iterator<Item = f64>, t60_s: f64, cosine: bool) -> (Vec<ModeRecord>, Vec<GainRecord>) {
    let mut number = numbers();
    hz.map(|hz| {
        let decay = 1000f64.ln() / t60_s * (0.5 + number());
        let mode = ModeRecord { frequency_hz: (hz as f32).into(), decay_per_s: (decay as f32).into() };
        let gain = |x: f64| ((x * 2.0 - 1.0) as f32 * 3000.0).into();
        (mode, GainRecord { sine: gain(number()), cosine: if cosine { gain(number()) } else { 0.0.into() } })
    })
    .unzip()
}

/// Plays one list of strikes on chip and PC, in whole and cut ticks, and compares every sample.
fn play_on_both(chip: &mut BankOnChip, modes: &[ModeRecord], gains: &[GainRecord], cuts: &[usize]) {
    chip.load(modes, gains, 48_000).unwrap();
    let mut pc = OnPc::new(modes, gains);
    let mut number = numbers();
    for tick in 0..24 {
        assert_eq!(chip.tick(true).unwrap().0, pc.tick(true), "modes that ring at tick {tick}");
        let struck = tick % 8 < 2;
        let mut left = TICK_FRAMES;
        let mut cut = cuts.iter();
        while left > 0 {
            let frames = cut.next().copied().unwrap_or(left).min(left);
            let level = 2f64.powf(number() * 26.0);
            let force: Vec<i32> = (0..frames).map(|_| ((number() * 2.0 - 1.0) * level) as i32).collect();
            let force = struck.then_some(&force[..]);
            let (got, _) = chip.render(force, frames).unwrap();
            assert_eq!(got, pc.render(force, frames), "tick {tick}, {left} frames before its end, driven: {struck}");
            left -= frames;
        }
    }
}

/// Middles of the frequency ranges of the forms: coupled, shifted by 1, shifted by 2, then each of
/// them mirrored.
const FORMS_HZ: [f64; 6] = [1000.0, 5600.0, 10_000.0, 14_000.0, 18_400.0, 22_000.0];

#[test]
fn the_chip_gives_the_bits_of_the_pc_for_every_form_and_group_size() {
    let mut chip = BankOnChip::new().unwrap();
    for (form, hz) in FORMS_HZ.into_iter().enumerate() {
        for count in 1..=13 {
            for cosine in [false, true] {
                let (modes, gains) = table((0..count).map(|n| hz + f64::from(n) * 7.3), 0.4, cosine);
                let cuts: &[usize] = if (form + count as usize).is_multiple_of(2) { &[] } else { &[1, 13, 2] };
                play_on_both(&mut chip, &modes, &gains, cuts);
            }
        }
    }
}

#[test]
fn the_chip_gives_the_bits_of_the_pc_for_a_bank_of_all_forms_that_retires() {
    let mut chip = BankOnChip::new().unwrap();
    for cuts in [&[][..], &[1], &[31], &[16], &[5, 5, 5], &[15, 2]] {
        let (modes, gains) = table((0..83).map(|n| 40.0 * 1.079f64.powi(n)), 0.02, true);
        play_on_both(&mut chip, &modes, &gains, cuts);
    }
}
