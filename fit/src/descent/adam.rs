//! Adam (Kingma and Ba), with the clipped gradients of the released notebook.

use super::parameters::{Kind, Places};

/// Decay of the mean of the gradients.
const MEAN_DECAY: f64 = 0.9;
/// Decay of the mean of their squares.
const SQUARE_DECAY: f64 = 0.999;
/// Number that keeps a step finite.
const EPSILON: f64 = 1e-7;
/// Largest norm of the gradient by the numbers of one kind (`clipnorm`).
const LARGEST_NORM: f64 = 1.0;

/// State of the optimiser.
#[derive(Clone, Debug)]
pub(super) struct Adam {
    means: Vec<f64>,
    squares: Vec<f64>,
    steps: i32,
    /// Learning rate.
    rate: f64,
}

impl Adam {
    pub(super) fn new(places: &Places, rate: f64) -> Self {
        Self { means: vec![0.0; places.total()], squares: vec![0.0; places.total()], steps: 0, rate }
    }

    /// Moves the parameters by one step against their gradient.
    pub(super) fn step(&mut self, places: &Places, parameters: &mut [f64], mut gradient: Vec<f64>) {
        for kind in Kind::ALL {
            let part = &mut gradient[places.of(kind)];
            let norm = part.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm > LARGEST_NORM {
                part.iter_mut().for_each(|x| *x *= LARGEST_NORM / norm);
            }
        }
        self.steps += 1;
        let [mean_share, square_share] = [MEAN_DECAY, SQUARE_DECAY].map(|decay| 1.0 - decay.powi(self.steps));
        for (((parameter, slope), mean), square) in
            parameters.iter_mut().zip(gradient).zip(&mut self.means).zip(&mut self.squares)
        {
            *mean += (1.0 - MEAN_DECAY) * (slope - *mean);
            *square += (1.0 - SQUARE_DECAY) * (slope * slope - *square);
            *parameter -= self.rate * (*mean / mean_share) / ((*square / square_share).sqrt() + EPSILON);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adam_ends_at_the_minimum_of_a_narrow_valley() {
        let places = Places { nodes: 1, modes: 1, noise_bands: 1, room_bands: 1 };
        let mut parameters = vec![1.0; places.total()];
        let mut adam = Adam::new(&places, 0.01);
        let steep = |index: usize| if index == 0 { 0.1 } else { 0.001 };
        for _ in 0..3_000 {
            let gradient = parameters.iter().enumerate().map(|(index, x)| steep(index) * (x - 0.25)).collect();
            adam.step(&places, &mut parameters, gradient);
        }
        assert!(parameters.iter().all(|x| (x - 0.25).abs() < 1e-3), "{parameters:?}");
    }
}
