//! Four sections, as the kernels take them.

use dsp_core::biquad::Root;
use dsp_core::biquad::fractions::{Part, Realised};
use dsp_core::biquad::pole::steps;

/// A pole in single precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FloatPole {
    mirrored: bool,
    kept: f32,
    step_squared: f64,
}

impl Realised for FloatPole {
    type Form = ();

    const EMPTY: Self = Self { mirrored: false, kept: 0.0, step_squared: 1.0 };

    /// Beyond 18.5 kHz at 48 kHz: up to there the form's ellipse is at most three times as long as
    /// wide, and fours are full more often.
    const MIRROR_BELOW: f64 = -0.75;

    fn form_of(_: Root, _: bool) {}

    fn new(root: Root, mirrored: bool, (): &()) -> Self {
        let (delta, step_squared) = steps(root, mirrored);
        // What rounds to 1 would never decay.
        Self { mirrored, kept: ((1.0 - delta) as f32).min(1.0 - f32::EPSILON / 2.0), step_squared }
    }

    fn is_mirrored(self) -> bool {
        self.mirrored
    }

    fn delta(self) -> f64 {
        1.0 - f64::from(self.kept)
    }

    fn step_squared(self) -> f64 {
        self.step_squared
    }

    /// Gains into u are b.
    fn entry(self) -> f64 {
        1.0
    }

    fn handed(self, wanted: f64) -> f64 {
        wanted
    }
}

/// Four sections, field by field; what is not in use is silent.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Quad {
    /// The component that does not sound.
    pub(super) u: [f32; 4],
    /// The component that sounds.
    pub(super) v: [f32; 4],
    /// κ.
    pub(super) kept: [f32; 4],
    /// a.
    pub(super) turn: [f32; 4],
    /// b.
    pub(super) entry: [f32; 4],
    /// g.
    pub(super) gain: [f32; 4],
    /// Not 0 if the quad is run.
    pub(super) awake: u32,
    /// Of linked sections: share of the v before that goes into u.
    pub(super) couple: [f32; 4],
    /// Of linked sections: 1 for those that sound.
    pub(super) sounding: [f32; 4],
    /// Size of v that a u of 1 turns into: sqrt(b / a).
    worth: [f32; 4],
    count: usize,
    is_mirrored: bool,
    is_linked: bool,
}

/// States smaller than this, a step of the bus, are silence; behind one another a thousandth of it.
const SILENCE: f32 = 1.0 / 134_217_728.0;

impl Quad {
    /// No sections.
    pub const EMPTY: Self = Self {
        u: [0.0; 4],
        v: [0.0; 4],
        kept: [0.0; 4],
        turn: [0.0; 4],
        entry: [0.0; 4],
        gain: [0.0; 4],
        awake: 0,
        couple: [0.0; 4],
        sounding: [0.0; 4],
        worth: [0.0; 4],
        count: 0,
        is_mirrored: false,
        is_linked: false,
    };

    /// An empty quad for parts of a kind: mirrored or not, linked or not.
    pub(super) fn for_cluster(cluster: &[Part<FloatPole>]) -> Self {
        let is_mirrored = cluster.first().is_some_and(|part| part.pole.mirrored);
        Self { is_mirrored, is_linked: cluster.len() > 1, ..Self::EMPTY }
    }

    /// Takes the parts of a cluster and gives true, if it has room and is of their kind.
    pub(super) fn take(&mut self, cluster: &[Part<FloatPole>]) -> bool {
        let like = Self::for_cluster(cluster);
        let fits = self.count + cluster.len() <= 4 && self.key() == like.key();
        if fits {
            for (index, part) in cluster.iter().enumerate() {
                self.put(part, index + 1 == cluster.len());
            }
        }
        fits
    }

    fn put(&mut self, part: &Part<FloatPole>, sounds: bool) {
        let [wanted, gain] = part.gains;
        let e = libm::sqrt(part.pole.step_squared);
        let smallest = (gain.abs() * e / 1_048_576.0).max(1e-25);
        let entry = if wanted.abs() < smallest { libm::copysign(smallest, wanted) } else { wanted };
        let (turn, entry) = factors(part.pole.step_squared, entry);
        let at = self.count;
        let set = |field: &mut [f32; 4], value: f32| {
            if let Some(slot) = field.get_mut(at) {
                *slot = value;
            }
        };
        set(&mut self.kept, part.pole.kept);
        set(&mut self.turn, turn);
        set(&mut self.entry, entry);
        set(&mut self.gain, gain as f32);
        set(&mut self.couple, (part.handed / f64::from(entry)) as f32);
        set(&mut self.sounding, if sounds { 1.0 } else { 0.0 });
        set(&mut self.worth, libm::sqrt((f64::from(entry) / f64::from(turn)).abs()) as f32);
        self.count += 1;
    }

    /// Orders quads: plain ones, mirrored ones, then linked ones of each kind.
    pub(super) fn key(&self) -> (bool, bool) {
        (self.is_linked, self.is_mirrored)
    }

    /// True if its sections stand behind one another.
    pub(super) fn is_linked(&self) -> bool {
        self.is_linked
    }

    /// True if it runs on input and output of alternating sign.
    pub(super) fn is_mirrored(&self) -> bool {
        self.is_mirrored
    }

    /// Clears the states and leaves it out.
    pub(super) fn rest(&mut self) {
        (self.u, self.v, self.awake) = ([0.0; 4], [0.0; 4], 0);
    }

    /// True if it will still be heard without input. States that are no numbers are not.
    pub(super) fn is_heard(&self) -> bool {
        let silence = if self.is_linked { SILENCE / 1000.0 } else { SILENCE };
        let mut states = self.u.iter().zip(&self.v).zip(&self.worth).take(self.count);
        states.any(|((u, v), worth)| (u * worth).abs() > silence || v.abs() > silence)
    }
}

/// a and b with `a b` nearest to e², for b within a few of its own roundings.
fn factors(step_squared: f64, entry: f64) -> (f32, f32) {
    let middle = entry as f32;
    let around = (-64i32..=64).map(|steps| f32::from_bits(middle.to_bits().wrapping_add_signed(steps)));
    let pairs = around.map(|entry| ((step_squared / f64::from(entry)) as f32, entry));
    let off = |&(turn, entry): &(f32, f32)| (f64::from(turn) * f64::from(entry) / step_squared - 1.0).abs();
    pairs.min_by(|one, other| off(one).total_cmp(&off(other))).unwrap_or((0.0, middle))
}
