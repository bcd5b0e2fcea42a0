//! Rendering by the `f64` reference, from the same physical parameters: contacts, modes, biquads. It has no noise ([`leaves_out`]).

use dsp_core::SampleRate;
use dsp_core::event::Action;
use dsp_core::fixed::ONE_Q27;

use super::Performance;

/// What the reference leaves out of a kit.
pub fn leaves_out(kit: &kit::Kit) -> Vec<&'static str> {
    let any = |has: fn(&kit::Object) -> bool| kit.objects.iter().any(has);
    [
        (
            any(|object| object.dynamic_filter.is_some()),
            "dynamic filters (modes that go through them are heard beside)",
        ),
        (any(|object| object.residual.is_some()), "residuals"),
        (kit.background.is_some(), "the background"),
        (!kit.room.is_empty(), "the room"),
    ]
    .into_iter()
    .filter_map(|(is_there, what)| is_there.then_some(what))
    .collect()
}

/// The pads of a kit as the reference knows them.
pub fn pads(kit: &kit::Kit, rate: SampleRate) -> Vec<reference::Pad> {
    kit.pads
        .iter()
        .map(|pad| {
            let object = kit.objects.iter().find(|object| object.name == pad.object);
            let strikers =
                pad.strikers.iter().filter_map(|name| kit.strikers.iter().find(|striker| striker.name == *name));
            reference::Pad {
                object: reference::Object {
                    modes: object.map_or(Vec::new(), |object| modes(&object.modes)),
                    acceleration: object.map_or(0.0, |object| f64::from(object.acceleration)),
                    biquads: object
                        .and_then(|object| object.biquads.as_ref())
                        .map_or(vec![], |bank| biquads(bank, rate)),
                },
                strikers: strikers.map(striker).collect(),
                striker_weight: f64::from(pad.striker_weight),
                level_db: f64::from(pad.level_db),
                pan: f64::from(pad.pan),
                choke_t60_s: f64::from(pad.choke_t60_s),
            }
        })
        .collect()
}

fn striker(striker: &kit::Striker) -> reference::Striker {
    reference::Striker {
        pulse: match striker.pulse {
            kit::Pulse::Hertz => reference::Pulse::HertzHalfSine,
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

/// Biquads at a rate: poles and zeros raised to the power of the table's rate over it, the gain at the pole's frequency kept.
fn biquads(bank: &kit::Biquads, rate: SampleRate) -> Vec<Vec<reference::biquad::Biquad>> {
    let power = f64::from(bank.rate_hz) / rate.hz();
    let carried = |biquad: &kit::Biquad| {
        let root = |[re, im]: [f32; 2]| (f64::from(re), f64::from(im));
        let raised = |(re, im): (f64, f64)| {
            let (radius, angle) = (re.hypot(im).powf(power), im.atan2(re) * power);
            if re == 0.0 && im == 0.0 { (0.0, 0.0) } else { (radius * angle.cos(), radius * angle.sin()) }
        };
        let (pole, zero, gain) = (root(biquad.pole), root(biquad.zero), f64::from(biquad.gain));
        let given = reference::biquad::Biquad::from_roots(pole, zero, gain);
        if power == 1.0 {
            return given;
        }
        let angle = pole.1.abs().atan2(pole.0);
        let moved = reference::biquad::Biquad::from_roots(raised(pole), raised(zero), gain);
        let same = given.magnitude(angle) / moved.magnitude(angle * power);
        reference::biquad::Biquad {
            numerator: moved.numerator.map(|b| if same.is_finite() { b * same } else { b }),
            ..moved
        }
    };
    bank.chains.iter().map(|chain| chain.iter().map(carried).collect()).collect()
}

/// Renders a performance, 1.0 = full scale, not clipped; `progress` is told how many frames are done.
///
/// A pad that cannot be choked (`choke_t60_s` = 0) ignores chokes and releases, here as in the instrument.
///
/// # Errors
/// As [`reference::Scene::new`].
pub fn render(
    kit: &kit::Kit,
    performance: &Performance,
    rate: SampleRate,
    mut progress: impl FnMut(usize),
) -> Result<Vec<[f64; 2]>, reference::Error> {
    let pads = pads(kit, rate);
    let (numerator, denominator) = rate.ratio();
    let rate = reference::SampleRate { numerator, denominator };
    let chokable = |pad: u8| kit.pads.get(usize::from(pad)).is_some_and(|pad| pad.choke_t60_s > 0.0);
    let events: Vec<_> = performance
        .events
        .iter()
        .filter(|event| event.action == Action::Strike || chokable(event.pad))
        .filter_map(|event| {
            let action = match event.action {
                Action::Strike => reference::Action::Strike,
                Action::Choke => reference::Action::Choke,
                Action::Release => reference::Action::Release,
                // The law has all the time it needs.
                Action::Shed(_) => return None,
            };
            Some((event, action))
        })
        .map(|(event, action)| reference::Event {
            time_samples: event.time.frame as f64 + f64::from(event.time.fraction) / 4_294_967_296.0,
            pad: usize::from(event.pad),
            velocity: f64::from(event.velocity),
            position: f64::from(event.position),
            striker: usize::from(event.striker),
            action,
        })
        .collect();
    let force: Vec<f64> = performance.direct.as_ref().map_or(Vec::new(), |(pad, force)| {
        let newtons = reference_force(kit, usize::from(*pad)) / f64::from(ONE_Q27);
        force.iter().map(|&sample| f64::from(sample) * newtons).collect()
    });
    let direct =
        performance.direct.as_ref().map(|(pad, _)| reference::Direct { pad: usize::from(*pad), force: &force });
    let mut scene = reference::Scene::new(&pads, &events, direct, rate)?;
    let mut frames = vec![[0.0; 2]; performance.frames];
    let mut done = 0;
    for block in frames.chunks_mut(4096) {
        scene.render(block);
        done += block.len();
        progress(done);
    }
    Ok(frames)
}

fn reference_force(kit: &kit::Kit, pad: usize) -> f64 {
    let object = kit.pads.get(pad).and_then(|pad| kit.objects.iter().find(|object| object.name == pad.object));
    object.map_or(1.0, |object| f64::from(object.reference_force))
}
