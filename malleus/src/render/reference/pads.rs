//! Conversion of a kit's pads to those of the reference.

use dsp_core::SampleRate;
use dsp_core::table::Kit;
use dsp_core::voice::Form;

use super::super::instrument;

/// Pads of the reference for a kit at a sample rate.
pub fn pads(kit: &kit::Kit, rate: SampleRate) -> Vec<reference::Pad> {
    let forms = forms(kit, rate);
    (0u32..)
        .zip(&kit.pads)
        .map(|(number, pad)| {
            let object = kit.objects.iter().find(|object| object.name == pad.object);
            let strikers =
                pad.strikers.iter().filter_map(|name| kit.strikers.iter().find(|striker| striker.name == *name));
            reference::Pad {
                object: reference::Object {
                    modes: object.map_or(Vec::new(), |object| modes(&object.modes)),
                    acceleration: object
                        .map_or(reference::Acceleration::NONE, |object| acceleration(object.acceleration)),
                    biquads: object
                        .and_then(|object| object.biquads.as_ref())
                        .map_or(vec![], |bank| biquads(bank, rate)),
                    dynamic_filter: object.and_then(|object| dynamic_filter(object, number, rate)),
                },
                strikers: strikers.map(striker).collect(),
                striker_weight: f64::from(pad.striker_weight),
                level_db: f64::from(pad.level_db),
                pan: f64::from(pad.pan),
                choke_t60_s: f64::from(pad.choke_t60_s),
                is_in_frames: forms.get(number as usize) == Some(&Form::Frames),
            }
        })
        .collect()
}

/// Forms in which the instrument plays a kit's pads; none of a kit that it refuses.
fn forms(kit: &kit::Kit, rate: SampleRate) -> Vec<Form> {
    let Ok(binary) = kit::binary::build(kit) else { return vec![] };
    let Ok(table) = Kit::parse(&binary) else { return vec![] };
    instrument::forms(&table, rate).unwrap_or_default()
}

fn acceleration(acceleration: kit::Acceleration) -> reference::Acceleration {
    match acceleration {
        kit::Acceleration::Factor(alpha) => reference::Acceleration::Factor(f64::from(alpha)),
        kit::Acceleration::Balance => reference::Acceleration::Balance,
    }
}

fn striker(striker: &kit::Striker) -> reference::Striker {
    reference::Striker {
        pulse: match striker.pulse {
            kit::Pulse::Hertz => reference::Pulse::Hertz { restitution: f64::from(striker.restitution) },
            kit::Pulse::Gaussian => reference::Pulse::Gaussian,
        },
        peak_force: f64::from(striker.peak_force),
        peak_exponent: f64::from(striker.peak_exponent),
        contact_time_s: f64::from(striker.contact_time_s),
        contact_exponent: f64::from(striker.contact_exponent),
        modes: modes(&striker.modes),
    }
}

fn modes(modes: &[kit::Mode]) -> Vec<reference::Mode> {
    modes
        .iter()
        .map(|mode| reference::Mode {
            frequency_hz: f64::from(mode.frequency_hz),
            decay_per_s: f64::from(mode.decay_per_s),
            gains: mode
                .gains
                .iter()
                .map(|gain| reference::Gain { sine: f64::from(gain.sine), cosine: f64::from(gain.cosine) })
                .collect(),
        })
        .collect()
}

/// Biquads of the reference, carried over to a sample rate.
fn biquads(bank: &kit::Biquads, rate: SampleRate) -> Vec<Vec<reference::biquad::Biquad>> {
    let ratio = f64::from(bank.rate_hz) / rate.hz();
    let carried = |biquad: &kit::Biquad| {
        let root = |[re, im]: [f32; 2]| (f64::from(re), f64::from(im));
        reference::biquad::Biquad::carried(root(biquad.pole), root(biquad.zero), f64::from(biquad.gain), ratio)
    };
    bank.chains.iter().map(|chain| chain.iter().map(carried).collect()).collect()
}

/// Dynamic filter of the reference, carried over to a sample rate.
///
/// The pad's index, counted from 0, selects the stream of its noise.
fn dynamic_filter(object: &kit::Object, pad: u32, rate: SampleRate) -> Option<reference::pad::DynamicFilter> {
    let table = object.dynamic_filter.as_ref()?;
    let ratio = rate.hz() / f64::from(table.rate_hz);
    let breakpoint = |point: &kit::Breakpoint| {
        let kit::Breakpoint { time_s, noise, a1, a2, b0, b1, b2 } = *point;
        let [time_s, noise, a1, a2, b0, b1, b2] = [time_s, noise, a1, a2, b0, b1, b2].map(f64::from);
        reference::dynamic_filter::Breakpoint { time_s, noise, a1, a2, b0, b1, b2 }.at_ratio(ratio)
    };
    let round = |one: &kit::Loop| reference::waveguide::Loop {
        frequency_hz: f64::from(one.frequency_hz),
        bandwidth_hz: f64::from(one.bandwidth_hz),
        gain: f64::from(one.gain),
        delay_s: f64::from(one.delay_s),
    };
    let exciter = |band: kit::Exciter| reference::dynamic_filter::Exciter {
        low_hz: f64::from(band.low_hz),
        high_hz: f64::from(band.high_hz),
        exponent: f64::from(band.exponent),
    };
    Some(reference::pad::DynamicFilter {
        order: match table.order {
            kit::Order::First => 1,
            kit::Order::Second => 2,
        },
        path: table.path.iter().map(breakpoint).collect(),
        exciter: table.exciter.map(exciter),
        loops: table.loops.iter().map(round).collect(),
        takes_modes: table.modes == kit::ModesGo::Through,
        // The factor keeps the noise's power density the same at every rate.
        noise: (reference::dynamic_filter::White::new(table.seed, pad), ratio.sqrt()),
        reference_force: f64::from(object.reference_force),
    })
}
