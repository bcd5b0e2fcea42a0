//! Scenes of the whole engine and of the bank alone, and their cost on the chip.

use dsp_core::SampleRate;
use dsp_core::engine::Direct;
use dsp_core::event::{Event, Time};
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::layout::{GainRecord, ModeRecord};
use kit::{Gain, Kit, Loaded, Object, Pad};
use virtual_core::Cost;

use super::{BankOnChip, EngineOnChip, OnChipError};
use crate::run_time::rows::SceneRow;
use crate::scene::{load, mode, one_pad};

/// Number of modes of a pad of [`pads`].
pub const MODES_PER_PAD: usize = 64;

/// Kit of equal pads with 64 modes each: three quarters from 80 Hz to 3.8 kHz, a quarter from 3.9
/// to 11.5 kHz, T60 3 s falling to 0.8 s, sine gains.
pub fn pads(count: usize) -> Loaded {
    pads_of(count, 1)
}

/// Kit of equal pads with `turns` times 64 modes each. Turn n lies 1.3 n % above the first.
pub fn pads_of(count: usize, turns: usize) -> Loaded {
    let Kit { objects, strikers, pads, .. } = one_pad(Vec::new());
    let (objects, pads) = (0..count)
        .map(|index| {
            let name = format!("object {index}");
            let detune = 1.0 + 0.001 * index as f64;
            let hz = (0..turns).flat_map(|turn| frequencies().map(move |hz| hz * (1.0 + 0.013 * turn as f64)));
            let modes = hz.map(|hz| mode(hz * detune, 3.0 / (1.0 + hz / 4000.0), 120.0, 0.0)).collect();
            let pan = index as f32 / count as f32 * 2.0 - 1.0;
            (
                Object { name: name.clone(), modes, ..objects[0].clone() },
                Pad { name: format!("pad {index}"), object: name, pan, level_db: -12.0, ..pads[0].clone() },
            )
        })
        .unzip();
    load(Kit {
        name: format!("{count} pads"),
        objects,
        strikers,
        pads,
        background: None,
        room: vec![],
        headphone_db: None,
        surfaces: Vec::new(),
    })
}

/// Kit of [`pads`] that can be choked, with a choke T60 of 0.1 s.
pub fn choked_pads(count: usize) -> Loaded {
    let mut kit = pads(count).kit;
    kit.pads.iter_mut().for_each(|pad| pad.choke_t60_s = 0.1);
    load(kit)
}

/// Kit of [`choked_pads`] with gains at three positions and contacts of 3 ms.
pub fn pads_with_positions(count: usize) -> Loaded {
    let mut kit = choked_pads(count).kit;
    for mode in kit.objects.iter_mut().flat_map(|object| &mut object.modes) {
        let gain = mode.gains[0];
        let weaker = |share: f32| Gain { sine: gain.sine * share, cosine: gain.cosine };
        mode.gains = vec![gain, weaker(0.3), weaker(-0.7)];
    }
    kit.strikers.iter_mut().for_each(|striker| striker.contact_time_s = 0.003);
    load(kit)
}

fn frequencies() -> impl Iterator<Item = f64> {
    let low = (0..48).map(|n| 80.0 * (3800.0f64 / 80.0).powf(f64::from(n) / 48.0));
    low.chain((0..16).map(|n| 3900.0 * (11_500.0f64 / 3900.0).powf(f64::from(n) / 15.0)))
}

/// Strikes on every pad of a kit at one frame.
pub fn strikes(pads: usize, frame: u64, velocity: f32) -> Vec<Event> {
    let event = Event { time: Time::at_frame(frame), velocity, ..Event::default() };
    (0..pads).map(|pad| Event { pad: pad as u8, ..event }).collect()
}

/// Cost of a scene: all its measured ticks together, and the dearest of them.
#[derive(Clone, Copy, Debug, Default)]
pub struct SceneCost {
    /// Number of measured ticks.
    pub ticks: usize,
    /// Cost of all measured ticks together.
    pub total: Cost,
    /// Cost of the tick with the most nominal cycles.
    pub dearest_tick: Cost,
    /// Peak stack of a render call in bytes.
    pub stack_bytes: u32,
}

impl SceneCost {
    pub(super) fn add(&mut self, cost: Cost) {
        self.ticks += 1;
        self.total += cost;
        if cost.nominal > self.dearest_tick.nominal {
            self.dearest_tick = cost;
        }
    }

    /// Nominal cycles a frame, the mean of all measured ticks.
    pub fn mean(&self) -> f64 {
        self.total.nominal as f64 / (self.ticks * TICK_FRAMES) as f64
    }

    /// Nominal cycles a frame of the dearest tick.
    pub fn dearest(&self) -> f64 {
        self.dearest_tick.nominal as f64 / TICK_FRAMES as f64
    }

