//! Residuals and background: the noise beside the modes, where an engine has room for it.

use core::iter::Peekable;
use core::slice::IterMut;

use super::{Engine, Fitting, Left, LoadError, Stage, Surroundings};
use crate::SampleRate;
use crate::noise::Sfc32;
use crate::output::Panner;
use crate::residual::Shaper;
use crate::resonator::TICK_FRAMES;
use crate::table::Kit;

/// An engine's room for noise: [`NoResiduals`], or [`Residuals`] of some number.
pub trait ResidualRoom {
    /// All silent.
    const EMPTY: Self;

    /// The places.
    fn places(&self) -> &[Place];

    /// The places to be changed.
    fn places_mut(&mut self) -> &mut [Place];
}

/// No room: no memory and no code. A kit's residuals and background are then not heard.
#[derive(Clone, Copy, Debug)]
pub struct NoResiduals;

/// Room for so many pads with a residual, the background counting as one; 24 KB each.
pub type Residuals<const COUNT: usize> = [Place; COUNT];

impl ResidualRoom for NoResiduals {
    const EMPTY: Self = Self;

    #[inline(always)]
    fn places(&self) -> &[Place] {
        &[]
    }

    #[inline(always)]
    fn places_mut(&mut self) -> &mut [Place] {
        &mut []
    }
}

impl<const COUNT: usize> ResidualRoom for Residuals<COUNT> {
    const EMPTY: Self = [const { Place::FREE }; COUNT];

    fn places(&self) -> &[Place] {
        self
    }

    fn places_mut(&mut self) -> &mut [Place] {
        self
    }
}

/// What sounds at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    Nobody,
    Pad(u8),
    Background,
}

/// Room for one residual or the background.
#[derive(Clone, Debug)]
pub struct Place {
    owner: Owner,
    /// What it takes while it sounds.
    cycles: u32,
    shaper: Shaper,
    panner: Panner,
}

impl Place {
    /// Of nobody.
    pub const FREE: Self = Self { owner: Owner::Nobody, cycles: 0, shaper: Shaper::NONE, panner: Panner::SILENT };
}

/// Where there are no places at all.
fn pass_over<F: Fitting>(kit: &Kit<'_>, fitting: &mut F) {
    if !F::TELLS {
        return;
    }
    for (pad, number) in kit.pads().zip(0u8..) {
        if kit.residual_of(pad.object_index()).is_some() {
            fitting.pass_over(Stage::Residual(number));
        }
    }
    if kit.background().is_some() {
        fitting.pass_over(Stage::Background);
    }
}

/// The next free place, as its owner's; `None` where the noise is left out.
fn next_place<'p>(
    free: &mut Peekable<IterMut<'p, Place>>,
    (owner, panner): (Owner, Panner),
    (bands, edge_hz): (usize, f32),
    (capacity, rate): (usize, SampleRate),
    fitting: &mut impl Fitting,
) -> Result<Option<&'p mut Place>, LoadError> {
    let (pad, stage) = match owner {
        Owner::Pad(pad) => (Some(pad), Stage::Residual(pad)),
        _ => (None, Stage::Background),
    };
    if f64::from(edge_hz) > rate.hz() / 2.0 {
        return fitting.leave_out(LoadError::BeyondNyquist { pad, edge_hz, rate }).map(|()| None);
    }
    if free.peek().is_none() {
        return fitting.leave_out(LoadError::TooManyResiduals { pad, capacity }).map(|()| None);
    }
    let cycles = Shaper::dearest_tick(bands);
    let cycles = match owner {
        Owner::Background => fitting.take(stage, cycles).then_some(0),
        _ => fitting.afford(stage, cycles),
    };
    let Some((place, cycles)) = cycles.and_then(|cycles| Some((free.next()?, cycles))) else { return Ok(None) };
    (place.owner, place.panner, place.cycles) = (owner, panner, cycles);
    Ok(Some(place))
}

/// Output below which noise ends, rms: -110 dBFS.
const SILENCE: f32 = 3.162_277_7e-6;

impl<
    'k,
    const PADS: usize,
    const BANKS: usize,
    const MODES: usize,
    const GROUPS: usize,
    const ORIGINS: usize,
    const CONTACTS: usize,
    S: Surroundings,
