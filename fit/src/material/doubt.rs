//! Doubts about a Young's modulus that was read off a solid of known size.

use std::fmt;

use super::ringing::RingingMode;
use super::solid::{LEAST_LEVEL_DB, LEAST_MODES, LEAST_SHARE, MODULI_PA, MOST_CHANCE, Modulus, Solid};

/// Young's moduli that solids have, in pascals: from the softest rubber to diamond.
const REAL_PA: std::ops::RangeInclusive<f64> = 1e5..=1.2e12;
/// Reason to doubt a Young's modulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// The modes do not stand where those of the solid do.
    OtherSeries {
        /// Solid that was given.
        solid: Solid,
        /// Number of modes that stand where one of the solid's does.
        modes: usize,
        /// Share of the energy that they have, 0 to 1.
        share: f64,
    },
    /// Modes at other frequencies often stand as near to those of the solid.
    ByChance {
        /// Solid that was given.
        solid: Solid,
        /// Share of trials in which they do, 0 to 1.
        chance: f64,
    },
    /// No solid has the modulus.
    Impossible {
        /// Young's modulus in pascals.
        pascals: f64,
    },
    /// The modes tell no modulus.
    NoModulus,
}

impl Doubt {
    /// Doubts about the modulus that the modes of a solid tell.
    pub(super) fn about(modulus: Option<&Modulus>, modes: &[RingingMode], solid: Solid) -> Vec<Self> {
        let Some(modulus) = modulus else {
            let is_heard = modes.iter().any(|mode| mode.level_db > LEAST_LEVEL_DB);
            return if is_heard { vec![Self::NoModulus] } else { Vec::new() };
        };
        let (pascals, modes, share) = (modulus.pascals.estimate, modulus.modes, modulus.share);
        let other = modes < LEAST_MODES || share < LEAST_SHARE;
        let by_chance =
            (!other && modulus.chance > MOST_CHANCE).then_some(Self::ByChance { solid, chance: modulus.chance });
        let other = other.then_some(Self::OtherSeries { solid, modes, share });
        let impossible = (!REAL_PA.contains(&pascals)).then_some(Self::Impossible { pascals });
        other.into_iter().chain(by_chance).chain(impossible).collect()
    }
}

/// Numbers that decide about a modulus.
const CHECK: &str = "check the body, its sizes in metres and its density in kg/m³";

