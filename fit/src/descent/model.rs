//! Eq. 1: the sound of a model, and the gradient by all its numbers.

use fourier::Complex;

use super::bands;
use super::force::{ForceInputs, ForceShape, Pulse};
use super::modes::{ModalResponse, ModeInputs, ScaledMode};
use super::noise;
use super::parameters::{Kind, Places};
use super::room::Room;
use crate::convolution::{Convolution, even, fast_length};
use crate::random::SplitMix64;

/// Number of bands of background noise, as in the released notebook.
const NOISE_BANDS: usize = 100;
/// Number of bands of the room, as in the released notebook.
const ROOM_BANDS: usize = 16;
/// Longest response of the room in seconds, as in the released notebook.
const ROOM_S: f64 = 1.0;
/// Mean of the random dampings of modes at the start, as in the released notebook.
const START_DAMPING: f64 = -1.0;
/// Damping of the room's bands at the start, as in the released notebook.
const START_ROOM_DECAY: f64 = -1.0;
/// Acceleration sound at the start, as in the released notebook.
const START_ACCELERATION: f64 = 0.1;
/// Standard deviation of the noise on magnitudes at the start (appendix B).
const START_SPREAD: f64 = 0.1;
/// Standard deviation of the random magnitudes at the start.
///
/// The paper prints no number. At this one the noise on magnitudes is as large as their
/// differences, so that any node of a window may become its peak.
const START_MAGNITUDES: f64 = 0.1;

/// A recording's model without its learned numbers.
#[derive(Clone)]
pub(super) struct Model {
    length: usize,
    /// Places of the numbers.
    pub(super) places: Places,
    force: ForceShape,
    modes: ModalResponse,
    room: Room,
    convolution: Convolution,
}

/// Random numbers of one step.
#[derive(Clone, Debug)]
pub(super) struct Draw {
    /// Normal number for each node of the force.
    magnitudes: Vec<f64>,
    /// Spectrum of the white noise behind the background.
    background: Vec<Complex<f64>>,
}

/// A rendered sound, with what its gradient needs.
#[derive(Clone, Debug)]
pub(super) struct Rendered {
    /// Samples of the sound.
    pub(super) sound: Vec<f64>,
    /// Pulses of the force.
    pub(super) pulses: Vec<Pulse>,
    /// Modes with their numbers in physical units.
    pub(super) modes: Vec<ScaledMode>,
    force: Vec<f64>,
    force_spectrum: Vec<Complex<f64>>,
    response_spectrum: Vec<Complex<f64>>,
    dry_spectrum: Vec<Complex<f64>>,
    room_spectrum: Vec<Complex<f64>>,
    room_length: usize,
}

impl Model {
    pub(super) fn new(length: usize, rate_hz: f64, modes: usize, random: &mut SplitMix64) -> Self {
        let force = ForceShape::new(length, rate_hz);
        let places = Places { nodes: force.nodes(), modes, noise_bands: NOISE_BANDS, room_bands: ROOM_BANDS };
        let room_length = even(length.min((ROOM_S * rate_hz) as usize) - 1);
        Self {
            length,
            places,
            force,
            modes: ModalResponse::new(modes, length, rate_hz),
            room: Room::new(ROOM_BANDS, room_length, rate_hz, random),
            convolution: Convolution::new(2 * length),
        }
    }

    /// Random numbers at which a descent begins.
    pub(super) fn start(&self, random: &mut SplitMix64) -> Vec<f64> {
        let mut parameters: Vec<f64> = (0..self.places.total()).map(|_| random.normal()).collect();
        parameters[self.places.of(Kind::Magnitude)].iter_mut().for_each(|x| *x *= START_MAGNITUDES);
        parameters[self.places.of(Kind::Spread)].fill(START_SPREAD);
        parameters[self.places.of(Kind::ContactBias)].fill(0.0);
        parameters[self.places.of(Kind::Damping)].iter_mut().for_each(|x| *x += START_DAMPING);
        parameters[self.places.of(Kind::Acceleration)].fill(START_ACCELERATION);
        parameters[self.places.of(Kind::RoomDecay)].fill(START_ROOM_DECAY);
        parameters
    }

    /// Random numbers of the next step.
    pub(super) fn draw(&self, random: &mut SplitMix64) -> Draw {
        Draw {
            magnitudes: (0..self.places.nodes).map(|_| random.normal()).collect(),
            background: bands::white(fast_length(self.length), random),
        }
    }

