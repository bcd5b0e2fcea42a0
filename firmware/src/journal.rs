//! Log of the audio interrupt: its lines, with the names of the kit that plays.

use core::cell::RefCell;

use dsp_core::event::{Action, Event, Shedding};
use dsp_core::table::Kit;
use embassy_sync::blocking_mutex::ThreadModeMutex;
use embassy_time::{Duration, Instant};

use crate::audio::{Line, Log};
use crate::faults::{self, Fault};

/// Time for which a passing fault is shown.
const SHOWN: Duration = Duration::from_secs(5);

/// Log of the audio interrupt, with what its lines say of faults.
struct Journal {
    lines: Log,
    /// Kit whose pads the lines name.
    kit: Kit<'static>,
    sound_until: Instant,
    adc_until: Instant,
    /// Bit n is set while piezo n fails.
    failing_piezos: u32,
}

static JOURNAL: ThreadModeMutex<RefCell<Option<Journal>>> = ThreadModeMutex::new(RefCell::new(None));

/// Begins the log with the kit that plays.
pub fn begin(lines: Log, kit: Kit<'static>) {
    let journal = Journal { lines, kit, sound_until: Instant::MIN, adc_until: Instant::MIN, failing_piezos: 0 };
    JOURNAL.lock(|place| *place.borrow_mut() = Some(journal));
}

/// Logs the lines of the audio interrupt that wait. Later lines name the pads of `next`, if there
/// is one.
pub fn pass_on(next: Option<Kit<'static>>) {
    JOURNAL.lock(|journal| {
        let Ok(mut journal) = journal.try_borrow_mut() else { return };
        if let Some(journal) = journal.as_mut() {
            journal.pass_on();
            journal.kit = next.unwrap_or(journal.kit);
        }
    });
}

impl Journal {
    fn pass_on(&mut self) {
        while let Some(line) = self.lines.take() {
            let shown_until = Instant::now() + SHOWN;
            match line {
                Line::Event(event) => tell(&event, &self.kit),
                Line::PiezoFault { channel, fault } => {
                    self.failing_piezos |= 1 << (channel % 32);
                    defmt::error!("piezo {=u8}: {}", channel, defmt::Display2Format(&fault));
                }
                Line::PiezoRecovered { channel } => {
                    self.failing_piezos &= !(1 << (channel % 32));
                    defmt::info!("piezo {=u8}: well again", channel);
                }
                Line::Missed { halves } => {
                    self.sound_until = shown_until;
                    defmt::warn!("audio: {=u32} halves missed", halves);
                }
                Line::StreamRestarted => {
                    self.sound_until = shown_until;
                    defmt::error!("I2S: DMA transfer error, stream started anew");
                }
                Line::AdcRestarted => {
                    self.adc_until = shown_until;
                    defmt::error!("ADC: overrun or DMA error, sampling started anew");
                }
            }
        }
        let now = Instant::now();
        faults::set(Fault::Piezo, self.failing_piezos != 0);
        faults::set(Fault::Sound, now < self.sound_until);
        faults::set(Fault::Adc, now < self.adc_until);
    }
}

/// Logs an event as a line of an events file.
fn tell(event: &Event, kit: &Kit<'static>) {
    let sample = event.time.first_frame();
    let pad = kit.pads().nth(usize::from(event.pad));
    let name = pad.map_or("", |pad| pad.name());
    match event.action {
        Action::Strike => {
            let striker = pad.and_then(|pad| kit.strikers_of(pad).nth(usize::from(event.striker)));
            let striker = striker.map_or("", |striker| striker.name());
            defmt::info!(
                "event {=u64},{=str},{=f32},{=f32},{=str},strike",
                sample,
                name,
                event.velocity,
                event.position,
                striker
            );
        }
        Action::Choke => defmt::info!("event {=u64},{=str},,,,choke", sample, name),
        Action::Release => defmt::info!("event {=u64},{=str},,,,release", sample, name),
        Action::Level => defmt::info!("event {=u64},,{=f32},,,level", sample, event.velocity),
        Action::Silence => defmt::info!("event {=u64},,,,,silence", sample),
        Action::Shed(Shedding::Quietest(groups)) => defmt::info!("event {=u64},,,,,shed {=u16}", sample, groups),
        Action::Shed(Shedding::AllButFirst) => defmt::info!("event {=u64},,,,,shed all but first", sample),
    }
}
