//! Direct forces on pads that a motion's contacts make.

use dsp_core::fixed::ONE_Q27;
use dsp_core::time::TICK_FRAMES;

use super::super::part::{self, Part};
use super::contacts::{Scraped, Source};

/// Force of a motion as a direct force on its pad, in Q4.27 of the force bus.
///
/// `None` if one is not enough: contacts with several pads or strikers, with another than the first
/// striker, or on an object with several positions. Then [`parts`] make the sound.
pub fn direct(scraped: &Scraped, kit: &kit::Kit) -> Option<(u8, Vec<i32>)> {
    let first = scraped.sources.first()?;
    let pad = kit.pads.get(usize::from(first.pad))?;
    let is_plain = scraped.sources.iter().all(|source| (source.pad, source.striker) == (first.pad, 0));
    (is_plain && part::positions(kit, pad) == 1).then(|| (first.pad, force(scraped)))
}

/// Force of all contacts of a motion on one pad, in Q4.27 of the force bus.
pub fn force(scraped: &Scraped) -> Vec<i32> {
    summed(&scraped.sources, |_, _| 1.0)
}

/// Splits the contacts of a motion into parts ([`part`](super::super::part)), whose sounds add up:
/// one for each pad and position, in the shares of the contact's place along the object, and one
/// for each striker with modes of its own.
pub fn parts(scraped: &Scraped, kit: &kit::Kit) -> Vec<Part> {
    let mut parts = Vec::new();
    for (index, pad) in (0u8..).zip(&kit.pads) {
        let here: Vec<Source> = scraped.sources.iter().filter(|source| source.pad == index).cloned().collect();
        if here.is_empty() {
            continue;
        }
        let positions = part::positions(kit, pad);
        for position in 0..positions {
            let shares = |source: &Source, tick: usize| {
                source.along.get(tick).map_or(0.0, |&along| part::share(along, position, positions))
            };
            parts.push(Part { kit: part::at_position(kit, pad, position), direct: (index, summed(&here, shares)) });
        }
        for striker in 0..pad.strikers.len() {
            let own: Vec<Source> = here.iter().filter(|s| usize::from(s.striker) == striker).cloned().collect();
            if own.is_empty() {
                continue;
            }
            let kit = part::of_striker(kit, pad, striker);
            parts.extend(kit.map(|kit| Part { kit, direct: (index, summed(&own, |_, _| 1.0)) }));
        }
    }
    // What sounds without a contact sounds once.
    parts.iter_mut().skip(1).for_each(|part| part.kit.background = None);
    parts
}

/// Sum of forces in Q4.27 of the force bus, each with its share at the end of each tick; within a
/// tick shares change in straight lines.
fn summed(sources: &[Source], share: impl Fn(&Source, usize) -> f64) -> Vec<i32> {
    let end = sources.iter().map(|source| source.first_frame + source.force_n.len()).max().unwrap_or(0);
    let mut sum = vec![0.0; end];
    for source in sources {
        for (tick, newtons) in source.force_n.chunks(TICK_FRAMES).enumerate() {
            let to = share(source, tick);
            let from = tick.checked_sub(1).map_or(to, |before| share(source, before));
            for (frame, newtons) in newtons.iter().enumerate() {
                let weight = from + (to - from) * (frame + 1) as f64 / TICK_FRAMES as f64;
                let at = source.first_frame + tick * TICK_FRAMES + frame;
                sum[at] += newtons * weight / source.reference_force_n;
            }
        }
    }
    // `as` saturates, as the force bus does.
    sum.into_iter().map(|force| (force * f64::from(ONE_Q27)).round() as i32).collect()
}