> Engine<'k, PADS, BANKS, MODES, GROUPS, ORIGINS, CONTACTS, S>
{
    /// Derives the residuals of all pads whose object has one, and the background, and begins it.
    #[inline(never)] // its stack is not that of the stages that follow
    pub(super) fn load_noise(
        &mut self,
        kit: &Kit<'_>,
        rate: SampleRate,
        fitting: &mut impl Fitting,
    ) -> Result<(), LoadError> {
        let places = self.residuals.places_mut();
        for place in places.iter_mut() {
            place.owner = Owner::Nobody;
            place.shaper.reset();
        }
        let capacity = places.len();
        if capacity == 0 {
            pass_over(kit, fitting);
            return Ok(());
        }
        let mut free = places.iter_mut().peekable();
        if let Some(background) = kit.background() {
            let own = (Owner::Background, Panner::new(0.0, 0.0));
            let highest_hz = background.bands().last().map_or(0.0, |band| band.edges_hz[1]);
            let bands = (background.bands().count(), highest_hz);
            if let Some(place) = next_place(&mut free, own, bands, (capacity, rate), fitting)? {
                let noise = Sfc32::new(background.seed(), u32::MAX);
                place.shaper.load(background.bands(), rate, noise, 0.0);
                place.shaper.begin();
            }
        }
        for (pad, number) in kit.pads().zip(0u8..) {
            let Some(residual) = kit.residual_of(pad.object_index()) else { continue };
            let own = (Owner::Pad(number), Panner::new(pad.level_db(), pad.pan()));
            let highest_hz = residual.bands().last().map_or(0.0, |band| band.edges_hz[1]);
            let bands = (residual.bands().count(), highest_hz);
            let Some(place) = next_place(&mut free, own, bands, (capacity, rate), fitting)? else { continue };
            let noise = Sfc32::new(residual.seed(), u32::from(number));
            let choke_t60_s = f64::from(pad.choke_t60_s());
            let hand_db_per_s = if choke_t60_s > 0.0 { 60.0 / choke_t60_s } else { 0.0 };
            let silence = SILENCE / place.panner.loudest();
            place.shaper.load_choked(residual.bands(), rate, noise, silence, hand_db_per_s);
        }
        Ok(())
    }

    /// A strike of a pad, its peak force in bus steps.
    #[inline(never)]
    pub(super) fn strike_noise(&mut self, pad: u8, peak: i32, left: &mut Left) {
        let offset = (self.now % TICK_FRAMES as u64) as usize;
        for place in self.residuals.places_mut().iter_mut().filter(|place| place.owner == Owner::Pad(pad)) {
            if !left.admits(place.shaper.is_active(), place.cycles) {
                continue;
            }
            place.shaper.strike(peak as f32 / crate::fixed::ONE_Q27 as f32, offset);
        }
    }

    /// A hand that comes to a pad or goes, on a tick.
    pub(super) fn choke_noise(&mut self, pad: u8, lies: bool) {
        for place in self.residuals.places_mut().iter_mut().filter(|place| place.owner == Owner::Pad(pad)) {
            place.shaper.set_choked(lies);
        }
    }

    /// Adds all noise to a run of the stereo bus.
    #[inline(always)]
    pub(super) fn render_noise(&mut self, out: &mut [[i32; 2]]) {
        if self.noisy {
            self.add_noise(out);
        }
    }

    #[inline(never)] // its buffer and registers must not weigh on kits without
    fn add_noise(&mut self, out: &mut [[i32; 2]]) {
        for place in self.residuals.places_mut().iter_mut().filter(|place| place.shaper.is_active()) {
            let mut sound = [0; TICK_FRAMES];
            let Some(sound) = sound.get_mut(..out.len()) else { continue };
            place.shaper.render(sound);
            place.panner.render(sound, out);
            match place.owner {
                Owner::Background => self.report.background_frames += out.len() as u32,
                _ => self.report.residual_frames += out.len() as u32,
            }
        }
    }

    /// What noise to come needs in this tick.
    #[inline(always)]
    pub(super) fn end_noise_tick(&mut self) {
        if self.noisy {
            self.work_on_noise();
        }
    }

    #[inline(never)]
    fn work_on_noise(&mut self) {
        for place in self.residuals.places_mut().iter_mut().filter(|place| place.shaper.is_active()) {
            place.shaper.end_tick();
        }
        self.report.residuals = self.noises() as u32;
    }

    /// What residuals that sound take.
    #[inline(always)]
    pub(super) fn sounding_noise_cycles(&self) -> u32 {
        self.residuals.places().iter().filter(|place| place.shaper.is_active()).map(|place| place.cycles).sum()
    }

    /// Residuals that sound, and the background.
    #[inline(always)]
    pub(super) fn noises(&self) -> usize {
        if self.noisy { self.count_noises() } else { 0 }
    }

    #[inline(never)]
    fn count_noises(&self) -> usize {
        self.residuals.places().iter().filter(|place| place.shaper.is_active()).count()
    }

    /// Cycles that the work on noise to come takes in this tick.
    #[inline(always)]
    pub(super) fn noise_cycles(&self) -> u32 {
        if self.noisy { self.cycles_of_noise() } else { 0 }
    }

    #[inline(never)]
    fn cycles_of_noise(&self) -> u32 {
        self.residuals.places().iter().map(|place| place.shaper.cycles_ahead()).sum()
    }

    /// Whether any has been loaded.
    pub(super) fn has_any_noise(&self) -> bool {
        self.residuals.places().iter().any(|place| place.owner != Owner::Nobody)
    }

    /// Whether a strike of a pad begins noise.
    #[inline(always)]
    pub(super) fn has_noise(&self, pad: u8) -> bool {
        self.noisy && self.residuals.places().iter().any(|place| place.owner == Owner::Pad(pad))
    }
}