fn name(solid: Solid) -> &'static str {
    match solid {
        Solid::Bar { .. } => "a bar that is free at both ends",
        Solid::Disc { .. } => "a disc that is free all round",
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherSeries { solid, modes, share } => {
                let body = name(*solid);
                let [number, stand, have] =
                    if *modes == 1 { ["mode", "stands", "has"] } else { ["modes", "stand", "have"] };
                let percent = 100.0 * share;
                write!(
                    f,
                    "{modes} {number} {stand} where {body} has its own, and {have} {percent:.0} % of the energy: Young's \
                     modulus is that of another body, or uncertain; {CHECK}"
                )
            }
            Self::ByChance { solid, chance } => write!(
                f,
                "modes of other bodies stand as near to those of {} in {:.0} % of trials: Young's modulus is that of \
                 another body, or anywhere in its range; {CHECK}",
                name(*solid),
                100.0 * chance
            ),
            Self::Impossible { pascals } => {
                write!(f, "a Young's modulus of {pascals:.1e} Pa is none of a solid, 1e5 to 1.2e12 Pa: {CHECK}")
            }
            Self::NoModulus => {
                let (low, high) = (MODULI_PA.start(), MODULI_PA.end());
                write!(f, "no mode tells a Young's modulus from {low:.0e} to {high:.0e} Pa: {CHECK}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Told, guess};
    use super::*;
    use crate::random::SplitMix64;

    const BAR: Solid = Solid::Bar { length_m: 0.3, height_m: 0.006, density: 7850.0 };
    const DISC: Solid = Solid::Disc { radius_m: 0.1, height_m: 0.004, density: 2600.0 };

    fn told(numbers: &[f64], lowest_hz: f64, solid: Solid) -> Told {
        let modes = numbers.iter().zip([0.0, -3.0, -6.0, -5.0, -9.0]).map(|(number, level_db)| RingingMode {
            frequency_hz: lowest_hz * number / numbers[0],
            decay_per_s: 5.0,
            level_db,
        });
        guess(&modes.collect::<Vec<_>>(), &[], Some(solid))
    }

    #[test]
    fn modes_of_the_body_that_was_given_raise_no_doubt() {
        let bar = told(&[22.373, 61.673, 120.9, 199.86, 298.56], 343.0, BAR);
        assert_eq!(bar.doubts, [], "{:?}", bar.young_modulus_pa);
        let disc = told(&[5.358, 9.003, 12.439, 20.475, 21.835], 522.0, DISC);
        assert_eq!(disc.doubts, [], "{:?}", disc.young_modulus_pa);
    }

    #[test]
    fn modes_of_another_body_are_told() {
        let bodies: [(&[f64], Solid); 4] = [
            (&[5.358, 9.003, 12.439, 20.475, 21.835], BAR),
            (&[22.373, 61.673, 120.9, 199.86, 298.56], DISC),
            (&[1.0, 2.0, 3.0, 4.0, 5.0], BAR),
            // A mode alone lies somewhere in every series.
            (&[1.0], BAR),
        ];
        for (numbers, solid) in bodies {
            let told = told(numbers, 500.0, solid);
            let is_told = |doubt: &Doubt| matches!(doubt, Doubt::OtherSeries { .. });
            assert!(told.doubts.iter().any(is_told), "{numbers:?} {told:?}");
        }
    }

    /// Modes of a random thing whose lowest mode has a frequency: some modes of its series, or any
    /// frequencies if it has none, with up to five others that are weaker by 6 dB and more.
    fn random(series: &[f64], lowest_hz: f64, random: &mut SplitMix64) -> Vec<RingingMode> {
        let mut weaker = |least_db: f64| least_db + 8.0 * (1.0 - random.uniform()).ln();
        let levels_db: [f64; 24] = std::array::from_fn(|index| weaker(if index < 16 { 0.0 } else { -6.0 }));
        let count = 3 + (random.uniform() * if series.is_empty() { 13.0 } else { series.len() as f64 - 2.0 }) as usize;
        let others = (random.uniform() * 6.0) as usize;
        let own = (0..count).map(|index| match series.get(index) {
            Some(number) => (number / series[0] * (0.004 * random.normal()).exp(), random.uniform() > 0.12),
            None => ((3.0 * random.uniform()).exp(), true),
        });
        let own: Vec<(f64, bool)> = own.collect();
        let own = own.into_iter().enumerate().filter(|(index, (_, is_heard))| *index == 0 || *is_heard);
        let mut modes: Vec<(f64, f64)> = own.map(|(index, (ratio, _))| (ratio, levels_db[index])).collect();
        if !series.is_empty() {
            modes.extend((0..others).map(|index| (1.1 + 14.0 * random.uniform(), levels_db[16 + index])));
        }
        let loudest = modes.iter().map(|mode| mode.1).fold(f64::MIN, f64::max);
        let ringing = |(ratio, level_db): (f64, f64)| RingingMode {
            frequency_hz: lowest_hz * ratio,
            decay_per_s: 5.0,
            level_db: level_db - loudest,
        };
        modes.into_iter().map(ringing).collect()
    }

    #[test]
    fn most_random_bodies_of_another_kind_are_doubted_and_few_of_the_right_one() {
        const COUNT: usize = 200;
        let bar = [22.373, 61.673, 120.903, 199.859, 298.556, 416.991, 555.165, 713.079];
        let disc = [5.358, 9.003, 12.439, 20.475, 21.835, 33.495, 35.260, 38.443];
        let membrane = [2.405, 3.832, 5.136, 5.520, 6.380, 7.016, 7.588, 8.417];
        let harmonic = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
        let slender = Solid::Bar { length_m: 0.3, height_m: 0.001, density: 7850.0 };
        let mut generator = SplitMix64(5);
        for (name, series) in
            [("bar", &bar[..]), ("disc", &disc), ("membrane", &membrane), ("string", &harmonic), ("anything", &[])]
        {
            for (given, solid, lowest_hz) in [("bar", slender, 57.0), ("disc", DISC, 522.0)] {
                let is_doubted = |_: &usize| {
                    let octaves = if name == given { 0.0 } else { 3.0 * generator.uniform() - 1.5 };
                    let modes = random(series, lowest_hz * octaves.exp2(), &mut generator);
                    !guess(&modes, &[], Some(solid)).doubts.is_empty()
                };
                let doubted = (0..COUNT).filter(is_doubted).count();
                println!("{name} given as a {given}: {doubted} of {COUNT} are doubted");
                if name == given {
                    assert!(doubted * 20 < COUNT, "{doubted} of {COUNT}: {name} as {given}");
                } else {
                    assert!(doubted * 10 > 9 * COUNT, "{doubted} of {COUNT}: {name} as {given}");
                }
            }
        }
    }

    #[test]
    fn range_of_a_doubted_modulus_is_wide_and_that_of_the_right_body_is_narrow() {
        let bar = [22.373, 61.673, 120.903, 199.859, 298.556, 416.991, 555.165, 713.079];
        let slender = Solid::Bar { length_m: 0.3, height_m: 0.001, density: 7850.0 };
        let mut generator = SplitMix64(6);
        for series in [&bar[..], &[]] {
            let widths = (0..100).filter_map(|_| {
                let told = guess(&random(series, 57.0, &mut generator), &[], Some(slender));
                let pascals = told.young_modulus_pa.filter(|_| told.doubts.is_empty() != series.is_empty())?;
                Some(pascals.high / pascals.low)
            });
            let widths: Vec<f64> = widths.collect();
            let wide = widths.iter().filter(|width| **width > 2.0).count();
            println!("{wide} of {} ranges are wider than a factor of 2", widths.len());
            let is_right = if series.is_empty() { wide * 2 > widths.len() } else { wide == 0 };
            assert!(widths.len() > 80 && is_right, "{wide} of {}: {series:?}", widths.len());
        }
    }

    #[test]
    fn moduli_of_no_solid_are_told_and_so_is_none() {
        // A bar whose thickness was given as its length's thirtieth, and is a third of that.
        let numbers = [22.373, 61.673, 120.9, 199.86, 298.56];
        let thin = told(&numbers, 900.0, BAR);
        assert!(matches!(thin.doubts[..], [Doubt::Impossible { pascals }] if pascals > 1.2e12), "{thin:?}");
        let message = thin.doubts[0].to_string();
        assert!(message.contains("e12 Pa is none of a solid") && message.contains("density"), "{message}");
        assert_eq!(told(&numbers, 1e5, BAR).doubts, [Doubt::NoModulus]);
        assert_eq!(guess(&[], &[], Some(BAR)).doubts, []);
    }
}
