//! The search for a strike's peak over the scan time.

use super::units::LAST_COUNT;

/// Search for the peak of one strike.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scan {
    /// Frame at which the strike is decided (low 32 bits).
    pub(super) decide_at: u32,
    /// Largest magnitude so far, in signal units.
    pub(super) peak: i32,
    /// Largest envelope so far, in signal units.
    pub(super) envelope: i32,
    /// True if a sample was at a rail of the ADC.
    pub(super) saturated: bool,
    /// Last sample.
    previous: i32,
    /// Sample before the last.
    before: i32,
    /// Number of the two last samples that are known.
    known: u8,
}

impl Scan {
    pub(super) const NONE: Self =
        Self { decide_at: 0, peak: 0, envelope: 0, saturated: false, previous: 0, before: 0, known: 0 };

    /// Begins a search; `peak` is the largest magnitude since the onset.
    pub(super) fn begin(decide_at: u32, peak: i32) -> Self {
        Self { decide_at, peak, ..Self::NONE }
    }

    /// Takes the next sample: in counts, without its baseline, and the envelope after it.
    pub(super) fn push(&mut self, raw: u16, x: i32, envelope: i32) {
        self.saturated |= raw == 0 || raw >= LAST_COUNT;
        self.envelope = self.envelope.max(envelope);
        self.peak = self.peak.max(x.abs());
        if self.known >= 2 {
            self.peak = self.peak.max(vertex(self.before, self.previous, x));
        } else {
            self.known = self.known.saturating_add(1);
        }
        (self.before, self.previous) = (self.previous, x);
    }
}

/// Magnitude of the vertex of the parabola through three samples; 0 if the middle one is no
/// extremum.
///
/// Samples of a ring of 8 kHz at 48 kHz may miss its crest by 30 degrees, or 1.2 dB. The vertex
/// leaves 0.2 dB of that.
fn vertex(before: i32, middle: i32, after: i32) -> i32 {
    let (before, middle, after) = if middle < 0 { (-before, -middle, -after) } else { (before, middle, after) };
    if middle < before || middle < after {
        return 0;
    }
    // Signals have up to 25 bits. Two are dropped, so that the quotient's numerator fits 32.
    let difference = (after - before) >> 2;
    let curvature = (2 * middle - before - after) >> 2;
    let quotient = (difference << 8).checked_div(curvature).unwrap_or(0).clamp(-256, 256);
    // The rise is difference²/(8·curvature), back in signal units.
    let rise = (difference.saturating_mul(quotient)) >> (8 + 3 - 2);
    middle.saturating_add(rise)
}
