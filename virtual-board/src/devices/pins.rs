//! Analog side of the piezos' pins: what is wired to each, the chip's pulls, and the sampling
//! capacitor that all channels share.

use super::gpio::{Mode, Pull};

/// Part that is wired to a piezo's pin.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PiezoPin {
    /// Piezo with clamp and bias, as in docs/hardware.md.
    #[default]
    Circuit,
    /// Nothing.
    Open,
    /// Ground.
    Grounded,
    /// Wire of 10 cm with nothing at its end, which picks up the mains' hum.
    Wire,
}

/// Supply of the chip, in volts.
pub(super) const SUPPLY: f64 = 3.3;
/// Pull resistor of the chip, in ohms (datasheets: 30 to 50 kΩ).
const PULL: f64 = 40e3;
/// Bias of a piezo: two resistors of 100 kΩ in parallel, in ohms.
const BIAS: f64 = 50e3;
/// Capacitance that the bias charges, in farads: 1 nF at the pin, and 100 nF in series with the
/// 20 nF of a piezo.
const CIRCUIT: f64 = 17.7e-9;
/// Sampling capacitor of the ADC, in farads (datasheets: 4 pF).
const SAMPLING: f64 = 4e-12;
/// Capacitance of an open pin, in farads: a sample moves its voltage by 0.22 of the way to the
/// voltage that was sampled before, as measured on an F4 Discovery.
const OPEN: f64 = SAMPLING * 0.78 / 0.22;
/// Capacitance that a wire of 10 cm adds, in farads.
const WIRE: f64 = 10e-12;
/// Time in which a pin that nothing drives loses its charge through leakage, in seconds.
const LEAK_S: f64 = 0.05;
/// Hum on a wire with nothing at its end: amplitude in volts, and frequency in hertz.
const HUM: (f64, f64) = (0.05, 50.0);

/// Pins of the piezos, and the ADC's sampling capacitor.
#[derive(Debug, Clone)]
pub(crate) struct Pins {
    pins: Vec<Pin>,
    /// Voltage of the sampling capacitor.
    sampled: f64,
    /// Noise of each conversion in counts, rms.
    noise_counts: f64,
    random: u32,
}

#[derive(Debug, Clone, Copy)]
struct Pin {
    wired: PiezoPin,
    /// Voltage of an undriven pin; for a circuit what it deviates from its undisturbed voltage.
    volts: f64,
    /// Time up to which `volts` is right, in seconds.
    at_s: f64,
    pull: Pull,
}

impl Pins {
    pub(crate) fn new(wired: &[PiezoPin], noise_counts: f64) -> Pins {
        let pin = |&wired: &PiezoPin| Pin { wired, volts: 0.0, at_s: 0.0, pull: Pull::None };
        Pins { pins: wired.iter().map(pin).collect(), sampled: 0.0, noise_counts, random: 1 }
    }

    /// Notes the pull of a pin from now on. An analog pin has none.
    pub(crate) fn set_pull(&mut self, piezo: usize, mode: Mode, pull: Pull, now_s: f64) {
        let pull = if mode == Mode::Analog { Pull::None } else { pull };
        if let Some(pin) = self.pins.get_mut(piezo).filter(|pin| pin.pull != pull) {
            pin.settle(now_s);
            pin.pull = pull;
        }
    }

    /// Samples a pin: returns the code of the ADC. `undisturbed` is the voltage that a piezo's
    /// circuit has by itself.
    pub(crate) fn sample(&mut self, piezo: usize, undisturbed: f64, now_s: f64) -> u16 {
        let noise = self.noise();
        let Some(pin) = self.pins.get_mut(piezo) else { return 0 };
        pin.settle(now_s);
        let hum = HUM.0 * (std::f64::consts::TAU * HUM.1 * now_s).sin();
        let volts = match pin.wired {
            // 1 nF beside 4 pF: what the capacitor brings along is less than the noise.
            PiezoPin::Circuit => undisturbed + pin.volts,
            PiezoPin::Grounded => 0.0,
            PiezoPin::Open => pin.share(self.sampled, OPEN, 0.0),
            PiezoPin::Wire => pin.share(self.sampled, OPEN + WIRE, hum),
        };
        // The clamp keeps the pin between the rails.
        self.sampled = volts.clamp(0.0, SUPPLY);
        (4095.0 * self.sampled / SUPPLY + noise).round().clamp(0.0, 4095.0) as u16
    }

    /// Returns the noise of a conversion in counts: the sum of twelve uniform numbers.
    fn noise(&mut self) -> f64 {
        if self.noise_counts == 0.0 {
            return 0.0;
        }
        let mut uniform = || {
            self.random = self.random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(self.random >> 8) / f64::from(1 << 24) - 0.5
        };
        self.noise_counts * (0..12).map(|_| uniform()).sum::<f64>()
    }
}

impl Pin {
    /// Brings the voltage to a time.
    fn settle(&mut self, now_s: f64) {
        let passed = now_s - self.at_s;
        self.at_s = now_s;
        let rail = match self.pull {
            Pull::None => None,
            Pull::Up => Some(SUPPLY),
            Pull::Down => Some(0.0),
        };
        let (end, lasts_s) = match (self.wired, rail) {
            (PiezoPin::Circuit, None) => (0.0, BIAS * CIRCUIT),
            (PiezoPin::Circuit, Some(rail)) => {
                ((rail - SUPPLY / 2.0) * BIAS / (BIAS + PULL), BIAS * PULL / (BIAS + PULL) * CIRCUIT)
            }
            (_, None) => (0.0, LEAK_S),
            (_, Some(rail)) => (rail, PULL * (OPEN + WIRE)),
        };
        self.volts = end + (self.volts - end) * (-passed / lasts_s).exp();
    }

    /// Shares the charge of the sampling capacitor with a pin of a capacitance; returns the common
    /// voltage. `hum` is what the surroundings add.
    fn share(&mut self, sampled: f64, capacitance: f64, hum: f64) -> f64 {
        let own = self.volts + hum;
        let common = (own * capacitance + sampled * SAMPLING) / (capacitance + SAMPLING);
        self.volts += common - own;
        common
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pins(wired: PiezoPin) -> Pins {
        Pins::new(&[PiezoPin::Circuit, wired], 0.0)
    }

    #[test]
    fn an_open_pin_follows_the_channel_before_by_22_percent_a_scan() {
        let mut pins = pins(PiezoPin::Open);
        let codes = (0..3).map(|scan| {
            pins.sample(0, SUPPLY, 1e-5 * f64::from(scan));
            pins.sample(1, 0.0, 1e-5 * f64::from(scan))
        });
        assert_eq!(codes.collect::<Vec<_>>(), [901, 1603, 2151]);
    }

    #[test]
    fn a_circuit_goes_back_to_its_bias_when_a_pull_ends_and_an_open_pin_stays() {
        for (wired, after_pull, later) in [(PiezoPin::Circuit, 3185, 2086), (PiezoPin::Open, 3194, 3008)] {
            let mut pins = pins(wired);
            pins.set_pull(1, Mode::Input, Pull::Up, 0.0);
            pins.set_pull(1, Mode::Analog, Pull::Up, 0.005);
            assert_eq!(pins.clone().sample(1, SUPPLY / 2.0, 0.005), after_pull, "{wired:?}");
            assert_eq!(pins.sample(1, SUPPLY / 2.0, 0.008), later, "{wired:?}");
        }
    }
}
