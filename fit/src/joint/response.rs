//! Response of a mode to the contact force.

use fourier::Complex;

type C64 = Complex<f64>;

/// Response of a mode to the force, per unit of gain.
#[derive(Clone, Debug)]
pub(super) struct Response {
    /// `ln z`.
    pub(super) log_pole: C64,
    /// `z u[n]` and its derivative by `ln z` at samples 0 to the end of the force, shifted by one:
    /// entry 0 is that before the force.
    pub(super) head: Vec<[C64; 2]>,
}

impl Response {
    pub(super) fn new(log_pole: C64, force: &[f64]) -> Self {
        let z = log_pole.exp();
        let zero = C64::new(0.0, 0.0);
        let mut head = vec![[zero; 2]];
        let (mut u, mut v) = (zero, zero);
        for &force in force {
            v = z * (v + u);
            u = z * u + force;
            head.push([z * u, z * (v + u)]);
        }
        Self { log_pole, head }
    }

    /// `z u[n-1]` at sample n, and its derivative by `ln z`.
    pub(super) fn state(&self, n: i64) -> [C64; 2] {
        let Ok(at) = usize::try_from(n) else { return [C64::new(0.0, 0.0); 2] };
        let end = self.head.len() - 1;
        match self.head.get(at) {
            Some(state) => *state,
            None => {
                let since = (at - end) as f64;
                self.ringing(since, (self.log_pole * since).exp())
            }
        }
    }

    /// The state `since` samples behind the force, or before its end if negative, as if the mode
    /// rang freely. `power` is its pole to the power of `since`.
    pub(super) fn ringing(&self, since: f64, power: C64) -> [C64; 2] {
        let [state, slope] = self.head[self.head.len() - 1];
        [power * state, power * (slope + state * since)]
    }
}

/// Powers of a pole at times of which neighbours often lie equally far apart: each is the one
/// before, times the power of their distance.
pub(super) struct Powers {
    log_pole: C64,
    time: f64,
    power: C64,
    distance: f64,
    factor: C64,
}

impl Powers {
    pub(super) fn of(log_pole: C64) -> Self {
        let one = C64::new(1.0, 0.0);
        Self { log_pole, time: 0.0, power: one, distance: 0.0, factor: one }
    }

    /// The pole to the power of `time`, in samples.
    pub(super) fn at(&mut self, time: f64) -> C64 {
        let distance = time - self.time;
        if distance < 0.0 {
            // The way back from what has died away would begin at 0.
            *self = Self { time, power: (self.log_pole * time).exp(), ..Self::of(self.log_pole) };
            return self.power;
        }
        if distance != self.distance {
            (self.distance, self.factor) = (distance, (self.log_pole * distance).exp());
        }
        (self.time, self.power) = (time, self.power * self.factor);
        self.power
    }
}
