//! Instruments of the kit `recorded`: their recordings, numbers of modes, and pads.

/// Instrument of the kit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instrument {
    /// Name of the table, of its object and of the pad.
    pub(crate) name: &'static str,
    /// File name of the recording.
    pub(crate) recording: &'static str,
    /// Maximum number of modes; more would not bring the sound much nearer to the recording.
    pub(crate) modes: usize,
    /// Pan of the pad, -1 to 1.
    pub(crate) pan: f32,
    /// Level of the pad in dB. A long sound is as loud as a short one at a lower peak.
    pub(crate) level_db: f32,
    /// T60 of the pad while it is choked, in seconds; 0 for a pad that cannot be choked.
    pub(crate) choke_t60_s: f32,
    /// MIDI notes: those of General MIDI percussion for the instrument or one like it, if it has
    /// one.
    pub(crate) midi_notes: &'static [u8],
}

const fn instrument(
    name: &'static str,
    recording: &'static str,
    modes: usize,
    (pan, level_db, choke_t60_s): (f32, f32, f32),
    midi_notes: &'static [u8],
) -> Instrument {
    Instrument { name, recording, modes, pan, level_db, choke_t60_s, midi_notes }
}

/// Instruments of the kit, in the order of its pads.
pub(crate) const INSTRUMENTS: [Instrument; 14] = [
    instrument("bass-drum", "membrane_bobobobass_1.wav", 24, (0.0, -7.9, 0.08), &[35, 36, 41, 43]),
    instrument("treble-drum", "membrane_bobobotreble_1.wav", 32, (-0.2, -1.4, 0.08), &[38, 40, 45, 47]),
    instrument("bongo", "membrane_bongo_1.wav", 32, (0.3, -1.6, 0.08), &[60, 61, 62, 63]),
    instrument("tabla", "membrane_tabla_1.wav", 48, (-0.4, -6.9, 0.08), &[48, 50, 64, 66]),
    instrument("marimba-low", "wood_marimba_1.wav", 24, (-0.3, -5.7, 0.12), &[71]),
    instrument("marimba", "wood_marimba_2.wav", 24, (-0.15, -8.0, 0.12), &[72]),
    instrument("xylophone", "wood_xylophone_1.wav", 32, (0.2, -7.6, 0.1), &[74]),
    instrument("glockenspiel", "metal_glockenspiel_1.wav", 40, (0.4, -6.2, 0.1), &[80, 81]),
    instrument("handbell", "metal_handbell_1.wav", 24, (0.15, -8.5, 0.2), &[51, 53, 59]),
    instrument("meditation-bell", "metal_meditationbell_1.wav", 40, (-0.1, -10.7, 0.25), &[49, 52, 55, 57]),
    instrument("wood-block", "wood_block_1.wav", 64, (0.6, -0.3, 0.0), &[76, 77]),
    instrument("utensil-holder", "wood_holder_1.wav", 32, (-0.6, 5.0, 0.0), &[37, 75]),
    instrument("ceramic-mug", "ceramic_mug_1.wav", 24, (0.5, -2.4, 0.0), &[46, 56]),
    instrument("plastic-cup", "plastic_cup_1.wav", 32, (-0.5, 2.6, 0.0), &[39, 42, 44, 54]),
];
