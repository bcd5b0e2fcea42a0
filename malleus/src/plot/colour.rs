//! Colours of the pictures: a few fixed ones and two colour maps.

/// Colour in 8-bit sRGB with an opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Colour {
    /// Red component, 0 to 255.
    pub(super) red: u8,
    /// Green component, 0 to 255.
    pub(super) green: u8,
    /// Blue component, 0 to 255.
    pub(super) blue: u8,
    /// Opacity, from 0 (invisible) to 255 (opaque).
    pub(super) opacity: u8,
}

impl Colour {
    /// Creates an opaque colour from its sRGB hexadecimal value, `0xRRGGBB`.
    pub(super) const fn hex(rgb: u32) -> Self {
        let [_, red, green, blue] = rgb.to_be_bytes();
        Self { red, green, blue, opacity: 255 }
    }
}

/// Colour of the blank page.
pub(super) const PAGE: Colour = Colour::hex(0xffffff);
/// Colour of titles and data labels.
pub(super) const INK: Colour = Colour::hex(0x1b2027);
/// Colour of axis labels and remarks.
pub(super) const MUTED: Colour = Colour::hex(0x59626d);
/// Colour of the frame and the ticks of a panel.
pub(super) const FRAME: Colour = Colour::hex(0x8c949d);
/// Colour of grid lines.
pub(super) const GRID: Colour = Colour::hex(0xe7eaed);
/// Colour of every other lane, and of places without data.
pub(super) const LANE: Colour = Colour::hex(0xf4f6f8);
/// Colour of a waveform.
pub(super) const WAVEFORM: Colour = Colour::hex(0x27628f);
/// Colour of modes and stages that a contact force drives.
pub(super) const DRIVEN: Colour = Colour::hex(0xc8553d);
/// Colour of modes that ring without a force.
pub(super) const FREE: Colour = Colour::hex(0x8fb4cf);
/// Colour of the strikers' own banks.
pub(super) const STRIKER: Colour = Colour::hex(0xd9972f);
/// Colour of the acceleration sound.
pub(super) const ACCELERATION: Colour = Colour::hex(0x4f8a6d);
/// Colour of a force that drives a pad directly.
pub(super) const DIRECT: Colour = Colour::hex(0x6b5b95);

/// Perceptually uniform colour map: one polynomial of degree 6 for each of red, green and blue.
///
/// The polynomials fit the maps of S. van der Walt and N. Smith in matplotlib (CC0). Their
/// coefficients are those of M. Zucker (CC0), rounded to 1e-4.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColourMap {
    coefficients: [[f32; 3]; 7],
}

/// Map from black over purple to pale yellow, for levels.
pub(super) const MAGMA: ColourMap = ColourMap {
    coefficients: [
        [-0.0021, -0.0007, -0.0054],
        [0.2517, 0.6775, 2.4940],
        [8.3537, -3.5777, 0.3145],
        [-27.6687, 14.2647, -13.6492],
        [52.1761, -27.9436, 12.9442],
        [-50.7685, 29.0466, 4.2342],
        [18.6557, -11.4898, -5.6020],
    ],
};

/// Map from dark blue over green to yellow, for decay times.
pub(super) const VIRIDIS: ColourMap = ColourMap {
    coefficients: [
        [0.2777, 0.0054, 0.3341],
        [0.1051, 1.4046, 1.3846],
        [-0.3309, 0.2148, 0.0951],
        [-4.6342, -5.7991, -19.3324],
        [6.2283, 14.1799, 56.6906],
        [4.7764, -13.7451, -65.3530],
        [-5.4355, 4.6459, 26.3124],
    ],
};

impl ColourMap {
    /// Colour at `share` of the way from the low end (0) to the high end (1).
    ///
    /// A share beyond an end gives the colour of that end.
    pub(super) fn colour(&self, share: f32) -> Colour {
        let share = share.clamp(0.0, 1.0);
        let channel =
            |index: usize| byte(self.coefficients.iter().rev().fold(0.0, |sum, term| sum * share + term[index]));
        Colour { red: channel(0), green: channel(1), blue: channel(2), opacity: 255 }
    }
}

/// Converts a share from 0 to 1 to a byte from 0 to 255.
fn byte(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(colour: Colour, published: u32) {
        let [_, red, green, blue] = published.to_be_bytes();
        for (ours, theirs) in [(colour.red, red), (colour.green, green), (colour.blue, blue)] {
            assert!(ours.abs_diff(theirs) <= 6, "{colour:?} against {published:06x}");
        }
    }

    #[test]
    fn colour_maps_pass_through_their_published_colours() {
        for (share, magma, viridis) in [
            (0.0, 0x000004, 0x440154),
            (0.25, 0x51127c, 0x3b528b),
            (0.5, 0xb73779, 0x21918c),
            (0.75, 0xfc8961, 0x5ec962),
            (1.0, 0xfcfdbf, 0xfde725),
        ] {
            assert_near(MAGMA.colour(share), magma);
            assert_near(VIRIDIS.colour(share), viridis);
        }
    }

    #[test]
    fn magma_is_never_darker_for_a_louder_level() {
        let lightness = |share: f32| {
            let colour = MAGMA.colour(share);
            0.2126 * f32::from(colour.red) + 0.7152 * f32::from(colour.green) + 0.0722 * f32::from(colour.blue)
        };
        for step in 1..=50 {
            let share = step as f32 / 50.0;
            assert!(lightness(share) + 1.5 > lightness(share - 0.02));
        }
    }
}
