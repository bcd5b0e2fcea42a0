//! The instrument's room network in double precision: a twin that proves its arithmetic.
//!
//! It shares everything with `dsp-core`'s room but rounding and bounds: the feed's all-passes, the
//! crossovers, the delays, the angles, and the cycle counts from which the number of sections
//! follows. So it shows sample by sample that the instrument computes the intended network. A
//! comparison with [`super::room`] shows that this network is a good room.

mod crossover;
mod feed;
mod network;
mod plan;
mod split;

use self::plan::{BLOCK_FRAMES, plans};
use crate::rate::SampleRate;
use crate::room::band::RoomBand;

/// Reverberation of a stereo sound (left, right) by the network, without the sound itself.
///
/// All delays together hold at most `samples` values. Bands are trusted to rise from 0 and to stay
/// below 0.49 of the sample rate.
pub fn network_twin(bands: &[RoomBand], dry: [&[f64]; 2], rate: SampleRate, samples: usize) -> [Vec<f64>; 2] {
    let hz = rate.hz();
    let plans = plans(bands, hz, samples);
    let frames = dry[0].len();
    let blocks = frames.div_ceil(BLOCK_FRAMES);
    let mut low = feed::feed(dry);
    low.resize(blocks * BLOCK_FRAMES, 0.0);
    let (mut division, mut answers) = (1, Vec::new());
    for plan in plans.iter().rev() {
        low = low.into_iter().step_by(plan.division / division).collect();
        division = plan.division;
        let high = match &plan.crossover {
            None => std::mem::take(&mut low),
            Some(crossover::Crossover { low_pass, tangent }) => {
                let (below, above) = split::split(&low, low_pass, *tangent);
                low = below;
                above
            }
        };
        answers.push((division, network::render(plan, &high, hz)));
    }
    // Doubles the rate of a signal that runs at the full rate over `division`.
    let double = |signal: &[f64], division: usize| {
        let slow = plans.iter().filter(|plan| plan.division >= division);
        let highest_hz = slow.map(|plan| plan.to_hz).fold(0.0, f64::max);
        split::double(signal, highest_hz * division as f64 / hz)
    };
    let mut sum = [Vec::new(), Vec::new()];
    for (own, answer) in answers.into_iter().rev() {
        for (sum, answer) in sum.iter_mut().zip(answer) {
            let mut slower = division;
            while slower > own {
                *sum = double(sum, slower);
                slower /= 2;
            }
            sum.resize(answer.len(), 0.0);
            sum.iter_mut().zip(answer).for_each(|(sum, answer)| *sum += answer);
        }
        division = own;
    }
    while division > 1 {
        sum = sum.map(|side| double(&side, division));
        division /= 2;
    }
    sum.map(|side| std::iter::repeat_n(0.0, 2 * BLOCK_FRAMES).chain(side).take(frames).collect())
}
