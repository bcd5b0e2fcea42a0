//! Strikes that clip at velocity 1, and the numbers of the kit that fit.

use malleus::render::force;
use malleus::render::headroom::{self, Loudness, OWN_END, TARGET_DBFS};
use serde::Serialize;

/// Finding of one striker on one pad.
#[derive(Debug, Serialize)]
pub(super) struct StrikeFinding {
    pub(super) pad: String,
    striker: String,
    /// Peak force in reference forces; the force bus ends at 16.
    force: f64,
    position: f32,
    peak_dbfs: Option<f64>,
    /// Peak of the pad's own sound before its level, which is clipped at +24 dBFS.
    own_peak_dbfs: Option<f64>,
    /// Reference force with which the force bus does not clip; `None` if it does not clip now.
    fitting_reference_force: Option<f32>,
    /// Change in dB of the object's gains with which no pad's own sound clips; `None` if no pad's
    /// that plays the object clips now.
    fitting_gain_db: Option<f64>,
    /// Level with which the pad's loudest striker peaks at -6 dBFS, with the gains that fit; `None`
    /// if neither the pad clips now nor the own sound of any pad of its object.
    fitting_level_db: Option<f32>,
    #[serde(skip)]
    object: String,
    #[serde(skip)]
    needs_rescaling: bool,
}

impl StrikeFinding {
    /// Finding of a strike among all strikes of the kit; `None` if the kit has no such striker.
    pub(super) fn of(kit: &kit::Kit, strike: &Loudness, all: &[Loudness]) -> Option<Self> {
        let pad = kit.pads.get(strike.pad)?;
        let (striker, object) = force::bound(kit, pad, strike.striker)?;
        let reference_force = || headroom::fitting_reference_force(kit, &object.name, 0.0);
        // Lower gains make all pads of the object softer, also those that do not clip.
        let gain = headroom::fitting_gain(kit, &object.name, all, OWN_END);
        let of_pad = all.iter().filter(|other| other.pad == strike.pad);
        let loudest = of_pad.map(|other| other.peak).fold(0.0, f64::max) * gain.unwrap_or(1.0);
        let clips = strike.clips() || gain.is_some();
        Some(Self {
            pad: pad.name.clone(),
            striker: striker.name.clone(),
            force: strike.force,
            position: strike.position,
            peak_dbfs: dbfs(strike.peak),
            own_peak_dbfs: dbfs(strike.own_peak),
            fitting_reference_force: strike.overloads_force().then(reference_force).flatten(),
            fitting_gain_db: gain.map(|gain| (200.0 * gain.log10()).floor() / 10.0),
            fitting_level_db: clips.then(|| headroom::fitting_level_db(pad.level_db, loudest)),
            object: object.name.clone(),
            needs_rescaling: object.residual.is_some() || object.dynamic_filter.is_some(),
        })
    }

    /// A line for each place where the strike clips.
    pub(super) fn as_lines(&self, name: &str) -> Vec<String> {
        let Self { pad, striker, object, force, .. } = self;
        let mut lines = Vec::new();
        if let Some(newtons) = self.fitting_reference_force {
            let rest = match self.needs_rescaling {
                true => ", with the object's residual and dynamic filter scaled to it (docs/kit-format.md)",
                false => "",
            };
            lines.push(format!(
                "{name}: pad {pad:?} with {striker:?} at velocity 1: the force is {force:.1} times reference_force and clips at 16; reference_force = {newtons} fits{rest}"
            ));
        }
        if let (Some(gain_db), Some(own_dbfs)) = (self.fitting_gain_db, self.own_peak_dbfs) {
            let clips = if own_dbfs > 20.0 * OWN_END.log10() { " and clips at +24 dBFS" } else { "" };
            let softer_db = -gain_db;
            lines.push(format!(
                "{name}: pad {pad:?} with {striker:?} at velocity 1: its own sound peaks at {own_dbfs:+.1} dBFS before level_db{clips}; gains of object {object:?} {softer_db:.1} dB lower fit"
            ));
        }
        if let (Some(level_db), Some(peak_dbfs)) = (self.fitting_level_db, self.peak_dbfs) {
            let clips = if peak_dbfs > 0.0 { " and clips" } else { "" };
            let gains = if self.fitting_gain_db.is_some() { "with these gains " } else { "" };
            lines.push(format!(
                "{name}: pad {pad:?} with {striker:?} at velocity 1 peaks at {peak_dbfs:+.1} dBFS{clips}; {gains}level_db = {level_db:.1} fits and peaks at {TARGET_DBFS:.0} dBFS"
            ));
        }
        lines
    }
}

/// Peak in dBFS; `None` for silence.
pub(super) fn dbfs(peak: f64) -> Option<f64> {
    (peak > 0.0).then(|| 20.0 * peak.log10())
}
