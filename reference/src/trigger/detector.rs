//! Detection over all channels: finds the pad and striker of a strike, and its velocity.

use super::adc::{HALF_RANGE_COUNTS, TICK_FRAMES};
use super::piezo::Piezo;
use super::settings::PiezoSettings;
use crate::rate::SampleRate;

/// Strike that was detected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strike {
    /// ADC frame of the decision. It is onset plus scan time, and at least one tick after the onset
    /// is noticed.
    pub frame: usize,
    /// Index of the pad that was struck.
    pub pad: usize,
    /// Index of the striker within the pad.
    pub striker: usize,
    /// Velocity, 0 to 1.
    pub velocity: f64,
}

struct Lane {
    piezo: Piezo,
    pad: usize,
    striker: usize,
    partner: Option<usize>,
    rivalry: f64,
}

/// Finds the strikes in frames of ADC counts, one count a channel.
///
/// Ignores pads whose channel does not exist in the frames.
pub fn detect(frames: &[Vec<u16>], pads: &[PiezoSettings], rate: SampleRate) -> Vec<Strike> {
    let Some(first) = frames.first() else { return Vec::new() };
    let mut lanes: Vec<Option<Lane>> = first.iter().map(|_| None).collect();
    for (pad, settings) in pads.iter().enumerate() {
        let sensors = [
            Some((settings.channel, 0, settings.rim.map(|rim| rim.channel), 1.0)),
            settings.rim.map(|rim| (rim.channel, rim.striker, Some(settings.channel), 10f64.powf(rim.gain_db / 20.0))),
        ];
        for (channel, striker, partner, rivalry) in sensors.into_iter().flatten() {
            if let (Some(lane), Some(&count)) = (lanes.get_mut(channel), first.get(channel)) {
                let piezo = Piezo::new(*settings, count, rate.hz());
                *lane = Some(Lane { piezo, pad, striker, partner, rivalry });
            }
        }
    }
    let mut strikes = Vec::new();
    for (frame, counts) in frames.iter().enumerate() {
        for (lane, &count) in lanes.iter_mut().zip(counts) {
            if let Some(lane) = lane {
                lane.piezo.push(count, frame);
            }
        }
        let now = frame + 1;
        if now % TICK_FRAMES == 0 {
            lanes.iter_mut().flatten().for_each(|lane| lane.piezo.tick());
        }
        for channel in 0..lanes.len() {
            let is_due = |lane: &Lane| lane.piezo.scan.as_ref().is_some_and(|scan| scan.decide_at == now);
            if lanes[channel].as_ref().is_some_and(is_due) {
                strikes.extend(decide(&mut lanes, channel, pads, now));
            }
        }
    }
    strikes
}

fn decide(lanes: &mut [Option<Lane>], channel: usize, pads: &[PiezoSettings], now: usize) -> Option<Strike> {
    let lane = lanes[channel].as_ref()?;
    let partner = lane.partner.filter(|&partner| partner < lanes.len());
    let loudness = |lane: &Lane| lane.piezo.scanned_peak() * lane.rivalry;
    let rival = partner.and_then(|partner| lanes[partner].as_ref()).filter(|rival| rival.piezo.scan.is_some());
    let winner = rival.filter(|rival| loudness(rival) > loudness(lane)).unwrap_or(lane);
    let settings = &pads[winner.pad];
    let peak = winner.piezo.scanned_peak();
    let others = (0..lanes.len()).filter(|&other| other != channel && Some(other) != partner);
    let elsewhere: f64 = others.filter_map(|other| lanes[other].as_ref()).map(|lane| lane.piezo.recent_peak()).sum();
    let scan = winner.piezo.scan.as_ref()?;
    let linear = (peak / (settings.full_scale * HALF_RANGE_COUNTS)).clamp(0.0, 1.0);
    let velocity = if scan.saturated { 1.0 } else { linear.powf(settings.velocity_exponent) };
    let is_strike = peak >= settings.threshold * HALF_RANGE_COUNTS
        && peak >= elsewhere * 10f64.powf(settings.crosstalk_db / 20.0)
        && velocity > 0.0;
    let strike = Strike { frame: now, pad: winner.pad, striker: winner.striker, velocity };
    for sensor in [Some(channel), partner].into_iter().flatten() {
        if let Some(lane) = &mut lanes[sensor] {
            lane.piezo.end_scan(is_strike);
        }
    }
    is_strike.then_some(strike)
}