    /// Draw without noise, for the sound of the fitted model.
    pub(super) fn still(&self) -> Draw {
        let bins = fast_length(self.length) / 2 + 1;
        Draw { magnitudes: vec![0.0; self.places.nodes], background: vec![Complex::new(0.0, 0.0); bins] }
    }

    fn force_inputs<'a>(&self, parameters: &'a [f64], draw: &'a Draw) -> ForceInputs<'a> {
        ForceInputs {
            magnitudes: &parameters[self.places.of(Kind::Magnitude)],
            spreads: &parameters[self.places.of(Kind::Spread)],
            contact_times: &parameters[self.places.of(Kind::ContactTime)],
            bias: self.single(parameters, Kind::ContactBias),
            noise: &draw.magnitudes,
        }
    }

    /// The number of a kind of which there is one.
    pub(super) fn single(&self, parameters: &[f64], kind: Kind) -> f64 {
        parameters[self.places.of(kind)].iter().sum()
    }

    /// Sound of the model (eq. 1).
    pub(super) fn render(&self, parameters: &[f64], draw: &Draw) -> Rendered {
        let part = |kind: Kind| &parameters[self.places.of(kind)];
        let pulses = self.force.pulses(&self.force_inputs(parameters, draw));
        let force = self.force.force(&pulses);
        let inputs =
            ModeInputs { gains: part(Kind::Gain), dampings: part(Kind::Damping), frequencies: part(Kind::Frequency) };
        let modes = self.modes.scaled(&inputs);
        let force_spectrum = self.convolution.spectrum(&force);
        let response_spectrum = self.convolution.spectrum(&self.modes.response(&modes));
        let mut dry = self.convolution.convolved(&force_spectrum, &response_spectrum, self.length);
        let acceleration = self.single(parameters, Kind::Acceleration);
        let noise = noise::noise(part(Kind::NoiseGain), &draw.background, self.length);
        for ((sum, force), noise) in dry.iter_mut().zip(&force).zip(noise) {
            *sum += acceleration * force + noise;
        }
        let room = self.room.response(part(Kind::RoomGain), part(Kind::RoomDecay));
        let (dry_spectrum, room_spectrum) = (self.convolution.spectrum(&dry), self.convolution.spectrum(&room));
        let mut sound = self.convolution.convolved(&dry_spectrum, &room_spectrum, self.length);
        sound.iter_mut().zip(&dry).for_each(|(sum, x)| *sum += x);
        Rendered {
            sound,
            pulses,
            modes,
            force,
            force_spectrum,
            response_spectrum,
            dry_spectrum,
            room_spectrum,
            room_length: room.len(),
        }
    }

    /// Gradient by all parameters, from that by the samples of the rendered sound.
    pub(super) fn gradient(&self, parameters: &[f64], draw: &Draw, rendered: &Rendered, by_sound: &[f64]) -> Vec<f64> {
        let part = |kind: Kind| &parameters[self.places.of(kind)];
        let by_sound_spectrum = self.convolution.spectrum(by_sound);
        let by_room = self.convolution.correlated(&by_sound_spectrum, &rendered.dry_spectrum, rendered.room_length);
        let mut by_dry = self.convolution.correlated(&by_sound_spectrum, &rendered.room_spectrum, self.length);
        by_dry.iter_mut().zip(by_sound).for_each(|(sum, x)| *sum += x);
        let by_dry_spectrum = self.convolution.spectrum(&by_dry);
        let by_response = self.convolution.correlated(&by_dry_spectrum, &rendered.force_spectrum, self.length);
        let mut by_force = self.convolution.correlated(&by_dry_spectrum, &rendered.response_spectrum, self.length);
        let acceleration = self.single(parameters, Kind::Acceleration);
        by_force.iter_mut().zip(&by_dry).for_each(|(sum, x)| *sum += acceleration * x);
        let by_acceleration = by_dry.iter().zip(&rendered.force).map(|(slope, force)| slope * force).sum();

        let force = self.force.gradient(&self.force_inputs(parameters, draw), &rendered.pulses, &by_force);
        let modes = self.modes.gradient(&rendered.modes, &by_response);
        let noise = noise::gradient(part(Kind::NoiseGain), &draw.background, &by_dry);
        let (room_gains, room_decays) = self.room.gradient(part(Kind::RoomGain), part(Kind::RoomDecay), &by_room);
        // In the order of the kinds.
        [
            force.magnitudes,
            force.spreads,
            force.contact_times,
            vec![force.bias],
            modes.gains,
            modes.dampings,
            modes.frequencies,
            vec![by_acceleration],
            noise,
            room_gains,
            room_decays,
        ]
        .concat()
    }
}
