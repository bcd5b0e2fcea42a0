//! Rendering of a table by the instrument that a board runs, and by the reference.

use dsp_core::SampleRate;
use dsp_core::engine::{Engine, Plan, Setup};
use dsp_core::event::{Action, Event, Time};
use dsp_core::fixed::ONE_Q27;
use dsp_core::memory::{Memory, Word};
use kit::{Kit, Pad};

use crate::error::FitError;

/// The table bound to one pad, in the middle, at a level of 0 dB for each channel.
pub fn playable(table: &Kit) -> Kit {
    let object = table.objects.first().map_or(String::new(), |object| object.name.clone());
    Kit {
        pads: vec![Pad {
            name: object.clone(),
            object,
            strikers: table.strikers.iter().map(|striker| striker.name.clone()).collect(),
            // Constant-power panning attenuates the middle by 3 dB.
            level_db: CENTRE_DB,
            pan: 0.0,
            striker_weight: 1.0,
            choke_t60_s: 0.1,
            midi_notes: Vec::new(),
            note_off: kit::NoteOff::Nothing,
            trigger: None,
        }],
        ..table.clone()
    }
}

/// Level in dB that makes up for the attenuation of the middle by constant-power panning.
const CENTRE_DB: f32 = 3.010_3;

fn rate_of(rate_hz: f64) -> Result<SampleRate, FitError> {
    SampleRate::new(rate_hz.round() as u32, 1).ok_or_else(|| {
        FitError::Render(format!(
            "the instrument cannot play a rate of {rate_hz} Hz: give a recording of 8000 to 192000 Hz"
        ))
    })
}

/// Renders one strike at velocity 1 and a position from 0 to 1 by dsp-core, from frame 0 on.
///
/// Full scale is 1, without clipping.
///
/// # Errors
/// [`FitError::Table`] and [`FitError::Render`] if a board would refuse the table.
pub fn by_instrument(table: &Kit, position: f64, rate_hz: f64, frames: usize) -> Result<Vec<f64>, FitError> {
    let binary = kit::binary::build(&playable(table))?;
    let view = dsp_core::table::Kit::parse(&binary).map_err(|error| FitError::Render(error.to_string()))?;
    let setup = Setup::new(rate_of(rate_hz)?);
    let refused = |error: dsp_core::engine::LoadError| FitError::Render(error.to_string());
    let words = Plan::of::<i32>(&view, setup).map_err(refused)?.words;
    let (mut fast, mut bulk) = (vec![Word::uninit(); words.fast], vec![Word::uninit(); words.bulk]);
    let mut engine = Engine::<i32>::new(&view, setup, Memory::new(&mut fast, &mut bulk)).map_err(refused)?;
    let strike = Event {
        time: Time::at_frame(0),
        pad: 0,
        velocity: 1.0,
        position: position as f32,
        striker: 0,
        action: Action::Strike,
    };
    let mut out = vec![[0; 2]; frames];
    engine.render_bus(&[strike], None, &mut out, |_| {}).map_err(|error| FitError::Render(error.to_string()))?;
    Ok(out.iter().map(|frame| f64::from(frame[0]) / f64::from(ONE_Q27)).collect())
}

/// Renders one strike at velocity 1 and a position from 0 to 1 by the `f64` reference, from frame 0
/// on.
///
/// # Errors
/// [`FitError::Render`] if the table lacks an object or a striker, or the reference refuses it.
pub fn by_reference(table: &Kit, position: f64, rate_hz: f64, frames: usize) -> Result<Vec<f64>, FitError> {
    let (Some(object), Some(striker)) = (table.objects.first(), table.strikers.first()) else {
        return Err(FitError::Render("the table lacks an object or a striker: add one of each".to_owned()));
    };
    let modes = object.modes.iter().map(|mode| reference::Mode {
        frequency_hz: f64::from(mode.frequency_hz),
        decay_per_s: f64::from(mode.decay_per_s),
        gains: mode
            .gains
            .iter()
            .map(|gain| reference::Gain { sine: f64::from(gain.sine), cosine: f64::from(gain.cosine) })
            .collect(),
    });
    let pad = reference::Pad {
        object: reference::Object {
            modes: modes.collect(),
            acceleration: match object.acceleration {
                kit::Acceleration::Factor(alpha) => reference::Acceleration::Factor(f64::from(alpha)),
                kit::Acceleration::Balance => reference::Acceleration::Balance,
            },
            biquads: vec![],
            dynamic_filter: None,
        },
        strikers: vec![reference::Striker {
            pulse: match striker.pulse {
                kit::Pulse::Hertz => reference::Pulse::Hertz { restitution: f64::from(striker.restitution) },
                kit::Pulse::Gaussian => reference::Pulse::Gaussian,
            },
            peak_force: f64::from(striker.peak_force),
            peak_exponent: f64::from(striker.peak_exponent),
            contact_time_s: f64::from(striker.contact_time_s),
            contact_exponent: f64::from(striker.contact_exponent),
            modes: Vec::new(),
        }],
        striker_weight: 1.0,
        level_db: f64::from(CENTRE_DB),
        pan: 0.0,
        choke_t60_s: 0.1,
        is_in_frames: false,
    };
    let strike = reference::Event {
        time_samples: 0.0,
        pad: 0,
        velocity: 1.0,
        position: f64::from(position as f32),
        striker: 0,
        action: reference::Action::Strike,
    };
    let rate = reference::SampleRate { numerator: rate_hz.round() as u32, denominator: 1 };
    let frames = reference::render(&[pad], &[strike], None, rate, frames)
        .map_err(|error| FitError::Render(error.to_string()))?;
    Ok(frames.iter().map(|frame| frame[0]).collect())
}
