//! Parts that recordings have in common, the things and the strikers, and who met whom.

use std::collections::BTreeSet;

use super::clip::Clip;

/// Things and strikers of a set of recordings. Things come first, strikers after them.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    /// Number of things.
    pub(super) objects: usize,
    /// Number of things and strikers together.
    pub(super) count: usize,
    /// Thing and striker of each recording, as indices of parts.
    pub(super) of_clip: Vec<[usize; 2]>,
}

impl Parts {
    pub(super) fn new(clips: &[Clip<'_>]) -> Self {
        let objects = clips.iter().map(|clip| clip.object + 1).max().unwrap_or(0);
        let strikers = clips.iter().map(|clip| clip.striker + 1).max().unwrap_or(0);
        let of_clip = clips.iter().map(|clip| [clip.object, objects + clip.striker]).collect();
        Self { objects, count: objects + strikers, of_clip }
    }

    /// True if both parts may sound in one recording, or are one part.
    pub(super) fn may_meet(&self, a: usize, b: usize) -> bool {
        a == b || (a < self.objects) != (b < self.objects)
    }

    /// The other part of a recording; `None` if the recording lacks the part.
    pub(super) fn partner(&self, part: usize, clip: usize) -> Option<usize> {
        match self.of_clip[clip] {
            [object, striker] if object == part => Some(striker),
            [object, striker] if striker == part => Some(object),
            _ => None,
        }
    }

    /// Number of different partners of a part.
    pub(super) fn partners(&self, part: usize) -> usize {
        let partners: BTreeSet<usize> = (0..self.of_clip.len()).filter_map(|clip| self.partner(part, clip)).collect();
        partners.len()
    }

    /// Energies that a part explains in recordings, summed by partner, as [`common`] weighs them.
    pub(super) fn shared(&self, part: usize, energies: impl Iterator<Item = (usize, f64)>) -> f64 {
        let mut of_partner = vec![0.0; self.count];
        for (clip, energy) in energies {
            if let Some(partner) = self.partner(part, clip) {
                of_partner[partner] += energy;
            }
        }
        common(of_partner.into_iter(), self.partners(part))
    }
}

/// Largest ratio of what a mode explains with one partner to what it explains with the next: 17 dB.
const DOMINANT: f64 = 50.0;

/// Energy that speaks for a mode, of the energies that it explains with each partner of its part.
///
/// A mode that is loud with one partner only is that partner's: so that partner does not speak for
/// it, and nothing does if one partner has 17 dB more than any other. A part with a single partner
/// has all of its energy.
pub(super) fn common(of_partner: impl Iterator<Item = f64>, partners: usize) -> f64 {
    let (mut all, mut most, mut next) = (0.0, 0.0f64, 0.0f64);
    for energy in of_partner {
        all += energy;
        next = next.max(energy.min(most));
        most = most.max(energy);
    }
    match partners {
        0 | 1 => all,
        _ if most > DOMINANT * next => 0.0,
        _ => all - most,
    }
}