    fn row(&self, scene: &str, modes: usize) -> SceneRow {
        let frames = (self.ticks * TICK_FRAMES) as f64;
        let per_frame = self.mean();
        let share = |clock_hz: f64| per_frame * 48_000.0 / clock_hz;
        SceneRow {
            scene: scene.into(),
            modes: modes as u32,
            cycles_per_frame_nominal: per_frame,
            cycles_per_frame_with_flash: self.total.with_flash() as f64 / frames,
            share_of_168_mhz: share(168e6),
            share_of_96_mhz: share(96e6),
        }
    }
}

/// Plays events on the chip tick by tick, and measures the ticks from `from` to `to`.
///
/// `direct` is a force on pad 0, repeated if it is shorter than the scene.
///
/// # Errors
/// [`OnChipError`].
pub fn measure(
    chip: &mut EngineOnChip,
    kit: &[u8],
    events: &[Event],
    direct: Option<&[i32]>,
    (from, to): (usize, usize),
) -> Result<SceneCost, OnChipError> {
    chip.load(kit, SampleRate::HZ_48000)?;
    let mut cost = SceneCost::default();
    for tick in 0..to {
        let frames = (tick * TICK_FRAMES) as u64..((tick + 1) * TICK_FRAMES) as u64;
        let now: Vec<Event> = events.iter().filter(|e| frames.contains(&e.time.first_frame())).copied().collect();
        let force: Option<Vec<i32>> =
            direct.map(|force| force.iter().cycle().skip(tick * TICK_FRAMES).take(TICK_FRAMES).copied().collect());
        let direct = force.as_ref().map(|force| Direct { pad: 0, force });
        let (_, call) = chip.render(&now, direct, TICK_FRAMES)?;
        cost.stack_bytes = cost.stack_bytes.max(call.stack_bytes);
        if tick >= from {
            cost.add(call.cost);
        }
    }
    Ok(cost)
}

/// Measures the bank alone, ringing freely, with guards and retirement.
///
/// # Errors
/// [`OnChipError`].
pub fn bank_alone(chip: &mut BankOnChip, modes: usize) -> Result<SceneRow, OnChipError> {
    let (records, gains): (Vec<_>, Vec<_>) = (0..modes)
        .map(|n| {
            let (hz, turn) = (frequencies().nth(n % MODES_PER_PAD).unwrap_or(80.0), n / MODES_PER_PAD);
            let (hz, decay) = (hz * (1.0 + 0.001 * turn as f64), 2.3 * (1.0 + hz / 4000.0));
            (
                ModeRecord { frequency_hz: (hz as f32).into(), decay_per_s: (decay as f32).into() },
                GainRecord { sine: 3000.0.into(), cosine: 0.0.into() },
            )
        })
        .unzip();
    chip.load(&records, &gains, 48_000)?;
    chip.render(Some(&[1 << 20; TICK_FRAMES]), TICK_FRAMES)?;
    let mut cost = SceneCost::default();
    for tick in 0..48 {
        let (_, guard) = chip.tick(true)?;
        let (_, render) = chip.render(None, TICK_FRAMES)?;
        if tick >= 16 {
            cost.add(guard + render);
        }
    }
    Ok(cost.row(&format!("bank alone, {modes} modes"), modes))
}

/// Measures all scenes of the table.
///
/// # Errors
/// [`OnChipError`].
pub fn measure_all() -> Result<Vec<SceneRow>, OnChipError> {
    let mut bank = BankOnChip::new()?;
    let mut rows = Vec::new();
    for modes in [16, 64, 256, 512, 640] {
        rows.push(bank_alone(&mut bank, modes)?);
    }
    let mut chip = EngineOnChip::new()?;
    let demo = kit::open("demo").expect("the demo kit ships with the project");
    let demo_modes = |pads: &[Pad]| {
        let object = |pad: &Pad| demo.kit.objects.iter().find(|object| object.name == pad.object);
        pads.iter().filter_map(object).map(|object| object.modes.len()).sum::<usize>()
    };
    let (first, all) = (demo_modes(&demo.kit.pads[..1]), demo_modes(&demo.kit.pads));
    let once = |chip: &mut EngineOnChip, events: &[Event]| measure(chip, &demo.binary, events, None, (0, 150));
    rows.push(once(&mut chip, &[])?.row("silence", 0));
    rows.push(once(&mut chip, &strikes(1, 5, 0.8))?.row("one strike of the demo kit, 100 ms", first));
    let pad_count = demo.kit.pads.len();
    rows.push(once(&mut chip, &strikes(pad_count, 5, 0.8))?.row("every pad of the demo kit struck, 100 ms", all));
    let force: Vec<i32> = (0..480).map(|n| ((f64::from(n) * 0.37).sin() * 2e6) as i32).collect();
    let direct = measure(&mut chip, &demo.binary, &[], Some(&force), (8, 150))?;
    rows.push(direct.row("direct drive of the demo kit's first pad", first));
    // As `Setup::new` has it: so many pads play in frames.
    chip.unlimit_frames()?;
    for count in [4, 8] {
        let kit = pads(count);
        let free = measure(&mut chip, &kit.binary, &strikes(count, 5, 0.8), None, (64, 192))?;
        rows.push(free.row(&format!("{count} pads of 64 modes ringing"), count * MODES_PER_PAD));
    }
    Ok(rows)
}
