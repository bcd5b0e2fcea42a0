//! Direct drive: the conditioned signal as a contact force.

use super::channel::Channel;
use super::config::ChannelConfig;
use crate::fixed::ONE_Q27;

/// Frames for which the gate stays open once the envelope has fallen below half of its opening
/// level: 10 ms at 48 kHz, so that a ring's own zero crossings never close it.
const OPEN_FRAMES: u16 = 480;
/// Logarithm to base 2 of the number of frames over which a closing gate fades out.
const FADE_SHIFT: u32 = 6;
/// Largest force: 12 dB over full scale.
const LIMIT: i32 = 4 * (ONE_Q27 - 1);

/// Noise gate of a direct pad.
///
/// It opens on the very sample at which the envelope exceeds threshold and noise. It fades out over
/// 64 frames once the envelope has stayed below half of that level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gate {
    frames_left: u16,
    /// Weight of the signal, 0 to 64.
    weight: i32,
}

impl Gate {
    pub(super) const SHUT: Self = Self { frames_left: 0, weight: 0 };

    /// Writes the force of up to one tick of samples, and gives the number of samples written.
    pub(super) fn run(
        &mut self,
        channel: &mut Channel,
        samples: impl Iterator<Item = u16>,
        config: &ChannelConfig,
        gain_q16: i32,
        force: &mut [i32],
    ) -> usize {
        let level = channel.gate_level(config);
        let mut written = 0;
        for (raw, slot) in samples.zip(force) {
            let (x, envelope) = channel.take(raw);
            let holds = self.frames_left > 0 && envelope > level >> 1;
            if envelope > level || holds {
                self.frames_left = OPEN_FRAMES;
                self.weight = 1 << FADE_SHIFT;
            } else if self.frames_left > 0 {
                self.frames_left -= 1;
            } else if self.weight > 0 {
                self.weight -= 1;
            }
            let product = (i64::from(x) * i64::from(gain_q16)) >> 16;
            let limited = product.clamp(-i64::from(LIMIT), i64::from(LIMIT)) as i32;
            *slot = (limited >> FADE_SHIFT) * self.weight;
            written += 1;
        }
        if self.frames_left > 0 {
            channel.ring();
        }
        channel.hold_envelope();
        written
    }
}
