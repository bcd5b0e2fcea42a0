//! What an object may have beside its modes: a dynamic filter with loops round it, and a biquad bank. Plain owned values that mirror the text's keys.

/// Noise, and the modes where they go through it, through a filter whose coefficients move after each strike (dynamic-filter eq. 5, 6, 17), with
/// banded waveguides round it (eq. 8 to 13).
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicFilter {
    /// Seed of the noise; each pad has a stream of its own.
    pub seed: u32,
    /// Where the object's modes go.
    pub modes: ModesGo,
    /// The rate in Hz that the coefficients are for; at another one the bilinear transformation carries them over.
    pub rate_hz: f32,
    /// Band-pass of the filter's noise, if any.
    pub exciter: Option<Exciter>,
    /// Order of the filter; of the first order a2 and b2 of all breakpoints are 0.
    pub order: Order,
    /// 1 to 32 breakpoints, the first at 0 s, each later than the one before; linear between them, no noise after the last.
    pub path: Vec<Breakpoint>,
    /// At most 16 banded waveguides round the filter.
    pub loops: Vec<Loop>,
}

/// Where an object's modes go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ModesGo {
    /// To the output, beside the filter.
    #[default]
    Beside,
    /// Into the filter, with its noise.
    Through,
}

impl ModesGo {
    /// The word in the text form.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Beside => "beside",
            Self::Through => "through",
        }
    }
}

/// Order of a dynamic filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// One pole, one zero.
    #[default]
    First,
    /// Two poles, two zeros.
    Second,
}

/// The exciter: a Butterworth band-pass of fourth order, both of whose edges are times `(peak force / reference force)^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exciter {
    /// Lower edge (-3 dB) in Hz at the reference force.
    pub low_hz: f32,
    /// Upper edge (-3 dB) in Hz at the reference force.
    pub high_hz: f32,
    /// By which power of the peak force both edges move.
    pub exponent: f32,
}

/// The coefficients at a time after the strike: `s(n) = b0 e(n) + b1 e(n-1) + b2 e(n-2) - a1 s(n-1) - a2 s(n-2)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Breakpoint {
    /// Seconds after the strike.
    pub time_s: f32,
    /// a1.
    pub a1: f32,
    /// a2; 0 in a filter of first order.
    pub a2: f32,
    /// b0.
    pub b0: f32,
    /// b1.
    pub b1: f32,
    /// b2; 0 in a filter of first order.
    pub b2: f32,
}

/// A banded waveguide: a delay and a band-pass in a feedback loop round the filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// Middle f_c of the band-pass in Hz.
    pub frequency_hz: f32,
    /// Width Δf of the band-pass at -3 dB in Hz, below `frequency_hz`.
    pub bandwidth_hz: f32,
    /// Gain γ_s at f_c.
    pub gain: f32,
    /// Delay d_s in seconds.
    pub delay_s: f32,
}

/// A biquad bank (diffmodal eq. 2, 3): 1 to 64 chains side by side, driven by the contact force in newtons.
#[derive(Clone, Debug, PartialEq)]
pub struct Biquads {
    /// The rate in Hz that poles and zeros are for.
    pub rate_hz: f32,
    /// The chains, all of the same 1 to 4 biquads, one behind the other.
    pub chains: Vec<Vec<Biquad>>,
}

/// A biquad `k (1 - 2 Re q z⁻¹ + |q|² z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biquad {
    /// p as real and imaginary part, within the unit circle.
    pub pole: [f32; 2],
    /// q as real and imaginary part; (0, 0) is none.
    pub zero: [f32; 2],
    /// k.
    pub gain: f32,
}
