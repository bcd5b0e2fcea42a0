//! Motions that leave the object that they scrape.

use std::fmt::{self, Display, Formatter};

use dsp_core::SampleRate;
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;
use kit::counting::counted;

use super::contacts::{object_size_m, pad_name};
use crate::motion::Motion;

/// Share of the size by which rounding may put a place at the edge beyond it.
const ROUNDING: f64 = 1e-5;

/// Places of a motion on a pad that lie beyond the object's edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Beyond {
    /// Name of the pad.
    pub pad: String,
    /// Size of the pad's object in metres.
    pub size_m: [f32; 2],
    /// Number of times that the motion leaves the object.
    pub times: usize,
    /// Time of the first place beyond an edge, in seconds.
    pub first_s: f64,
    /// First place beyond an edge, in metres from the object's middle.
    pub first_m: [f64; 2],
    /// Time beyond the edges, in seconds.
    pub whole_s: f64,
}

impl Display for Beyond {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { pad, size_m: [length_m, width_m], times, first_s, first_m: [x_m, y_m], whole_s } = self;
        write!(
            f,
            "pad {pad}: the motion leaves the object {}, first at {first_s:.3} s at {x_m:.4},{y_m:.4} m, for {whole_s:.3} s in all; \
             its modes sound there as at its end (size_m = [{length_m}, {width_m}] of the object, 0,0 is its middle)",
            counted(*times, "times")
        )
    }
}

/// Places of a motion beyond the edges of the objects, for each pad that has any.
///
/// An engine plays these places with the modes' gains at the object's end, and says nothing.
pub fn beyond(motion: &Motion, kit: &Kit<'_>, rate: SampleRate) -> Vec<Beyond> {
    let mut found: Vec<(u8, Beyond)> = Vec::new();
    let tick_s = TICK_FRAMES as f64 / rate.hz();
    let mut reader = motion.reader();
    let mut last = None;
    for tick in 1..=(motion.end_s() / tick_s) as usize {
        let time_s = tick as f64 * tick_s;
        let outside = reader.at(time_s).and_then(|state| {
            let touch = motion.contacts().get(state.contact)?;
            let size_m = object_size_m(kit, touch);
            let is_outside =
                |axis: usize| state.position_m[axis].abs() > 0.5 * f64::from(size_m[axis]) * (1.0 + ROUNDING);
            (is_outside(0) || is_outside(1)).then_some((state, touch, size_m))
        });
        let before = std::mem::replace(&mut last, outside.as_ref().map(|(state, ..)| state.contact));
        let Some((state, touch, size_m)) = outside else { continue };
        let index = found.iter().position(|(pad, _)| *pad == touch.pad).unwrap_or_else(|| {
            let (pad, first_m) = (pad_name(kit, touch), state.position_m);
            found.push((touch.pad, Beyond { pad, size_m, times: 0, first_s: time_s, first_m, whole_s: 0.0 }));
            found.len() - 1
        });
        let (_, beyond) = &mut found[index];
        beyond.times += usize::from(before != Some(state.contact));
        beyond.whole_s += tick_s;
    }
    found.into_iter().map(|(_, beyond)| beyond).collect()
}
