//! Rendering by the `f64` reference, from the physical parameters that the instrument uses.
//!
//! The reference plays contacts, modes, biquads, dynamic filters with their noise and loops, and
//! the room. Residuals and the background, which are nothing but noise, are left out
//! ([`leaves_out`]).

mod fader;
mod pads;
mod surfaces;

pub use pads::pads;
pub use surfaces::contact;

use dsp_core::SampleRate;
use dsp_core::event::Action;
use dsp_core::fixed::ONE_Q27;

use super::instrument::ROOM_SAMPLES;
use super::performance::Performance;

/// Model of the room in which a performance is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Room {
    /// Noise that decays band by band: the model that the instrument's network approximates.
    Reference,
    /// Delay network of the instrument in double precision, for comparisons sample by sample.
    NetworkTwin,
}

/// Seed of the room's noise, fixed so that each run gives the same sound.
const ROOM_SEED: u64 = 0;

/// Names of the parts of a kit that the reference leaves out.
pub fn leaves_out(kit: &kit::Kit) -> Vec<&'static str> {
    let has_residual = kit.objects.iter().any(|object| object.residual.is_some());
    [(has_residual, "residuals"), (kit.background.is_some(), "the background")]
        .into_iter()
        .filter_map(|(is_there, what)| is_there.then_some(what))
        .collect()
}

/// Renders a performance by the reference, 1.0 = full scale, without clipping.
///
/// `progress` gets the number of frames that are done. A pad that cannot be choked (`choke_t60_s` =
/// 0) ignores chokes and releases, as it does in the instrument.
///
/// # Errors
/// The errors of [`reference::Scene::new`].
pub fn render(
    kit: &kit::Kit,
    performance: &Performance,
    rate: SampleRate,
    progress: impl FnMut(usize),
) -> Result<Vec<[f64; 2]>, reference::Error> {
    render_in(Room::Reference, kit, performance, rate, progress)
}

/// Renders a performance as [`render`] does, with a choice of the room's model.
///
/// # Errors
/// The errors of [`reference::Scene::new`].
pub fn render_in(
    room: Room,
    kit: &kit::Kit,
    performance: &Performance,
    rate: SampleRate,
    mut progress: impl FnMut(usize),
) -> Result<Vec<[f64; 2]>, reference::Error> {
    let mut frames = vec![[0.0; 2]; performance.frames];
    for part in fader::parts(&performance.events, rate) {
        let events = Performance { events: part.events, direct: performance.direct.clone(), frames: frames.len() };
        let mut sound = render_part(room, kit, &events, rate, &mut progress)?;
        fader::fade(&mut sound, (part.from, part.to), rate);
        for (sum, [left, right]) in frames.iter_mut().zip(sound) {
            *sum = [sum[0] + left, sum[1] + right];
        }
    }
    fader::set_levels(&performance.events, rate, &mut frames);
    Ok(frames)
}

/// Renders a performance without orders of silence.
fn render_part(
    room: Room,
    kit: &kit::Kit,
    performance: &Performance,
    rate: SampleRate,
    progress: &mut impl FnMut(usize),
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
                // The reference has no budget, and leaves nothing out for want of time.
                Action::Shed(_) => return None,
                // The fader does these.
                Action::Level | Action::Silence => return None,
                // Motions come as a direct force.
                Action::Touch { .. } | Action::Move(_) | Action::Lift => return None,
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
    add_room(kit, room, rate, &mut frames);
    Ok(frames)
}

/// Adds the room's response to a sound.
fn add_room(kit: &kit::Kit, room: Room, rate: reference::SampleRate, frames: &mut [[f64; 2]]) {
    if kit.room.is_empty() {
        return;
    }
    let bands: Vec<_> = kit
        .room
        .iter()
        .map(|band| reference::RoomBand {
            from_hz: f64::from(band.from_hz),
            gain: f64::from(band.gain),
            decay_per_s: f64::from(band.decay_per_s),
        })
        .collect();
    let sides = [0, 1].map(|side| frames.iter().map(|frame| frame[side]).collect::<Vec<f64>>());
    let dry = sides.each_ref().map(Vec::as_slice);
    let [left, right] = match room {
        Room::Reference => reference::room(&bands, dry, rate, ROOM_SEED),
        Room::NetworkTwin => reference::network_twin(&bands, dry, rate, ROOM_SAMPLES),
    };
    for (frame, (left, right)) in frames.iter_mut().zip(left.into_iter().zip(right)) {
        *frame = [frame[0] + left, frame[1] + right];
    }
}

/// Reference force of a pad's object, in newtons.
fn reference_force(kit: &kit::Kit, pad: usize) -> f64 {
    let object = kit.pads.get(pad).and_then(|pad| kit.objects.iter().find(|object| object.name == pad.object));
    object.map_or(1.0, |object| f64::from(object.reference_force))
}
