//! The decision at the end of a scan: which sensor of the pad plays, whether the peak is a strike
//! or crosstalk, and its velocity.

use super::crosstalk;
use super::lane::Lane;
use super::units::COUNT;

/// Strike that a scan has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Verdict {
    pub(super) pad: u8,
    pub(super) striker: u8,
    pub(super) velocity: f32,
}

/// Decides the scan of channel `index`, and ends it together with that of the pad's other sensor.
/// `None` if the scan found no strike.
pub(super) fn decide(lanes: &mut [Option<Lane>], index: usize) -> Option<Verdict> {
    let lane = lanes.get(index)?.as_ref()?;
    let partner = lane.config.partner.map(usize::from);
    let rival = partner.and_then(|partner| lanes.get(partner)?.as_ref()).filter(|rival| rival.channel.is_scanning);
    let winner = match rival {
        Some(rival) if loudness(rival) > loudness(lane) => rival,
        _ => lane,
    };
    let Lane { channel, config, .. } = winner;
    let peak = channel.scanned_peak();
    let others = lanes.iter().enumerate().filter(|&(other, _)| other != index && Some(other) != partner);
    let elsewhere = others.filter_map(|(_, lane)| lane.as_ref()).map(|lane| lane.channel.recent_peak());
    let is_strike = peak >= config.threshold_peak && !crosstalk::explains(peak, elsewhere, config.crosstalk);
    let velocity = config.curve.velocity(peak as f32 / COUNT as f32, channel.scan.saturated);
    let verdict = Verdict { pad: config.pad, striker: config.striker, velocity };
    for sensor in [Some(index), partner].into_iter().flatten() {
        if let Some(Some(lane)) = lanes.get_mut(sensor) {
            lane.channel.end_scan(is_strike, &lane.config);
        }
    }
    (is_strike && velocity > 0.0).then_some(verdict)
}

/// Peak of a lane's scan, weighed against that of the pad's other sensor.
fn loudness(lane: &Lane) -> f32 {
    lane.channel.scanned_peak() as f32 * lane.config.rivalry
}

/// Number of frames until the channel's scan is decided; `None` if no scan is on.
pub(super) fn frames_left(lane: &Lane, now: u32) -> Option<u32> {
    lane.channel.is_scanning.then(|| lane.channel.scan.decide_at.wrapping_sub(now))
}

/// True if the channel's scan is decided at frame `now`.
pub(super) fn is_due(lane: &Lane, now: u32) -> bool {
    frames_left(lane, now) == Some(0)
}
